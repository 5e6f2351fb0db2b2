// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "comparison/mesh_surface.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/core/vector3.h"

/** \brief The public denoising protocol: points of a mesh in the unit sphere, and errors after a
 * method has moved them. */
namespace pcl_slim::denoise {

using Points = std::vector<Vector3>;

/** \brief Evenly spread points of a mesh, all scaled so that the points fill the unit sphere. */
struct MeshScan {
  std::string name;
  Points points, normals;  ///< clean, and the faces' normals
  Points vertices;
  std::vector<comparison::MeshSurface::Triangle> triangles;
  double area = 0;
};

/** \brief Loads a mesh and draws points: five times as many uniformly, reduced by weighted sample
 * elimination (Yuksel 2015) to a Poisson disc set. */
Result<MeshScan> loadMeshScan(const std::string& path, std::size_t points, std::uint64_t seed);

/** \brief Adds white noise to points. */
Points noisy(const Points& points, double sigma, std::uint64_t seed);

/** \brief Squared distances times 1e4, each the sum of the means of both directions. */
struct Errors {
  double chamfer = 0;  ///< to the clean points, and from them
  double mesh = 0;     ///< from points to the mesh, and from its triangles to their nearest point
  double sides[2] = {0, 0};  ///< the two terms of mesh
};

/** \brief Measures moved points; those with NaN are left out. */
Errors errorsOf(const MeshScan& scan, const Points& points);

}  // namespace pcl_slim::denoise
