// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "pcl_slim/core/vector3.h"

/** \brief Generated clouds whose balls meet two sides of a thin part, with the exact surface. */
namespace pcl_slim::thin {

/** \brief A scene of spacing 1: its clean points, their outward normals, and the distance to it. */
struct Scene {
  std::string name;
  std::vector<Vector3> points, normals;
  std::function<double(const Vector3&)> distance;
  std::function<double(const Vector3&)>
      thickness;  ///< distance from a point of a side to the other
};

/** \brief Two parallel square plates, facing apart. */
Scene plates(double gap, double edge = 70);

/** \brief A tube of a radius, open at its ends. */
Scene tube(double radius, double height = 250);

/** \brief Two spheres about one middle, a gap between them. */
Scene nestedSpheres(double gap);

/** \brief Two spheres that touch at a point. */
Scene touchingSpheres();

/** \brief Two planes that meet in an edge at an angle in degrees. */
Scene wedge(double degrees);

/** \brief A pole of a radius that stands on a plane. */
Scene pole(double radius);

/** \brief A scene turned to no axis: equal coordinates of whole planes are no scanner's. */
Scene turned(Scene scene);

/** \brief All of the scenes above, over the sizes of the table. */
std::vector<Scene> allScenes();

/** \brief The scene's points with white noise along each axis. */
std::vector<Vector3> noisyPoints(const Scene& scene, double sigma, std::uint64_t seed);

}  // namespace pcl_slim::thin
