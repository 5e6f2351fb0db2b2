// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "pcl_slim/splat/octree_cloud.h"

namespace pcl_slim_test {

/** How a camera stands to what it looks at. */
enum class StressView : unsigned char { kFront, kGrazing, kInside, kTouching, kNoArea };

/** A cloud that somebody may feed us, and what is known of the right answer. */
struct StressCloud {
  std::vector<double> points;
  std::vector<float> normals;  ///< empty: none
  std::vector<std::uint8_t> bgr;
  bool must_succeed = false;     ///< a refusal is no answer to a scan as good as this
  std::size_t on_wave = 0;       ///< so many of the first points are on the wave, but for noise
  double scale = 1, offset = 0;  ///< of the wave: p = offset + scale q
  double noise = 0;              ///< of q
  double error_factor = 2;       ///< of the undisturbed wave's error that may be left,
  double error_slack = 1e-4;     ///< and this much more, in units of q
  bool one_look = true;          ///< no two points at one place with different normals
  int resolution = 0;            ///< root cells along the longest side for splats; 0: theirs
  int max_depth = 20;
  StressView camera = StressView::kFront;

  std::size_t size() const { return points.size() / 3; }
  pcl_slim::CloudView cloud() const;
  pcl_slim::ColorView colors() const { return {bgr.data(), 3}; }

  /** Adds one point, white, with a normal if the others have some. */
  void add(double x, double y, double z, const float* normal = nullptr);
  /** The same points in another order, each so many times, and some that are nowhere. */
  StressCloud mixed(std::mt19937_64& random, std::size_t times, std::size_t nowhere) const;
  /** Distance of a place from the wave, in units of q. */
  double distance(const double p[3]) const;
};

/** count points on z = .1 sin 6x cos 5y over the unit square. */
StressCloud wave(std::mt19937_64& random, std::size_t count, double noise, bool normals);

/** A family of clouds: what its members have in common. */
struct StressFamily {
  const char* name;
  StressCloud (*make)(std::mt19937_64& random);
};

const std::vector<StressFamily>& stressFamilies();

}  // namespace pcl_slim_test
