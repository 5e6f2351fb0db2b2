// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/query/surface_probe.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pcl_slim/cloud/block_tree.h"
#include "pcl_slim/cloud/morton.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/leaf/detail/gates.h"
#include "pcl_slim/query/leaf_noise.h"
#include "pcl_slim/surface/surfel_color.h"
#include "probe/probe.h"
#include "projection/block_errors.h"
#include "projection/projection.h"

namespace pcl_slim {

using namespace detail;

namespace {

/** What a leaf adds to a ProbeScale. */
struct LeafScale {
  float effective_count, equivalent_count, filled;
};

/** A leaf, ready for evaluation anywhere. */
struct ProbeLeaf {
  BlockLeaf leaf;  ///< but for its shift
  Vector3 center;
  LeafScale scale;
};

/** The leaves that reach into a box, relative to its middle, with columns to choose among them. */
class LeafRegion {
 public:
  bool covers(const Vector3& low, const Vector3& high) const;
  void clear() { valid_ = false; }

  /** Collects the leaves about a box and a margin around it. \param[in] tree of the leaves' boxes
   * \param[in] reach how far a leaf reaches, in radii of its ball */
  void build(const std::vector<ProbeLeaf>& leaves, const BlockTree& tree, double reach,
             const Vector3& low, const Vector3& high, double margin);

  const Vector3& origin() const { return origin_; }
  /** A place relative to the origin. */
  std::array<float, 3> offset(const Vector3& p) const {
    return {static_cast<float>(p[0] - origin_[0]), static_cast<float>(p[1] - origin_[1]),
            static_cast<float>(p[2] - origin_[2])};
  }

  /** Leaves that reach into a box inside the region. */
  void choose(const Vector3& low, const Vector3& high, std::vector<const BlockLeaf*>& chosen);

  /** Calls body(leaf, its scale, squared distance over squared radius) for each leaf whose ball
   * contains a place. */
  template <typename Body>
  void forHolding(const Vector3& place, const Body& body) {
    const auto p = offset(place);
    for (std::size_t j = 0; j < count_; ++j) {
      const float dx = x_[j] - p[0], dy = y_[j] - p[1], dz = z_[j] - p[2];
      measure_[j] = dx * dx + dy * dy + dz * dz - share_ * reach_sq_[j];
    }
    for (std::size_t j = 0; j < count_; ++j) {
      if (measure_[j] < 0) body(leaves_[j], scales_[j], 1 + measure_[j] / (share_ * reach_sq_[j]));
    }
  }

 private:
  void resize(std::size_t count);

  bool valid_ = false;
  float share_ = 1;  ///< of the squared reach: the squared radius
  Vector3 low_{}, high_{}, origin_{};
  std::size_t count_ = 0;
  std::vector<std::uint32_t> places_;
  std::vector<float> x_, y_, z_, reach_sq_, measure_;
  std::vector<LeafScale> scales_;
  std::vector<BlockLeaf> leaves_;
};

/** Squared distance from a place to a box. */
double distanceSq(const Vector3& p, const Vector3& low, const Vector3& high) {
  double sum = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const double off = std::max({low[a] - p[a], p[a] - high[a], 0.0});
    sum += off * off;
  }
  return sum;
}

bool LeafRegion::covers(const Vector3& low, const Vector3& high) const {
  bool inside = valid_;
  for (std::size_t a = 0; a < 3; ++a) inside = inside && low_[a] <= low[a] && high[a] <= high_[a];
  return inside;
}

void LeafRegion::resize(std::size_t count) {
  if (leaves_.size() >= count) return;
  for (auto* column : {&x_, &y_, &z_, &reach_sq_, &measure_}) column->resize(count);
  scales_.resize(count);
  leaves_.resize(count);
}

void LeafRegion::build(const std::vector<ProbeLeaf>& leaves, const BlockTree& tree, double reach,
                       const Vector3& low, const Vector3& high, double margin) {
  float min[3], max[3];
  for (std::size_t a = 0; a < 3; ++a) {
    low_[a] = low[a] - margin;
    high_[a] = high[a] + margin;
    origin_[a] = 0.5 * (low[a] + high[a]);
    min[a] = static_cast<float>(low_[a]);
    max[a] = static_cast<float>(high_[a]);
  }
  valid_ = true;
  share_ = static_cast<float>(1 / (reach * reach));
  places_.clear();
  tree.blocksInBox(min, max, places_);
  resize(places_.size());
  count_ = 0;
  for (const std::uint32_t place : places_) {
    const ProbeLeaf& own = leaves[place];
    const double r = reach * own.leaf.radius;
    if (distanceSq(own.center, low_, high_) > r * r) continue;
    const auto center = offset(own.center);
    x_[count_] = center[0];
    y_[count_] = center[1];
    z_[count_] = center[2];
    reach_sq_[count_] = static_cast<float>(r * r);
    scales_[count_] = own.scale;
    leaves_[count_] = own.leaf;
    for (std::size_t a = 0; a < 3; ++a) leaves_[count_].shift[a] = -center[a];
    ++count_;
  }
}

void LeafRegion::choose(const Vector3& low, const Vector3& high,
                        std::vector<const BlockLeaf*>& chosen) {
  float middle[3], half[3];
  for (std::size_t a = 0; a < 3; ++a) {
    middle[a] = static_cast<float>(0.5 * (low[a] + high[a]) - origin_[a]);
    half[a] = static_cast<float>(0.5 * (high[a] - low[a]));
  }
  for (std::size_t j = 0; j < count_; ++j) {
    const float dx = std::max(std::abs(x_[j] - middle[0]) - half[0], 0.0f);
    const float dy = std::max(std::abs(y_[j] - middle[1]) - half[1], 0.0f);
    const float dz = std::max(std::abs(z_[j] - middle[2]) - half[2], 0.0f);
    measure_[j] = dx * dx + dy * dy + dz * dz - reach_sq_[j];
  }
  chosen.clear();
  for (std::size_t j = 0; j < count_; ++j) {
    if (measure_[j] < 0) chosen.push_back(&leaves_[j]);
  }
}

// Distances to sheets.
constexpr float kMostDistance = 0.6f;  ///< of r: leaves farther from a place do not count
constexpr double kReach = 1.17;        ///< of r: a place that far from its foot in the ball
constexpr float kSameSheet = 0.3f;     ///< of r: leaves of one sheet differ by no more
constexpr float kNoiseErrors = 3.0f;   ///< and by this many deviations of the noise
constexpr float kSoftening = 0.05f;    ///< of r: nearer leaves are equally near

ProbeLeaf placeLeaf(const SLIMSurface& surface, std::uint32_t i, double noise) {
  const double gate = std::max(kLeastErrorGate, kErrorGate * surface.error[i] / surface.radius[i]);
  ProbeLeaf placed{blockLeaf(surface, i, gate, noise),
                   {surface.cx[i], surface.cy[i], surface.cz[i]},
                   {surface.effective_count[i], static_cast<float>(equivalentCount(surface, i)),
                    static_cast<float>(filledShare(surface.trimMap(i), surface.info.fit_kernel))}};
  BlockLeaf& leaf = placed.leaf;
  leaf.variance_weight = surface.info.paper_mode ? 1.0f : surface.varianceWeight(i);
  if (surface.hasColors()) leaf.color = surface.colors.data() + i * kColorBytes;
  leaf.texture = surface.texture(i);
  leaf.textured = surface.hasTextures();
  return placed;
}

}  // namespace

struct ProbeIndex::Leaves {
  std::vector<ProbeLeaf> all;  ///< in Morton order of their centres
  BlockTree tree;              ///< over their balls' boxes
  BlendRules rules;
  TrimTables trims;
  LeafErrorTable errors;
  double reach = 1;   ///< of leaves, in radii
  float noise = 0;    ///< local units
  float min_dot = 0;  ///< least cosine between a leaf's normal and the requested side
};

ProbeIndex::ProbeIndex(const SLIMSurface& surface, ProbeUse use, bool errors, int threads)
    : surface_(surface), leaves_(std::make_unique<Leaves>()) {
  const bool extraction = use != ProbeUse::kSamples;
  if (use == ProbeUse::kSharp) leaves_->min_dot = kSharpCosine;
  if (extraction) {
    leaves_->reach = kReach;
    leaves_->trims = TrimTables(surface);
  }
  if (errors) leaves_->errors = LeafErrorTable(surface, threads);
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order;
  for (std::uint32_t i = 0; i < surface.size(); ++i) {
    if (!surface.isLeaf(i)) continue;
    // Centres are within a unit box about the origin but for those that moved onto their fit.
    order.emplace_back(mortonCode(surface.cx[i], surface.cy[i], surface.cz[i]), i);
  }
  std::sort(order.begin(), order.end());
  const double noise = std::sqrt(std::max(0.0, surface.info.lambda)) * surface.info.diagonal;
  BlockTree::Level boxes;
  boxes.allocate(order.size());
  for (std::size_t j = 0; j < order.size(); ++j) {
    const std::uint32_t i = order[j].second;
    leaves_->all.push_back(placeLeaf(surface, i, noise));
    leaves_->all.back().leaf.trim = leaves_->trims.of(i);
    if (errors) leaves_->all.back().leaf.errors = leaves_->errors.of(surface, i);
    const float r = static_cast<float>(leaves_->reach * surface.radius[i]);
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
  leaves_->noise = static_cast<float>(noise);
}

ProbeIndex::~ProbeIndex() = default;

std::size_t ProbeIndex::memoryBytes() const {
  return leaves_->all.size() * sizeof(ProbeLeaf) + leaves_->tree.memoryBytes();
}

/** What a probe keeps between requests. */
struct SurfaceProbe::Scratch {
  alignas(64) float x[16], y[16], z[16], nx[16], ny[16], nz[16];
  BlockSums sums;
  BlockSheets sheets;
  BlockColors colors;
  BlockPrincipals principals;
  BlockBlend blend;
  BlockErrors errors;
  LeafRegion region;  ///< the leaves at hand
  std::vector<const BlockLeaf*> near;
  std::vector<LeafHeights> heights;  ///< of those near
};

SurfaceProbe::SurfaceProbe(const ProbeIndex& index)
    : index_(index), scratch_(std::make_unique<Scratch>()) {}

SurfaceProbe::~SurfaceProbe() = default;

void SurfaceProbe::restart(double margin) {
  margin_ = margin;
  scratch_->region.clear();
}

/** Collects the leaves near a box. */
void SurfaceProbe::cover(const Vector3& low, const Vector3& high) {
  LeafRegion& region = scratch_->region;
  if (region.covers(low, high)) return;
  region.build(index_.leaves_->all, index_.leaves_->tree, index_.leaves_->reach, low, high,
               margin_);
}

/** Chooses the leaves near some places, and writes the places where kernels read them. */
void SurfaceProbe::load(const Vector3* positions, std::size_t count) {
  Bounds box;
  for (std::size_t i = 0; i < count; ++i) box.add(positions[i]);
  cover(box.low, box.high);
  Scratch& s = *scratch_;
  s.region.choose(box.low, box.high, s.near);
  float* const columns[3] = {s.x, s.y, s.z};
  for (float* column : columns) std::fill(column, column + 16, PointStore::kFarAway);
  for (std::size_t i = 0; i < count; ++i) {
    const auto offset = s.region.offset(positions[i]);
    for (std::size_t a = 0; a < 3; ++a) columns[a][i] = offset[a];
  }
}

/** Writes down which sides leaves must face. \return whether any. */
bool SurfaceProbe::loadSides(const ProbeRequest& request) {
  Scratch& s = *scratch_;
  const bool each = request.sides != nullptr;
  if (!each && !(dot(request.side, request.side) > 0)) return false;
  float* const sides[3] = {s.nx, s.ny, s.nz};
  for (std::size_t a = 0; a < 3; ++a) {
    std::fill(sides[a], sides[a] + 16, static_cast<float>(request.side[a]));
    for (std::size_t i = 0; each && i < request.count; ++i) {
      sides[a][i] = static_cast<float>(request.sides[i][a]);
    }
  }
  return true;
}

void SurfaceProbe::evaluate(const ProbeRequest& request, ProbeSample* samples) {
  if (request.count == 0) return;
  ++num_requests_;
  load(request.positions, request.count);
  Scratch& s = *scratch_;
  BlendRules rules = index_.leaves_->rules;
  rules.with_hessian = request.curvature;
  rules.with_third = request.curvature && request.extremality;
  BlockPoints points{s.x, s.y, s.z};
  if (rules.oriented && rules.guarded && loadSides(request)) {
    points.nx = s.nx;
    points.ny = s.ny;
    points.nz = s.nz;
    points.min_dot = index_.leaves_->min_dot;
  }
  for (auto& column : s.sums.direction) std::fill(column, column + 16, 0.0f);
  s.heights.resize(std::max(s.near.size(), s.heights.size()));
  for (std::size_t j = 0; j < s.near.size(); ++j) {
    kernels::addDirections(points, *s.near[j], rules, s.sums, s.heights[j]);
  }
  kernels::finishDirections(s.sums);
  for (std::size_t j = 0; j < s.near.size(); ++j) {
    kernels::addIntersections(points, *s.near[j], rules, s.heights[j], s.sums);
  }
  kernels::findPrincipals(s.sums, s.principals);
  for (std::size_t i = 0; i < request.count; ++i) finish(request, i, samples[i]);
  if (request.errors) addErrors(points, rules, request, samples);
}

/** Finds the standard errors of what was blended. */
void SurfaceProbe::addErrors(const BlockPoints& points, const BlendRules& rules,
                             const ProbeRequest& request, ProbeSample* samples) {
  Scratch& s = *scratch_;
  for (std::size_t i = 0; i < kMost; ++i) {
    const bool supported = i < request.count && samples[i].supported;
    s.blend.offset[i] = supported ? s.sums.offset[i] / s.sums.weight[i] : 0.0f;
    for (std::size_t a = 0; a < 3; ++a) s.blend.normal[a][i] = s.principals.normal[a][i];
    s.blend.curvature[i] = supported ? 0.5f * (samples[i].frame.k1 + samples[i].frame.k2) : 0.0f;
  }
  s.errors = {};
  for (std::size_t j = 0; j < s.near.size(); ++j) {
    if (s.near[j]->errors.variances == nullptr) continue;
    kernels::addErrors(points, *s.near[j], rules, s.heights[j], s.sums, s.blend, s.errors);
  }
  for (std::size_t i = 0; i < request.count; ++i) {
    samples[i].errors = standardErrors(s.errors, i, rules.with_hessian);
  }
}

/** Stores the blended result for one place. */
void SurfaceProbe::finish(const ProbeRequest& request, std::size_t i, ProbeSample& sample) const {
  const BlockSums& sums = scratch_->sums;
  const BlockPrincipals& found = scratch_->principals;
  const double weight = sums.weight[i];
  sample.supported = weight > 0 && found.length[i] > kLeastGradient;
  if (!sample.supported) return;
  const double offset = sums.offset[i] / weight;
  for (std::size_t a = 0; a < 3; ++a) {
    sample.position[a] = request.positions[i][a] + offset * sums.direction[a][i];
    sample.normal[a] = found.normal[a][i];
  }
  sample.outside = sums.outside[i] / weight;
  if (!request.curvature) return;
  if (request.extremality && i < request.with_directions) return finishThird(i, sample);
  sample.frame.k1 = found.k1[i];
  sample.frame.k2 = found.k2[i];
  if (i >= request.with_directions) return;
  for (std::size_t a = 0; a < 3; ++a) {
    sample.frame.direction1[a] = found.direction1[a][i];
    sample.frame.direction2[a] = found.direction2[a][i];
  }
}

/** The same for curvatures and their extremalities, in double precision: on clean data they give
 * the line's place to a hundredth of a spacing. */
void SurfaceProbe::finishThird(std::size_t i, ProbeSample& sample) const {
  const BlockSums& sums = scratch_->sums;
  const double weight = sums.weight[i];
  const Vector3 g = {sums.gradient[0][i] / weight, sums.gradient[1][i] / weight,
                     sums.gradient[2][i] / weight};
  const double length = pcl_slim::length(g);
  Symmetric3<double> h;
  double third[10];
  for (std::size_t k = 0; k < 6; ++k) h[k] = sums.hessian[k][i] / weight;
  for (std::size_t k = 0; k < 10; ++k) third[k] = sums.third[k][i] / weight;
  sample.frame = principalCurvatures(g, length, h);
  setExtremality(g, length, h, third, sample.frame);
}

void SurfaceProbe::distances(const Vector3* places, std::size_t count, SheetDistance* distances) {
  if (count == 0) return;
  ++num_requests_;
  load(places, count);
  Scratch& s = *scratch_;
  const ProbeIndex::Leaves& leaves = *index_.leaves_;
  SheetRules rules{leaves.rules.kernel, leaves.rules.oriented};
  rules.most_distance = kMostDistance;
  rules.reach_sq = static_cast<float>(kReach * kReach);
  rules.same_sheet = kSameSheet;
  rules.softening = kSoftening;
  rules.noise = kNoiseErrors * leaves.noise;
  rules.min_dot = leaves.min_dot;
  const BlockPoints points{s.x, s.y, s.z};
  kernels::clearSheets(s.sheets);
  for (const BlockLeaf* leaf : s.near) kernels::findSheets(points, *leaf, rules, s.sheets);
  for (const BlockLeaf* leaf : s.near) kernels::addSheets(points, *leaf, rules, s.sheets);
  for (std::size_t i = 0; i < count; ++i) {
    const float weight = s.sheets.weight[i];
    const Vector3 sum = {s.sheets.normal_sum[0][i], s.sheets.normal_sum[1][i],
                         s.sheets.normal_sum[2][i]};
    distances[i] = SheetDistance();
    if (!(weight > 0) || !(dot(sum, sum) > 0)) continue;
    const Vector3 unit = normalized(sum);
    distances[i].known = true;
    distances[i].distance = s.sheets.distance_sum[i] / weight;
    for (std::size_t a = 0; a < 3; ++a) distances[i].normal[a] = static_cast<float>(unit[a]);
  }
}

void SurfaceProbe::colors(const Vector3* places, const Vector3* sides, std::size_t count,
                          std::array<float, 3>* colors, const float* widths) {
  std::fill(colors, colors + count, std::array<float, 3>{-1.0f, -1.0f, -1.0f});
  if (count == 0 || !index_.surface_.hasColors()) return;
  ++num_requests_;
  load(places, count);
  Scratch& s = *scratch_;
  const BlendRules& rules = index_.leaves_->rules;
  BlockPoints points{s.x, s.y, s.z};
  ProbeRequest facing;
  facing.count = count;
  facing.sides = sides;
  if (rules.oriented && loadSides(facing)) {
    points.nx = s.nx;
    points.ny = s.ny;
    points.nz = s.nz;
  }
  s.colors = BlockColors{};
  for (const BlockLeaf* leaf : s.near) kernels::addColors(points, *leaf, rules, widths, s.colors);
  for (std::size_t i = 0; i < count; ++i) {
    const float weight = s.colors.weight[i];
    for (std::size_t c = 0; c < 3 && weight > 0; ++c) colors[i][c] = s.colors.sum[c][i] / weight;
  }
}

ProbeScale SurfaceProbe::scaleAt(const Vector3& position, const Vector3& side) {
  cover(position, position);
  const BlendRules& rules = index_.leaves_->rules;
  const bool sided = rules.oriented && dot(side, side) > 0;
  const double alpha = index_.surface_.info.cover_radius, widening = 1 / (alpha * alpha);
  double weight = 0;
  ProbeScale sum;
  scratch_->region.forHolding(
      position, [&](const BlockLeaf& leaf, const LeafScale& scale, float s_sq) {
        if (sided && dot({leaf.w[0], leaf.w[1], leaf.w[2]}, side) <= 0) return;
        const double g = leaf.variance_weight * evaluateKernel(rules.kernel, s_sq);
        weight += g;
        sum.radius += g * leaf.radius;
        sum.effective_count += g * scale.effective_count;
        sum.equivalent_count += g * scale.equivalent_count;
        sum.filled += g * scale.filled;
        sum.coverage += evaluateKernel(rules.kernel, widening * s_sq);
      });
  if (!(weight > 0)) return {};
  for (double* mean : {&sum.radius, &sum.effective_count, &sum.equivalent_count, &sum.filled})
    *mean /= weight;
  return sum;
}

}  // namespace pcl_slim
