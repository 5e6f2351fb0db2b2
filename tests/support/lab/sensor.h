// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pcl_slim/core/vector3.h"

/** \brief Exact surfaces that sensors look at: a ray meets them, and any point has a foot on them.
 * Scans of them as depth cameras and turning lidars make them, with the truth behind each point.
 * Metres. */
namespace pcl_slim::measure {

/** \brief One surface of a scene. */
struct Solid {
  enum class Kind {
    kPlane,  ///< through center, across axis
    kWaves,  ///< a plane with waves along its first tangent
    kSphere,
    kPole  ///< a cylinder without ends about center, along z
  };
  Kind kind = Kind::kPlane;
  Vector3 center{}, axis{{0, 0, 1}};                       ///< axis: unit
  double radius = 0;                                       ///< of a sphere or pole
  double amplitude = 0, wavelength = 0;                    ///< of waves
  Vector3 low{{-1e9, -1e9, -1e9}}, high{{1e9, 1e9, 1e9}};  ///< the solid ends at this box
};

/** \brief The distance along a ray from origin at which it meets a solid; infinite if it does not.
 * \param[in] direction of any length; the distance is in units of it. */
double meet(const Solid& solid, const Vector3& origin, const Vector3& direction);

/** \brief Signed distance of a point from a solid, and the solid's unit normal at its foot. */
struct Foot {
  double distance = 0;
  Vector3 normal{};
};

Foot footOn(const Solid& solid, const Vector3& point);

/** \brief Points with the surface that each was seen on. */
struct SensorScan {
  std::vector<float> points;  ///< x y z a point [m], noise added
  std::vector<int> solid;     ///< index of its surface in solids; -1: a mixed pixel, of none
  std::vector<Solid> solids;
  Vector3 sensor{};
  bool one_sensor = true;  ///< all points were seen from it; else from each layer's own side

  std::size_t size() const { return solid.size(); }
};

/** \brief A camera that measures depth by disparity, at the origin, along z. */
struct DepthCamera {
  int width = 320, height = 240;
  double focal = 292.5;                    ///< [px of its image]
  double disparity_focal = 585;            ///< [px of the images it matches]
  double baseline = 0.075;                 ///< [m]
  double sigma = 0.06;                     ///< RMS error of disparity [px]
  int correlated_x = 1, correlated_y = 1;  ///< box that errors are averaged over [px]
  double step = 0;                         ///< disparity is a multiple of it [px]; 0: any
  double depth_step = 0;                   ///< depth is a multiple of it [m]; 0: any
  double mixed = 0;                        ///< share of pixels at depth steps that see both sides
};

/** \brief Solids in the coordinates of a camera that has moved and then turned about its y axis.
 * Boxes at which solids end are not turned: of unbounded solids.
 * \param[in] turn [rad], to the right if positive */
std::vector<Solid> seenFrom(std::vector<Solid> solids, const Vector3& camera, double turn);

/** \brief What a camera sees of some solids, pixel by pixel. */
SensorScan scanByCamera(const std::vector<Solid>& solids, const DepthCamera& camera,
                        std::uint64_t seed);

/** \brief A lidar that turns about z and errs along its beam. */
struct TurningLidar {
  Vector3 origin{{0, 0, 1.8}};
  int rings = 64, steps = 1800;      ///< beams one above the other, directions a turn
  double lowest = -25, highest = 5;  ///< elevation of the rings [degrees]
  double sigma = 0.02;               ///< RMS error of range [m]
  double farthest = 60;              ///< [m]
};

SensorScan scanByLidar(const std::vector<Solid>& solids, const TurningLidar& lidar,
                       std::uint64_t seed);

/** \brief Scans from several sides, registered with an error. */
struct LayeredScan {
  int layers = 10;
  double spacing = 0.001;  ///< of the parallel rays of a layer [m]
  double sigma = 0.0002;   ///< RMS error along them, from point to point [m]
  double shift = 0.0003;   ///< RMS error of a layer's place along each axis [m]
  double reach = 0.2;      ///< half the width of a layer about the origin [m]
};

SensorScan scanInLayers(const std::vector<Solid>& solids, const LayeredScan& layers,
                        std::uint64_t seed);

/** \brief Geometry by name: room and hall (wall, floor, two spheres), frontal hall (its wall faces
 * the camera within 6 degrees), balls (two planes, five spheres), wave40, wave15, wave6 (a tilted
 * plane with waves of 40, 15 or 6 cm) for cameras; street (ground, walls, poles) for a lidar;
 * figure (two spheres on a foot) for layers. Empty for another name. */
std::vector<Solid> namedSolids(const std::string& name);

}  // namespace pcl_slim::measure
