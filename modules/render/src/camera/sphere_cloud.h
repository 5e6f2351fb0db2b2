// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "pcl_slim/core/vector3.h"
#include "pcl_slim/render/bounding_spheres.h"

namespace pcl_slim::detail {

/** \brief One of the six directions along the axes. */
struct SignedAxis {
  std::size_t axis = 2;
  double sign = 1.0;

  double of(const Vector3& v) const { return sign * v[axis]; }
  Vector3 direction() const {
    Vector3 d{};
    d[axis] = sign;
    return d;
  }
};

/** \brief What a picture of a whole object has to show: the bulk of its points, without strays. */
std::vector<BoundingSphere> framedSpheres(const BoundingSpheres& object);

/** \brief The framed part of an object as even pieces: a middle and a normal of each cell of a grid
 * and each of the six ways that normals face in it. However many balls overlap there, and however
 * dense the scan was, a surface, its splats and its mesh have nearly the same. Local units. */
struct SphereCloud {
  std::vector<Vector3> centers, normals;
  double radius = 0.0;    ///< of a disc that covers its cell
  Vector3 low{}, high{};  ///< bounds of the central 98 % on each axis
  Vector3 deviation{};    ///< standard deviation along each axis, inside those bounds
  Vector3 mean_normal{0.0, 0.0, 0.0};

  /** \brief O(spheres + cells that they cover). */
  explicit SphereCloud(const BoundingSpheres& object);

  bool empty() const { return centers.empty(); }
  double extent(std::size_t axis) const { return high[axis] - low[axis]; }
  /** \brief Height over the lower end. */
  double heightOf(const Vector3& p, const SignedAxis& up) const {
    return up.sign > 0 ? p[up.axis] - low[up.axis] : high[up.axis] - p[up.axis];
  }
  /** \brief Share of the area that is flat at the lower end and faces up (side 1), as a floor, or
   * down (-1), as the underside of what stands there. */
  double flatShare(const SignedAxis& up, double side) const;
  /** \brief Share of the area between both ends that is flat and faces up: tables, seats. */
  double shelfShare(const SignedAxis& up) const;

 private:
  void measureAxis(std::size_t axis);
};

Vector3 middleOf(const SphereCloud& cloud);

/** \brief How far the middle of an object must rise, over its height, for the object to tip: more
 * than 0 if it is in balance on the lower end, up to 14 degrees off. O(pieces). */
double standing(const SphereCloud& cloud, const SignedAxis& up);

/** \brief A place that most of an object's normals face, and what is seen from there. */
struct Vantage {
  Vector3 place{};
  double facing = 0.0;      ///< share of the pieces that face the place
  double surrounded = 0.0;  ///< share of all directions in which a side that faces it is met first
  std::vector<Vector3> directions;  ///< unit, evenly over the sphere
  std::vector<double> depths;       ///< first piece met that faces the place; infinite: none
  std::vector<std::size_t> met;     ///< that piece

  /** \brief Share of the horizon where upright pieces are met, at most 30 degrees above or below
   * it. */
  double walledIn(const SphereCloud& cloud, const SignedAxis& up) const;
};

/** \brief Looks for the place, among those inside an object's bounds, that as much as possible
 * faces: the origin if most face it, else by relaxation (Agmon 1954) of the half spaces that the
 * pieces face. O(pieces). */
Vantage findVantage(const SphereCloud& cloud, const Vector3& origin);

}  // namespace pcl_slim::detail
