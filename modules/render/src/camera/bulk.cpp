// SPDX-License-Identifier: BSD-3-Clause
#include "camera/bulk.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <iterator>
#include <utility>

namespace pcl_slim::detail {
namespace {

constexpr int kCells = 64;            ///< along the longest extent
constexpr double kLeastPiece = 0.01;  ///< share of the points
constexpr double kRim = 0.05;         ///< share of the points beyond either end of the bulk ...
constexpr double kSlack = 0.5;        ///< [extent of the bulk] added at either end

using Interval = std::array<double, 2>;

double
pointsOf(const std::vector<BoundingSphere>& spheres)
{
  double points = 0.0;
  for (const BoundingSphere& sphere : spheres) points += sphere.points;
  return points;
}

/** \brief Per axis, the interval of centres that counts. */
std::array<Interval, 3>
framedExtent(const std::vector<BoundingSphere>& spheres)
{
  std::array<Interval, 3> extent;
  std::vector<std::pair<float, float>> values(spheres.size());  // coordinate, points
  const double rim = kRim * pointsOf(spheres);
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t i = 0; i < spheres.size(); ++i)
      values[i] = {spheres[i].center[a], spheres[i].points};
    std::sort(values.begin(), values.end());
    const auto inner = [rim](auto at) {
      for (double beyond = at->second; beyond < rim; beyond += at->second) ++at;
      return static_cast<double>(at->first);
    };
    const double low = inner(values.begin()), high = inner(values.rbegin());
    const double slack = kSlack * (high - low) + 1e-3;
    extent[a] = {low - slack, high + slack};
  }
  return extent;
}

std::vector<BoundingSphere>
withinExtent(const std::vector<BoundingSphere>& spheres)
{
  std::vector<BoundingSphere> inside;
  const auto extent = framedExtent(spheres);
  std::copy_if(spheres.begin(), spheres.end(), std::back_inserter(inside), [&](const auto& sphere) {
    for (std::size_t a = 0; a < 3; ++a) {
      if (sphere.center[a] < extent[a][0] || sphere.center[a] > extent[a][1]) return false;
    }
    return true;
  });
  return inside;
}

/** \brief A grid over the centres, for the connected components of spheres. */
class PieceGrid {
 public:
  explicit PieceGrid(const std::vector<BoundingSphere>& spheres);

  /** \brief Points of the piece that a sphere belongs to. */
  double pointsAround(const BoundingSphere& sphere) const
  {
    return points_[piece_[indexOf(cellsOf(sphere, 0.0f)[0])]];
  }

 private:
  using Cell = std::array<int, 3>;

  /** \brief Lowest and highest cell that a share of a sphere's box touches. */
  std::array<Cell, 2> cellsOf(const BoundingSphere& sphere, float share) const;
  static std::size_t indexOf(const Cell& c)
  {
    return static_cast<std::size_t>((c[2] * kCells + c[1]) * kCells + c[0]);
  }
  template <typename Visit>
  static void forCells(const Cell& low, const Cell& high, const Visit& visit);
  void setPlace(const std::vector<BoundingSphere>& spheres);
  void fill(std::size_t start);

  std::array<float, 3> low_{};
  float cell_ = 1.0f;
  std::vector<std::uint32_t> piece_;  ///< of each cell; 0: nothing, 1: not yet numbered
  std::vector<double> points_;        ///< of each piece
};

PieceGrid::PieceGrid(const std::vector<BoundingSphere>& spheres)
    : piece_(std::size_t{kCells} * kCells * kCells, 0), points_(2, 0.0)
{
  setPlace(spheres);
  for (const BoundingSphere& sphere : spheres) {
    const auto [low, high] = cellsOf(sphere, 0.5f);
    forCells(low, high, [this](std::size_t cell) { piece_[cell] = 1; });
  }
  for (std::size_t cell = 0; cell < piece_.size(); ++cell) {
    if (piece_[cell] == 1) fill(cell);
  }
  for (const BoundingSphere& sphere : spheres) {
    points_[piece_[indexOf(cellsOf(sphere, 0.0f)[0])]] += sphere.points;
  }
}

/** \brief Places the grid over all centres. */
void
PieceGrid::setPlace(const std::vector<BoundingSphere>& spheres)
{
  float longest = 0.0f;
  for (std::size_t a = 0; a < 3; ++a) {
    float high = low_[a] = spheres.front().center[a];
    for (const BoundingSphere& sphere : spheres) {
      low_[a] = std::min(low_[a], sphere.center[a]);
      high = std::max(high, sphere.center[a]);
    }
    longest = std::max(longest, high - low_[a]);
  }
  if (longest > 0.0f) cell_ = longest / (kCells - 1);
}

std::array<PieceGrid::Cell, 2>
PieceGrid::cellsOf(const BoundingSphere& sphere, float share) const
{
  std::array<Cell, 2> cells{};
  for (std::size_t a = 0; a < 3; ++a) {
    const float center = sphere.center[a] - low_[a], reach = share * sphere.radius;
    const auto cellAt = [this](float x) {
      return static_cast<int>(std::clamp(x / cell_, 0.0f, kCells - 1.0f));
    };
    cells[0][a] = cellAt(center - reach);
    cells[1][a] = cellAt(center + reach);
  }
  return cells;
}

template <typename Visit>
void
PieceGrid::forCells(const Cell& low, const Cell& high, const Visit& visit)
{
  for (int z = low[2]; z <= high[2]; ++z) {
    for (int y = low[1]; y <= high[1]; ++y) {
      for (int x = low[0]; x <= high[0]; ++x) visit(indexOf({x, y, z}));
    }
  }
}

/** \brief Numbers a cell and all that touch it, at corners as well. */
void
PieceGrid::fill(std::size_t start)
{
  const auto number = static_cast<std::uint32_t>(points_.size());
  points_.push_back(0.0);
  std::vector<std::size_t> open{start};
  piece_[start] = number;
  while (!open.empty()) {
    const auto at = static_cast<int>(open.back());
    open.pop_back();
    const Cell c{at % kCells, at / kCells % kCells, at / kCells / kCells};
    Cell low{}, high{};
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = std::max(0, c[a] - 1);
      high[a] = std::min(kCells - 1, c[a] + 1);
    }
    forCells(low, high, [&](std::size_t cell) {
      if (piece_[cell] != 1) return;
      piece_[cell] = number;
      open.push_back(cell);
    });
  }
}

}  // namespace

std::vector<BoundingSphere>
bulkOf(const std::vector<BoundingSphere>& spheres)
{
  if (spheres.empty()) return {};
  std::vector<BoundingSphere> inside = withinExtent(spheres);
  if (inside.empty()) return inside;
  const double total = pointsOf(inside);
  const PieceGrid grid(inside);
  std::vector<BoundingSphere> bulk;
  std::copy_if(inside.begin(), inside.end(), std::back_inserter(bulk), [&](const auto& sphere) {
    return grid.pointsAround(sphere) >= kLeastPiece * total;
  });
  return bulk.empty() ? inside : bulk;
}

}  // namespace pcl_slim::detail
