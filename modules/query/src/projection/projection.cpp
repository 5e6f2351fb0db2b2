// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/query/projection.h"

#include <algorithm>
#include <cmath>

#include "pcl_slim/query/detail/shape_operator.h"
#include "pcl_slim/cloud/detail/normal_bound.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/query/detail/block_means.h"
#include "pcl_slim/query/detail/projection_kernel.h"

namespace pcl_slim {

using namespace detail;

namespace {

constexpr double kGateErrors = 5.0;  ///< residuals and offsets beyond so many e do not count
constexpr float kSharpDot = 0.5f;  ///< with sharp features, leaves serve normals within 60 degrees
constexpr double kGateRadius = 0.25;  ///< nor offsets beyond this share of r
constexpr double kGateNoise = 0.6;    ///< unless noise explains them, up to this share
constexpr double kLeastGate = 1e-5;   ///< of r: exact fits must not gate on rounding

/** A surface in a store's units. Scales are powers of two and origins agree when the surface was
 * fitted to the store: its numbers then stay as they are. */
struct Placement {
  double shift[3];
  double factor;

  Placement(const PointStore& store, const SLIMSurface& surface)
      : factor(surface.info.scale / store.scale())
  {
    for (std::size_t a = 0; a < 3; ++a) {
      shift[a] = (surface.info.origin[a] - store.origin()[a]) / store.scale();
    }
  }

  std::array<double, 3> center(const SLIMSurface& surface, std::uint32_t i) const
  {
    return {shift[0] + factor * surface.cx[i], shift[1] + factor * surface.cy[i],
            shift[2] + factor * surface.cz[i]};
  }
  float radius(const SLIMSurface& surface, std::uint32_t i) const
  {
    return static_cast<float>(factor * surface.radius[i]);
  }
};

/** For every block of points the leaves whose ball meets it, ascending, as places in the list of
 * leaves. */
struct BlockLists {
  std::vector<std::uint32_t> begin, leaves;
};

BlockLists
listLeaves(const PointStore& store, const SLIMSurface& surface,
           const std::vector<std::uint32_t>& leaves, int threads)
{
  const Placement placement(store, surface);
  // Leaves are cut into as many slices as there are threads; each slice counts, then writes.
  const auto slices = static_cast<std::size_t>(threads);
  const std::size_t blocks = store.numBlocks();
  std::vector<std::vector<std::uint32_t>> counts(slices), hits(slices), hit_begin(slices);
  parallelFor(slices, threads, 1, [&](std::size_t s, int) {
    counts[s].assign(blocks, 0);
    for (std::size_t j = leaves.size() * s / slices; j < leaves.size() * (s + 1) / slices; ++j) {
      const std::uint32_t i = leaves[j];
      const auto at = placement.center(surface, i);
      const float center[3] = {static_cast<float>(at[0]), static_cast<float>(at[1]),
                               static_cast<float>(at[2])};
      hit_begin[s].push_back(static_cast<std::uint32_t>(hits[s].size()));
      store.tree().blocksInBall(center, placement.radius(surface, i), hits[s]);
    }
    hit_begin[s].push_back(static_cast<std::uint32_t>(hits[s].size()));
    for (const std::uint32_t b : hits[s]) ++counts[s][b];
  });
  BlockLists lists;
  lists.begin.resize(blocks + 1);
  std::uint32_t total = 0;
  for (std::size_t b = 0; b < blocks; ++b) {
    lists.begin[b] = total;
    for (std::size_t s = 0; s < slices; ++s) {
      const std::uint32_t count = counts[s][b];
      counts[s][b] = total;
      total += count;
    }
  }
  lists.begin[blocks] = total;
  lists.leaves.resize(total);
  parallelFor(slices, threads, 1, [&](std::size_t s, int) {
    const std::size_t first = leaves.size() * s / slices;
    for (std::size_t j = 0; j + 1 < hit_begin[s].size(); ++j) {
      for (std::uint32_t h = hit_begin[s][j]; h < hit_begin[s][j + 1]; ++h) {
        lists.leaves[counts[s][hits[s][h]]++] = static_cast<std::uint32_t>(first + j);
      }
    }
  });
  return lists;
}

/** What one thread needs beside the result. */
struct Scratch {
  BlockSums sums;
  std::vector<BlockLeaf> near;  ///< the leaves of one block
};

class Projector {
 public:
  Projector(const PointStore& store, const SLIMSurface& surface,
            const std::vector<std::uint32_t>& leaves, const ProjectionParams& params, int threads)
      : store_(store),
        surface_(surface),
        placement_(store, surface),
        directions_(params.directions || params.extremality)
  {
    rules_.kernel = surface.info.blend_kernel;
    rules_.oriented = surface.info.oriented;
    rules_.guarded = !params.paper_mode;
    rules_.with_hessian = params.curvature || directions_;
    rules_.with_third = params.extremality;
    noise_ = std::sqrt(std::max(0.0, surface.info.lambda)) * surface.info.diagonal;
    gated_ = surface.info.oriented && store.hasNormals() && !params.paper_mode;
    if (gated_) min_dot_ = params.sharp_features ? kSharpDot : normalGate(store);
    placed_.resize(leaves.size());
    parallelFor(leaves.size(), threads, 1024,
                [&](std::size_t j, int) { placed_[j] = place(leaves[j]); });
  }

  /** Projects one block's points on the leaves at the given places. */
  void project(std::size_t block, const std::uint32_t* begin, const std::uint32_t* end,
               Scratch& scratch, Projection& result) const
  {
    BlockSums& sums = scratch.sums;
    scratch.near.clear();
    for (const std::uint32_t* at = begin; at != end; ++at) {
      scratch.near.push_back(relativeTo(block, placed_[*at]));
    }
    const std::size_t first = block * PointStore::kBlock;
    BlockPoints points{store_.x() + first, store_.y() + first, store_.z() + first};
    if (gated_) {
      points.nx = store_.nx() + first;
      points.ny = store_.ny() + first;
      points.nz = store_.nz() + first;
      points.min_dot = min_dot_;
    }
    for (auto& column : sums.direction) std::fill(column, column + 16, 0.0f);
    for (const BlockLeaf& leaf : scratch.near) {
      kernels::addDirections(points, leaf, rules_, sums);
    }
    kernels::finishDirections(sums);
    for (const BlockLeaf& leaf : scratch.near) {
      kernels::addIntersections(points, leaf, rules_, sums);
    }
    const std::size_t count = std::min(PointStore::kBlock, store_.size() - first);
    const BlockMeans means(sums);
    for (std::size_t lane = 0; lane < count; ++lane) {
      finish(first + lane, lane, sums, means, result);
    }
  }

 private:
  /** A leaf in the store's units, but for its shift to a block. */
  struct PlacedLeaf {
    BlockLeaf leaf;
    std::array<double, 3> center;
  };

  BlockLeaf relativeTo(std::size_t block, const PlacedLeaf& placed) const
  {
    BlockLeaf leaf = placed.leaf;
    const double origin[3] = {store_.blockOriginX()[block], store_.blockOriginY()[block],
                              store_.blockOriginZ()[block]};
    for (std::size_t a = 0; a < 3; ++a) {
      leaf.shift[a] = static_cast<float>(origin[a] - placed.center[a]);
    }
    return leaf;
  }

  PlacedLeaf place(std::uint32_t i) const
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
    const double gate = kGateErrors * surface_.error[i] / surface_.radius[i] + kLeastGate;
    leaf.max_residual = static_cast<float>(gate);
    const double noise = std::min(kGateErrors * noise_ / surface_.radius[i], kGateNoise);
    leaf.max_offset = static_cast<float>(std::min(gate, std::max(kGateRadius, noise)));
    leaf.trust = rules_.guarded ? surface_.trust(i) : 1.0f;
    leaf.degree = surface_.degree[i];
    leaf.c = surface_.coefficientsOf(i);
    return placed;
  }

  /** Writes down what was blended for point i. */
  void finish(std::size_t i, std::size_t lane, const BlockSums& sums, const BlockMeans& means,
              Projection& result) const
  {
    auto position = store_.position(i);
    const double weight = sums.weight[lane], length = means.length[lane];
    if (weight > 0 && length > BlockMeans::kLeastGradient) {
      for (int a = 0; a < 3; ++a) {
        position[a] += means.offset[lane] * sums.direction[a][lane];
        result.normal[i][a] = means.unit[a][lane];
      }
      result.supported[i] = 1;
      if (rules_.with_hessian) setCurvature(i, lane, sums, means, result);
    }
    result.position[i] = position;
  }

  void setCurvature(std::size_t i, std::size_t lane, const BlockSums& sums, const BlockMeans& means,
                    Projection& result) const
  {
    const double weight = sums.weight[lane], length = means.length[lane];
    const double g[3] = {means.gradient[0][lane], means.gradient[1][lane], means.gradient[2][lane]};
    double h[6];
    for (int k = 0; k < 6; ++k) h[k] = sums.hessian[k][lane] / weight;
    result.curvature[i] = meanAndGaussian(g, length, h);
    if (directions_) result.principal[i] = principalCurvatures(g, length, h);
    if (rules_.with_third) {
      double third[10];
      for (int k = 0; k < 10; ++k) third[k] = sums.third[k][lane] / weight;
      setExtremality(g, length, h, third, result.principal[i]);
    }
  }

  const PointStore& store_;
  const SLIMSurface& surface_;
  Placement placement_;
  std::vector<PlacedLeaf> placed_;
  bool directions_;
  double noise_;  ///< sqrt(lambda) in the surface's local units
  bool gated_ = false;
  float min_dot_ = 0.0f;
  BlendRules rules_;
};

}  // namespace

Error
projectPoints(const PointStore& store, const SLIMSurface& surface, const ProjectionParams& params,
              Projection& result, Progress* progress)
{
  result = Projection();
  const double factor = surface.info.scale / store.scale();
  if (!(factor > 1e-30 && factor < 1e30)) {
    return {ErrorCode::kBadArgument,
            "the surface has nothing of the cloud's size; project the cloud it was fitted to"};
  }
  const int threads = resolveThreads(params.threads);
  result.position.resize(store.size());
  result.normal.assign(store.size(), {0, 0, 0});
  result.supported.assign(store.size(), 0);
  const bool directions = params.directions || params.extremality;
  if (params.curvature || directions) result.curvature.assign(store.size(), {0, 0});
  if (directions) result.principal.assign(store.size(), {});

  std::vector<std::uint32_t> leaves;
  for (std::uint32_t i = 0; i < surface.size(); ++i) {
    if (surface.isLeaf(i)) leaves.push_back(i);
  }
  if (progress != nullptr) progress->report(0.0f, "projecting");
  const BlockLists lists = listLeaves(store, surface, leaves, threads);
  const Projector projector(store, surface, leaves, params, threads);
  std::vector<Scratch> scratch(static_cast<std::size_t>(threads));
  parallelFor(store.numBlocks(), threads, 64, [&](std::size_t b, int thread) {
    if (progress != nullptr && progress->cancelled()) return;
    projector.project(b, lists.leaves.data() + lists.begin[b],
                      lists.leaves.data() + lists.begin[b + 1],
                      scratch[static_cast<std::size_t>(thread)], result);
  });
  if (progress != nullptr && progress->cancelled()) {
    result = Projection();
    return {ErrorCode::kCancelled, "the projection was cancelled"};
  }
  result.num_unsupported =
      static_cast<std::uint64_t>(std::count(result.supported.begin(), result.supported.end(), 0));
  return {};
}

}  // namespace pcl_slim
