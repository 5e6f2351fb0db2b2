// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <queue>

#include "borders/borders.h"

namespace pcl_slim::detail {

namespace {

constexpr double kPrecision = 0.01;
constexpr int kMostSquares = 64;  ///< along the box's longer side, at first
constexpr std::size_t kMostSteps = 20000;

/** A square that may contain the middle of the largest disc. */
struct Square {
  double x, y, half;
  double radius;  ///< of the disc about its middle; below 0: the middle is outside
  double most;    ///< of any disc about a place in it

  bool operator<(const Square& other) const { return most < other.most; }
};

/** Distance from a place to the border; below 0: the place is outside. */
double radiusAt(const std::vector<BorderPiece>& border, double x, double y) {
  double least = std::numeric_limits<double>::infinity();
  bool inside = false;
  for (const BorderPiece& piece : border) {
    const double ax = piece.from[0] - x, ay = piece.from[1] - y;
    const double dx = piece.to[0] - piece.from[0], dy = piece.to[1] - piece.from[1];
    const double length_sq = dx * dx + dy * dy;
    const double t = length_sq > 0 ? std::clamp(-(ax * dx + ay * dy) / length_sq, 0.0, 1.0) : 0.0;
    const double px = ax + t * dx, py = ay + t * dy;
    least = std::min(least, px * px + py * py);
    const double by = ay + dy;
    if ((ay > 0) != (by > 0) && ax - ay * dx / dy > 0) inside = !inside;
  }
  return inside ? std::sqrt(least) : -std::sqrt(least);
}

}  // namespace

double widestDisc(const std::vector<BorderPiece>& border, double least, double most) {
  Bounds box;
  for (const BorderPiece& piece : border) {
    box.add({piece.from[0], piece.from[1], 0});
    box.add({piece.to[0], piece.to[1], 0});
  }
  if (border.empty()) return least;
  const double width = box.high[0] - box.low[0], height = box.high[1] - box.low[1];
  const double side = std::max(std::min(width, height), std::max(width, height) / kMostSquares);
  if (!(side > 0)) return least;
  std::priority_queue<Square> squares;
  double best = least / 2;
  const auto add = [&](double x, double y, double half) {
    const double radius = radiusAt(border, x, y);
    best = std::max(best, radius);
    squares.push({x, y, half, radius, radius + half * M_SQRT2});
  };
  for (double y = box.low[1] + side / 2; y < box.high[1] + side / 2; y += side) {
    for (double x = box.low[0] + side / 2; x < box.high[0] + side / 2; x += side) {
      add(x, y, side / 2);
    }
  }
  for (std::size_t step = 0; step < kMostSteps && !squares.empty() && 2 * best < most; ++step) {
    const Square widest = squares.top();
    squares.pop();
    if (widest.most <= best + kPrecision * std::max(best, side / 4)) break;
    const double half = widest.half / 2;
    for (const double dy : {-half, half}) {
      for (const double dx : {-half, half}) add(widest.x + dx, widest.y + dy, half);
    }
  }
  return 2 * best;
}

PlaneView::PlaneView(const Vector3& origin, const Vector3& normal) : origin_(origin) {
  std::size_t least = 0;
  for (std::size_t a = 1; a < 3; ++a) {
    if (std::abs(normal[a]) < std::abs(normal[least])) least = a;
  }
  Vector3 axis{};
  axis[least] = 1;
  u_ = normalized(cross(normal, axis));
  v_ = normalized(cross(normal, u_));
}

BorderPiece PlaneView::piece(const Vector3& from, const Vector3& to) const {
  const Vector3 a = subtract(from, origin_), b = subtract(to, origin_);
  return {{dot(a, u_), dot(a, v_)}, {dot(b, u_), dot(b, v_)}};
}

}  // namespace pcl_slim::detail
