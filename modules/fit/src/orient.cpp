// SPDX-License-Identifier: BSD-3-Clause
#include "orient.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "pcl_slim/core/parallel.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/surface/polynomial.h"

namespace pcl_slim::detail {

namespace {

/** Votes on a leaf's side, and their weights: of the points on its sheet, and of all in its ball. */
struct Votes {
  double sheet = 0, all = 0, sheet_weight = 0, all_weight = 0;

  double result() const {
    if (sheet != 0) return sheet / sheet_weight;
    return all_weight > 0 ? all / all_weight : 0;
  }
};

/** One leaf at hand. */
class LeafVote {
 public:
  LeafVote(const SLIMSurface& s, std::uint32_t i, double sheet)
      : center_{s.cx[i], s.cy[i], s.cz[i]},
        frame_({s.nx[i], s.ny[i], s.nz[i]}),
        radius_(s.radius[i]),
        reach_(sheet * s.error[i]),
        degree_(s.degree[i]),
        coefficients_(s.coefficientsOf(i)) {}

  /** \param[in] ray to where the point is seen from, of any length */
  void add(const Vector3& p, const Vector3& ray, Votes& votes) const {
    const Vector3 d = subtract(p, center_);
    const double near = 1 - dot(d, d) / (radius_ * radius_);
    const double range = length(ray);
    if (!(near > 0) || !(range > 0)) return;
    const HeightJet jet =
        evaluateJet(degree_, coefficients_, dot(d, frame_.u) / radius_, dot(d, frame_.v) / radius_);
    const Vector3 normal = along(along(frame_.w, -jet.hu, frame_.u), -jet.hv, frame_.v);
    const double weight = near * near;
    const double vote = weight * dot(ray, normal) / (range * length(normal));
    votes.all += vote;
    votes.all_weight += weight;
    if (std::abs(dot(d, frame_.w) - radius_ * jet.h) > reach_) return;
    votes.sheet += vote;
    votes.sheet_weight += weight;
  }

 private:
  Vector3 center_;
  LocalFrame frame_;
  double radius_, reach_;
  int degree_;
  const float* coefficients_;
};

/** \brief Votes on the sides of leaves, each the mean cosine between the leaf's normal and the rays
 * of its points: more than 0 where it faces what its points are seen from.
 *
 * Points count by nearness; those farther from the leaf than OrientConstants::sheet residuals are of
 * another sheet and vote only where there are no others. Of many points some blocks vote, evenly
 * chosen. O(leaves). \param[in] store the points fitted \param[in] ray of a stored point */
template <typename Ray>
std::vector<double> votesByRays(const SLIMSurface& surface, const PointStore& store,
                                const std::vector<std::uint32_t>& leaves,
                                const OrientConstants& constants, int threads, const Ray& ray) {
  std::vector<double> results(leaves.size());
  parallelFor(leaves.size(), threads, 64, [&](std::size_t k, int) {
    thread_local std::vector<std::uint32_t> blocks;
    const std::uint32_t i = leaves[k];
    const float center[3] = {surface.cx[i], surface.cy[i], surface.cz[i]};
    blocks.clear();
    store.tree().blocksInBall(center, surface.radius[i], blocks);
    const LeafVote leaf(surface, i, constants.sheet);
    Votes votes;
    const std::size_t step = (blocks.size() + constants.blocks - 1) / constants.blocks;
    for (std::size_t at = 0; at < blocks.size(); at += step) {
      const std::size_t begin = blocks[at] * PointStore::kBlock;
      const std::size_t end = std::min(store.size(), begin + PointStore::kBlock);
      for (std::size_t point = begin; point < end; ++point)
        leaf.add(store.position(point), ray(point), votes);
    }
    results[k] = votes.result();
  });
  return results;
}

Vector3 normalOf(const SLIMSurface& s, std::size_t i) {
  return {s.nx[i], s.ny[i], s.nz[i]};
}

/** Internal surfels take the side of the leaves below them, from the finest level up; those without
 * any keep theirs. */
void signInternals(const SLIMSurface& s, std::vector<signed char>& signs) {
  std::vector<std::uint32_t> order;
  for (std::uint32_t i = 0; i < s.size(); ++i) {
    if (!s.isLeaf(i)) order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return s.level[a] > s.level[b]; });
  for (const std::uint32_t i : order) {
    if (s.child_begin[i] == s.child_begin[i + 1]) continue;
    double vote = 0;
    for (std::uint32_t k = s.child_begin[i]; k < s.child_begin[i + 1]; ++k) {
      const std::uint32_t child = s.children[k];
      vote += signs[child] * dot(normalOf(s, child), normalOf(s, i));
    }
    signs[i] = vote < 0 ? -1 : 1;
  }
}

/** Turns the leaves of sign -1, and internal surfels with the leaves below them. */
void turn(const std::vector<std::uint32_t>& leaves, const std::vector<signed char>& of_leaves,
          SLIMSurface& surface) {
  std::vector<signed char> signs(surface.size(), 1);
  for (std::size_t k = 0; k < leaves.size(); ++k) signs[leaves[k]] = of_leaves[k];
  signInternals(surface, signs);
  for (std::size_t i = 0; i < surface.size(); ++i) {
    if (signs[i] < 0) surface.flip(i);
  }
}

/** Cosines of the leaves' normals and the beams from an eye, in world coordinates. */
std::vector<double> votesByEye(const std::vector<SidePatch>& patches,
                               const std::array<double, 3>& eye, const SurfaceInfo& info) {
  const Vector3 from = scaled(subtract(eye, info.origin), 1 / info.scale);
  std::vector<double> votes(patches.size());
  for (std::size_t k = 0; k < votes.size(); ++k) {
    const Vector3 ray = subtract(from, patches[k].center);
    const double range = length(ray);
    votes[k] = range > 0 ? dot(ray, patches[k].normal) / range : 0;
  }
  return votes;
}

/** The share of the points whose leaves have a positive vote. \param[in] signs of the votes */
double shareOf(const SLIMSurface& surface, const std::vector<std::uint32_t>& leaves,
               const std::vector<double>& votes, const std::vector<signed char>* signs = nullptr) {
  double facing = 0, all = 0;
  for (std::size_t k = 0; k < leaves.size(); ++k) {
    const double points = surface.effective_count[leaves[k]];
    all += points;
    facing += (signs != nullptr ? (*signs)[k] * votes[k] : votes[k]) > 0 ? points : 0;
  }
  return all > 0 ? facing / all : 0;
}

}  // namespace

Orientation orientSurface(const PointStore* store, const SideEvidence& evidence,
                          const OrientConstants& constants, int threads, SLIMSurface& surface) {
  const std::vector<std::uint32_t> leaves = surface.leaves();
  const std::vector<SidePatch> patches = patchesOf(surface, leaves);
  std::vector<SignedEdge> edges = overlapGraph(surface, leaves, patches, threads, constants);
  Orientation found{evidence.source, edges.size(), {}};
  std::vector<double> votes;
  if (evidence.eye) {
    votes = votesByEye(patches, *evidence.eye, surface.info);
  } else if (store != nullptr && store->hasSensors()) {
    votes = votesByRays(surface, *store, leaves, constants, threads, [&](std::size_t i) {
      return subtract(store->sensor(i), store->position(i));
    });
  } else {
    found.source = SideSource::kOutward;
    turn(leaves, signsOutward(patches, edges), surface);
    return found;
  }
  for (double& vote : votes) vote *= kBeamWeight;
  const std::vector<signed char> signs = signsByVotes(std::move(edges), votes);
  found.facing = shareOf(surface, leaves, votes, &signs);
  turn(leaves, signs, surface);
  return found;
}

void measureFacing(const SLIMSurface& surface, SideStatistics& sides) {
  const std::vector<std::uint32_t> leaves = surface.leaves();
  const std::vector<SidePatch> patches = patchesOf(surface, leaves);
  Vector3 sum{};
  double weight = 0;
  for (const SidePatch& patch : patches) {
    sum = along(sum, patch.weight, patch.center);
    weight += patch.weight;
  }
  const auto facing = [&](const std::array<double, 3>& eye) {
    return shareOf(surface, leaves, votesByEye(patches, eye, surface.info));
  };
  if (weight > 0) {
    const Vector3 middle = along(surface.info.origin, surface.info.scale, scaled(sum, 1 / weight));
    sides.facing_outward = 1 - facing(middle);
  }
  sides.facing_origin = facing({});
}

void turnToSides(const PointStore& store, const OrientConstants& constants, int threads,
                 SLIMSurface& surface) {
  const auto side = [&](std::size_t i) {
    const std::array<float, 3> n = store.normal(i);
    return Vector3{n[0], n[1], n[2]};
  };
  const std::vector<std::uint32_t> leaves = surface.leaves();
  const std::vector<double> votes = votesByRays(surface, store, leaves, constants, threads, side);
  std::vector<signed char> signs(votes.size());
  std::transform(votes.begin(), votes.end(), signs.begin(),
                 [](double vote) { return static_cast<signed char>(vote < 0 ? -1 : 1); });
  turn(leaves, signs, surface);
}

namespace {

constexpr double kSheetShare = 0.1;   ///< of r: leaves of one sheet differ by no more,
constexpr double kSheetErrors = 2;    ///< nor by more residuals
constexpr double kSheetSlack = 0.02;  ///< and this share of r
constexpr double kSheetReach = 0.9;   ///< of r: where that is evaluated
constexpr double kSheetCosine = 0.9;  ///< of their normals
constexpr double kOwnSide = 0.3;      ///< weight of a leaf's side [two leaves that agree]

/** The cosine of a normal and the gradient of a leaf at the foot of a place, or nothing where the
 * place is not on the leaf's sheet. */
std::optional<double> cosineOnSheet(const SLIMSurface& s, std::uint32_t i, const Vector3& place,
                                    const Vector3& normal, double most) {
  const LocalFrame frame({s.nx[i], s.ny[i], s.nz[i]});
  const Vector3 d = subtract(place, {s.cx[i], s.cy[i], s.cz[i]});
  const double r = s.radius[i], u = dot(d, frame.u) / r, v = dot(d, frame.v) / r;
  if (u * u + v * v > kSheetReach * kSheetReach) return std::nullopt;
  const HeightJet jet = evaluateJet(s.degree[i], s.coefficientsOf(i), u, v);
  if (std::abs(dot(d, frame.w) - r * jet.h) > most) return std::nullopt;
  return dot(normalized(along(along(frame.w, -jet.hu, frame.u), -jet.hv, frame.v)), normal);
}

/** Edges between leaves that are certainly of one sheet: 1 where their sides agree, else -1. */
std::vector<SignedEdge> edgesOnSheets(const SLIMSurface& s,
                                      const std::vector<std::uint32_t>& leaves, int threads,
                                      const OrientConstants& constants) {
  const std::vector<SidePatch> patches = patchesOf(s, leaves);
  std::vector<SignedEdge> found;
  const auto normalAt = [&](std::uint32_t i) {
    const LocalFrame frame({s.nx[i], s.ny[i], s.nz[i]});
    const HeightJet jet = evaluateJet(s.degree[i], s.coefficientsOf(i), 0, 0);
    return normalized(along(along(frame.w, -jet.hu, frame.u), -jet.hv, frame.v));
  };
  for (const SignedEdge& edge : overlapGraph(s, leaves, patches, threads, constants)) {
    const std::uint32_t a = leaves[edge.a], b = leaves[edge.b];
    const double r = std::min(s.radius[a], s.radius[b]);
    const double most = std::min(kSheetShare * r,
                                 kSheetSlack * r + kSheetErrors * std::min(s.error[a], s.error[b]));
    const auto of_b = cosineOnSheet(s, a, patches[edge.b].center, normalAt(b), most);
    if (!of_b || std::abs(*of_b) < kSheetCosine) continue;
    const auto of_a = cosineOnSheet(s, b, patches[edge.a].center, normalAt(a), most);
    if (!of_a || std::abs(*of_a) < kSheetCosine || (*of_a > 0) != (*of_b > 0)) continue;
    found.push_back({edge.a, edge.b, *of_a > 0 ? 1.0 : -1.0});
  }
  return found;
}

/** Turns the sides of the points on a leaf's sheet that face away from it. */
void turnPoints(const SLIMSurface& surface, std::uint32_t i, double sheet, const PointStore& store,
                std::vector<std::array<float, 3>>& normals) {
  std::vector<std::uint32_t> blocks;
  const float center[3] = {surface.cx[i], surface.cy[i], surface.cz[i]};
  store.tree().blocksInBall(center, surface.radius[i], blocks);
  for (const std::uint32_t block : blocks) {
    const std::size_t begin = block * PointStore::kBlock;
    for (std::size_t p = begin; p < std::min(store.size(), begin + PointStore::kBlock); ++p) {
      const Vector3 normal = {normals[p][0], normals[p][1], normals[p][2]};
      const auto cosine =
          cosineOnSheet(surface, i, store.position(p), normal, sheet * surface.error[i]);
      if (!cosine || !(*cosine < 0)) continue;
      for (float& n : normals[p]) n = -n;
    }
  }
}

}  // namespace

std::uint64_t turnContradicted(const OrientConstants& constants, int threads, PointStore& store,
                               SLIMSurface& surface) {
  const std::vector<std::uint32_t> leaves = surface.leaves();
  const std::vector<SignedEdge> edges = edgesOnSheets(surface, leaves, threads, constants);
  SignedRegions regions(leaves.size());
  for (const SignedEdge& e : edges) {
    if (e.agreement > 0) regions.join(e.a, e.b);
  }
  std::vector<double> votes(regions.number(), 0.0);
  for (std::uint32_t k = 0; k < leaves.size(); ++k) votes[regions.of(k)] += kOwnSide;
  std::vector<SignedEdge> between;
  for (const SignedEdge& e : edges) {
    const std::uint32_t a = regions.of(e.a), b = regions.of(e.b);
    if (a != b) between.push_back({a, b, e.agreement});
  }
  if (between.empty()) return 0;
  const std::vector<signed char> of_regions = signsByVotes(std::move(between), votes);
  std::vector<signed char> signs(leaves.size());
  for (std::uint32_t k = 0; k < leaves.size(); ++k) signs[k] = of_regions[regions.of(k)];
  const auto turned = static_cast<std::uint64_t>(std::count(signs.begin(), signs.end(), -1));
  if (turned == 0) return 0;
  turn(leaves, signs, surface);
  std::vector<std::array<float, 3>> normals(store.size());
  for (std::size_t p = 0; p < normals.size(); ++p) normals[p] = store.normal(p);
  for (std::uint32_t k = 0; k < leaves.size(); ++k) {
    if (signs[k] < 0) turnPoints(surface, leaves[k], constants.sheet, store, normals);
  }
  store.setSides(normals);
  return turned;
}

}  // namespace pcl_slim::detail
