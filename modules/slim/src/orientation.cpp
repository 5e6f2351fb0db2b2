// SPDX-License-Identifier: BSD-3-Clause
#include "orientation.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "center_grid.h"
#include "pcl_slim/core/parallel.h"

namespace pcl_slim {

namespace {

using Vector = std::array<double, 3>;

constexpr std::size_t kMostEdges = 8;  ///< per leaf and level, the nearest
constexpr double kFlatFlux = 0.1;      ///< flux below this share of its bound: no inside
constexpr float kWeakEdge = 0.5f;      ///< edges of more weight may lead across a gap
constexpr double kClosedFlux = 0.4;    ///< flux above this share of its bound: a body of its own
constexpr double kReach = 0.9;         ///< of r + r': farther centres are not neighbours

Vector
centerOf(const SLIMSurface& s, std::size_t i)
{
  return {s.cx[i], s.cy[i], s.cz[i]};
}

Vector
normalOf(const SLIMSurface& s, std::size_t i)
{
  return {s.nx[i], s.ny[i], s.nz[i]};
}

double
dot(const Vector& a, const Vector& b)
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

Vector
minus(const Vector& a, const Vector& b)
{
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

/** A leaf with its frame at hand. */
struct Leaf {
  std::uint32_t surfel;
  Vector center;
  LocalFrame frame;
  double radius;
};

/** |f| of a leaf at x in local length, and the gradient of f there (not unit). */
struct Probe {
  double offset;
  Vector gradient;
};

Probe
probe(const SLIMSurface& s, const Leaf& leaf, const Vector& x)
{
  const Vector d = minus(x, leaf.center);
  const double r = leaf.radius;
  // Beyond its ball a polynomial says nothing: ask it at the rim.
  double u = dot(d, leaf.frame.u) / r, v = dot(d, leaf.frame.v) / r;
  const double length_sq = u * u + v * v;
  const double shrink = length_sq > 1.0 ? 1.0 / std::sqrt(length_sq) : 1.0;
  u *= shrink;
  v *= shrink;
  // Orientation needs no more of a leaf than its quadric.
  const HeightJet jet =
      evaluateJet(std::min<int>(2, s.degree[leaf.surfel]), s.coefficientsOf(leaf.surfel), u, v);
  Probe result;
  result.offset = std::abs(dot(d, leaf.frame.w) - r * jet.h);
  for (int a = 0; a < 3; ++a) {
    result.gradient[a] = leaf.frame.w[a] - jet.hu * leaf.frame.u[a] - jet.hv * leaf.frame.v[a];
  }
  return result;
}

/** An edge of the overlap graph: small where two leaves clearly lie on one sheet. */
struct Edge {
  float weight;
  std::uint32_t a, b;
  bool opposed;  ///< the normals point to different sides

  bool operator<(const Edge& other) const
  {
    if (weight != other.weight) return weight < other.weight;
    return a != other.a ? a < other.a : b < other.b;
  }
};

Edge
makeEdge(const SLIMSurface& s, const Leaf& a, const Leaf& b, double distance)
{
  const Probe at_a = probe(s, a, b.center), at_b = probe(s, b, a.center);
  const double cosine =
      dot(at_a.gradient, at_b.gradient) /
      std::sqrt(dot(at_a.gradient, at_a.gradient) * dot(at_b.gradient, at_b.gradient));
  const double offset = 0.5 * (at_a.offset + at_b.offset) / std::max(distance, 1e-15);
  return {static_cast<float>(1.0 - std::abs(cosine) + offset), a.surfel, b.surfel, cosine < 0};
}

/** Edges between leaves and their nearest neighbours among leaves of the same or a coarser level:
 * leaves of one level are alike in size, so one grid serves each. */
std::vector<Edge>
overlapGraph(const SLIMSurface& s, const std::vector<std::uint32_t>& leaves, int threads)
{
  std::vector<Leaf> data(s.size());
  std::vector<std::vector<std::uint32_t>> members(256);
  for (const std::uint32_t i : leaves) {
    data[i] = {i, centerOf(s, i), LocalFrame(normalOf(s, i)), s.radius[i]};
    members[s.level[i]].push_back(i);
  }
  std::vector<Edge> edges;
  std::vector<std::vector<Edge>> found(leaves.size());
  for (int coarse = 0; coarse < 256; ++coarse) {
    if (members[coarse].empty()) continue;
    float widest = 0;
    for (const std::uint32_t i : members[coarse]) widest = std::max(widest, s.radius[i]);
    const CenterGrid grid(s, members[coarse], static_cast<float>(2.0 * kReach) * widest);
    parallelFor(leaves.size(), threads, 256, [&](std::size_t at, int) {
      const std::uint32_t i = leaves[at];
      if (s.level[i] < coarse || s.radius[i] > 2.0f * widest) return;
      std::array<std::pair<float, std::uint32_t>, kMostEdges> nearest;
      std::size_t count = 0;
      grid.forEachNear(i, [&](std::uint32_t j, float distance_sq) {
        if (j == i || (s.level[j] == s.level[i] && j > i)) return;
        const double reach = kReach * (s.radius[i] + s.radius[j]);
        if (distance_sq >= reach * reach) return;
        const std::pair<float, std::uint32_t> entry{distance_sq, j};
        if (count == kMostEdges && !(entry < nearest[count - 1])) return;
        std::size_t place = count < kMostEdges ? count++ : count - 1;
        for (; place > 0 && entry < nearest[place - 1]; --place)
          nearest[place] = nearest[place - 1];
        nearest[place] = entry;
      });
      for (std::size_t k = 0; k < count; ++k) {
        found[at].push_back(
            makeEdge(s, data[nearest[k].second], data[i], std::sqrt(nearest[k].first)));
      }
    });
  }
  for (const auto& list : found) edges.insert(edges.end(), list.begin(), list.end());
  return edges;
}

/** Union-find in which every member knows its sign relative to its root. */
class SignedForest {
 public:
  explicit SignedForest(std::size_t count) : parent_(count), sign_(count, 1)
  {
    std::iota(parent_.begin(), parent_.end(), 0u);
  }

  std::uint32_t root(std::uint32_t i, int& sign)
  {
    sign = 1;
    std::uint32_t r = i;
    while (parent_[r] != r) {
      sign *= sign_[r];
      r = parent_[r];
    }
    int rest = sign;
    while (parent_[i] != i) {
      const std::uint32_t next = parent_[i];
      const int own = sign_[i];
      parent_[i] = r;
      sign_[i] = static_cast<signed char>(rest);
      rest *= own;
      i = next;
    }
    return r;
  }

  std::uint32_t root(std::uint32_t i)
  {
    int sign;
    return root(i, sign);
  }

  void join(std::uint32_t a, std::uint32_t b, bool opposed)
  {
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

/** Area-weighted moments of a connected part of the leaves. Outward is where the flux about the
 * part's middle is positive; a sheet too flat to have an inside turns up its main side. */
struct Part {
  double weight = 0, flux = 0, reach = 0;
  Vector center{}, normal{};

  bool closed() const { return std::abs(flux) > kClosedFlux * reach; }

  bool turned() const
  {
    if (std::abs(flux) > kFlatFlux * reach) return flux < 0;
    const auto main = std::max_element(
        normal.begin(), normal.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
    return *main < 0;
  }
};

/** The parts of a forest, each at its root's place. */
std::vector<Part>
partsOf(const SLIMSurface& s, const std::vector<std::uint32_t>& leaves, SignedForest& forest)
{
  std::vector<Part> parts(s.size());
  for (const std::uint32_t i : leaves) {
    Part& part = parts[forest.root(i)];
    const double area = static_cast<double>(s.radius[i]) * s.radius[i];
    part.weight += area;
    const Vector c = centerOf(s, i);
    for (int a = 0; a < 3; ++a) part.center[a] += area * c[a];
  }
  for (const std::uint32_t i : leaves) {
    int sign;
    Part& part = parts[forest.root(i, sign)];
    const Vector c = centerOf(s, i), n = normalOf(s, i);
    const Vector away = {c[0] - part.center[0] / part.weight, c[1] - part.center[1] / part.weight,
                         c[2] - part.center[2] / part.weight};
    const double area = static_cast<double>(s.radius[i]) * s.radius[i];
    part.flux += sign * area * dot(away, n);
    part.reach += area * std::sqrt(dot(away, away));
    for (int a = 0; a < 3; ++a) part.normal[a] += sign * area * n[a];
  }
  return parts;
}

/** A spanning forest of the overlap graph. Weak edges come last and never join two closed bodies:
 * what faces each other across a gap says nothing about either's outside. */
SignedForest
spanningForest(const SLIMSurface& s, const std::vector<std::uint32_t>& leaves, int threads)
{
  std::vector<Edge> edges = overlapGraph(s, leaves, threads);
  std::sort(edges.begin(), edges.end());
  SignedForest forest(s.size());
  std::size_t next = 0;
  for (; next < edges.size() && edges[next].weight <= kWeakEdge; ++next) {
    forest.join(edges[next].a, edges[next].b, edges[next].opposed);
  }
  const std::vector<Part> parts = partsOf(s, leaves, forest);
  std::vector<char> closed(s.size());
  for (const std::uint32_t i : leaves) closed[i] = parts[i].closed();
  for (; next < edges.size(); ++next) {
    const Edge& e = edges[next];
    const std::uint32_t a = forest.root(e.a), b = forest.root(e.b);
    if (closed[a] && closed[b]) continue;
    forest.join(e.a, e.b, e.opposed);
    closed[forest.root(a)] = closed[a] || closed[b];
  }
  return forest;
}

/** Signs per surfel such that neighbouring leaves agree and each part looks away from its middle. */
std::vector<signed char>
graphSigns(const SLIMSurface& s, const std::vector<std::uint32_t>& leaves, int threads)
{
  SignedForest forest = spanningForest(s, leaves, threads);
  const std::vector<Part> parts = partsOf(s, leaves, forest);
  std::vector<signed char> signs(s.size(), 1);
  for (const std::uint32_t i : leaves) {
    int sign;
    const std::uint32_t root = forest.root(i, sign);
    signs[i] = static_cast<signed char>(parts[root].turned() ? -sign : sign);
  }
  return signs;
}

std::vector<signed char>
viewpointSigns(const SLIMSurface& s, const FitParams& params,
               const std::vector<std::uint32_t>& leaves)
{
  Vector eye;
  for (int a = 0; a < 3; ++a) eye[a] = (params.viewpoint[a] - s.info.origin[a]) / s.info.scale;
  std::vector<signed char> signs(s.size(), 1);
  for (const std::uint32_t i : leaves) {
    if (dot(minus(eye, centerOf(s, i)), normalOf(s, i)) < 0) signs[i] = -1;
  }
  return signs;
}

/** Internal surfels take the side of the leaves below them, from the finest level up. */
void
signInternals(const SLIMSurface& s, std::vector<signed char>& signs)
{
  std::vector<std::uint32_t> order(s.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return s.level[a] > s.level[b]; });
  for (const std::uint32_t i : order) {
    if (s.isLeaf(i)) continue;
    double vote = 0;
    for (std::uint32_t k = s.child_begin[i]; k < s.child_begin[i + 1]; ++k) {
      const std::uint32_t child = s.children[k];
      vote += signs[child] * dot(normalOf(s, child), normalOf(s, i));
    }
    signs[i] = vote < 0 ? -1 : 1;
  }
}

}  // namespace

void
orientSurface(const FitParams& params, SLIMSurface& surface)
{
  std::vector<std::uint32_t> leaves;
  for (std::uint32_t i = 0; i < surface.size(); ++i) {
    if (surface.isLeaf(i)) leaves.push_back(i);
  }
  std::vector<signed char> signs =
      params.has_viewpoint ? viewpointSigns(surface, params, leaves)
                           : graphSigns(surface, leaves, resolveThreads(params.threads));
  signInternals(surface, signs);
  for (std::size_t i = 0; i < surface.size(); ++i) {
    if (signs[i] < 0) surface.flip(i);
  }
}

}  // namespace pcl_slim
