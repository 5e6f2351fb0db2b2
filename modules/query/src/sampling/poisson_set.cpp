// SPDX-License-Identifier: BSD-3-Clause
#include "sampling/poisson_set.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "pcl_slim/core/parallel.h"

namespace pcl_slim::detail {

namespace {

constexpr std::uint32_t kNone = 0xffffffffu;
constexpr std::size_t kBatch = 8192;  ///< points that are tried side by side

std::uint64_t
mixed(std::uint64_t bits)
{
  bits += 0x9e3779b97f4a7c15u;
  bits = (bits ^ (bits >> 30)) * 0xbf58476d1ce4e5b9u;
  bits = (bits ^ (bits >> 27)) * 0x94d049bb133111ebu;
  return bits ^ (bits >> 31);
}

/** Chosen points in cells as wide as the spacing, found by a hash of the cell. */
class CellTable {
 public:
  CellTable(const SidedPoints& points, double spacing)
      : points_(points), spacing_(spacing), next_(points.position.size(), kNone)
  {
    std::size_t slots = 1024;
    while (slots < points.position.size() / 4) slots *= 2;
    heads_.assign(slots, kNone);
  }

  void add(std::uint32_t i)
  {
    std::uint32_t& head = heads_[slotOf(cellOf(i))];
    next_[i] = head;
    head = i;
  }

  /** The nearest chosen point nearer than twice the spacing that is not i itself, of those in the cells
   * around: surely found if it is nearer than the spacing. */
  std::pair<std::uint32_t, double> nearest(std::uint32_t i, double bound) const
  {
    std::pair<std::uint32_t, double> best{kNone, bound * bound};
    const auto cell = cellOf(i);
    for (std::int64_t x = -1; x <= 1; ++x) {
      for (std::int64_t y = -1; y <= 1; ++y) {
        for (std::int64_t z = -1; z <= 1; ++z) {
          const std::size_t slot = slotOf({cell[0] + x, cell[1] + y, cell[2] + z});
          for (std::uint32_t j = heads_[slot]; j != kNone; j = next_[j]) {
            const double d = squaredDistance(i, j);
            if (j != i && d < best.second && face(i, j)) best = {j, d};
          }
        }
      }
    }
    return best;
  }

 private:
  std::array<std::int64_t, 3> cellOf(std::uint32_t i) const
  {
    std::array<std::int64_t, 3> cell;
    for (std::size_t a = 0; a < 3; ++a)
      cell[a] = static_cast<std::int64_t>(std::floor(points_.position[i][a] / spacing_));
    return cell;
  }

  std::size_t slotOf(const std::array<std::int64_t, 3>& cell) const
  {
    std::uint64_t hash = 0;
    for (const std::int64_t c : cell) hash = mixed(hash ^ static_cast<std::uint64_t>(c));
    return static_cast<std::size_t>(hash) & (heads_.size() - 1);
  }

  double squaredDistance(std::uint32_t i, std::uint32_t j) const
  {
    double sum = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      const double d = points_.position[i][a] - points_.position[j][a];
      sum += d * d;
    }
    return sum;
  }

  bool face(std::uint32_t i, std::uint32_t j) const
  {
    if (!points_.oriented) return true;
    const auto &m = points_.normal[i], &n = points_.normal[j];
    return m[0] * n[0] + m[1] * n[1] + m[2] * n[2] > 0.0f;
  }

  const SidedPoints& points_;
  double spacing_;
  std::vector<std::uint32_t> heads_, next_;
};

}  // namespace

std::vector<std::uint32_t>
poissonSet(const SidedPoints& points, double spacing, std::uint64_t seed, int threads)
{
  const std::size_t n = points.position.size();
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order(n);
  for (std::uint32_t i = 0; i < n; ++i) order[i] = {mixed(mixed(seed) ^ i), i};
  std::sort(order.begin(), order.end());
  CellTable chosen(points, spacing);
  std::vector<std::uint32_t> set;
  std::vector<std::uint8_t> free(kBatch);
  for (std::size_t begin = 0; begin < n; begin += kBatch) {
    // Most points are too near to one of an earlier batch; the few others are tried again in their order.
    const std::size_t count = std::min(kBatch, n - begin);
    parallelFor(count, threads, 256, [&](std::size_t k, int) {
      free[k] = chosen.nearest(order[begin + k].second, spacing).first == kNone;
    });
    for (std::size_t k = 0; k < count; ++k) {
      const std::uint32_t i = order[begin + k].second;
      if (free[k] == 0 || chosen.nearest(i, spacing).first != kNone) continue;
      chosen.add(i);
      set.push_back(i);
    }
  }
  std::sort(set.begin(), set.end());
  return set;
}

void
thinSet(const SidedPoints& points, double spacing, std::size_t count,
        std::vector<std::uint32_t>& set)
{
  if (set.size() <= count) return;
  CellTable chosen(points, spacing);
  for (const std::uint32_t i : set) chosen.add(i);
  struct Neighbor {
    double distance;
    std::uint32_t point, nearest;
  };
  std::vector<Neighbor> neighbors;
  for (const std::uint32_t i : set) {
    const auto [j, distance] = chosen.nearest(i, 2 * spacing);
    neighbors.push_back({distance, i, j});
  }
  std::stable_sort(neighbors.begin(), neighbors.end(),
                   [](const Neighbor& a, const Neighbor& b) { return a.distance < b.distance; });
  std::vector<std::uint8_t> gone(points.position.size(), 0);
  std::size_t left = set.size();
  for (const bool pairs : {true, false}) {
    for (const Neighbor& n : neighbors) {
      const bool widowed = n.nearest != kNone && gone[n.nearest] != 0;
      if (left == count || gone[n.point] != 0 || (pairs && widowed)) continue;
      gone[n.point] = 1;
      --left;
    }
  }
  set.erase(std::remove_if(set.begin(), set.end(), [&](std::uint32_t i) { return gone[i] != 0; }),
            set.end());
}

}  // namespace pcl_slim::detail
