// SPDX-License-Identifier: BSD-3-Clause
#include "reference/tile_passes.h"

#include <algorithm>
#include <limits>

#include "pcl_slim/query/detail/ray_surfel.h"

namespace pcl_slim::detail {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kMaxShift = 0.25;  ///< distance of q^ from a leaf's own surface, in its radii

/** \brief Interval of s in which a ray is inside the ball of relative radius rho and beyond the
 * near plane; empty when low > high. */
struct Chord {
  double low, high;

  Chord(const RaySurfel& surfel, const Approach& approach, double rho, double near_plane)
  {
    const double half_sq = rho * rho - approach.distance_sq;
    high = half_sq > 0.0 ? std::sqrt(half_sq) : -1.0;
    low = std::max(-high, (near_plane - approach.depth) * surfel.inverse_radius);
  }
};

/** \brief Depth of the first root of a leaf between two depths, or infinity. */
double
firstRoot(const FrameContext& frame, const RaySurfel& surfel, const Ray& ray, double nearest,
          double limit, std::uint64_t& evaluated)
{
  const Approach approach(surfel, ray);
  Chord chord(surfel, approach, frame.rules.shrink, nearest);
  chord.high = std::min(chord.high, (limit - approach.depth) * surfel.inverse_radius);
  if (!(chord.low <= chord.high)) return kInfinity;
  ++evaluated;
  const RayPolynomial polynomial(surfel, approach, ray.direction);
  const Roots roots = polynomial.roots(surfel.degree, chord.low, chord.high);
  for (int i = 0; i < roots.count; ++i) {
    if (frame.rules.front_only && !(polynomial.slope(roots.at[i]) < 0.0)) continue;
    return approach.depth + roots.at[i] * surfel.radius;
  }
  return kInfinity;
}

/** \brief Largest first depth of the pixels to look at: infinity until each has one. */
double
farthest(const Tile& tile)
{
  double depth = 0.0;
  for (int y = tile.pending.y0; y <= tile.pending.y1; ++y) {
    for (int x = tile.pending.x0; x <= tile.pending.x1; ++x) {
      const std::size_t pixel = tile.index(x, y);
      if (tile.is_pending[pixel]) depth = std::max(depth, tile.first_depth[pixel]);
    }
  }
  return depth;
}

/** \brief Adds w grad f and w H of a leaf, turned by sign, in world axes. */
void
addDerivatives(const RaySurfel& surfel, const HeightJet& jet, double weight, BlendSum& sum)
{
  const Vector3 &u = surfel.frame.u, &v = surfel.frame.v, &w = surfel.frame.w;
  for (int k = 0; k < 3; ++k) {
    sum.gradient[k] += weight * (w[k] - jet.hu * u[k] - jet.hv * v[k]);
  }
  const double scale = -weight * surfel.inverse_radius;
  const auto entry = [&](int i, int j) {
    return scale *
           (jet.huu * u[i] * u[j] + jet.huv * (u[i] * v[j] + v[i] * u[j]) + jet.hvv * v[i] * v[j]);
  };
  sum.hessian[0] += entry(0, 0);
  sum.hessian[1] += entry(1, 1);
  sum.hessian[2] += entry(2, 2);
  sum.hessian[3] += entry(0, 1);
  sum.hessian[4] += entry(0, 2);
  sum.hessian[5] += entry(1, 2);
}

/** \brief The root nearest to s_hat, of those on the chord that count. \return false when there is
 * none. */
bool
nearestRoot(const RayPolynomial& polynomial, int degree, const Chord& chord, double s_hat,
            bool front_only, double& root)
{
  const auto counts = [&](double s) { return !front_only || polynomial.slope(s) < 0.0; };
  if (obviousRoot(polynomial.a, s_hat, root) && root >= chord.low && root <= chord.high &&
      counts(root)) {
    return true;
  }
  const Roots roots = polynomial.roots(degree, chord.low, chord.high);
  bool found = false;
  for (int i = 0; i < roots.count; ++i) {
    const double s = roots.at[i];
    if (!counts(s) || (found && std::abs(s - s_hat) >= std::abs(root - s_hat))) continue;
    root = s;
    found = true;
  }
  return found;
}

/** \brief Adds one leaf to one pixel's blend. */
void
blendLeaf(const FrameContext& frame, const RaySurfel& surfel, std::uint32_t id, const Ray& ray,
          double depth_hat, BlendSum& sum, std::uint64_t& evaluated)
{
  const Approach approach(surfel, ray);
  const double s_hat = (depth_hat - approach.depth) * surfel.inverse_radius;
  const double hat_sq = approach.distance_sq + s_hat * s_hat;
  if (!(hat_sq < 1.0)) return;
  ++evaluated;
  const RayPolynomial polynomial(surfel, approach, ray.direction);
  if (!(std::abs(evaluate<4>(polynomial.a, s_hat)) < kMaxShift)) return;
  const Chord chord(surfel, approach, 1.0, frame.rules.near_plane);
  double s = 0.0;
  if (!nearestRoot(polynomial, surfel.degree, chord, s_hat, frame.rules.front_only, s)) return;

  const Vector3 q = along(approach.point, s, ray.direction);
  const HeightJet jet = evaluateJet(surfel.degree, surfel.coefficients, dot(q, surfel.frame.u),
                                    dot(q, surfel.frame.v));
  const double slope = polynomial.slope(s);
  // A leaf of another sheet may have its root near its own centre: q^ has to be near as well.
  const double root_sq = approach.distance_sq + s * s;
  const WeightKernel kernel = frame.surface.info.blend_kernel;
  const double weight = surfel.trust * evaluateKernel(kernel, std::max(hat_sq, root_sq));
  if (!(weight > 0.0)) return;
  const double side = slope > 0.0 ? -1.0 : 1.0;
  sum.weight += weight;
  sum.shift += weight * (s - s_hat) * surfel.radius;
  sum.coverage += evaluateKernel(kernel, root_sq / (frame.rules.cover_radius * frame.rules.cover_radius));
  for (std::size_t k = 0; k < 3; ++k) sum.lean[k] += weight * q[k];
  ++sum.leaves;
  sum.facing += slope > 0.0 ? -1 : 1;
  addDerivatives(surfel, jet, side * weight, sum);
  if (weight > sum.largest_weight) {
    sum.largest_weight = weight;
    sum.surfel = id;
  }
}

/** \brief Whether a blend belongs to the surface: its leaves cover it, or it lies in a gap between
 * leaves all around it. Beyond the rim of what was measured all leaves lie to one side. */
bool
isSupported(const BlendSum& sum, double min_coverage)
{
  constexpr int kMinLeaves = 3;
  constexpr double kMaxLean = 0.25;  ///< in radii
  if (sum.coverage >= min_coverage) return true;
  const double lean_sq =
      sum.lean[0] * sum.lean[0] + sum.lean[1] * sum.lean[1] + sum.lean[2] * sum.lean[2];
  return sum.leaves >= kMinLeaves && lean_sq < kMaxLean * kMaxLean * sum.weight * sum.weight;
}

}  // namespace

void
Tile::begin(const FrameContext& frame, const ImageSize& size, std::size_t t)
{
  const auto columns = static_cast<std::size_t>(frame.bins.columns);
  x0 = static_cast<int>(t % columns) * kTileSize;
  y0 = static_cast<int>(t / columns) * kTileSize;
  width = std::min(kTileSize, size.width - x0);
  height = std::min(kTileSize, size.height - y0);
  rays.resize(kTileSize * kTileSize);
  first_depth.assign(kTileSize * kTileSize, kInfinity);
  nearest.assign(kTileSize * kTileSize, frame.rules.near_plane);
  is_pending.assign(kTileSize * kTileSize, 1);
  sums.assign(kTileSize * kTileSize, BlendSum());
  pending = {x0, y0, x0 + width - 1, y0 + height - 1};
  for (int y = y0; y < y0 + height; ++y) {
    for (int x = x0; x < x0 + width; ++x) rays[index(x, y)] = frame.rays.ray(x, y);
  }
}

PixelRect
Tile::clip(const PixelRect& rect) const
{
  return {std::max(rect.x0, pending.x0), std::max(rect.y0, pending.y0),
          std::min(rect.x1, pending.x1), std::min(rect.y1, pending.y1)};
}

void
findFirstIntersections(const FrameContext& frame, std::size_t t, Tile& tile,
                       RenderStatistics& statistics)
{
  constexpr std::uint64_t kLookEvery = 16;  // entries between looks at the whole tile's depth
  const SurfelBins& bins = frame.bins;
  for (std::uint64_t e = bins.begin[t]; e < bins.begin[t + 1]; ++e) {
    const VisibleLeaf& leaf = bins.leaves[bins.entries[e]];
    if (frame.rules.skip && (e - bins.begin[t]) % kLookEvery == 0 && leaf.nearest > farthest(tile)) {
      statistics.occluded_entries += bins.begin[t + 1] - e;
      return;  // entries are sorted: every later one is as far
    }
    const PixelRect rect = tile.clip(leaf.first);
    if (rect.empty()) continue;
    const RaySurfel surfel(frame.surface, leaf.surfel);
    for (int y = rect.y0; y <= rect.y1; ++y) {
      for (int x = rect.x0; x <= rect.x1; ++x) {
        const std::size_t pixel = tile.index(x, y);
        double& first = tile.first_depth[pixel];
        if (!tile.is_pending[pixel] || leaf.nearest > first) continue;
        first = std::min(first, firstRoot(frame, surfel, tile.rays[pixel], tile.nearest[pixel],
                                          first, statistics.rays_first));
      }
    }
  }
}

void
gatherBlends(const FrameContext& frame, std::size_t t, Tile& tile, RenderStatistics& statistics)
{
  const SurfelBins& bins = frame.bins;
  double last = 0.0;
  for (const double depth : tile.first_depth) {
    if (depth < kInfinity) last = std::max(last, depth);
  }
  for (std::uint64_t e = bins.begin[t]; e < bins.begin[t + 1]; ++e) {
    const VisibleLeaf& leaf = bins.leaves[bins.entries[e]];
    if (frame.rules.skip && leaf.nearest > last) return;
    const PixelRect rect = tile.clip(leaf.blend);
    if (rect.empty()) continue;
    const RaySurfel surfel(frame.surface, leaf.surfel);
    for (int y = rect.y0; y <= rect.y1; ++y) {
      for (int x = rect.x0; x <= rect.x1; ++x) {
        const std::size_t pixel = tile.index(x, y);
        const double first = tile.first_depth[pixel];
        if (!tile.is_pending[pixel] || !(first < kInfinity)) continue;
        blendLeaf(frame, surfel, leaf.surfel, tile.rays[pixel], first, tile.sums[pixel],
                  statistics.rays_blend);
      }
    }
  }
}

bool
peelUncovered(const FrameContext& frame, Tile& tile)
{
  // Nothing well covered lies within a leaf's reach of an uncovered q^, or it would have been
  // blended: a step of a share of its radius passes over the other leaves of the same flap.
  constexpr double kStep = 0.05;
  PixelRect left;
  left.x0 = left.y0 = std::numeric_limits<int>::max();
  for (int y = tile.pending.y0; y <= tile.pending.y1; ++y) {
    for (int x = tile.pending.x0; x <= tile.pending.x1; ++x) {
      const std::size_t pixel = tile.index(x, y);
      if (!tile.is_pending[pixel]) continue;
      BlendSum& sum = tile.sums[pixel];
      const bool met = sum.surfel != GBuffer::kNothing;
      if (!met || isSupported(sum, frame.rules.min_coverage)) {
        tile.is_pending[pixel] = 0;
        continue;
      }
      tile.nearest[pixel] = tile.first_depth[pixel] + kStep * frame.surface.radius[sum.surfel];
      tile.first_depth[pixel] = kInfinity;
      sum = BlendSum();
      left = {std::min(left.x0, x), std::min(left.y0, y), std::max(left.x1, x),
              std::max(left.y1, y)};
    }
  }
  tile.pending = left;
  return !left.empty();
}

}  // namespace pcl_slim::detail
