// SPDX-License-Identifier: BSD-3-Clause
// Points onto the surface: equations (6) to (8), with the guards of theory.md, "Projection"; and
// curvatures from a blended gradient and Hessian: theory.md, "Curvature", equation (8), left.
#include "projection/projection.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "hwy/highway.h"
#include "pcl_slim/cloud/detail/noise.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/leaf/detail/gates.h"
#include "pcl_slim/leaf/detail/level_set-inl.h"
#include "pcl_slim/surface/polynomial.h"
#include "projection/block_errors.h"

namespace pcl_slim::detail {

namespace {

/** a^T H b. */
double form(const Vector3& a, const Symmetric3<double>& h, const Vector3& b) {
  return dot(a, multiplied(h, b));
}

std::array<float, 3> directionOf(const kernels::HWY_NAMESPACE::Triple<double>& d) {
  return {static_cast<float>(d.x), static_cast<float>(d.y), static_cast<float>(d.z)};
}

}  // namespace

BlockLeaf blockLeaf(const SLIMSurface& surface, std::uint32_t i, double residual, double noise) {
  BlockLeaf leaf{};
  const LocalFrame frame({surface.nx[i], surface.ny[i], surface.nz[i]});
  for (std::size_t a = 0; a < 3; ++a) {
    leaf.u[a] = static_cast<float>(frame.u[a]);
    leaf.v[a] = static_cast<float>(frame.v[a]);
    leaf.w[a] = static_cast<float>(frame.w[a]);
  }
  leaf.radius = surface.radius[i];
  leaf.max_residual = static_cast<float>(residual);
  leaf.max_offset = static_cast<float>(offsetGate(residual, noise, surface.radius[i]));
  leaf.degree = surface.degree[i];
  leaf.c = surface.coefficientsOf(i);
  return leaf;
}

std::array<float, 2> meanAndGaussian(const Vector3& g, const Symmetric3<double>& h) {
  const kernels::HWY_NAMESPACE::LevelSetCurvatures<double> curvature(g.data(), h.data());
  return {static_cast<float>(curvature.mean), static_cast<float>(curvature.gaussian)};
}

PrincipalFrame principalCurvatures(const Vector3& g, double length, const Symmetric3<double>& h) {
  const auto entry = [&h](std::size_t i) HWY_ATTR { return h[i]; };
  const kernels::HWY_NAMESPACE::PrincipalCurvatures<double> found(
      {g[0] / length, g[1] / length, g[2] / length}, 1.0 / length, entry);
  PrincipalFrame principal;
  principal.k1 = static_cast<float>(found.k1);
  principal.k2 = static_cast<float>(found.k2);
  principal.direction1 = directionOf(found.direction1);
  principal.direction2 = directionOf(found.direction2);
  return principal;
}

void setExtremality(const Vector3& g, double length, const Symmetric3<double>& h,
                    const double third[10], PrincipalFrame& principal) {
  const Vector3 n = {g[0] / length, g[1] / length, g[2] / length};
  const auto derivative = [&](const std::array<float, 3>& direction, double k) {
    const Vector3 t = {direction[0], direction[1], direction[2]};
    // The multiplicity of each entry of the symmetric tensor in T(t, t, t).
    static constexpr double kCount[10] = {1, 3, 3, 3, 6, 3, 1, 3, 3, 1};
    double ttt = 0;
    for (int a = 0, i = 0; a < 3; ++a) {
      for (int b = a; b < 3; ++b) {
        for (int c = b; c < 3; ++c, ++i) ttt += kCount[i] * third[i] * t[a] * t[b] * t[c];
      }
    }
    return static_cast<float>((ttt - 3 * k * form(t, h, n)) / length);
  };
  principal.extremality1 = derivative(principal.direction1, principal.k1);
  principal.extremality2 = derivative(principal.direction2, principal.k2);
}

}  // namespace pcl_slim::detail

namespace pcl_slim {

using namespace detail;

namespace {

/** \brief Weighted means of a block's points, in plain loops; undefined where nothing was added. */
struct BlockMeans {
  double offset[16], gradient[3][16], length[16];
  float unit[3][16];

  explicit BlockMeans(const BlockSums& sums) {
    constexpr int N = 16;
    double weight[N];
    for (int i = 0; i < N; ++i) {
      const double own = sums.weight[i];
      weight[i] = own > 0 ? own : 1.0;
    }
    for (int i = 0; i < N; ++i) offset[i] = sums.offset[i] / weight[i];
    for (int a = 0; a < 3; ++a) {
      for (int i = 0; i < N; ++i) gradient[a][i] = sums.gradient[a][i] / weight[i];
    }
    for (int i = 0; i < N; ++i) {
      length[i] = std::sqrt(gradient[0][i] * gradient[0][i] + gradient[1][i] * gradient[1][i] +
                            gradient[2][i] * gradient[2][i]);
    }
    for (int a = 0; a < 3; ++a) {
      for (int i = 0; i < N; ++i) {
        const double divisor = length[i] > kLeastGradient ? length[i] : 1.0;
        unit[a][i] = static_cast<float>(gradient[a][i] / divisor);
      }
    }
  }
};

/** \brief A surface in a store's units. Where the surface was fitted to the store, origins agree
 * and scales are powers of two: its numbers then stay as they are. */
struct Placement {
  double shift[3];
  double factor;

  Placement(const PointStore& store, const SLIMSurface& surface)
      : factor(surface.info.scale / store.scale()) {
    for (std::size_t a = 0; a < 3; ++a) {
      shift[a] = (surface.info.origin[a] - store.origin()[a]) / store.scale();
    }
  }

  std::array<double, 3> center(const SLIMSurface& surface, std::uint32_t i) const {
    return {shift[0] + factor * surface.cx[i], shift[1] + factor * surface.cy[i],
            shift[2] + factor * surface.cz[i]};
  }
  float radius(const SLIMSurface& surface, std::uint32_t i) const {
    return static_cast<float>(factor * surface.radius[i]);
  }
};

/** \brief For every block of points the leaves whose ball meets it, ascending, as places in a list
 * of leaves: block b has leaves[begin[b]] up to, but not including, leaves[begin[b + 1]]. */
struct BlockLists {
  std::vector<std::uint32_t> begin, leaves;
};

/** A run of the leaves, and the blocks that each of them meets. */
struct Slice {
  std::size_t first, last;               ///< places in the list of leaves
  std::vector<std::uint32_t> hits;       ///< blocks, leaf by leaf
  std::vector<std::uint32_t> hit_begin;  ///< where each leaf's hits begin, and where the last ends
  std::vector<std::uint32_t> at;  ///< of each block: its number of hits, then a place to write
};

void findBlocks(const PointStore& store, const SLIMSurface& surface,
                const std::vector<std::uint32_t>& leaves, Slice& slice) {
  const Placement placement(store, surface);
  for (std::size_t j = slice.first; j < slice.last; ++j) {
    const auto center = placement.center(surface, leaves[j]);
    const float at[3] = {static_cast<float>(center[0]), static_cast<float>(center[1]),
                         static_cast<float>(center[2])};
    slice.hit_begin.push_back(static_cast<std::uint32_t>(slice.hits.size()));
    store.tree().blocksInBall(at, placement.radius(surface, leaves[j]), slice.hits);
  }
  slice.hit_begin.push_back(static_cast<std::uint32_t>(slice.hits.size()));
  slice.at.assign(store.numBlocks(), 0);
  for (const std::uint32_t block : slice.hits) ++slice.at[block];
}

/** Turns the slices' counts into places: block by block, and within a block slice by slice, so that
 * its leaves ascend. \return where each block begins, and the end. */
std::vector<std::uint32_t> placeSlices(std::size_t blocks, std::vector<Slice>& slices) {
  std::vector<std::uint32_t> begin(blocks + 1);
  std::uint32_t total = 0;
  for (std::size_t b = 0; b < blocks; ++b) {
    begin[b] = total;
    for (Slice& slice : slices) {
      const std::uint32_t count = slice.at[b];
      slice.at[b] = total;
      total += count;
    }
  }
  begin[blocks] = total;
  return begin;
}

void writeLeaves(Slice& slice, std::vector<std::uint32_t>& leaves) {
  for (std::size_t j = 0; j + 1 < slice.hit_begin.size(); ++j) {
    for (std::uint32_t h = slice.hit_begin[j]; h < slice.hit_begin[j + 1]; ++h) {
      leaves[slice.at[slice.hits[h]]++] = static_cast<std::uint32_t>(slice.first + j);
    }
  }
}

/** \brief Lists the leaves of all blocks. O(leaves log blocks), plus what is listed; the same for
 * any number of threads. */
BlockLists listLeaves(const PointStore& store, const SLIMSurface& surface,
                      const std::vector<std::uint32_t>& leaves, int threads) {
  // As many slices as threads: each finds its blocks, all are counted, then each writes its own.
  std::vector<Slice> slices(static_cast<std::size_t>(threads));
  for (std::size_t s = 0; s < slices.size(); ++s) {
    slices[s].first = leaves.size() * s / slices.size();
    slices[s].last = leaves.size() * (s + 1) / slices.size();
  }
  parallelFor(slices.size(), threads, 1,
              [&](std::size_t s, int) { findBlocks(store, surface, leaves, slices[s]); });
  BlockLists lists;
  lists.begin = placeSlices(store.numBlocks(), slices);
  lists.leaves.resize(lists.begin.back());
  parallelFor(slices.size(), threads, 1,
              [&](std::size_t s, int) { writeLeaves(slices[s], lists.leaves); });
  return lists;
}

/** \brief Projects the points of a store block by block onto the leaves of a surface, by equations
 * (6) to (8) with the guards of theory.md, "Projection". */
class BlockProjector {
 public:
  /** \brief The scratch memory of one thread. */
  struct Scratch {
    BlockSums sums;
    std::vector<BlockLeaf> near;       ///< the leaves of one block
    std::vector<LeafHeights> heights;  ///< under its points
    BlockBlend blend;
    BlockErrors block_errors;
  };

  /** \brief The arguments must outlive this object. \param[in] leaves those that BlockLists refer
   * to. */
  BlockProjector(const PointStore& store, const SLIMSurface& surface,
                 const std::vector<std::uint32_t>& leaves, const ProjectionParams& params,
                 int threads);

  /** \brief Projects one block's points onto the leaves at some places. */
  void project(std::size_t block, const std::uint32_t* begin, const std::uint32_t* end,
               Scratch& scratch, Projection& result) const;

 private:
  /** A leaf in the store's units, but for its shift to a block. */
  struct PlacedLeaf {
    BlockLeaf leaf;
    std::array<double, 3> center;
  };

  /** \brief Blends the leaves near a block for those of its points that have no support yet.
   * \return whether all have it now. */
  bool blend(std::size_t block, const BlockPoints& points, Scratch& scratch,
             Projection& result) const;
  PlacedLeaf placed(std::uint32_t i) const;
  BlockLeaf relativeTo(std::size_t block, const PlacedLeaf& placed) const;
  BlockPoints pointsOf(std::size_t block) const;
  void write(std::size_t i, std::size_t lane, const BlockSums& sums, const BlockMeans& means,
             Projection& result) const;
  void writeCurvature(std::size_t i, std::size_t lane, const BlockSums& sums,
                      const BlockMeans& means, Projection& result) const;
  void writeErrors(std::size_t block, const BlockPoints& points, const BlockMeans& means,
                   const std::array<bool, PointStore::kBlock>& written, Scratch& scratch,
                   Projection& result) const;

  const PointStore& store_;
  const SLIMSurface& surface_;
  Placement placement_;
  TrimTables trims_;
  std::vector<PlacedLeaf> placed_;
  LeafErrorTable errors_;  ///< of the leaves, if requested
  bool with_errors_;
  BlendRules rules_;
  bool with_directions_;     ///< principal curvatures and directions
  float reach_;              ///< > 0: [r] largest residual and offset, in place of the above
  double noise_;             ///< sqrt(lambda) in the surface's local units
  bool by_normals_;          ///< whether a leaf counts only for normals near its own
  float min_dot_ = 0.0f;     ///< and the least cosine with it
  bool sides_may_be_wrong_;  ///< sides were found: where no leaf is of a point's side, all count
};

constexpr double kRounding = 1e-5;  ///< [r] added to the largest residual, for exact fits

BlockProjector::BlockProjector(const PointStore& store, const SLIMSurface& surface,
                               const std::vector<std::uint32_t>& leaves,
                               const ProjectionParams& params, int threads)
    : store_(store),
      surface_(surface),
      placement_(store, surface),
      trims_(surface),
      with_errors_(params.errors),
      with_directions_(params.directions || params.extremality),
      reach_(static_cast<float>(params.reach)),
      noise_(std::sqrt(std::max(0.0, surface.info.lambda)) * surface.info.diagonal),
      by_normals_(surface.info.oriented && store.hasSides() && !surface.info.paper_mode),
      sides_may_be_wrong_(by_normals_ && !store.hasNormals()) {
  rules_.kernel = surface.info.blend_kernel;
  rules_.oriented = surface.info.oriented;
  rules_.guarded = !surface.info.paper_mode;
  rules_.with_hessian = params.curvature || with_directions_;
  rules_.with_third = params.extremality;
  if (by_normals_) min_dot_ = params.sharp_features ? kSharpCosine : normalBound(store);
  if (with_errors_) errors_ = LeafErrorTable(surface, threads);
  placed_.resize(leaves.size());
  parallelFor(leaves.size(), threads, 1024,
              [&](std::size_t j, int) { placed_[j] = placed(leaves[j]); });
}

BlockProjector::PlacedLeaf BlockProjector::placed(std::uint32_t i) const {
  const double residual = kErrorGate * surface_.error[i] / surface_.radius[i] + kRounding;
  PlacedLeaf placed{blockLeaf(surface_, i, residual, noise_), placement_.center(surface_, i)};
  BlockLeaf& leaf = placed.leaf;
  leaf.radius = placement_.radius(surface_, i);
  if (reach_ > 0) leaf.max_residual = leaf.max_offset = reach_;
  leaf.variance_weight = rules_.guarded ? surface_.varianceWeight(i) : 1.0f;
  leaf.trim = trims_.of(i);
  if (with_errors_) leaf.errors = errors_.of(surface_, i);
  return placed;
}

BlockLeaf BlockProjector::relativeTo(std::size_t block, const PlacedLeaf& placed) const {
  BlockLeaf leaf = placed.leaf;
  const double origin[3] = {store_.blockOriginX()[block], store_.blockOriginY()[block],
                            store_.blockOriginZ()[block]};
  for (std::size_t a = 0; a < 3; ++a) {
    leaf.shift[a] = static_cast<float>(origin[a] - placed.center[a]);
  }
  return leaf;
}

BlockPoints BlockProjector::pointsOf(std::size_t block) const {
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

void BlockProjector::project(std::size_t block, const std::uint32_t* begin,
                             const std::uint32_t* end, Scratch& scratch, Projection& result) const {
  scratch.near.clear();
  for (const std::uint32_t* at = begin; at != end; ++at) {
    scratch.near.push_back(relativeTo(block, placed_[*at]));
  }
  scratch.heights.resize(std::max(scratch.near.size(), scratch.heights.size()));
  BlockPoints points = pointsOf(block);
  if (blend(block, points, scratch, result) || !sides_may_be_wrong_) return;
  points.nx = nullptr;
  blend(block, points, scratch, result);
}

bool BlockProjector::blend(std::size_t block, const BlockPoints& points, Scratch& scratch,
                           Projection& result) const {
  BlockSums& sums = scratch.sums;
  for (auto& column : sums.direction) std::fill(column, column + PointStore::kBlock, 0.0f);
  std::fill(sums.weight, sums.weight + PointStore::kBlock, 0.0f);
  const std::size_t leaves = scratch.near.size();
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
  bool all = true;
  std::array<bool, PointStore::kBlock> written{};
  for (std::size_t lane = 0; lane < count; ++lane) {
    if (result.supported[first + lane] != 0) continue;
    write(first + lane, lane, sums, means, result);
    written[lane] = result.supported[first + lane] != 0;
    all = all && written[lane];
  }
  if (with_errors_) writeErrors(block, points, means, written, scratch, result);
  return all;
}

/** Writes the standard errors of a block's points that have just been written. */
void BlockProjector::writeErrors(std::size_t block, const BlockPoints& points,
                                 const BlockMeans& means,
                                 const std::array<bool, PointStore::kBlock>& written,
                                 Scratch& scratch, Projection& result) const {
  const std::size_t first = block * PointStore::kBlock;
  BlockBlend& blend = scratch.blend;
  for (std::size_t lane = 0; lane < PointStore::kBlock; ++lane) {
    blend.offset[lane] = static_cast<float>(means.offset[lane]);
    for (std::size_t a = 0; a < 3; ++a) blend.normal[a][lane] = means.unit[a][lane];
    const bool curved = written[lane] && rules_.with_hessian;
    blend.curvature[lane] = curved ? result.curvature[first + lane][0] : 0.0f;
  }
  scratch.block_errors = {};
  for (std::size_t j = 0; j < scratch.near.size(); ++j) {
    kernels::addErrors(points, scratch.near[j], rules_, scratch.heights[j], scratch.sums, blend,
                       scratch.block_errors);
  }
  for (std::size_t lane = 0; lane < PointStore::kBlock; ++lane) {
    if (!written[lane]) continue;
    result.errors[first + lane] = standardErrors(scratch.block_errors, lane, rules_.with_hessian);
  }
}

/** Writes what was blended for point i: its place along the ray (eq. 6) and the normal (eq. 7). */
void BlockProjector::write(std::size_t i, std::size_t lane, const BlockSums& sums,
                           const BlockMeans& means, Projection& result) const {
  auto position = store_.position(i);
  if (sums.weight[lane] > 0 && means.length[lane] > kLeastGradient) {
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
void BlockProjector::writeCurvature(std::size_t i, std::size_t lane, const BlockSums& sums,
                                    const BlockMeans& means, Projection& result) const {
  const double weight = sums.weight[lane], length = means.length[lane];
  const Vector3 g = {means.gradient[0][lane], means.gradient[1][lane], means.gradient[2][lane]};
  Symmetric3<double> h;
  for (std::size_t k = 0; k < h.size(); ++k) h[k] = sums.hessian[k][lane] / weight;
  result.curvature[i] = meanAndGaussian(g, h);
  if (with_directions_) result.principal[i] = principalCurvatures(g, length, h);
  if (rules_.with_third) {
    double third[10];
    for (int k = 0; k < 10; ++k) third[k] = sums.third[k][lane] / weight;
    setExtremality(g, length, h, third, result.principal[i]);
  }
}

void allocate(std::size_t points, const ProjectionParams& params, Projection& result) {
  result.position.resize(points);
  result.normal.assign(points, {0, 0, 0});
  result.supported.assign(points, 0);
  result.inside.assign(points, 0);
  const bool directions = params.directions || params.extremality;
  if (params.curvature || directions) result.curvature.assign(points, {0, 0});
  if (directions) result.principal.assign(points, {});
  if (params.errors) result.errors.assign(points, {});
}

}  // namespace

Error projectPoints(const PointStore& store, const SLIMSurface& surface,
                    const ProjectionParams& params, Projection& result, Progress* progress) {
  result = Projection();
  const double factor = surface.info.scale / store.scale();
  if (!(factor > 1e-30 && factor < 1e30)) {
    return {ErrorCode::kBadArgument,
            "the surface has nothing of the cloud's size; project the cloud it was fitted to"};
  }
  const int threads = resolveThreads(params.threads);
  allocate(store.size(), params, result);
  if (progress != nullptr) progress->report(0.0f, "projecting");
  const std::vector<std::uint32_t> leaves = surface.leaves();
  const BlockLists lists = listLeaves(store, surface, leaves, threads);
  const BlockProjector projector(store, surface, leaves, params, threads);
  std::vector<BlockProjector::Scratch> scratch(static_cast<std::size_t>(threads));
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
