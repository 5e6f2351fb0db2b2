// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <random>
#include <vector>

#include "pcl_slim/core/vector3.h"

namespace pcl_slim::sides {

/** \brief Points of a surface with its unit normals. */
struct Sample {
  std::vector<Vector3> points, normals;
};

/** \brief A solid: its function is about the distance from its surface, negative inside. */
struct Body {
  std::function<double(const Vector3&)> distance;
  Bounds box;
  std::function<bool(const Vector3& place, const Vector3& normal)> is_seen;  ///< empty: everywhere
};

/** \brief A hollow vessel about the z axis and the origin, .4 high, open at the top. Its inner side
 * is seen .06 deep. */
Body openJar();

/** \brief The same, filled and closed by a lid. */
Body closedJar();

/** \brief A head about the origin, y up, with nose and neck; .3 high. */
Body head();

/** \brief Evenly spread random points with outward normals.
 * \param[in] noise RMS error along each axis */
Sample sampleBody(const Body& body, std::size_t count, double noise, std::mt19937_64& random);

/** \brief A planar parallelogram with the normal cross(a, b). */
struct Face {
  Vector3 corner, a, b;
};

/** \brief The six faces of a box, facing outwards; \param[in] low, high its corners. */
std::vector<Face> boxFaces(const Vector3& low, const Vector3& high);

/** \brief A box of 2 x 1.4 x .8 with a cylinder on its top: exact points and outward normals of
 * seven faces and a top. \param[out] face of each point, 0 to 7 */
Sample sampleBoxWithBoss(std::size_t count, std::mt19937_64& random, std::vector<int>& face);

/** \brief A wall of 4 x 3 with a door and a window, whose reveals are .2 deep: what a viewpoint
 * sees of it. Normals face it. */
Sample sampleWall(std::size_t count, double noise, const Vector3& viewpoint,
                  std::mt19937_64& random);

/** \brief Terrain of 240 x 240 with houses, seen from above: points of the ground and roofs and a
 * few of facades, whose normals are zero. \param[in] origin is added to the points */
Sample sampleTerrain(std::size_t count, double noise, const Vector3& origin,
                     std::mt19937_64& random);

/** \brief A tree: trunk, branches and clusters of leaves. Without normals. */
Sample sampleTree(std::mt19937_64& random);

}  // namespace pcl_slim::sides
