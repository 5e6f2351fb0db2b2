// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl/pcl_base.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include "pcl_slim/filters/slim_projection_base.h"

namespace pcl_slim {

/** \brief Colours for the points of a cloud, from a coloured SLIM surface of the same object.
 *
 * \code
 * pcl_slim::SLIMColorizer<pcl::PointXYZ> colorizer;
 * colorizer.setInputCloud(cloud);
 * colorizer.setSurface(surface);  // of a coloured scan
 * pcl::PointCloud<pcl::PointXYZRGB> colored;
 * if (!colorizer.colorize(colored)) std::cerr << colorizer.getError().message << "\n";
 * \endcode
 *
 * Each point gets the colour where it meets the surface; points stay where they are. Where the
 * cloud has normals (setInputNormals(), else fields of PointInT) and the surface is oriented, only
 * leaves that face a point's normal count, so that both sides of a thin part keep their colours;
 * without normals the nearest side counts. A point that is farther than half a radius from every
 * leaf around it keeps its own colour, or is white where PointInT has no field rgb or rgba;
 * getUnsupported() returns these points.
 *
 * The surface is that of setSurface(), which must have colours. Without one, a surface is fitted
 * to the input and its own colours, which averages noise of colours on the surface.
 *
 * The output has one point for each of the input, or for each index, with width and height kept
 * without indices. Fields that both types have are copied. Points with a NaN coordinate stay as
 * unsupported ones do. The result is the same for any number of threads.
 *
 * A missing or empty cloud, one without a finite point, indices out of range, a surface without
 * colours, and an input without colours where no surface is set are errors: the output is then
 * empty and getError() gives the reason.
 *
 * PointOutT may be any type with a field rgb or rgba. Compiled for the inputs SLIMCrestLines is
 * compiled for, and for PointXYZRGB, PointXYZRGBA and PointXYZRGBNormal as output. For other types
 * include pcl_slim/filters/impl/slim_colorizer.hpp where you use them.
 */
template <typename PointInT, typename PointOutT = pcl::PointXYZRGB>
class SLIMColorizer : public pcl::PCLBase<PointInT>, public SLIMProjectionBase {
 public:
  using Ptr = pcl::shared_ptr<SLIMColorizer<PointInT, PointOutT>>;
  using ConstPtr = pcl::shared_ptr<const SLIMColorizer<PointInT, PointOutT>>;
  using PointCloudOut = pcl::PointCloud<PointOutT>;
  using NormalCloud = pcl::PointCloud<pcl::Normal>;

  /** \brief Normals of the input cloud, one for each of its points; null: those of PointInT if it
   * has any. */
  void setInputNormals(const NormalCloud::ConstPtr& normals) { normals_ = normals; }
  NormalCloud::ConstPtr getInputNormals() const { return normals_; }

  /** \brief Colours the points. \param[out] output may be the input cloud. \return false with
   * getError() and an empty output when it cannot. O(points + surfels log surfels). */
  bool colorize(PointCloudOut& output);

 protected:
  using pcl::PCLBase<PointInT>::input_;
  using pcl::PCLBase<PointInT>::indices_;
  using pcl::PCLBase<PointInT>::use_indices_;

 private:
  /** \brief Copies the points and gives those that are supported the surface's colours. \param[in]
   * indices null: all points \param[in] far a projection of points up to half a radius away
   * \param[in] near one of those that a smoothing moves */
  void write(const pcl::PointCloud<PointInT>& input, const pcl::Indices* indices,
             const SLIMSurface& surface, const CloudProjection& far, const CloudProjection& near,
             PointCloudOut& output) const;

  NormalCloud::ConstPtr normals_;
};

}  // namespace pcl_slim

#ifdef PCL_NO_PRECOMPILE
#include "pcl_slim/filters/impl/slim_colorizer.hpp"
#endif
