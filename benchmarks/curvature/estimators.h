// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <random>
#include <string>
#include <vector>

#include "curvature/implicit_surfaces.h"

/** \brief Curvature by methods that take one radius: compact versions of published ones. */
namespace pcl_slim::curvature {

/** \brief A point, first, with the others within a radius of it. */
struct Neighborhood {
  std::vector<Vector3> points;
  std::vector<Vector3> normals;  ///< turned to the first one's side
  double radius = 0;
};

/** \brief A method; those that need normals are given those of the cloud, or PCA's of the same
 * radius. */
struct Estimator {
  std::string name;
  bool needs_normals = false;
  std::function<Differential(const Neighborhood&)> estimate;
};

/** \brief PCA's normal. */
Vector3 pcaNormal(const std::vector<Vector3>& points, double radius);

/** \brief Quadric in PCA's frame; CGAL's jets of degree 2 and 4; shape operator of the normals'
 * slopes; corrected normal currents (Lachaud et al. 2023) over random triangles; algebraic shape
 * operator (Lejemble et al. 2021): derivative of the normals of fitted spheres. */
std::vector<Estimator> allEstimators();

}  // namespace pcl_slim::curvature
