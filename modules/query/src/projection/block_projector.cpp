// SPDX-License-Identifier: BSD-3-Clause
#include "projection/block_projector.h"

#include <algorithm>
#include <cmath>

#include "pcl_slim/cloud/detail/normal_bound.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/query/detail/shape_operator.h"

namespace pcl_slim::detail {

namespace {

// theory.md, "Guards", Projection: which leaves serve a point.
constexpr double kErrors = 5.0;        ///< residuals and offsets beyond so many e do not count,
constexpr double kOffsetShare = 0.25;  ///< nor offsets beyond this share of r,
constexpr double kNoiseShare = 0.6;    ///< unless noise explains them, up to this share
constexpr double kRounding = 1e-5;     ///< of r: exact fits are not held to less than this
constexpr float kSharpDot = 0.5f;  ///< with sharp features leaves serve normals within 60 degrees

}  // namespace

BlockProjector::BlockProjector(const PointStore& store, const SLIMSurface& surface,
                               const std::vector<std::uint32_t>& leaves,
                               const ProjectionParams& params, int threads)
    : store_(store),
      surface_(surface),
      placement_(store, surface),
      trims_(surface),
      with_directions_(params.directions || params.extremality),
      reach_(static_cast<float>(params.reach)),
      noise_(std::sqrt(std::max(0.0, surface.info.lambda)) * surface.info.diagonal),
      by_normals_(surface.info.oriented && store.hasSides() && !params.paper_mode)
{
  rules_.kernel = surface.info.blend_kernel;
  rules_.oriented = surface.info.oriented;
  rules_.guarded = !params.paper_mode;
  rules_.with_hessian = params.curvature || with_directions_;
  rules_.with_third = params.extremality;
  if (by_normals_) min_dot_ = params.sharp_features ? kSharpDot : normalBound(store);
  placed_.resize(leaves.size());
  parallelFor(leaves.size(), threads, 1024,
              [&](std::size_t j, int) { placed_[j] = placed(leaves[j]); });
}

BlockProjector::PlacedLeaf
BlockProjector::placed(std::uint32_t i) const
{
  PlacedLeaf placed{{}, placement_.center(surface_, i)};
  BlockLeaf& leaf = placed.leaf;
  const LocalFrame frame({surface_.nx[i], surface_.ny[i], surface_.nz[i]});
  for (int a = 0; a < 3; ++a) {
    leaf.u[a] = static_cast<float>(frame.u[a]);
    leaf.v[a] = static_cast<float>(frame.v[a]);
    leaf.w[a] = static_cast<float>(frame.w[a]);
  }
  leaf.radius = placement_.radius(surface_, i);
  const double residual = kErrors * surface_.error[i] / surface_.radius[i] + kRounding;
  leaf.max_residual = static_cast<float>(residual);
  const double noise = std::min(kErrors * noise_ / surface_.radius[i], kNoiseShare);
  leaf.max_offset = static_cast<float>(std::min(residual, std::max(kOffsetShare, noise)));
  if (reach_ > 0) leaf.max_residual = leaf.max_offset = reach_;
  leaf.variance_weight = rules_.guarded ? surface_.varianceWeight(i) : 1.0f;
  leaf.degree = surface_.degree[i];
  leaf.c = surface_.coefficientsOf(i);
  leaf.trim = trims_.of(i);
  return placed;
}

BlockLeaf
BlockProjector::relativeTo(std::size_t block, const PlacedLeaf& placed) const
{
  BlockLeaf leaf = placed.leaf;
  const double origin[3] = {store_.blockOriginX()[block], store_.blockOriginY()[block],
                            store_.blockOriginZ()[block]};
  for (std::size_t a = 0; a < 3; ++a) {
    leaf.shift[a] = static_cast<float>(origin[a] - placed.center[a]);
  }
  return leaf;
}

BlockPoints
BlockProjector::pointsOf(std::size_t block) const
{
  const std::size_t first = block * PointStore::kBlock;
  BlockPoints points{store_.x() + first, store_.y() + first, store_.z() + first};
  if (by_normals_) {
    points.nx = store_.nx() + first;
    points.ny = store_.ny() + first;
    points.nz = store_.nz() + first;
    points.min_dot = min_dot_;
  }
  return points;
}

void
BlockProjector::project(std::size_t block, const std::uint32_t* begin, const std::uint32_t* end,
                        Scratch& scratch, Projection& result) const
{
  BlockSums& sums = scratch.sums;
  scratch.near.clear();
  for (const std::uint32_t* at = begin; at != end; ++at) {
    scratch.near.push_back(relativeTo(block, placed_[*at]));
  }
  const BlockPoints points = pointsOf(block);
  for (auto& column : sums.direction) std::fill(column, column + PointStore::kBlock, 0.0f);
  std::fill(sums.weight, sums.weight + PointStore::kBlock, 0.0f);
  const std::size_t leaves = scratch.near.size();
  scratch.heights.resize(std::max(leaves, scratch.heights.size()));
  for (std::size_t j = 0; j < leaves; ++j) {
    kernels::addDirections(points, scratch.near[j], rules_, sums, scratch.heights[j]);
  }
  kernels::finishDirections(sums);
  for (std::size_t j = 0; j < leaves; ++j) {
    kernels::addIntersections(points, scratch.near[j], rules_, scratch.heights[j], sums);
  }

  const std::size_t first = block * PointStore::kBlock;
  const std::size_t count = std::min(PointStore::kBlock, store_.size() - first);
  const BlockMeans means(sums);
  for (std::size_t lane = 0; lane < count; ++lane) {
    write(first + lane, lane, sums, means, result);
  }
}

/** Writes what was blended for point i: its place along the ray (eq. 6) and the normal (eq. 7). */
void
BlockProjector::write(std::size_t i, std::size_t lane, const BlockSums& sums,
                      const BlockMeans& means, Projection& result) const
{
  auto position = store_.position(i);
  if (sums.weight[lane] > 0 && means.length[lane] > BlockMeans::kLeastGradient) {
    for (int a = 0; a < 3; ++a) {
      position[a] += means.offset[lane] * sums.direction[a][lane];
      result.normal[i][a] = means.unit[a][lane];
    }
    result.supported[i] = 1;
    result.inside[i] = static_cast<std::uint8_t>(sums.outside[lane] <= 0.5f * sums.weight[lane]);
    if (rules_.with_hessian) writeCurvature(i, lane, sums, means, result);
  }
  result.position[i] = position;
}

/** The same for curvatures and their derivatives (eq. 8, left). */
void
BlockProjector::writeCurvature(std::size_t i, std::size_t lane, const BlockSums& sums,
                               const BlockMeans& means, Projection& result) const
{
  const double weight = sums.weight[lane], length = means.length[lane];
  const Vector3 g = {means.gradient[0][lane], means.gradient[1][lane], means.gradient[2][lane]};
  Symmetric3<double> h;
  for (std::size_t k = 0; k < h.size(); ++k) h[k] = sums.hessian[k][lane] / weight;
  result.curvature[i] = meanAndGaussian(g, length, h);
  if (with_directions_) result.principal[i] = principalCurvatures(g, length, h);
  if (rules_.with_third) {
    double third[10];
    for (int k = 0; k < 10; ++k) third[k] = sums.third[k][lane] / weight;
    setExtremality(g, length, h, third, result.principal[i]);
  }
}

}  // namespace pcl_slim::detail
