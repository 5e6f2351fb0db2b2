// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "reference/tile_passes.h"

namespace pcl_slim::detail {
namespace {

/** \brief Curvatures of the level set with the given gradient and Hessian. */
struct LevelSetCurvature {
  double mean = 0.0, gaussian = 0.0, k_max = 0.0, k_min = 0.0;

  LevelSetCurvature(const double g[3], const Symmetric3<double>& h)
  {
    const double norm_sq = g[0] * g[0] + g[1] * g[1] + g[2] * g[2];
    if (!(norm_sq > 0.0)) return;
    const double gx = g[0], gy = g[1], gz = g[2];
    const double ghg = gx * gx * h[kXX] + gy * gy * h[kYY] + gz * gz * h[kZZ] +
                       2.0 * (gx * gy * h[kXY] + gx * gz * h[kXZ] + gy * gz * h[kYZ]);
    mean = 0.5 * (h[kXX] + h[kYY] + h[kZZ] - ghg / norm_sq) / std::sqrt(norm_sq);
    const double adjugate = gx * gx * (h[kYY] * h[kZZ] - h[kYZ] * h[kYZ]) +
                            gy * gy * (h[kXX] * h[kZZ] - h[kXZ] * h[kXZ]) +
                            gz * gz * (h[kXX] * h[kYY] - h[kXY] * h[kXY]) +
                            2.0 * (gx * gy * (h[kXZ] * h[kYZ] - h[kXY] * h[kZZ]) +
                                   gx * gz * (h[kXY] * h[kYZ] - h[kXZ] * h[kYY]) +
                                   gy * gz * (h[kXY] * h[kXZ] - h[kYZ] * h[kXX]));
    gaussian = adjugate / (norm_sq * norm_sq);
    const double spread = std::sqrt(std::max(0.0, mean * mean - gaussian));
    k_max = mean + spread;
    k_min = mean - spread;
  }
};

/** \brief Writes the requested attributes from the blended derivatives. */
void
writeDerivatives(const BlendSum& sum, std::size_t pixel, GBuffer& out)
{
  double gradient[3];
  Symmetric3<double> hessian;
  for (int k = 0; k < 3; ++k) gradient[k] = sum.gradient[k] / sum.weight;
  for (std::size_t k = 0; k < 6; ++k) hessian[k] = sum.hessian[k] / sum.weight;
  const Vector3 normal = normalized({gradient[0], gradient[1], gradient[2]});
  for (std::size_t k = 0; k < 3; ++k) {
    out.normal[pixel][k] = static_cast<float>(normal[k]);
    if (!out.gradient.empty()) out.gradient[pixel][k] = static_cast<float>(gradient[k]);
  }
  for (std::size_t k = 0; k < 6 && !out.hessian.empty(); ++k) {
    out.hessian[pixel][k] = static_cast<float>(hessian[k]);
  }
  if (out.mean_curvature.empty()) return;
  const LevelSetCurvature curvature(gradient, hessian);
  out.mean_curvature[pixel] = static_cast<float>(curvature.mean);
  out.gaussian_curvature[pixel] = static_cast<float>(curvature.gaussian);
  out.principal[pixel] = {static_cast<float>(curvature.k_max), static_cast<float>(curvature.k_min)};
}

}  // namespace

void
writeBlend(const SLIMSurface& surface, const Ray& ray, double depth_hat, const BlendSum& sum,
           std::size_t pixel, GBuffer& out)
{
  const double depth = depth_hat + sum.shift / sum.weight;
  const Vector3 q = along(ray.origin, depth, ray.direction);
  out.depth[pixel] = static_cast<float>(depth);
  for (std::size_t k = 0; k < 3 && !out.position.empty(); ++k) {
    out.position[pixel][k] = static_cast<float>(q[k]);
  }
  writeDerivatives(sum, pixel, out);
  out.surfel[pixel] = sum.surfel;
  if (!out.level.empty()) {
    out.level[pixel] = surface.level[sum.surfel];
    out.radius[pixel] = surface.radius[sum.surfel];
  }
  if (!out.weight.empty()) {
    out.weight[pixel] = static_cast<float>(sum.weight);
    out.coverage[pixel] = static_cast<float>(sum.coverage);
  }
  out.back_face[pixel] = static_cast<std::uint8_t>(surface.info.hasFront() && sum.facing < 0);
}

void
resolveTile(const FrameContext& frame, const Tile& tile, GBuffer& buffer,
            RenderStatistics& statistics)
{
  for (int y = tile.y0; y < tile.y0 + tile.height; ++y) {
    for (int x = tile.x0; x < tile.x0 + tile.width; ++x) {
      const std::size_t pixel = tile.index(x, y);
      const BlendSum& sum = tile.sums[pixel];
      if (sum.surfel == GBuffer::kNothing) continue;
      writeBlend(frame.surface, tile.rays[pixel], tile.first_depth[pixel], sum, buffer.index(x, y),
                 buffer);
      ++statistics.covered_pixels;
    }
  }
}

}  // namespace pcl_slim::detail
