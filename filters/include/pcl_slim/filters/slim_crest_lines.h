// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pcl_slim/filters/point_crest.h"
#include "pcl_slim/filters/slim_crest_lines_base.h"
#include "pcl_slim/filters/slim_fit.h"

namespace pcl_slim {

/** \brief Ridges and ravines of a raw cloud as polylines, traced on the SLIM surface fitted to it.
 *
 * \code
 * pcl_slim::SLIMCrestLines<pcl::PointXYZ> crest;
 * crest.setInputCloud(cloud);
 * pcl_slim::CrestLines lines;
 * if (!crest.compute(lines)) std::cerr << crest.getError().message << "\n";
 * \endcode
 *
 * Every setter of SLIMFit is there: input, indices, normals, the fit's parameters, threads, progress,
 * cancel. Lines are in the cloud's coordinates and units, strongest first. Which lines are ridges and
 * which ravines depends on the side the normals face. Lines want polynomials of degree 4, the default;
 * of degree 2 there are few.
 *
 * A missing or empty cloud, one without a finite point, indices out of range and parameters out of range
 * are errors; the output is cleared first. The result is the same for any number of threads.
 *
 * Compiled for PointXYZ, XYZI, XYZRGB, XYZRGBA, PointNormal, XYZINormal and XYZRGBNormal. For another
 * type include pcl_slim/filters/impl/slim_crest_lines.hpp where you use it.
 */
template <typename PointT>
class SLIMCrestLines : public SLIMFit<PointT>, public SLIMCrestLinesBase {
 public:
  using Ptr = pcl::shared_ptr<SLIMCrestLines<PointT>>;
  using ConstPtr = pcl::shared_ptr<const SLIMCrestLines<PointT>>;

  /** \brief Lines need no trim maps: none are made unless asked for. */
  SLIMCrestLines() { this->setTrimming(false); }

  /** \brief Traces the lines. \return false with getError() and no lines when it cannot. O(points) for
   * the fit and the seeds, then by the length of the lines. */
  bool compute(CrestLines& lines);

  /** \brief The same as points, with the cloud's header; coordinates are rounded to float. */
  bool compute(pcl::PointCloud<PointCrest>& vertices);

 protected:
  using pcl::PCLBase<PointT>::input_;
};

}  // namespace pcl_slim

#ifdef PCL_NO_PRECOMPILE
#include "pcl_slim/filters/impl/slim_crest_lines.hpp"
#endif
