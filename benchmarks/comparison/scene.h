// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "pcl_slim/core/error.h"
#include "support/lab/scenes.h"

/** \brief SLIM compared with PCL's own classes: the same input points, the same truth for the
 * results, the same clock for both. */
namespace pcl_slim::comparison {

/** \brief x y z per point as PCL's cloud of floats. */
pcl::PointCloud<pcl::PointXYZ>::Ptr toCloud(const std::vector<double>& xyz);

/** \brief sqrt(area / points) from the median distance to the 10th neighbour of clean points, if
 * they are spread evenly over a surface; 0 of ten points or fewer. */
double spacingOf(const pcl::PointCloud<pcl::PointXYZ>::Ptr& clean);

/** \brief A noisy cloud and what is true of it. */
struct Scene {
  /** \brief What is true at point i of the cloud once a method has moved it to position. */
  using TruthOf =
      std::function<measure::Truth(std::size_t i, const std::array<double, 3>& position)>;

  std::string name;
  double noise = 0;  ///< share of the clean box's diagonal; 0 for scans
  pcl::PointCloud<pcl::PointXYZ>::Ptr points;
  std::vector<float> normals;  ///< x y z per point, as given to a fit; empty: none
  TruthOf truth;               ///< distance may be one from point to point
  double spacing = 0;          ///< sqrt(area / points), of the clean points
  double unit = 1;             ///< unit length of the errors, world units
  bool unit_is_edge = false;   ///< unit is the truth's mean edge length
  bool has_true_normals = true, has_true_curvature = true;
  std::vector<std::uint8_t> judged;  ///< 0: the truth has nothing near this point; empty: all count

  std::size_t size() const { return points->size(); }
  bool isJudged(std::size_t i) const { return judged.empty() || judged[i] != 0; }
};

/** \brief Shapes that makeScene knows: sphere, torus, bumpy, relief, cube. */
const std::vector<std::string>& shapeNames();

constexpr double kNormalNoise = 0.05;  ///< rad, of the normals that scenes come with

/** \brief count points on an exact shape, fixed by seed, with isotropic Gaussian noise of points
 * and normals. The same seed gives the same points and normals under any noise of the points. An
 * unknown name gives an error. */
Result<Scene> makeScene(const std::string& shape, std::size_t count, double noise,
                        std::uint64_t seed = 7, double normal_noise = kNormalNoise);

/** \brief A scan and its truth: as many points in one order or, where the counts differ, the
 * surface of a mesh.
 *
 * Point by point, errors are in mean edge lengths if the truth is a mesh. From a surface,
 * errors are distances to it in the files' unit, and only points within a mean edge of it
 * and away from its borders and holes count. Points not finite in either file are left out. Both
 * are moved to a first point, which keeps large coordinates exact enough for PCL's floats.
 */
Result<Scene> loadScene(const std::string& name, const std::string& input,
                        const std::string& truth);

}  // namespace pcl_slim::comparison
