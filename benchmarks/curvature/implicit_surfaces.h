// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pcl_slim/core/vector3.h"
#include "support/lab/line_truth.h"

namespace pcl_slim::curvature {

/** \brief A closed surface F = 0 in about [-1, 1]^3, F > 0 outside. */
struct ImplicitSurface {
  std::string name;
  measure::Jet (*value)(const measure::Jet& x, const measure::Jet& y, const measure::Jet& z);
};

/** \brief sphere, ellipsoid, torus, cylinder (rounded), goursat, genus2, tangle (genus 5), blobs
 * and bumpy: of the kinds that the survey of CGF 45(2), 2026, measures on. */
const std::vector<ImplicitSurface>& implicitSurfaces();

/** \brief Outward normal, mean and Gaussian curvature of a surface; a sphere's mean is 1 / R. */
struct Differential {
  Vector3 normal{};
  double mean = 0, gaussian = 0;

  double k1() const;  ///< the greater principal curvature
  Differential flipped() const { return {scaled(normal, -1), -mean, gaussian}; }
};

/** \brief Points evenly spread over a surface, with the truth there. */
struct SurfaceSample {
  std::vector<Vector3> points;
  std::vector<Differential> truth;
};

SurfaceSample sampleSurface(const ImplicitSurface& surface, std::size_t count, std::uint64_t seed);

}  // namespace pcl_slim::curvature
