// SPDX-License-Identifier: BSD-3-Clause
#include "comparison/mesh_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pcl_slim/core/vector3.h"

namespace pcl_slim::comparison {

namespace {

using Point = MeshSurface::Point;
constexpr std::uint32_t kLeafTriangles = 4;

Point minus(const Point& a, const Point& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

double dot(const Point& a, const Point& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/** Squared distance from a point to a box; 0 inside. */
double boxDistanceSq(const Point& low, const Point& high, const Point& p) {
  double sum = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const double off = std::max({low[a] - p[a], p[a] - high[a], 0.0});
    sum += off * off;
  }
  return sum;
}

/** The nearest point of a triangle, as shares of its corners. */
Point nearestShares(const Point& a, const Point& b, const Point& c, const Point& p) {
  const Point ab = minus(b, a), ac = minus(c, a), ap = minus(p, a);
  const double bb = dot(ab, ab), bc = dot(ab, ac), cc = dot(ac, ac);
  const double pb = dot(ap, ab), pc = dot(ap, ac), area = bb * cc - bc * bc;
  if (area > 0) {
    const double v = (cc * pb - bc * pc) / area, w = (bb * pc - bc * pb) / area;
    if (v >= 0 && w >= 0 && v + w <= 1) return {1 - v - w, v, w};
  }
  // Outside, or without area: the nearest of the three edges.
  const Point corners[3] = {a, b, c};
  Point best{};
  double best_sq = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 3; ++k) {
    const Point& from = corners[k];
    const Point edge = minus(corners[(k + 1) % 3], from), off = minus(p, from);
    const double length_sq = dot(edge, edge);
    const double t = length_sq > 0 ? std::clamp(dot(off, edge) / length_sq, 0.0, 1.0) : 0.0;
    const Point rest = {off[0] - t * edge[0], off[1] - t * edge[1], off[2] - t * edge[2]};
    if (dot(rest, rest) >= best_sq) continue;
    best_sq = dot(rest, rest);
    best = {};
    best[k] = 1 - t;
    best[(k + 1) % 3] = t;
  }
  return best;
}

}  // namespace

MeshSurface::MeshSurface(std::vector<Point> vertices, std::vector<Triangle> triangles)
    : vertices_(std::move(vertices)), triangles_(std::move(triangles)) {
  nodes_.reserve(triangles_.size());
  nodes_.emplace_back();
  build(0, 0, static_cast<std::uint32_t>(triangles_.size()));
  findBorders();
}

void MeshSurface::build(std::uint32_t node, std::uint32_t begin, std::uint32_t end) {
  Bounds box;
  for (std::uint32_t t = begin; t < end; ++t) {
    for (const std::uint32_t corner : triangles_[t]) box.add(vertices_[corner]);
  }
  const auto& [low, high] = box;
  nodes_[node].low = low;
  nodes_[node].high = high;
  nodes_[node].begin = begin;
  nodes_[node].end = end;
  if (end - begin <= kLeafTriangles) return;
  std::size_t axis = 0;
  for (std::size_t a = 1; a < 3; ++a) {
    if (high[a] - low[a] > high[axis] - low[axis]) axis = a;
  }
  const auto sum = [&](const Triangle& t) {
    return vertices_[t[0]][axis] + vertices_[t[1]][axis] + vertices_[t[2]][axis];
  };
  const std::uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(triangles_.begin() + begin, triangles_.begin() + middle,
                   triangles_.begin() + end,
                   [&](const Triangle& a, const Triangle& b) { return sum(a) < sum(b); });
  const auto first = static_cast<std::uint32_t>(nodes_.size());
  nodes_[node].first = first;
  nodes_.resize(nodes_.size() + 2);
  build(first, begin, middle);
  build(first + 1, middle, end);
}

void MeshSurface::findBorders() {
  using Edge = std::pair<std::uint32_t, std::uint32_t>;
  const auto edgeOf = [](const Triangle& t, std::size_t k) {
    return Edge(std::minmax(t[k], t[(k + 1) % 3]));
  };
  std::vector<Edge> edges;
  for (const Triangle& t : triangles_) {
    for (std::size_t k = 0; k < 3; ++k) edges.push_back(edgeOf(t, k));
  }
  std::sort(edges.begin(), edges.end());
  const auto isBorder = [&](const Edge& edge) {
    const auto range = std::equal_range(edges.begin(), edges.end(), edge);
    return range.second - range.first == 1;
  };
  std::vector<std::uint8_t> on_border(vertices_.size(), 0);
  borders_.assign(triangles_.size(), 0);
  for (std::size_t i = 0; i < triangles_.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (!isBorder(edgeOf(triangles_[i], k))) continue;
      borders_[i] |= static_cast<std::uint8_t>(1u << k);
      on_border[triangles_[i][k]] = on_border[triangles_[i][(k + 1) % 3]] = 1;
    }
  }
  for (std::size_t i = 0; i < triangles_.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (on_border[triangles_[i][k]]) borders_[i] |= static_cast<std::uint8_t>(8u << k);
    }
  }
}

void MeshSurface::visit(const Triangle& triangle, std::uint8_t borders, const Point& p,
                        double& best_sq, bool& border) const {
  const Point &a = vertices_[triangle[0]], &b = vertices_[triangle[1]], &c = vertices_[triangle[2]];
  const Point share = nearestShares(a, b, c, p);
  double distance_sq = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double off = share[0] * a[i] + share[1] * b[i] + share[2] * c[i] - p[i];
    distance_sq += off * off;
  }
  if (distance_sq >= best_sq) return;
  best_sq = distance_sq;
  border = false;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3, last = (k + 2) % 3;
    const bool on_edge = share[last] <= 0 && (borders >> k & 1);
    const bool on_corner = share[next] <= 0 && share[last] <= 0 && (borders >> (3 + k) & 1);
    border = border || on_edge || on_corner;
  }
}

MeshFoot MeshSurface::nearest(const Point& p) const {
  struct Entry {
    std::uint32_t node;
    double distance_sq;
  };
  std::array<Entry, 128> stack;  // two a level; halving keeps levels below 33
  std::size_t depth = 0;
  stack[depth++] = {0, 0};
  double best_sq = std::numeric_limits<double>::infinity();
  MeshFoot foot;
  while (depth > 0) {
    const Entry entry = stack[--depth];
    if (entry.distance_sq >= best_sq) continue;
    const Node& node = nodes_[entry.node];
    if (node.first == 0) {
      for (std::uint32_t t = node.begin; t < node.end; ++t) {
        visit(triangles_[t], borders_[t], p, best_sq, foot.border);
      }
      continue;
    }
    Entry near{node.first, 0}, far{node.first + 1, 0};
    for (Entry* child : {&near, &far}) {
      child->distance_sq = boxDistanceSq(nodes_[child->node].low, nodes_[child->node].high, p);
    }
    if (far.distance_sq < near.distance_sq) std::swap(near, far);
    stack[depth++] = far;
    stack[depth++] = near;
  }
  foot.distance = std::sqrt(best_sq);
  return foot;
}

}  // namespace pcl_slim::comparison
