// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/surface/trim_map.h"

#include <algorithm>
#include <cmath>

#include "pcl_slim/core/parallel.h"
#include "pcl_slim/surface/detail/trim_tables.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim {

namespace {

/** The node nearest to a coordinate and the weights of it and its neighbours. */
struct SplineSupport {
  int node;
  double weight[3];

  SplineSupport(double coordinate, int side) {
    const double x = std::clamp(0.5 * (coordinate + 1.0), 0.0, 1.0) * (side - 1);
    node = static_cast<int>(x + 0.5);
    const double d = x - node;
    weight[0] = 0.5 * (0.5 - d) * (0.5 - d);
    weight[1] = 0.75 - d * d;
    weight[2] = 0.5 * (0.5 + d) * (0.5 + d);
  }
};

}  // namespace

double outsideShare(const TrimMap& map, double u, double v) {
  if (map.closed()) return 0.0;
  const SplineSupport column(u, map.side), row(v, map.side);
  double outside = 0.0;
  for (int j = 0; j < 3; ++j) {
    const int y = std::clamp(row.node + j - 1, 0, map.side - 1);
    for (int i = 0; i < 3; ++i) {
      const int x = std::clamp(column.node + i - 1, 0, map.side - 1);
      if (!map.at(x, y)) outside += column.weight[i] * row.weight[j];
    }
  }
  return outside;
}

double filledShare(const TrimMap& map, WeightKernel kernel) {
  if (map.closed()) return 1;
  double sum[2] = {0, 0}, squares[2] = {0, 0};
  const double middle = 0.5 * (map.side - 1);
  for (int row = 0; row < map.side; ++row) {
    for (int column = 0; column < map.side; ++column) {
      const double u = column / middle - 1, v = row / middle - 1, s_sq = u * u + v * v;
      if (s_sq >= 1) continue;
      const double w = evaluateKernel(kernel, s_sq);
      const std::size_t inside = map.at(column, row) ? 1 : 0;
      sum[inside] += w;
      squares[inside] += w * w;
    }
  }
  if (!(squares[1] > 0)) return 1;
  const double all = sum[0] + sum[1];
  return sum[1] * sum[1] / squares[1] * (squares[0] + squares[1]) / (all * all);
}

namespace {

// Holes of trim maps closed after the fit: morphological closing by a disc, map by map.

/** Data are grown by half a spacing in maps, so that a hole is narrower by one. */
constexpr double kGrowth = 1.0;

/** \brief A map's nodes, and around them as many as closing by a disc looks at, each as the nearest
 * node of the map. */
class NodeSquare {
 public:
  NodeSquare(const TrimMap& map, int reach)
      : reach_(reach), margin_(2 * reach), side_(map.side + 2 * margin_) {
    inside_.reserve(static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_));
    for (int y = 0; y < side_; ++y) {
      const int row = std::clamp(y - margin_, 0, map.side - 1);
      for (int x = 0; x < side_; ++x) {
        inside_.push_back(map.at(std::clamp(x - margin_, 0, map.side - 1), row));
      }
    }
  }

  /** \brief Turns every node within a distance of one of a kind to that kind. O(nodes reach). */
  void spread(bool kind, double distance) {
    const std::vector<int> above = alongColumns(kind);
    std::vector<std::uint8_t> spread(inside_.size());
    for (int y = 0; y < side_; ++y) {
      for (int x = 0; x < side_; ++x) {
        const bool reached = isReached(above, x, y, distance * distance);
        spread[at(x, y)] = reached ? kind : !kind;
      }
    }
    inside_ = std::move(spread);
  }

  /** \brief Whether a node of the map itself is inside. */
  bool inside(int column, int row) const {
    return inside_[at(column + margin_, row + margin_)] != 0;
  }

 private:
  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(side_) +
           static_cast<std::size_t>(x);
  }

  /** \brief Rows from each node to the next one of a kind in its column; side() where there is
   * none. */
  std::vector<int> alongColumns(bool kind) const {
    std::vector<int> rows(inside_.size(), side_);
    const auto step = [&](int x, int y, int from) {
      int& own = rows[at(x, y)];
      if ((inside_[at(x, y)] != 0) == kind) own = 0;
      if (from >= 0 && from < side_) own = std::min(own, rows[at(x, from)] + 1);
    };
    for (int y = 0; y < side_; ++y) {
      for (int x = 0; x < side_; ++x) step(x, y, y - 1);
    }
    for (int y = side_ - 1; y >= 0; --y) {
      for (int x = 0; x < side_; ++x) step(x, y, y + 1);
    }
    return rows;
  }

  bool isReached(const std::vector<int>& rows, int x, int y, double distance_sq) const {
    const int first = std::max(0, x - reach_), last = std::min(side_ - 1, x + reach_);
    for (int k = first; k <= last; ++k) {
      const int dy = rows[at(k, y)];
      if (dy < side_ && (k - x) * (k - x) + dy * dy <= distance_sq) return true;
    }
    return false;
  }

  int reach_, margin_, side_;
  std::vector<std::uint8_t> inside_;
};

/** \brief A map whose holes narrower than `hole` nodes are closed; none if all of its disc then is.
 * \param[out] bits of the map */
int closedMap(const TrimMap& map, double hole, std::vector<std::uint8_t>& bits) {
  const double radius = std::min(0.5 * (hole - kGrowth), static_cast<double>(map.side));
  NodeSquare nodes(map, static_cast<int>(std::ceil(radius)));
  nodes.spread(true, radius);
  nodes.spread(false, radius);
  bits.assign(TrimMap::numBytes(map.side), 0);
  const double middle = 0.5 * (map.side - 1);
  bool is_open = false;
  for (int row = 0; row < map.side; ++row) {
    for (int column = 0; column < map.side; ++column) {
      // What the map had stays: a disc larger than the data's narrow parts would else take them.
      const bool inside = nodes.inside(column, row) || map.at(column, row);
      const int k = row * map.side + column;
      bits[static_cast<std::size_t>(k >> 3)] |= static_cast<std::uint8_t>(inside << (k & 7));
      is_open |= !inside && std::hypot(column - middle, row - middle) <= middle;
    }
  }
  return is_open ? map.side : 0;
}

}  // namespace

void SLIMSurface::closeHoles(double hole, int threads) {
  if (!hasTrimMaps() || !(hole > kGrowth)) return;
  std::vector<std::vector<std::uint8_t>> maps(size());
  std::vector<std::uint8_t> sides(size(), 0);
  parallelFor(size(), resolveThreads(threads), 64, [&](std::size_t i, int) {
    const TrimMap map = trimMap(i);
    if (map.closed()) return;
    sides[i] = static_cast<std::uint8_t>(closedMap(map, hole, maps[i]));
    if (sides[i] == 0) maps[i].clear();
  });
  std::vector<std::uint8_t> bits;
  for (const auto& map : maps) bits.insert(bits.end(), map.begin(), map.end());
  setTrimMaps(sides, bits);
}

}  // namespace pcl_slim

namespace pcl_slim::detail {

namespace {

/** Three bits: whether the nodes of a column in the rows about one are outside. */
std::uint32_t columnCode(const TrimMap& map, int column, int row) {
  const int x = std::clamp(column, 0, map.side - 1);
  std::uint32_t code = 0;
  for (int j = 0; j < 3; ++j) {
    const int y = std::clamp(row + j - 1, 0, map.side - 1);
    code |= static_cast<std::uint32_t>(!map.at(x, y)) << j;
  }
  return code;
}

void appendTable(const TrimMap& map, std::vector<std::int32_t>& words) {
  for (int row = 0; row < map.side; ++row) {
    for (int first = -1; first < map.side - 1; first += 8) {
      std::uint32_t word = 0;
      for (int k = 0; k < 10; ++k) word |= columnCode(map, first + k, row) << 3 * k;
      words.push_back(static_cast<std::int32_t>(word));
    }
  }
}

}  // namespace

TrimTables::TrimTables(const SLIMSurface& surface) {
  if (!surface.hasTrimMaps()) return;
  begin_.resize(surface.size());
  sides_.resize(surface.size());
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const TrimMap map = surface.trimMap(i);
    begin_[i] = static_cast<std::uint32_t>(words_.size());
    sides_[i] = static_cast<std::uint8_t>(map.side);
    appendTable(map, words_);
  }
}

}  // namespace pcl_slim::detail
