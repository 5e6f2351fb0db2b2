// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "pcl_slim/cloud/cloud_view.h"
#include "pcl_slim/surface/surface.h"
#include "pcl_slim/surface/surfel_color.h"

namespace pcl_slim_test {

/** A smooth colour of space, 0..255: waves of a length of about 3. */
inline std::array<double, 3> waveColor(const std::array<double, 3>& p) {
  return {128 + 100 * std::sin(2 * p[0]), 128 + 100 * std::cos(2 * p[1]), 128 + 60 * p[2]};
}

/** Bytes blue, green, red of a colour at each of some points, three coordinates each. */
template <typename Color>
std::vector<std::uint8_t> bgrOf(const std::vector<double>& points, const Color& color) {
  std::vector<std::uint8_t> bytes;
  for (std::size_t i = 0; i < points.size(); i += 3) {
    const std::array<double, 3> rgb = color({points[i], points[i + 1], points[i + 2]});
    for (std::size_t c = 0; c < 3; ++c)
      bytes.push_back(static_cast<std::uint8_t>(std::lround(rgb[2 - c])));
  }
  return bytes;
}

/** Random colours of every surfel. */
inline void setRandomColors(pcl_slim::SLIMSurface& surface) {
  std::mt19937 random(5);
  surface.colors.resize(surface.size() * pcl_slim::kColorBytes);
  for (std::size_t k = 0; k < surface.colors.size(); ++k) {
    auto byte = static_cast<std::uint8_t>(random());
    if (k % pcl_slim::kColorBytes >= 3 && byte == 128) byte = 127;  // -128 stands for no term
    surface.colors[k] = byte;
  }
}

/** Random textures of all surfels but every third. */
inline void setRandomTextures(pcl_slim::SLIMSurface& surface) {
  std::mt19937 random(7);
  std::vector<std::uint8_t> sides, texels;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    sides.push_back(i % 3 == 2 ? 0 : static_cast<std::uint8_t>(1 + random() % 20));
    for (std::size_t k = 0; k < pcl_slim::SurfelTexture::numBytes(sides.back()); ++k)
      texels.push_back(static_cast<std::uint8_t>(random()));
  }
  surface.setTextures(sides, texels);
}

/** Textures of all surfels, side x side texels of a colour of space, at the points of their surfaces.
 * \param[in] color std::array<double, 3>(std::array<double, 3>), local units to 0..255 */
template <typename Color>
void setTexturesOf(pcl_slim::SLIMSurface& surface, int side, const Color& color) {
  constexpr double kReach = pcl_slim::SurfelTexture::kReach;
  std::vector<std::uint8_t> texels;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const pcl_slim::LocalFrame frame({surface.nx[i], surface.ny[i], surface.nz[i]});
    const double center[3] = {surface.cx[i], surface.cy[i], surface.cz[i]};
    for (int k = 0; k < side * side; ++k) {
      const double u = kReach * ((2 * (k % side) + 1.0) / side - 1.0);
      const double v = kReach * ((2 * (k / side) + 1.0) / side - 1.0);
      const double h = pcl_slim::evaluateHeight(surface.degree[i], surface.coefficientsOf(i), u, v);
      std::array<double, 3> p;
      for (std::size_t a = 0; a < 3; ++a)
        p[a] = center[a] + surface.radius[i] * (u * frame.u[a] + v * frame.v[a] + h * frame.w[a]);
      for (const double value : color(p))
        texels.push_back(static_cast<std::uint8_t>(std::lround(value)));
    }
  }
  surface.setTextures(std::vector<std::uint8_t>(surface.size(), static_cast<std::uint8_t>(side)),
                      texels);
}

}  // namespace pcl_slim_test
