// SPDX-License-Identifier: BSD-3-Clause
// Cells of points, and the sheet through each (docs/sides.md, "Sides before the cover").
#include "sides/side_cells.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "pcl_slim/cloud/morton.h"
#include "pcl_slim/cloud/morton_sort.h"
#include "pcl_slim/core/parallel.h"

namespace pcl_slim::detail {

namespace {

constexpr std::size_t kTask = 4096;  ///< number of points that a thread takes at a time
constexpr std::int64_t kLast = (1 << kMortonBits) - 1;  ///< last index of a cube along an axis

using Place = std::array<std::int64_t, 3>;  ///< indices of a cube along the axes

Place placeOf(const Vector3& p, double width) {
  Place place;
  for (std::size_t a = 0; a < 3; ++a) {
    const double cell = (p[a] + 0.5) / width;
    place[a] = static_cast<std::int64_t>(std::clamp(cell, 0.0, static_cast<double>(kLast)));
  }
  return place;
}

std::uint64_t codeOf(const Place& place) {
  std::uint64_t code = 0;
  for (std::size_t a = 0; a < 3; ++a)
    code |= spreadBits(static_cast<std::uint64_t>(place[a])) << (2 - a);
  return code;
}

std::size_t hashOf(std::uint64_t code) {
  code *= 0x9e3779b97f4a7c15ULL;
  return static_cast<std::size_t>(code ^ code >> 32);
}

/** The cubes of a brick whose index along an axis is in [first, last], one bit each. */
std::uint64_t cubesWithin(std::size_t axis, std::int64_t first, std::int64_t last) {
  // Bits of a code within a brick: x1 y1 z1 x0 y0 z0.
  constexpr std::uint64_t kHigh[3] = {0xffffffff00000000u, 0xffff0000ffff0000u,
                                      0xff00ff00ff00ff00u};
  constexpr std::uint64_t kLow[3] = {0xf0f0f0f0f0f0f0f0u, 0xccccccccccccccccu, 0xaaaaaaaaaaaaaaaau};
  std::uint64_t cubes = 0;
  for (std::int64_t at = std::max<std::int64_t>(first, 0); at <= std::min<std::int64_t>(last, 3);
       ++at)
    cubes |= (at & 2 ? kHigh[axis] : ~kHigh[axis]) & (at & 1 ? kLow[axis] : ~kLow[axis]);
  return cubes;
}

/** Number of bits that are set: sums over pairs, over fours, and over all bytes at once. */
std::uint32_t countBits(std::uint64_t bits) {
  bits -= bits >> 1 & 0x5555555555555555u;
  bits = (bits & 0x3333333333333333u) + (bits >> 2 & 0x3333333333333333u);
  bits = (bits + (bits >> 4)) & 0x0f0f0f0f0f0f0f0fu;
  return static_cast<std::uint32_t>(bits * 0x0101010101010101u >> 56);
}

CellMoments momentsOf(const PointStore& store, const std::uint32_t* begin,
                      const std::uint32_t* end) {
  CellMoments m;
  m.count = static_cast<double>(end - begin);
  for (const std::uint32_t* i = begin; i != end; ++i) {
    const Vector3 p = store.position(*i);
    for (std::size_t a = 0; a < 3; ++a) m.mean[a] += p[a] / m.count;
  }
  for (const std::uint32_t* i = begin; i != end; ++i) {
    const Vector3 d = subtract(store.position(*i), m.mean);
    for (std::size_t a = 0, k = 0; a < 3; ++a) {
      for (std::size_t b = a; b < 3; ++b, ++k) m.covariance[k] += d[a] * d[b] / m.count;
    }
  }
  return m;
}

}  // namespace

SideCells::SideCells(const PointStore& store, double wanted, int threads)
    : width(std::max(wanted, std::ldexp(1.0, -kMortonBits))) {
  const std::size_t n = store.size();
  AlignedVector<std::uint64_t> keys(n);
  AlignedVector<std::uint32_t> order;
  parallelFor((n + kTask - 1) / kTask, threads, 1, [&](std::size_t task, int) {
    for (std::size_t i = task * kTask; i < std::min(n, (task + 1) * kTask); ++i)
      keys[i] = codeOf(placeOf(store.position(i), width));
  });
  sortByKey(keys, order, threads);
  std::vector<std::size_t> begins;
  std::vector<std::uint64_t> codes;
  for (std::size_t i = 0; i < n; ++i) {
    if (i > 0 && keys[i] == keys[i - 1]) continue;
    begins.push_back(i);
    codes.push_back(keys[i]);
  }
  begins.push_back(n);
  cells.resize(codes.size());
  cell_of.resize(n);
  parallelFor(cells.size(), threads, 256, [&](std::size_t c, int) {
    cells[c] = momentsOf(store, order.data() + begins[c], order.data() + begins[c + 1]);
    for (std::size_t i = begins[c]; i < begins[c + 1]; ++i)
      cell_of[order[i]] = static_cast<std::uint32_t>(c);
  });
  index(codes);
}

void SideCells::index(const std::vector<std::uint64_t>& codes) {
  for (std::uint32_t c = 0; c < codes.size(); ++c) {
    if (c == 0 || codes[c] >> 6 != bricks_.back().code) bricks_.push_back({codes[c] >> 6, 0, c});
    bricks_.back().cubes |= std::uint64_t(1) << (codes[c] & 63);
  }
  std::size_t size = 2;
  while (size < 2 * bricks_.size()) size *= 2;
  slots_.assign(size, kNone);
  for (std::uint32_t b = 0; b < bricks_.size(); ++b) {
    std::size_t slot = hashOf(bricks_[b].code) & (size - 1);
    while (slots_[slot] != kNone) slot = (slot + 1) & (size - 1);
    slots_[slot] = b;
  }
}

const SideCells::Brick& SideCells::brickOf(std::uint64_t code) const {
  static const Brick empty;
  const std::size_t mask = slots_.size() - 1;
  std::size_t slot = hashOf(code) & mask;
  while (slots_[slot] != kNone && bricks_[slots_[slot]].code != code) slot = (slot + 1) & mask;
  return slots_[slot] == kNone ? empty : bricks_[slots_[slot]];
}

std::uint32_t SideCells::cellAt(const Vector3& place) const {
  const std::uint64_t code = codeOf(placeOf(place, width)), cube = std::uint64_t(1) << (code & 63);
  const Brick& brick = brickOf(code >> 6);
  return brick.cubes & cube ? brick.first + countBits(brick.cubes & (cube - 1)) : kNone;
}

std::size_t SideCells::cellsAbout(std::uint32_t cell,
                                  std::array<std::uint32_t, kWindow>& found) const {
  constexpr std::int64_t kReach = 2;
  const Place middle = placeOf(cells[cell].mean, width);
  Place first;                 // first brick of the window
  std::uint64_t within[3][2];  // cubes of the first and the next brick, along each axis
  for (std::size_t a = 0; a < 3; ++a) {
    first[a] = std::max<std::int64_t>(middle[a] - kReach, 0) / 4;
    for (std::int64_t next = 0; next < 2; ++next) {
      const std::int64_t begin = 4 * (first[a] + next), from = middle[a] - begin;
      within[a][next] = begin > kLast ? 0 : cubesWithin(a, from - kReach, from + kReach);
    }
  }
  std::size_t count = 0;
  for (std::int64_t corner = 0; corner < 8; ++corner) {
    const std::int64_t x = corner >> 2, y = corner >> 1 & 1, z = corner & 1;
    std::uint64_t cubes = within[0][x] & within[1][y] & within[2][z];
    if (cubes == 0) continue;
    const Brick& brick = brickOf(codeOf({first[0] + x, first[1] + y, first[2] + z}));
    for (cubes &= brick.cubes; cubes != 0; cubes &= cubes - 1)
      found[count++] = brick.first + countBits(brick.cubes & ((cubes & (0 - cubes)) - 1));
  }
  return count;
}

namespace {

constexpr std::size_t kMost = SideConstants::kMostNeighbors;
/// Sizes of the neighbourhoods of a cell [cells]. The flattest one gives the normal.
constexpr std::array<std::size_t, 3> kNeighborhoods = {12, 18, 36};

/** The bits of the first cells. */
std::uint64_t firstCells(std::size_t count) {
  return (std::uint64_t{1} << count) - 1;
}

Vector3 meanOf(const CellSums& sums) {
  return {sums[1] / sums[0], sums[2] / sums[0], sums[3] / sums[0]};
}

/** Principal axes of sums over points. */
struct Axes {
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  double scale = 0;  ///< factor of the eigenvalues: the trace of the covariance

  Axes() = default;
  explicit Axes(const CellSums& sums) {
    const Vector3 m = meanOf(sums);
    const Eigen::Vector3d mean(m[0], m[1], m[2]);
    Eigen::Matrix3d covariance;
    covariance << sums[4], sums[5], sums[6], sums[5], sums[7], sums[8], sums[6], sums[8], sums[9];
    covariance = covariance / sums[0] - mean * mean.transpose();
    scale = std::max(covariance.trace(), std::numeric_limits<double>::min());
    solver.computeDirect(covariance / scale);
  }

  /** Variances along the axes, ascending, in units of scale. */
  Eigen::Vector3d spreads() const { return solver.eigenvalues().cwiseMax(0.0); }
};

/** Sets a sheet's normal and spread. \return the spread over the lesser variance across the normal
 */
double setNormal(const Axes& axes, CellSheet& sheet) {
  const Eigen::Vector3d n = axes.solver.eigenvectors().col(0), spreads = axes.spreads();
  const bool usable = n.allFinite() && n.squaredNorm() > 0.5;
  sheet.normal = usable ? Vector3{n[0], n[1], n[2]} : Vector3{0, 0, 1};
  sheet.spread = axes.scale * spreads[0];
  return spreads[1] > 0 ? spreads[0] / spreads[1] : 1;
}

/** Variance of the points along a unit direction. */
double varianceAlong(const CellSums& sums, const Vector3& n) {
  const double square = n[0] * (sums[4] * n[0] + 2 * (sums[5] * n[1] + sums[6] * n[2])) +
                        n[1] * (sums[7] * n[1] + 2 * sums[8] * n[2]) + n[2] * sums[9] * n[2];
  const double mean = dot(meanOf(sums), n);
  return square / sums[0] - mean * mean;
}

/** Whether two sheets are above each other, unlike the two faces of an edge: across the normal, the
 * distance of their means is below their RMS width. */
bool overlap(const std::array<CellSums, 2>& sides, const Vector3& normal) {
  const Vector3 between = subtract(meanOf(sides[1]), meanOf(sides[0]));
  const Vector3 across = along(between, -dot(between, normal), normal);
  const Vector3 n = normalized(across);
  return dot(across, across) < 0.5 * (varianceAlong(sides[0], n) + varianceAlong(sides[1], n));
}

/** Marks the cells of another sheet, if there are two along the normal.
 * \param[out] sides sums over the cell's own sheet and over the other */
void findOther(const NearCells& near, const CellSums& all, const Vector3& normal,
               const SideConstants& constants, SheetCells& from, std::array<CellSums, 2>& sides) {
  const double total = all[0], mean = dot(meanOf(all), normal);
  const TwoSheets two = kernels::separateCells(near, from.count, normal, mean, constants.passes);
  const double between = two.above * (total - two.above) / total * two.gap * two.gap;
  const double within = std::max(0.0, two.square - between) / total;
  const double least = constants.least_side * total;
  if (!(two.above > least && total - two.above > least)) return;
  if (!(two.gap * two.gap > constants.sheet_distance * constants.sheet_distance * within)) return;
  const std::uint64_t cells = firstCells(from.count);
  from.other = two.higher & 1 ? cells & ~two.higher : two.higher;
  sides = {kernels::sumCells(near, cells & ~from.other), kernels::sumCells(near, from.other)};
  if (!overlap(sides, normal)) from.other = 0;
}

/** A cell in a window, and the squared distance that it is sorted by. */
struct Distant {
  float square;
  std::uint32_t cell;

  bool operator<(const Distant& other) const {
    return square != other.square ? square < other.square : cell < other.cell;
  }
};

/** Sorts the nearest cells by distance: a counting sort by steps of the squared distance, of which
 * few have more than one cell, then an insertion sort.
 * \return the number of cells sorted, at least min(wanted, count) */
std::size_t sortNearest(const std::array<Distant, SideCells::kWindow>& found, std::size_t count,
                        double width, std::size_t wanted,
                        std::array<Distant, SideCells::kWindow>& sorted) {
  constexpr std::size_t kSteps = 128;
  constexpr float kStepsPerWidth = 4;
  const float scale = kStepsPerWidth / static_cast<float>(width * width);
  const auto stepOf = [scale](const Distant& at) {
    return static_cast<std::size_t>(std::min(at.square * scale, static_cast<float>(kSteps - 1)));
  };
  std::array<std::uint8_t, kSteps + 1> begins{};
  for (std::size_t k = 0; k < count; ++k) ++begins[stepOf(found[k]) + 1];
  std::size_t steps = 0, kept = 0;
  for (; steps < kSteps && kept < std::min(wanted, count); ++steps) {
    kept += begins[steps + 1];
    begins[steps + 1] = static_cast<std::uint8_t>(kept);
  }
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t step = stepOf(found[k]);
    if (step < steps) sorted[begins[step]++] = found[k];
  }
  for (std::size_t k = 1; k < kept; ++k) {
    const Distant at = sorted[k];
    std::size_t place = k;
    for (; place > 0 && at < sorted[place - 1]; --place) sorted[place] = sorted[place - 1];
    sorted[place] = at;
  }
  return kept;
}

/** Finds the cells of the nearest means, the cell itself first. \return their number */
std::size_t nearestCells(const SideCells& cut, std::uint32_t cell, std::size_t wanted,
                         std::array<std::uint32_t, kMost>& cells, NearCells& near) {
  std::array<std::uint32_t, SideCells::kWindow> window;
  std::array<Distant, SideCells::kWindow> found, sorted;
  const std::size_t count = cut.cellsAbout(cell, window);
  const Vector3& middle = cut.cells[cell].mean;
  for (std::size_t k = 0; k < count; ++k) {
    const Vector3 d = subtract(cut.cells[window[k]].mean, middle);
    found[k] = {window[k] == cell ? 0.0f : static_cast<float>(dot(d, d)), window[k]};
  }
  const std::size_t kept = std::min(sortNearest(found, count, cut.width, wanted, sorted), wanted);
  for (std::size_t k = 0; k < kept; ++k) {
    cells[k] = sorted[k].cell;
    const CellMoments& at = cut.cells[cells[k]];
    near.columns[0][k] = at.count;
    for (std::size_t a = 0; a < 3; ++a) near.columns[1 + a][k] = at.mean[a] - middle[a];
    for (std::size_t c = 0; c < 6; ++c) near.columns[4 + c][k] = at.covariance[c];
  }
  for (auto& column : near.columns) std::fill(column.begin() + kept, column.end(), 0.0);
  return kept;
}

/** Tests whether the cells are a rod whose surface is far flatter, in proportion, than their
 * flattest plane. Planes do not separate the sides of a rod that is hardly wider than a cell.
 * \return the sheet around the rod's axis, with radial normals; `flat` if there is no rod */
CellSheet rodOf(const NearCells& near, std::size_t count, const CellSums& sums, const Axes& axes,
                double flattest, const SideConstants& constants, const CellSheet& flat,
                SheetCells& cells) {
  constexpr double kFlatnessRatio = 0.5;  // largest ratio of the flatness of a rod and of the plane
  const Eigen::Vector3d spreads = axes.spreads(), main = axes.solver.eigenvectors().col(2);
  const bool round =
      spreads[1] < constants.rod * spreads[2] && spreads[0] > constants.round_rod * spreads[1];
  if (!round) return flat;
  CellSheet rod = flat;
  rod.axis = {main[0], main[1], main[2]};
  const Vector3 middle = meanOf(sums);
  std::array<Vector3, kMost> radii{};
  double first = 0, second = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const Vector3 at = {near.columns[1][k], near.columns[2][k], near.columns[3][k]};
    const Vector3 from = subtract(at, middle);
    radii[k] = along(from, -dot(from, rod.axis), rod.axis);
    const double points = near.columns[0][k], radius = length(radii[k]);
    first += points * radius / sums[0];
    second += points * radius * radius / sums[0];
  }
  rod.radius = radii[0];
  rod.spread = std::max(0.0, second - first * first);
  if (!(length(rod.radius) > 0 && rod.spread < kFlatnessRatio * flattest * axes.scale * spreads[0]))
    return flat;
  rod.normal = normalized(rod.radius);
  rod.middle = -length(rod.radius);
  cells.count = count;
  cells.other = 0;
  for (std::size_t k = 1; k < count; ++k) {
    if (dot(radii[k], rod.normal) < 0) cells.other |= std::uint64_t{1} << k;
  }
  return rod;
}

}  // namespace

CellSheet sheetOf(const SideCells& cut, std::uint32_t cell, const SideConstants& constants,
                  SheetCells& cells) {
  NearCells near;
  CellSheet best;
  const std::size_t count =
      nearestCells(cut, cell, std::min(kNeighborhoods.back(), kMost), cells.cells, near);
  double flattest = std::numeric_limits<double>::infinity();
  CellSums sums{};
  Axes axes;  // of all cells summed so far
  std::size_t summed = 0;
  for (const std::size_t size : kNeighborhoods) {
    CellSheet sheet;
    SheetCells from;
    from.count = std::min(size, count);
    const CellSums added = kernels::sumCells(near, firstCells(from.count) & ~firstCells(summed));
    for (std::size_t c = 0; c < sums.size(); ++c) sums[c] += added[c];
    summed = from.count;
    axes = Axes(sums);
    double flatness = setNormal(axes, sheet);
    std::array<CellSums, 2> sides{};
    findOther(near, sums, sheet.normal, constants, from, sides);
    if (from.other != 0) {
      flatness = setNormal(Axes(sides[0]), sheet);
      sheet.middle =
          0.5 * (dot(meanOf(sides[0]), sheet.normal) + dot(meanOf(sides[1]), sheet.normal));
    }
    if (flatness >= flattest) continue;
    flattest = flatness;
    cells.count = from.count;
    cells.other = from.other;
    best = sheet;
  }
  return rodOf(near, count, sums, axes, flattest, constants, best, cells);
}

}  // namespace pcl_slim::detail
