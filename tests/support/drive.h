// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "support/lab/sensor.h"

/** \brief A street as a lidar on a car scans it while the car drives round a corner. Metres,
 * seconds. */
namespace pcl_slim_test {

using pcl_slim::along;
using pcl_slim::dot;
using pcl_slim::scaled;
using pcl_slim::subtract;
using pcl_slim::Vector3;
using pcl_slim::measure::Solid;

/** Points with the place and time that each was seen from and at, and the surfaces seen. */
struct DrivenScan {
  std::vector<double> points, sensors;  ///< x y z a point
  std::vector<double> times;
  std::vector<Solid> solids;  ///< their normals face out, the road's up

  std::size_t size() const { return times.size(); }

  Vector3 point(std::size_t i) const {
    return {points[3 * i], points[3 * i + 1], points[3 * i + 2]};
  }
  Vector3 sensor(std::size_t i) const {
    return {sensors[3 * i], sensors[3 * i + 1], sensors[3 * i + 2]};
  }

  /** Whether a normal at a place near a surface is on the side that can be seen: of one of the
   * surfaces that are within a distance, as the two at an edge are. nothing near: -1. */
  int facesOut(const Vector3& place, const Vector3& normal, double within) const {
    int result = -1;
    for (const Solid& s : solids) {
      bool there = true;
      for (int a = 0; a < 3; ++a)
        there &= place[a] > s.low[a] - within && place[a] < s.high[a] + within;
      if (!there) continue;
      const auto foot = footOn(s, place);
      if (std::abs(foot.distance) > within) continue;
      if (dot(foot.normal, normal) > 0) return 1;
      result = 0;
    }
    return result;
  }
};

/** The car's lidar at a time: east for 40 m, left on a bend of 12 m, north for 40 m, at 8 m/s. */
inline Vector3 placeAlongDrive(double time) {
  constexpr double kStraight = 40, kBend = 12, kSpeed = 8, kHeight = 2;
  const double s = kSpeed * time - kStraight, arc = kBend * M_PI / 2;
  if (s < 0) return {s, 0, kHeight};
  if (s > arc) return {kBend, kBend + s - arc, kHeight};
  return {kBend * std::sin(s / kBend), kBend * (1 - std::cos(s / kBend)), kHeight};
}

constexpr double kDriveSeconds = (80 + 6 * M_PI) / 8;

/** Walls of a box between two corners, with its top. */
inline void addBox(const Vector3& low, const Vector3& high, std::vector<Solid>& solids) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const bool end : {false, true}) {
      if (axis == 2 && !end) continue;  // nobody sees the floor
      Solid face;
      face.axis = {};
      face.axis[axis] = end ? 1 : -1;
      face.low = low;
      face.high = high;
      face.center = end ? high : low;
      face.low[axis] = face.center[axis] - 1e-9;
      face.high[axis] = face.center[axis] + 1e-9;
      solids.push_back(face);
    }
  }
}

/** Road, houses on both sides of both streets, parked cars, poles and a row of thin panels. */
inline std::vector<Solid> streetSolids() {
  std::vector<Solid> solids(1);
  for (int k = 0; k < 4; ++k) {
    const double x = -44 + 13.0 * k, y = 16 + 13.0 * k;
    addBox({x, 7.5, 0}, {x + 10, 13, 6.0 + k}, solids);
    addBox({x + 2, -14, 0}, {x + 12, -8, 7.0 - k}, solids);
    addBox({19.5, y, 0}, {26, y + 10, 5.0 + k}, solids);
    addBox({-2, y + 2, 0}, {4, y + 11, 8.0 - k}, solids);
    addBox({x + 3, 3.4, 0.25}, {x + 7.2, 5.2, 1.45}, solids);
    addBox({15.4, y + 2, 0.25}, {17.2, y + 6.2, 1.45}, solids);
    for (const Vector3& foot : {Vector3{x, -5, 0}, Vector3{7.5, y, 0}}) {
      Solid pole;
      pole.kind = Solid::Kind::kPole;
      pole.center = foot;
      pole.radius = 0.12;
      pole.low[2] = 0;
      pole.high[2] = 5;
      solids.push_back(pole);
    }
    addBox({x + 8, -5.8, 1}, {x + 8.04, -4.2, 2.6}, solids);
  }
  addBox({24, -12, 0}, {30, 12, 7}, solids);
  return solids;
}

/** Scans the street by beams that turn with the lidar, which moves between any two of them.
 * \param[in] sigma RMS error along the beam */
inline DrivenScan scanByDrive(int beams, double sigma, std::uint64_t seed) {
  constexpr double kGolden = 0.6180339887498949, kFarthest = 40, kTurns = 10;
  std::mt19937_64 rng(seed);
  std::normal_distribution<double> gauss;
  DrivenScan scan;
  scan.solids = streetSolids();
  for (int k = 0; k < beams; ++k) {
    const double time = kDriveSeconds * (k + 0.5) / beams;
    const double turn = 2 * M_PI * std::fmod(kTurns * time, 1.0);
    const double up = (-30 + 50 * std::fmod(k * kGolden, 1.0)) * M_PI / 180;
    const Vector3 from = placeAlongDrive(time);
    const Vector3 ray = {std::cos(up) * std::cos(turn), std::cos(up) * std::sin(turn),
                         std::sin(up)};
    double nearest = kFarthest;
    for (const Solid& solid : scan.solids) nearest = std::min(nearest, meet(solid, from, ray));
    if (nearest == kFarthest) continue;
    const Vector3 p = along(from, nearest + sigma * gauss(rng), ray);
    scan.points.insert(scan.points.end(), p.begin(), p.end());
    scan.sensors.insert(scan.sensors.end(), from.begin(), from.end());
    scan.times.push_back(time);
  }
  return scan;
}

}  // namespace pcl_slim_test
