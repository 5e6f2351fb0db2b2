// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <array>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "pcl_slim/core/error.h"
#include "scenes.h"

/** \brief SLIM beside PCL's own classes: the same points in, the same truth against what comes
 * out, the same clock around both. */
namespace pcl_slim::comparison {

/** \brief A noisy cloud and what is true of it. */
struct Scene {
  /** \brief What is true at point i of the cloud once a method has moved it to position. */
  using TruthOf = std::function<bench::Truth(std::size_t i, const std::array<double, 3>& position)>;

  std::string name;
  double noise = 0;  ///< share of the clean box's diagonal; 0 for scans
  pcl::PointCloud<pcl::PointXYZ>::Ptr points;
  std::vector<float> normals;  ///< x y z per point, as given to a fit; empty: none
  TruthOf truth;               ///< distance may be one from point to point
  double spacing = 0;          ///< sqrt(area / points), of the clean points
  double unit = 1;             ///< length that errors are told in, world units
  bool unit_is_edge = false;   ///< unit is the truth's mean edge length
  bool has_true_normals = true, has_true_curvature = true;

  std::size_t size() const { return points->size(); }
};

/** \brief Shapes that makeScene knows: sphere, torus, bumpy, relief, cube. */
const std::vector<std::string>&
shapeNames();

/** \brief count points on an exact shape, fixed by seed, with isotropic Gaussian noise and normals
 * that are .05 rad off. An unknown name gives an error. */
Result<Scene>
makeScene(const std::string& shape, std::size_t count, double noise, std::uint64_t seed = 7);

/** \brief A scan and its truth, point by point: two files with as many points in one order.
 *
 * Errors are told in mean edge lengths where the truth is a mesh. Points that are not finite in
 * either file are left out. Both are moved to the truth's first point, which keeps large
 * coordinates exact enough for PCL's floats.
 */
Result<Scene>
loadScene(const std::string& name, const std::string& input, const std::string& truth);

}  // namespace pcl_slim::comparison
