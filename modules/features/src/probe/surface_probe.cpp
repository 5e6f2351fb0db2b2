// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/features/surface_probe.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pcl_slim/cloud/block_tree.h"
#include "pcl_slim/cloud/morton.h"
#include "pcl_slim/query/detail/block_means.h"
#include "pcl_slim/query/detail/projection_kernel.h"
#include "pcl_slim/query/detail/shape_operator.h"

namespace pcl_slim {

using namespace detail;

namespace {

constexpr double kGateErrors = 5.0;  ///< residuals and offsets beyond so many e do not count
constexpr double kLeastGate = 0.1;   ///< but those up to this share of r do
constexpr double kGateRadius = 0.25;
constexpr double kGateNoise = 0.6;

/** k1 and k2 alone: the eigenvalues of the Hessian over |g| in the tangent plane. */
std::pair<double, double>
principalValues(const Vector3& g, double length, const Symmetric3<double>& h)
{
  const LocalFrame frame({g[0] / length, g[1] / length, g[2] / length});
  const Vector3 &u = frame.u, &v = frame.v;
  const Vector3 hu = multiplied(h, u), hv = multiplied(h, v);
  const double uu = dot(u, hu), uv = dot(u, hv), vv = dot(v, hv);
  const double mean = 0.5 * (uu + vv), half = 0.5 * (uu - vv);
  const double spread = std::sqrt(half * half + uv * uv);
  return {(mean + spread) / length, (mean - spread) / length};
}

struct Leaf {
  BlockLeaf leaf;  ///< but for its shift
  Vector3 center;
  float effective_count;
};

Leaf
placeLeaf(const SLIMSurface& surface, std::uint32_t i, double noise)
{
  Leaf placed{{}, {surface.cx[i], surface.cy[i], surface.cz[i]}, surface.effective_count[i]};
  BlockLeaf& leaf = placed.leaf;
  const LocalFrame frame({surface.nx[i], surface.ny[i], surface.nz[i]});
  for (std::size_t a = 0; a < 3; ++a) {
    leaf.u[a] = static_cast<float>(frame.u[a]);
    leaf.v[a] = static_cast<float>(frame.v[a]);
    leaf.w[a] = static_cast<float>(frame.w[a]);
  }
  leaf.radius = surface.radius[i];
  const double gate = std::max(kLeastGate, kGateErrors * surface.error[i] / surface.radius[i]);
  const double most = std::min(kGateErrors * noise / surface.radius[i], kGateNoise);
  leaf.max_residual = static_cast<float>(gate);
  leaf.max_offset = static_cast<float>(std::min(gate, std::max(kGateRadius, most)));
  leaf.variance_weight = surface.info.paper_mode ? 1.0f : surface.varianceWeight(i);
  leaf.degree = surface.degree[i];
  leaf.c = surface.coefficientsOf(i);
  return placed;
}

/** Squared distance from a place to a box. */
double
distanceSq(const Vector3& p, const Vector3& low, const Vector3& high)
{
  double sum = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const double off = std::max({low[a] - p[a], p[a] - high[a], 0.0});
    sum += off * off;
  }
  return sum;
}

}  // namespace

struct ProbeIndex::Leaves {
  std::vector<Leaf> all;  ///< in Morton order of their centres
  BlockTree tree;         ///< over their balls' boxes
  BlendRules rules;
};

ProbeIndex::ProbeIndex(const SLIMSurface& surface)
    : surface_(surface), leaves_(std::make_unique<Leaves>())
{
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order;
  for (std::uint32_t i = 0; i < surface.size(); ++i) {
    if (!surface.isLeaf(i)) continue;
    // Centres lie within a unit box about the origin but for those that moved onto their fit.
    order.emplace_back(mortonCode(surface.cx[i], surface.cy[i], surface.cz[i]), i);
  }
  std::sort(order.begin(), order.end());
  const double noise = std::sqrt(std::max(0.0, surface.info.lambda)) * surface.info.diagonal;
  BlockTree::Level boxes;
  boxes.allocate(order.size());
  for (std::size_t j = 0; j < order.size(); ++j) {
    const std::uint32_t i = order[j].second;
    leaves_->all.push_back(placeLeaf(surface, i, noise));
    const float r = surface.radius[i];
    boxes.min_x[j] = surface.cx[i] - r;
    boxes.min_y[j] = surface.cy[i] - r;
    boxes.min_z[j] = surface.cz[i] - r;
    boxes.max_x[j] = surface.cx[i] + r;
    boxes.max_y[j] = surface.cy[i] + r;
    boxes.max_z[j] = surface.cz[i] + r;
  }
  leaves_->tree = BlockTree(std::move(boxes));
  leaves_->rules.kernel = surface.info.blend_kernel;
  leaves_->rules.oriented = surface.info.oriented;
  leaves_->rules.guarded = !surface.info.paper_mode;
  leaves_->rules.with_hessian = true;
}

ProbeIndex::~ProbeIndex() = default;

std::size_t
ProbeIndex::memoryBytes() const
{
  return leaves_->all.size() * sizeof(Leaf) + leaves_->tree.memoryBytes();
}

/** What a probe keeps between requests. */
struct SurfaceProbe::Scratch {
  alignas(64) float x[16], y[16], z[16], nx[16], ny[16], nz[16];
  BlockSums sums;
  Vector3 low, high, origin;          ///< the region whose leaves are at hand
  std::vector<std::uint32_t> places;  ///< of these leaves, in the index
  std::vector<BlockLeaf> region;      ///< and they themselves, relative to origin
  std::vector<const BlockLeaf*> near;
  bool valid = false;
};

SurfaceProbe::SurfaceProbe(const ProbeIndex& index)
    : index_(index), scratch_(std::make_unique<Scratch>())
{
}

SurfaceProbe::~SurfaceProbe() = default;

void
SurfaceProbe::restart(double margin)
{
  margin_ = margin;
  scratch_->valid = false;
}

void
SurfaceProbe::cover(const Vector3& low, const Vector3& high)
{
  Scratch& s = *scratch_;
  bool inside = s.valid;
  for (std::size_t a = 0; a < 3; ++a) inside = inside && s.low[a] <= low[a] && high[a] <= s.high[a];
  if (inside) return;
  float min[3], max[3];
  for (std::size_t a = 0; a < 3; ++a) {
    s.low[a] = low[a] - margin_;
    s.high[a] = high[a] + margin_;
    s.origin[a] = 0.5 * (low[a] + high[a]);
    min[a] = static_cast<float>(s.low[a]);
    max[a] = static_cast<float>(s.high[a]);
  }
  s.valid = true;
  s.places.clear();
  s.region.clear();
  const ProbeIndex::Leaves& leaves = *index_.leaves_;
  leaves.tree.blocksInBox(min, max, s.places);
  std::size_t kept = 0;
  for (const std::uint32_t place : s.places) {
    const Leaf& leaf = leaves.all[place];
    const double r = leaf.leaf.radius;
    if (distanceSq(leaf.center, s.low, s.high) > r * r) continue;
    s.places[kept++] = place;
    BlockLeaf& shifted = s.region.emplace_back(leaf.leaf);
    for (std::size_t a = 0; a < 3; ++a) {
      shifted.shift[a] = static_cast<float>(s.origin[a] - leaf.center[a]);
    }
  }
  s.places.resize(kept);
}

void
SurfaceProbe::gatherNear(const Vector3& low, const Vector3& high)
{
  cover(low, high);
  Scratch& s = *scratch_;
  s.near.clear();
  const Vector3 near_low = subtract(low, s.origin), near_high = subtract(high, s.origin);
  for (const BlockLeaf& leaf : s.region) {
    const Vector3 center = {-leaf.shift[0], -leaf.shift[1], -leaf.shift[2]};
    const double r = leaf.radius;
    if (distanceSq(center, near_low, near_high) < r * r) s.near.push_back(&leaf);
  }
}

void
SurfaceProbe::load(const ProbeRequest& request)
{
  Vector3 low = request.positions[0], high = low;
  for (std::size_t i = 1; i < request.count; ++i) {
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], request.positions[i][a]);
      high[a] = std::max(high[a], request.positions[i][a]);
    }
  }
  gatherNear(low, high);
  Scratch& s = *scratch_;
  float* const columns[3] = {s.x, s.y, s.z};
  float* const sides[3] = {s.nx, s.ny, s.nz};
  for (std::size_t a = 0; a < 3; ++a) {
    std::fill(columns[a], columns[a] + 16, PointStore::kFarAway);
    std::fill(sides[a], sides[a] + 16, static_cast<float>(request.side[a]));
    for (std::size_t i = 0; i < request.count; ++i) {
      columns[a][i] = static_cast<float>(request.positions[i][a] - s.origin[a]);
    }
  }
}

void
SurfaceProbe::evaluate(const ProbeRequest& request, ProbeSample* samples)
{
  if (request.count == 0) return;
  ++num_requests_;
  load(request);
  Scratch& s = *scratch_;
  BlendRules rules = index_.leaves_->rules;
  rules.with_third = request.extremality;
  BlockPoints points{s.x, s.y, s.z};
  const bool sided = rules.oriented && rules.guarded && dot(request.side, request.side) > 0;
  if (sided) {
    points.nx = s.nx;
    points.ny = s.ny;
    points.nz = s.nz;
  }
  for (auto& column : s.sums.direction) std::fill(column, column + 16, 0.0f);
  for (const BlockLeaf* leaf : s.near) kernels::addDirections(points, *leaf, rules, s.sums);
  kernels::finishDirections(s.sums);
  for (const BlockLeaf* leaf : s.near) kernels::addIntersections(points, *leaf, rules, s.sums);
  const BlockMeans means(s.sums);
  for (std::size_t i = 0; i < request.count; ++i) finish(request, means, i, samples[i]);
}

/** Writes down what was blended for one place. */
void
SurfaceProbe::finish(const ProbeRequest& request, const BlockMeans& means, std::size_t i,
                     ProbeSample& sample) const
{
  const BlockSums& sums = scratch_->sums;
  const double weight = sums.weight[i], length = means.length[i];
  sample.supported = weight > 0 && length > BlockMeans::kLeastGradient;
  if (!sample.supported) return;
  const Vector3 g = {means.gradient[0][i], means.gradient[1][i], means.gradient[2][i]};
  for (std::size_t a = 0; a < 3; ++a) {
    sample.position[a] = request.positions[i][a] + means.offset[i] * sums.direction[a][i];
    sample.normal[a] = g[a] / length;
  }
  Symmetric3<double> h;
  double third[10];
  for (std::size_t k = 0; k < 6; ++k) h[k] = sums.hessian[k][i] / weight;
  if (i >= request.with_directions) {
    const auto [k1, k2] = principalValues(g, length, h);
    sample.frame.k1 = static_cast<float>(k1);
    sample.frame.k2 = static_cast<float>(k2);
    return;
  }
  sample.frame = principalCurvatures(g, length, h);
  if (!request.extremality) return;
  for (std::size_t k = 0; k < 10; ++k) third[k] = sums.third[k][i] / weight;
  setExtremality(g, length, h, third, sample.frame);
}

ProbeScale
SurfaceProbe::scaleAt(const Vector3& position, const Vector3& side)
{
  gatherNear(position, position);
  const Scratch& s = *scratch_;
  double weight = 0, radius = 0, effective_count = 0;
  for (std::size_t j = 0; j < s.region.size(); ++j) {
    const BlockLeaf& leaf = s.region[j];
    const Leaf& own = index_.leaves_->all[s.places[j]];
    const Vector3 off = subtract(position, own.center);
    const double s_sq = dot(off, off) / (static_cast<double>(leaf.radius) * leaf.radius);
    if (!(s_sq < 1.0)) continue;
    const Vector3 w = {leaf.w[0], leaf.w[1], leaf.w[2]};
    if (index_.leaves_->rules.oriented && dot(side, side) > 0 && dot(w, side) <= 0) continue;
    const double g = leaf.variance_weight * evaluateKernel(index_.leaves_->rules.kernel, s_sq);
    weight += g;
    radius += g * leaf.radius;
    effective_count += g * own.effective_count;
  }
  if (!(weight > 0)) return {};
  return {radius / weight, effective_count / weight};
}

}  // namespace pcl_slim
