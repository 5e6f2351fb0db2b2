// SPDX-License-Identifier: BSD-3-Clause
#include "fast/near_leaf.h"

#include <cmath>
#include <limits>

#include "reference/leaf_on_ray.h"

namespace pcl_slim::detail {
namespace {

/** \brief Depths along a ray and the tile's depth values, both ways. */
struct DepthScale {
  bool perspective;
  double tile, slant;  ///< slant: length of the ray's step to the next unit of z

  DepthScale(const FrameScene& scene, const Ray& ray, float tile_depth)
      : perspective(scene.view.perspective), tile(tile_depth)
  {
    const auto& f = scene.view.forward;
    const auto& d = ray.direction;
    slant = 1.0 / (d[0] * f[0] + d[1] * f[1] + d[2] * f[2]);
  }
  double along(double value) const
  {
    const double depth = value + tile;
    if (!perspective) return depth;
    return depth < 0.0 ? -slant / depth : std::numeric_limits<double>::infinity();
  }
  float value(double depth) const
  {
    return static_cast<float>((perspective ? -slant / depth : depth) - tile);
  }
};

/** \brief A vector or a symmetric matrix in the camera's axes. */
void
turn(const FrameView& view, const BlendSum& sum, std::size_t lane, NearLanes& lanes)
{
  const float* const axes[3] = {view.right, view.up, view.forward};
  const Symmetric3<double>& h = sum.hessian;
  const auto product = [&](int i, int j) {
    double value = 0.0;
    for (int a = 0; a < 3; ++a) {
      for (int b = 0; b < 3; ++b) value += h[kSymmetricEntry[a][b]] * axes[i][a] * axes[j][b];
    }
    return static_cast<float>(value);
  };
  for (int i = 0; i < 3; ++i) {
    double value = 0.0;
    for (int a = 0; a < 3; ++a) value += sum.gradient[a] * axes[i][a];
    lanes.gradient[i][lane] = static_cast<float>(value);
    for (int j = i; j < 3; ++j) lanes.hessian[kSymmetricEntry[i][j]][lane] = product(i, j);
    lanes.lean[i][lane] = static_cast<float>(sum.lean[i]);
  }
}

}  // namespace

void
firstOfNearLeaf(const FrameScene& scene, std::uint32_t surfel, NearLanes& lanes)
{
  const RaySurfel leaf(scene.surface, surfel);
  std::uint64_t evaluated = 0;
  for (std::size_t i = 0; i < lanes.count; ++i) {
    if (!(lanes.live[i] > 0.0f)) continue;
    const Ray ray = scene.rays.ray(static_cast<int>(lanes.x[i]), static_cast<int>(lanes.y[i]));
    const DepthScale scale(scene, ray, lanes.tile_depth);
    const double nearest = std::max(scene.rules.near_plane, scale.along(lanes.nearest[i]));
    const double limit = scale.along(lanes.first[i]);
    const double depth = firstRoot(scene.rules, leaf, ray, nearest, limit, evaluated);
    if (depth < limit && depth > 0.0) lanes.first[i] = scale.value(depth);
  }
}

void
blendNearLeaf(const FrameScene& scene, std::uint32_t surfel, NearLanes& lanes)
{
  const RaySurfel leaf(scene.surface, surfel);
  std::uint64_t evaluated = 0;
  for (std::size_t i = 0; i < lanes.count; ++i) {
    lanes.weight[i] = 0.0f;
    if (!(lanes.live[i] > 0.0f)) continue;
    const Ray ray = scene.rays.ray(static_cast<int>(lanes.x[i]), static_cast<int>(lanes.y[i]));
    const DepthScale scale(scene, ray, lanes.tile_depth);
    BlendSum sum;
    blendLeaf(scene.rules, scene.surface.info.blend_kernel, leaf, surfel, ray,
              scale.along(lanes.first[i]), sum, evaluated);
    if (sum.leaves == 0) continue;
    lanes.weight[i] = static_cast<float>(sum.weight);
    lanes.shift[i] = static_cast<float>(sum.shift / scale.slant);
    lanes.coverage[i] = static_cast<float>(sum.coverage);
    lanes.outside[i] = static_cast<float>(sum.outside);
    lanes.facing[i] = static_cast<float>(sum.facing);
    turn(scene.view, sum, i, lanes);
  }
}

}  // namespace pcl_slim::detail
