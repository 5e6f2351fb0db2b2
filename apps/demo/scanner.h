// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pcl_slim/core/error.h"

namespace pcl_slim::demo {

/** \brief Settings of a simulated scan. */
struct ScanParams {
  std::uint64_t points = 200000;  ///< points wanted; organized: pixels, hit or not
  double noise = 0.001;  ///< std. deviation at medium range, share of the object's diagonal
  std::uint64_t seed = 1;
  bool organized = false;  ///< one station's grid with NaN where nothing was hit
  int threads = 0;         ///< 0: all cores; never changes the result
};

/** \brief A coloured cloud: x y z per point, metres, and packed 0x00RRGGBB. */
struct Scan {
  std::uint32_t width = 0, height = 1;
  std::vector<float> xyz;
  std::vector<std::uint32_t> rgb;
  std::array<float, 3> sensor{};  ///< where an organized scan was made from; 0 for several places
};

/** \brief Scans the amphora as a laser scanner on four tripods would.
 *
 * Each station shoots rays on a grid of equal angles; the first surface along a ray is measured,
 * so parts hidden from every station stay empty, and nearer stations see finer. Noise is along
 * the ray and grows with range and obliquity; grazing and dark hits are often lost. Exactly the
 * number of points requested, the same for any number of threads.
 */
Scan
scanAmphora(const ScanParams& params);

/** \brief The bytes of a binary PCD file with fields x y z rgb. */
std::vector<unsigned char>
encodePcd(const Scan& scan);

}  // namespace pcl_slim::demo
