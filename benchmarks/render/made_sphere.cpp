// SPDX-License-Identifier: BSD-3-Clause
#include "render/made_sphere.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace pcl_slim {
namespace {

constexpr double kRadius = 0.28;
constexpr double kDistance = 2.0;

struct Level {
  std::size_t count;
  double overlap;
  bool leaves;
};

/** \brief Point i of n spread evenly over the unit sphere (Fibonacci's lattice). */
std::array<double, 3> latticePoint(std::size_t i, std::size_t n) {
  const double z = 1.0 - (2.0 * static_cast<double>(i) + 1.0) / static_cast<double>(n);
  const double turn = std::fmod(static_cast<double>(i) * 0.6180339887498949, 1.0);
  const double flat = std::sqrt(1.0 - z * z);
  return {flat * std::cos(2.0 * M_PI * turn), flat * std::sin(2.0 * M_PI * turn), z};
}

/** \brief Root mean square of what such a series leaves out, over the ball with its weights: about
 * a fifth of what it leaves out at the rim. */
double errorOf(int degree, double radius, double bend) {
  return 0.2 * radius * (degree < 4 ? std::pow(bend, 3) / 8.0 : std::pow(bend, 5) / 16.0);
}

/** \brief The sphere's height over its tangent plane, in radii of a ball: a Taylor series. */
void setHeight(SLIMSurface& surface, std::size_t i, double bend) {
  float* c = surface.coefficients.data() + i * static_cast<std::size_t>(surface.stride());
  c[3] = c[5] = static_cast<float>(-0.5 * bend);
  if (surface.info.degree < 4) return;
  const double quartic = -0.125 * bend * bend * bend;
  c[10] = c[14] = static_cast<float>(quartic);
  c[12] = static_cast<float>(2.0 * quartic);
}

}  // namespace

SLIMSurface makeSphere(const MadeSphere& made) {
  std::vector<Level> levels{{made.leaves, 11.0, true}};
  while (made.links && levels.back().count > 100) {
    levels.push_back({levels.back().count / 8, 4.0, false});
  }
  std::reverse(levels.begin(), levels.end());
  SLIMSurface surface;
  surface.info.degree = made.degree;
  surface.info.oriented = true;
  surface.info.num_points = 10 * made.leaves;
  std::size_t total = 0;
  for (const Level& level : levels) total += level.count;
  surface.resize(total);
  std::size_t i = 0;
  for (std::size_t k = 0; k < levels.size(); ++k) {
    const auto n = static_cast<double>(levels[k].count);
    const double radius = 2.0 * kRadius * std::sqrt(levels[k].overlap / n);
    for (std::size_t at = 0; at < levels[k].count; ++at) {
      const auto p = latticePoint(at, levels[k].count);
      if (made.cap && p[2] < 0.94) continue;
      surface.cx[i] = static_cast<float>(kRadius * p[0]);
      surface.cy[i] = static_cast<float>(kRadius * p[1]);
      surface.cz[i] = static_cast<float>(kRadius * p[2]);
      surface.nx[i] = static_cast<float>(p[0]);
      surface.ny[i] = static_cast<float>(p[1]);
      surface.nz[i] = static_cast<float>(p[2]);
      surface.radius[i] = static_cast<float>(radius);
      surface.degree[i] = static_cast<std::uint8_t>(made.degree);
      surface.level[i] = static_cast<std::uint8_t>(k + 1);
      surface.flags[i] = levels[k].leaves ? kSurfelLeaf : 0;
      surface.error[i] = static_cast<float>(errorOf(made.degree, radius, radius / kRadius));
      surface.effective_count[i] = 20.0f;
      setHeight(surface, i++, radius / kRadius);
    }
  }
  surface.resize(i);
  if (made.links) surface.buildLinks(2);
  return surface;
}

Camera cameraBeforeSphere(int size, double zoom) {
  Camera camera;
  camera.position = {0.0, 0.0, kDistance};
  camera.size = {size, size};
  camera.fov = 2.0 * std::atan(1.12 * kRadius / (kDistance * zoom)) * 180.0 / M_PI;
  return camera;
}

}  // namespace pcl_slim
