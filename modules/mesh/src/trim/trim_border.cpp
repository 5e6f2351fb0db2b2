// SPDX-License-Identifier: BSD-3-Clause
#include "trim/trim_border.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "topology/fans.h"

namespace pcl_slim::detail {

namespace {

constexpr int kSteps = 4;       ///< of false position along an edge
constexpr double kSnap = 0.25;  ///< of an edge: a vertex that near to the border is brought onto it
constexpr float kBorder = 0.5f;

enum class Side : std::uint8_t { kInside, kOn, kOutside };

/** An edge that the border crosses. */
struct Cut {
  std::uint32_t inner, outer;
  double share = 0;  ///< of the edge, from the inner end
  std::uint32_t vertex = 0;
};

bool
isOutside(const SurfaceVertices& vertices, std::uint32_t v)
{
  return vertices.outside[v] > kBorder;
}

std::vector<Cut>
cutsOf(const EdgeTable& table, const SurfaceVertices& vertices)
{
  std::vector<Cut> cuts;
  for (const MeshEdge& edge : table.edges) {
    const bool low = isOutside(vertices, edge.low);
    if (low == isOutside(vertices, edge.high)) continue;
    Cut cut;
    cut.inner = low ? edge.high : edge.low;
    cut.outer = low ? edge.low : edge.high;
    cuts.push_back(cut);
  }
  return cuts;
}

/** An end of the part of an edge in which the border is. */
struct Bracket {
  double share, value;  ///< value: how far inside
};

/** Finds where on their edges the border is: false position, with steps that keep both ends moving
 * (Illinois). Vertices first + i are the places found, on the surface. */
void
findBorder(const ProbeField& field, std::size_t first, std::vector<Cut>& cuts,
           SurfaceVertices& vertices)
{
  const std::size_t n = cuts.size();
  std::vector<Bracket> in(n), out(n);
  std::vector<std::uint32_t> which(n);
  for (std::size_t i = 0; i < n; ++i) {
    in[i] = {0, std::max(1e-3, 0.5 - vertices.outside[cuts[i].inner])};
    out[i] = {1, std::min(-1e-3, 0.5 - vertices.outside[cuts[i].outer])};
    which[i] = static_cast<std::uint32_t>(first + i);
  }
  for (int step = 0; step < kSteps; ++step) {
    for (std::size_t i = 0; i < n; ++i) {
      Cut& cut = cuts[i];
      const double t = in[i].value / (in[i].value - out[i].value);
      cut.share = in[i].share + t * (out[i].share - in[i].share);
      const Vector3 &p = vertices.position[cut.inner], &q = vertices.position[cut.outer];
      vertices.position[first + i] = along(p, cut.share, subtract(q, p));
      vertices.normal[first + i] =
          normalized(along(vertices.normal[cut.inner], cut.share,
                           subtract(vertices.normal[cut.outer], vertices.normal[cut.inner])));
      vertices.size[first + i] = std::max(vertices.size[cut.inner], vertices.size[cut.outer]);
      vertices.outside[first + i] = kBorder;
    }
    putOnSurface(field, which, vertices);
    for (std::size_t i = 0; i < n; ++i) {
      const double value = 0.5 - vertices.outside[first + i];
      if (value >= 0) {
        in[i] = {cuts[i].share, std::max(value, 1e-6)};
        out[i].value *= 0.5;
      } else {
        out[i] = {cuts[i].share, value};
        in[i].value *= 0.5;
      }
    }
  }
}

/** Brings vertices next to the border onto it. */
void
snap(const std::vector<Cut>& cuts, std::vector<Side>& sides, SurfaceVertices& vertices)
{
  std::vector<double> nearest(sides.size(), kSnap);
  std::vector<std::uint32_t> target(sides.size(), 0);
  for (const Cut& cut : cuts) {
    if (cut.share < nearest[cut.inner]) {
      nearest[cut.inner] = cut.share;
      target[cut.inner] = cut.vertex;
    }
    if (1 - cut.share < nearest[cut.outer]) {
      nearest[cut.outer] = 1 - cut.share;
      target[cut.outer] = cut.vertex;
    }
  }
  for (std::size_t v = 0; v < sides.size(); ++v) {
    if (!(nearest[v] < kSnap)) continue;
    const std::uint32_t to = target[v];
    sides[v] = Side::kOn;
    vertices.position[v] = vertices.position[to];
    vertices.normal[v] = vertices.normal[to];
    vertices.k1[v] = vertices.k1[to];
    vertices.k2[v] = vertices.k2[to];
  }
}

class Cutter {
 public:
  Cutter(const std::vector<Cut>& cuts, const std::vector<Side>& sides,
         const SurfaceVertices& vertices)
      : cuts_(cuts), sides_(sides), vertices_(vertices)
  {
  }

  /** Appends what stays of a triangle. */
  void add(const Triangle& t, std::vector<Triangle>& made) const
  {
    std::size_t inside = 0, outside = 0, first_inside = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      inside += sides_[t[k]] == Side::kInside ? 1 : 0;
      outside += sides_[t[k]] == Side::kOutside ? 1 : 0;
    }
    if (inside == 0 && !(outside == 0 && mostlyInside(t))) return;
    if (outside == 0) {
      made.push_back(t);
      return;
    }
    // Walk around from an inner corner; what is left is a fan about it.
    while (sides_[t[first_inside]] != Side::kInside) ++first_inside;
    std::uint32_t polygon[5];
    std::size_t count = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[(first_inside + k) % 3], b = t[(first_inside + k + 1) % 3];
      if (sides_[a] != Side::kOutside) polygon[count++] = a;
      if (sides_[a] != Side::kOn && sides_[b] != Side::kOn && sides_[a] != sides_[b]) {
        polygon[count++] = cutVertex(a, b);
      }
    }
    for (std::size_t k = 2; k < count; ++k)
      made.push_back({polygon[0], polygon[k - 1], polygon[k]});
  }

 private:
  bool mostlyInside(const Triangle& t) const
  {
    int outer = 0;
    for (const std::uint32_t v : t) outer += isOutside(vertices_, v) ? 1 : 0;
    return outer < 2;
  }

  std::uint32_t cutVertex(std::uint32_t a, std::uint32_t b) const
  {
    const auto key = [](std::uint32_t p, std::uint32_t q) {
      return static_cast<std::uint64_t>(std::min(p, q)) << 32 | std::max(p, q);
    };
    const auto at = std::lower_bound(
        cuts_.begin(), cuts_.end(), key(a, b),
        [&](const Cut& cut, std::uint64_t k) { return key(cut.inner, cut.outer) < k; });
    return at->vertex;
  }

  const std::vector<Cut>& cuts_;
  const std::vector<Side>& sides_;
  const SurfaceVertices& vertices_;
};

}  // namespace

void
trimAtBorder(const ProbeField& field, std::vector<Triangle>& triangles, SurfaceVertices& vertices)
{
  const std::size_t count = vertices.count();
  std::vector<Cut> cuts = cutsOf(EdgeTable(triangles, field.threads), vertices);
  vertices.resize(count + cuts.size());
  for (std::size_t i = 0; i < cuts.size(); ++i) {
    cuts[i].vertex = static_cast<std::uint32_t>(count + i);
  }
  findBorder(field, count, cuts, vertices);
  std::vector<Side> sides(count);
  for (std::uint32_t v = 0; v < count; ++v) {
    sides[v] = isOutside(vertices, v) ? Side::kOutside : Side::kInside;
  }
  snap(cuts, sides, vertices);
  const Cutter cutter(cuts, sides, vertices);
  std::vector<Triangle> made;
  made.reserve(triangles.size());
  for (const Triangle& t : triangles) cutter.add(t, made);
  triangles = std::move(made);
}

}  // namespace pcl_slim::detail
