// SPDX-License-Identifier: BSD-3-Clause
#include "orient.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <numeric>
#include <vector>

#include "pcl_slim/core/aligned.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/surface/polynomial.h"

namespace pcl_slim::detail {

namespace {

/** Votes on a leaf's side: of the points on its sheet, and of all in its ball. */
struct Votes {
  double sheet = 0, all = 0;

  double result() const { return sheet != 0 ? sheet : all; }
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
    const double vote = near * near * dot(ray, normal) / (range * length(normal));
    votes.all += vote;
    if (std::abs(dot(d, frame_.w) - radius_ * jet.h) <= reach_) votes.sheet += vote;
  }

 private:
  Vector3 center_;
  LocalFrame frame_;
  double radius_, reach_;
  int degree_;
  const float* coefficients_;
};

/** \brief Signs, one for each surfel, such that leaves face where their points are seen from: 1, or
 * -1 for those to be turned.
 *
 * Each point within a leaf's ball votes with the cosine between the leaf's normal at it and its
 * ray, weighted by nearness; points farther from the leaf than OrientConstants::sheet residuals are
 * of another sheet and vote only where there are no others. Of many points some blocks vote, evenly
 * chosen. O(leaves). \param[in] store the points fitted \param[in] ray of a stored point */
template <typename Ray>
std::vector<signed char> signsByRays(const SLIMSurface& surface, const PointStore& store,
                                     const std::vector<std::uint32_t>& leaves,
                                     const OrientConstants& constants, int threads,
                                     const Ray& ray) {
  std::vector<signed char> signs(surface.size(), 1);
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
    if (votes.result() < 0) signs[i] = -1;
  });
  return signs;
}

/** \brief Union-find in which every member knows its sign relative to its root, the least member.
 */
class SignedForest {
 public:
  explicit SignedForest(std::size_t count) : parent_(count), sign_(count, 1) {
    std::iota(parent_.begin(), parent_.end(), 0u);
  }

  std::uint32_t root(std::uint32_t i, int& sign) {
    sign = 1;
    std::uint32_t r = i;
    while (parent_[r] != r) {
      sign *= sign_[r];
      r = parent_[r];
    }
    int rest = sign;
    while (parent_[i] != r && i != r) {
      const std::uint32_t next = parent_[i];
      const bool turns = sign_[i] < 0;
      parent_[i] = r;
      sign_[i] = static_cast<signed char>(rest);
      rest = turns ? -rest : rest;
      i = next;
    }
    return r;
  }

  std::uint32_t root(std::uint32_t i) {
    int sign;
    return root(i, sign);
  }

  void join(std::uint32_t a, std::uint32_t b, bool opposed) {
    int sign_a, sign_b;
    const std::uint32_t ra = root(a, sign_a), rb = root(b, sign_b);
    if (ra == rb) return;
    parent_[std::max(ra, rb)] = std::min(ra, rb);
    sign_[std::max(ra, rb)] = static_cast<signed char>(sign_a * sign_b * (opposed ? -1 : 1));
  }

 private:
  std::vector<std::uint32_t> parent_;
  std::vector<signed char> sign_;
};

/// Sign, exponent and 3 bits: classes an eighth wide; no result depends on their width.
constexpr int kClassBits = 12;
constexpr std::uint32_t kSignBit = 0x80000000u;

Vector3 centerOf(const SLIMSurface& s, std::size_t i) {
  return {s.cx[i], s.cy[i], s.cz[i]};
}

Vector3 normalOf(const SLIMSurface& s, std::size_t i) {
  return {s.nx[i], s.ny[i], s.nz[i]};
}

/** Area-weighted moments of a connected part of the leaves. Outward is where the flux about the
 * part's middle is positive; a sheet too flat to have an inside turns up its main side. */
struct Part {
  double weight = 0, flux = 0, reach = 0;
  Vector3 center{}, normal{};

  bool closed(const OrientConstants& constants) const {
    return std::abs(flux) > constants.closed_flux * reach;
  }

  bool turned(const OrientConstants& constants) const {
    if (std::abs(flux) > constants.flat_flux * reach) return flux < 0;
    const auto main = std::max_element(
        normal.begin(), normal.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
    return *main < 0;
  }
};

/** What a forest's trees are, by tree, and the leaves' places in them. */
struct Parts {
  std::vector<Part> parts;
  std::vector<std::uint32_t> part_of;  ///< for each leaf
  std::vector<signed char> signs;      ///< for each leaf, relative to its root
};

Parts partsOf(const SLIMSurface& s, const std::vector<std::uint32_t>& leaves,
              SignedForest& forest) {
  constexpr std::uint32_t kNew = 0xffffffffu;
  Parts result;
  auto& [parts, part_of, signs] = result;
  part_of.resize(leaves.size());
  signs.resize(leaves.size());
  std::vector<std::uint32_t> part_at(s.size(), kNew);
  for (std::size_t k = 0; k < leaves.size(); ++k) {
    const std::uint32_t i = leaves[k];
    int sign;
    std::uint32_t& at = part_at[forest.root(i, sign)];
    if (at == kNew) {
      at = static_cast<std::uint32_t>(parts.size());
      parts.emplace_back();
    }
    part_of[k] = at;
    signs[k] = static_cast<signed char>(sign);
    Part& part = parts[at];
    const double area = static_cast<double>(s.radius[i]) * s.radius[i];
    part.weight += area;
    const Vector3 c = centerOf(s, i);
    for (int a = 0; a < 3; ++a) part.center[a] += area * c[a];
  }
  for (std::size_t k = 0; k < leaves.size(); ++k) {
    const std::uint32_t i = leaves[k];
    Part& part = parts[part_of[k]];
    const Vector3 c = centerOf(s, i), n = normalOf(s, i);
    const Vector3 away = {c[0] - part.center[0] / part.weight, c[1] - part.center[1] / part.weight,
                          c[2] - part.center[2] / part.weight};
    const double area = static_cast<double>(s.radius[i]) * s.radius[i];
    part.flux += signs[k] * area * dot(away, n);
    part.reach += area * std::sqrt(dot(away, away));
    for (int a = 0; a < 3; ++a) part.normal[a] += signs[k] * area * n[a];
  }
  return result;
}

/** Which of a number of classes, each a little heavier than the last, a weight belongs to. */
std::size_t weightClass(float weight) {
  const float plain = weight + 0.0f;  // no -0
  std::uint32_t bits;
  std::memcpy(&bits, &plain, sizeof(bits));
  bits = (bits & kSignBit) != 0 ? ~bits : bits | kSignBit;
  return bits >> (32 - kClassBits);
}

/** Edges by class of weight, those of one class in no particular order. */
class ClassedEdges {
 public:
  explicit ClassedEdges(const std::vector<std::vector<OverlapEdge>>& lists)
      : begin_((std::size_t{1} << kClassBits) + 1, 0) {
    for (const auto& list : lists) {
      for (const OverlapEdge& e : list) ++begin_[weightClass(e.weight) + 1];
    }
    for (std::size_t k = 1; k < begin_.size(); ++k) begin_[k] += begin_[k - 1];
    edges_.resize(begin_.back());
    std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
    for (const auto& list : lists) {
      for (const OverlapEdge& e : list) edges_[next[weightClass(e.weight)]++] = e;
    }
  }

  std::size_t size() const { return edges_.size(); }

  /** Calls visit(edge) in ascending order for the edges for which wanted(edge) is still true when
   * their class is reached. */
  template <typename Wanted, typename Visit>
  void forEach(const Wanted& wanted, const Visit& visit) {
    for (std::size_t k = 0; k + 1 < begin_.size(); ++k) {
      const auto begin = edges_.begin() + static_cast<std::ptrdiff_t>(begin_[k]);
      const auto end = edges_.begin() + static_cast<std::ptrdiff_t>(begin_[k + 1]);
      const auto last = std::partition(begin, end, wanted);
      std::sort(begin, last);
      std::for_each(begin, last, visit);
    }
  }

 private:
  std::vector<std::size_t> begin_;
  AlignedVector<OverlapEdge> edges_;
};

/** A spanning forest of the overlap graph. Weak edges come last and never join two closed bodies:
 * surfaces that face each other across a gap do not determine either's outside. */
SignedForest spanningForest(const SLIMSurface& s, const std::vector<std::uint32_t>& leaves,
                            const OrientConstants& constants, ClassedEdges edges) {
  SignedForest forest(s.size());
  std::vector<char> closed;
  // Most edges connect what lighter ones have joined: they are dropped before they are ordered.
  const auto joinsTwo = [&](const OverlapEdge& e) { return forest.root(e.a) != forest.root(e.b); };
  edges.forEach(joinsTwo, [&](const OverlapEdge& e) {
    if (e.weight <= constants.weak_edge) {
      forest.join(e.a, e.b, e.opposed);
      return;
    }
    if (closed.empty()) {
      const Parts found = partsOf(s, leaves, forest);
      closed.resize(s.size());
      for (std::size_t k = 0; k < leaves.size(); ++k) {
        closed[forest.root(leaves[k])] = found.parts[found.part_of[k]].closed(constants);
      }
    }
    const std::uint32_t a = forest.root(e.a), b = forest.root(e.b);
    if (closed[a] && closed[b]) return;
    forest.join(e.a, e.b, e.opposed);
    closed[forest.root(a)] = closed[a] || closed[b];
  });
  return forest;
}

/** Signs per surfel such that neighbouring leaves agree and each part looks away from its middle.
 */
std::vector<signed char> graphSigns(const SLIMSurface& s, const std::vector<std::uint32_t>& leaves,
                                    const OrientConstants& constants, ClassedEdges edges) {
  SignedForest forest = spanningForest(s, leaves, constants, std::move(edges));
  const Parts found = partsOf(s, leaves, forest);
  std::vector<signed char> signs(s.size(), 1);
  for (std::size_t k = 0; k < leaves.size(); ++k) {
    const bool turned = found.parts[found.part_of[k]].turned(constants);
    signs[leaves[k]] = static_cast<signed char>(turned ? -found.signs[k] : found.signs[k]);
  }
  return signs;
}

std::vector<signed char> viewpointSigns(const SLIMSurface& s, const FitParams& params) {
  Vector3 eye;
  for (int a = 0; a < 3; ++a) eye[a] = ((*params.viewpoint)[a] - s.info.origin[a]) / s.info.scale;
  std::vector<signed char> signs(s.size(), 1);
  for (std::size_t i = 0; i < s.size(); ++i) {
    if (dot(subtract(eye, centerOf(s, i)), normalOf(s, i)) < 0) signs[i] = -1;
  }
  return signs;
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

/** Turns the surfels of sign -1, and internal surfels with the leaves below them. */
void turn(std::vector<signed char> signs, SLIMSurface& surface) {
  signInternals(surface, signs);
  for (std::size_t i = 0; i < surface.size(); ++i) {
    if (signs[i] < 0) surface.flip(i);
  }
}

}  // namespace

Orientation orientSurface(const PointStore* store, const FitParams& params,
                          const OrientConstants& constants, int threads, SLIMSurface& surface) {
  const std::vector<std::uint32_t> leaves = surface.leaves();
  Orientation found;
  std::vector<signed char> signs;
  if (params.viewpoint) {
    found.source = SideSource::kViewpoint;
    signs = viewpointSigns(surface, params);
  } else if (store != nullptr && store->hasSensors()) {
    found.source = SideSource::kSensors;
    signs = signsByRays(surface, *store, leaves, constants, threads, [&](std::size_t i) {
      return subtract(store->sensor(i), store->position(i));
    });
  } else {
    ClassedEdges edges(overlapGraph(surface, leaves, threads, constants));
    found = {SideSource::kOverlaps, edges.size()};
    signs = graphSigns(surface, leaves, constants, std::move(edges));
  }
  turn(signs, surface);
  return found;
}

void turnToSides(const PointStore& store, const OrientConstants& constants, int threads,
                 SLIMSurface& surface) {
  const auto side = [&](std::size_t i) {
    const std::array<float, 3> n = store.normal(i);
    return Vector3{n[0], n[1], n[2]};
  };
  turn(signsByRays(surface, store, surface.leaves(), constants, threads, side), surface);
}

}  // namespace pcl_slim::detail
