// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "pcl_slim/cloud/cloud_view.h"

/** \brief Analytic surfaces with exact position, normal and curvature: the truth that accuracy is
 * measured against. Scene units; noise is isotropic Gaussian, sigma as a share of the clean
 * bounding box's diagonal. */
namespace pcl_slim::measure {

enum class Shape { kSphere, kTorus, kBumpy, kRelief };

struct Scene {
  std::vector<double> points;  ///< x y z per point, noise added
  std::vector<float> normals;  ///< unit, as given to a fit
  double diagonal = 0;         ///< of the clean points' box
};

/** \brief Distance to the surface along its normal, unit normal and mean curvature at the foot. */
struct Truth {
  double distance = 0;
  std::array<double, 3> normal{};
  double mean_curvature = 0;
  bool rim = false;  ///< within 2 % of an open border
};

/** \brief Shape by name: sphere, torus, bumpy, relief. \return false for another name. */
bool parseShape(const std::string& name, Shape& shape);

/** \brief count points evenly spread over a shape, fixed by seed.
 * \param[in] noise share of the diagonal; \param[in] normal_noise [rad] of the normals. */
Scene makeScene(Shape shape, std::size_t count, double noise, double normal_noise,
                std::uint64_t seed);

/** \brief The true surface at the foot of a point near it. */
Truth truthAt(Shape shape, const std::array<double, 3>& point);

/** \brief A scene's points as floats or doubles, with or without its normals; borrows all three. */
CloudView viewOf(const Scene& scene, const std::vector<float>* floats, bool normals);

}  // namespace pcl_slim::measure
