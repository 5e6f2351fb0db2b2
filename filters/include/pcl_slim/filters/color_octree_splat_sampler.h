// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl/filters/filter_indices.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/search/search.h>

#include <vector>

#include "pcl_slim/filters/color_octree_splat_sampler_base.h"

namespace pcl_slim {

/** \brief Thins a coloured cloud to discs that cover its surface and keep shape and texture, after
 * Kim et al., "Efficient sampling of point data for surface splatting".
 *
 * \code
 * pcl_slim::ColorOctreeSplatSampler<pcl::PointXYZRGBNormal> sampler;
 * sampler.setInputCloud(cloud);
 * sampler.setMaxSplats(cloud->size() / 20);
 * pcl::PointCloud<pcl::PointSurfel> splats;
 * if (!sampler.sample(splats)) std::cerr << sampler.getError().message << "\n";
 * \endcode
 *
 * Cells of a grid are divided where normals or colours vary; each leaf becomes one disc. As a
 * FilterIndices it keeps one point of each leaf: filter(indices), filter(cloud), setNegative,
 * setKeepOrganized and getRemovedIndices work as for PCL's own filters, with indices ascending.
 *
 * Colours and normals are optional: without colours shape alone decides, without normals (neither
 * setInputNormals() nor fields of PointT) they are estimated from neighbours. Non-finite points are
 * skipped and counted, indices honoured. A missing or empty cloud, one without a finite point, and
 * indices out of range are errors: returned by getError(), and by filter() printed as PCL prints
 * them. Outputs are cleared first. The result is the same for any number of threads.
 *
 * Compiled for PointXYZ, PointXYZI, PointXYZRGB, PointXYZRGBA, PointNormal, PointXYZINormal and
 * PointXYZRGBNormal. For a point type of your own, include
 * pcl_slim/filters/impl/color_octree_splat_sampler.hpp where you use it.
 */
template <typename PointT>
class ColorOctreeSplatSampler : public pcl::FilterIndices<PointT>,
                                public ColorOctreeSplatSamplerBase {
 public:
  using Ptr = pcl::shared_ptr<ColorOctreeSplatSampler<PointT>>;
  using ConstPtr = pcl::shared_ptr<const ColorOctreeSplatSampler<PointT>>;
  using PointCloud = pcl::PointCloud<PointT>;
  using NormalCloud = pcl::PointCloud<pcl::Normal>;
  using SearchPtr = typename pcl::search::Search<PointT>::Ptr;

  /** \param[in] extract_removed_indices whether getRemovedIndices() returns them. */
  explicit ColorOctreeSplatSampler(bool extract_removed_indices = false);
  ColorOctreeSplatSampler(const ColorOctreeSplatSampler& other);
  ColorOctreeSplatSampler& operator=(const ColorOctreeSplatSampler& other);

  /** \brief Normals of the input cloud, one for each of its points; null: none. */
  void setInputNormals(const NormalCloud::ConstPtr& normals) { normals_ = normals; }
  NormalCloud::ConstPtr getInputNormals() const { return normals_; }

  /** \brief Search object for estimating normals, of clouds without, as pcl::NormalEstimation does;
   * null (default): the sampler estimates them with its own index. */
  void setSearchMethod(const SearchPtr& search) { search_ = search; }
  SearchPtr getSearchMethod() const { return search_; }

  /** \brief Points that represent cells, ascending. \return false with getError() when there are
   * none; indices are then empty. */
  bool filter(pcl::Indices& indices);
  /** \brief The same points as a cloud; it may be the input itself. \return false with getError()
   * on failure; the output is then empty. */
  bool filter(PointCloud& output);

  /** \brief One surfel for each cell: its disc's centre, normal, mean colour and radius; confidence
   * is the number of points behind it, curvature the surface variation of the 30 discs around, as
   * pcl::NormalEstimation computes it with setKSearch(30), 0 where there are too few. */
  bool sample(pcl::PointCloud<pcl::PointSurfel>& splats);
  /** \brief The same with the kept points' indices, colour gradients and a double origin. */
  bool sample(SplatSet& splats);

 protected:
  using pcl::PCLBase<PointT>::input_;
  using pcl::PCLBase<PointT>::indices_;
  using pcl::PCLBase<PointT>::use_indices_;
  using pcl::Filter<PointT>::removed_indices_;
  using pcl::Filter<PointT>::extract_removed_indices_;
  using pcl::FilterIndices<PointT>::negative_;

  void applyFilter(pcl::Indices& indices) override;
  using pcl::FilterIndices<PointT>::applyFilter;

 private:
  /** \brief Prints the error, as PCL's filters do; a cancelled run prints nothing. */
  void complain() const;

  NormalCloud::ConstPtr normals_;
  SearchPtr search_;
};

}  // namespace pcl_slim

#ifdef PCL_NO_PRECOMPILE
#include "pcl_slim/filters/impl/color_octree_splat_sampler.hpp"
#endif
