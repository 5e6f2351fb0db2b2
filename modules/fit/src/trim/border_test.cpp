// SPDX-License-Identifier: BSD-3-Clause
#include "trim/border_test.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "pcl_slim/cloud/detail/block_kernels.h"

namespace pcl_slim::detail {

namespace {

constexpr std::uint32_t kInside = 1;  // no direction has this code
constexpr std::uint32_t kPartner = 1u << 30, kAlone = 1u << 31;
constexpr int kHalfTen = 511;         ///< ten bits encode -1 to 1 in this many steps to each side
constexpr double kCoincident = 1e-3;  ///< [spacing] nearer points have no direction
constexpr std::size_t kAround = 9;  ///< nearest points on a side of a border, which give a spacing
constexpr int kTurns = 6;           ///< frames about a rim, 30 degrees apart
constexpr int kSteps = 4;           ///< spacings that a point is tested by, at most

std::uint32_t packed(const Vector3& direction) {
  std::uint32_t bits = 0;
  for (const double x : direction)
    bits = bits << 10 | static_cast<std::uint32_t>(std::lround(kHalfTen * (1.0 + x)));
  return bits;
}

Vector3 unpacked(std::uint32_t bits) {
  const auto coordinate = [&](int shift) {
    return static_cast<int>(bits >> shift & 1023) / static_cast<double>(kHalfTen) - 1.0;
  };
  return {coordinate(20), coordinate(10), coordinate(0)};
}

/** Number, and sums of x, y, z, xx, xy, xz, yy, yz, zz, of the place's own points within a distance,
 * in four columns, as every processor adds them. \param[in] numbers room for points */
std::array<double, 10> sumOffsets(const NearPoints& points, double reach,
                                  std::vector<std::uint32_t>& numbers) {
  constexpr std::size_t kColumns = 4;
  const auto limit = static_cast<float>(reach * reach);
  numbers.resize(points.count + kColumns);
  std::size_t count = 0;
  for (std::size_t i = 0; i < points.count; ++i) {
    numbers[count] = static_cast<std::uint32_t>(i);
    count += points.distance_sq[i] <= limit && points.own[i] != 0.0f;
  }
  std::fill_n(numbers.begin() + static_cast<std::ptrdiff_t>(count), kColumns,
              static_cast<std::uint32_t>(points.count));  // zeros
  double sums[9][kColumns] = {};
  for (std::size_t i = 0; i < count; i += kColumns) {
    for (std::size_t k = 0; k < kColumns; ++k) {
      const std::size_t at = numbers[i + k];
      const double x = points.x[at], y = points.y[at], z = points.z[at];
      sums[0][k] += x;
      sums[1][k] += y;
      sums[2][k] += z;
      sums[3][k] += x * x;
      sums[4][k] += x * y;
      sums[5][k] += x * z;
      sums[6][k] += y * y;
      sums[7][k] += y * z;
      sums[8][k] += z * z;
    }
  }
  std::array<double, 10> totals{static_cast<double>(count)};
  for (std::size_t j = 0; j < 9; ++j)
    totals[j + 1] = (sums[j][0] + sums[j][1]) + (sums[j][2] + sums[j][3]);
  return totals;
}

}  // namespace

std::size_t keepEnough(std::size_t enough, std::vector<std::uint32_t>& blocks) {
  const std::size_t stride = strideFor(blocks.size(), enough);
  if (stride == 1) return 1;
  const auto isLeftOut = [&](std::uint32_t block) { return block % stride != 0; };
  blocks.erase(std::remove_if(blocks.begin(), blocks.end(), isLeftOut), blocks.end());
  return stride;
}

BorderTest::BorderTest(const PointStore& store, const BorderConstants& constants, double noise,
                       double hole_size, float min_dot, bool edges_end, LocalSpacing& spacing,
                       PointBorders& borders)
    : store_(store),
      constants_(constants),
      noise_(noise),
      hole_size_(hole_size),
      edges_end_(edges_end),
      spacing_(spacing),
      borders_(borders) {
  side_.min_dot = min_dot;
}

bool BorderTest::isBorder(std::size_t point) {
  const std::uint32_t flag = flagOf(point);
  if (flag == kInside) return false;
  if ((flag & (kPartner | kAlone)) != 0) return (flag & kPartner) != 0;
  const bool kept = hasPartner(point, flag);
  borders_[point].store(flag | (kept ? kPartner : kAlone), std::memory_order_relaxed);
  return kept;
}

std::uint32_t BorderTest::flagOf(std::size_t point) {
  std::uint32_t flag = borders_[point].load(std::memory_order_relaxed);
  if (flag == 0) {
    flag = measure(point);
    // Another thread may have stored the same flag meanwhile, and more.
    std::uint32_t none = 0;
    if (!borders_[point].compare_exchange_strong(none, flag, std::memory_order_relaxed))
      flag = none;
  }
  return flag;
}

void BorderTest::listBlocks(const Vector3& place, double reach) {
  const float center[3] = {static_cast<float>(place[0]), static_cast<float>(place[1]),
                           static_cast<float>(place[2])};
  blocks_.clear();
  store_.tree().blocksInBall(center, static_cast<float>(reach), blocks_);
}

void BorderTest::gather(const Vector3& place, double reach) {
  listBlocks(place, reach);
  kernels::gatherOffsets(store_, blocks_, place, reach, side_, near_);
}

/** Gathers enough of the points within a reach of a place. \return whether these are all */
bool BorderTest::gatherEnough(const Vector3& place, double reach) {
  listBlocks(place, reach);
  const bool all = keepEnough(constants_.enough_blocks, blocks_) == 1;
  kernels::gatherOffsets(store_, blocks_, place, reach, side_, near_);
  return all;
}

/** Whether another border point, of about the same direction, is next to one. */
bool BorderTest::hasPartner(std::size_t point, std::uint32_t flag) {
  const Vector3 place = store_.position(point), direction = unpacked(flag);
  const double spacing = spacing_.of(point / PointStore::kBlock);
  const double reach = constants_.partner * (0.5 * hole_size_ * spacing + noise_);
  listBlocks(place, reach);
  keepEnough(constants_.enough_blocks, blocks_);
  const std::vector<std::uint32_t> blocks = blocks_;  // tests of others use the member
  for (const std::size_t b : blocks) {
    const std::size_t end = std::min((b + 1) * PointStore::kBlock, store_.size());
    for (std::size_t i = b * PointStore::kBlock; i < end; ++i) {
      const Vector3 offset = subtract(store_.position(i), place);
      if (i == point || dot(offset, offset) > reach * reach) continue;
      const std::uint32_t other = flagOf(i);
      if (other != kInside && dot(unpacked(other), direction) > 0) return true;
    }
  }
  return false;
}

/** The plane of least variance of the points around a place, and the sheet's height over it. */
SweepPlane BorderTest::findPlane(double spacing) {
  const double reach = std::max(constants_.plane * spacing, constants_.plane_noise * noise_);
  const std::array<double, 10> sums = sumOffsets(near_, reach, numbers_);
  const double n = std::max(sums[0], 1.0);
  const Eigen::Vector3d mean = Eigen::Vector3d(sums[1], sums[2], sums[3]) / n;
  Eigen::Matrix3d moments;
  moments << sums[4], sums[5], sums[6], sums[5], sums[7], sums[8], sums[6], sums[8], sums[9];
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(moments / n - mean * mean.transpose());
  SweepPlane plane;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto row = static_cast<Eigen::Index>(a);
    plane.axes[2][a] = solver.eigenvectors()(row, 0);
    plane.axes[1][a] = solver.eigenvectors()(row, 1);
  }
  plane.axes[0] = cross(plane.axes[1], plane.axes[2]);
  plane.window = constants_.window * noise_;
  // Noise alone takes the point off its sheet; where that bends, the mean is above or below it too.
  const double height = dot({mean[0], mean[1], mean[2]}, plane.axes[2]);
  plane.height = std::clamp(height, -plane.window, plane.window);
  if (!edges_end_) plane.slope = constants_.slope;
  return plane;
}

/** Whether a disc as wide as the reach touches the place and is empty of the points gathered, and
 * the middle of the interval of such discs' directions, in radians. */
bool BorderTest::findFree(double reach, double* middle) {
  std::array<float, kSweepDirections> inverse;
  kernels::sweepDirections(near_, inverse);
  const auto least = std::min_element(inverse.begin(), inverse.end());
  const auto widest = static_cast<float>(1.0 / reach);
  if (*least > widest) return false;
  const int at = static_cast<int>(least - inverse.begin());
  const auto isFree = [&](int k) {
    return inverse[static_cast<std::size_t>((k + 2 * kSweepDirections) % kSweepDirections)] <=
           widest;
  };
  int first = at, last = at;
  while (last - at < kSweepDirections - 1 && isFree(last + 1)) ++last;
  while (at - first < kSweepDirections - 1 && isFree(first - 1)) --first;
  *middle = M_PI * (first + std::min(last, first + kSweepDirections - 1)) / kSweepDirections;
  return true;
}

/** As findFree(), of all points that may be in a disc. \param[in] all whether they are gathered; else
 * a part is, and what it blocks, all of them block. */
bool BorderTest::findFreeOfAll(const Vector3& place, const SweepPlane& plane, double reach,
                               double spacing, bool all, double* middle) {
  kernels::findBlocked(plane, reach, kCoincident * spacing, near_);
  if (!findFree(reach, middle)) return false;
  if (all) return true;
  gather(place, std::hypot(reach, constants_.plane_noise * noise_));
  kernels::findBlocked(plane, reach, kCoincident * spacing, near_);
  return findFree(reach, middle);
}

/** Whether discs are empty in every plane turned about the rim, along the v axis, as well. */
bool BorderTest::isFreeTurned(SweepPlane plane, double reach, double spacing) {
  plane.window = constants_.turned_window * noise_;
  if (!edges_end_) plane.tip = constants_.tip * spacing;
  for (int k = 1; k < kTurns; ++k) {
    plane.turn = M_PI * k / kTurns;
    kernels::findBlocked(plane, reach, kCoincident * spacing, near_);
    double middle;
    if (!findFree(reach, &middle)) return false;
  }
  return true;
}

/** The spacing on a direction's side of the place that points were gathered about, within a reach:
 * of the nearest points of its sheet. \return 0 where there are fewer */
double BorderTest::halfSpacing(const Vector3& direction, double reach) {
  const auto x = static_cast<float>(direction[0]), y = static_cast<float>(direction[1]),
             z = static_cast<float>(direction[2]);
  squares_.resize(near_.count);
  std::size_t count = 0;
  for (std::size_t i = 0; i < near_.count; ++i) {
    squares_[count] = near_.distance_sq[i];
    const bool ahead = x * near_.x[i] + y * near_.y[i] + z * near_.z[i] > 0;
    count += ahead && near_.own[i] != 0.0f;
  }
  if (count < kAround) return 0;
  const double reach_sq = kernels::kthSmallest(squares_.data(), count, kAround);
  if (reach_sq > reach * reach) return 0;
  return std::sqrt(M_PI / 2 * reach_sq / static_cast<double>(kAround));
}

/** Gathers the points about a place that may be of a sheet; those of other sides count near it. */
void BorderTest::gatherSheet(const Vector3& place, double reach, const SweepPlane& plane) {
  gather(place, reach);
  if (plane.slope < 0 || !(side_.min_dot > -1)) return;
  for (std::size_t i = 0; i < near_.count; ++i) {
    const double height = dot({near_.x[i], near_.y[i], near_.z[i]}, plane.axes[2]) - plane.height;
    const double beside = std::abs(height) - plane.window;
    if (beside <= plane.slope * std::sqrt(near_.distance_sq[i])) near_.own[i] = 1.0f;
  }
}

/** Finds the nearest of the gathered points ahead of a border point. \return whether there is one */
bool BorderTest::findAhead(const Vector3& direction, double spacing, Vector3* next) const {
  double next_sq = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < near_.count; ++i) {
    const Vector3 offset{near_.x[i], near_.y[i], near_.z[i]};
    const double distance_sq = near_.distance_sq[i], ahead = dot(offset, direction);
    if (ahead <= 0 || 4 * ahead * ahead <= distance_sq || near_.own[i] == 0.0f) continue;
    if (distance_sq >= next_sq || distance_sq <= 4 * spacing * spacing) continue;
    next_sq = distance_sq;
    *next = offset;
  }
  return next_sq < std::numeric_limits<double>::max();
}

/** The spacing on either side of a border point, the larger one: behind it, and beyond the nearest
 * point ahead of it unless that is far. Most are found within a hole's diameter. */
double BorderTest::spacingAround(const Vector3& place, SweepPlane plane, const Vector3& direction,
                                 double spacing) {
  const double near = hole_size_ * spacing, far = std::max(near, constants_.across * spacing);
  // Where there are few points, as on a strip: as if the half disc of radius far were theirs.
  const double sparse = far * std::sqrt(M_PI / 2 / static_cast<double>(kAround));
  const auto orSparse = [&](double found) { return found > 0 ? found : sparse; };
  const Vector3 back = scaled(direction, -1);
  gatherSheet(place, near, plane);
  double behind = halfSpacing(back, near);
  Vector3 next{};
  bool is_ahead = findAhead(direction, spacing, &next);
  if (behind == 0 || !is_ahead) {
    gatherSheet(place, far, plane);
    if (behind == 0) behind = orSparse(halfSpacing(back, far));
    if (!is_ahead) is_ahead = findAhead(direction, spacing, &next);
  }
  if (!is_ahead) return behind;
  const Vector3 other = along(place, 1, next);
  plane.height -= dot(next, plane.axes[2]);
  gatherSheet(other, near, plane);
  double beyond = halfSpacing(direction, near);
  if (beyond == 0) {
    gatherSheet(other, far, plane);
    beyond = orSparse(halfSpacing(direction, far));
  }
  return std::max(behind, beyond);
}

/** kInside, or the direction away from the data, packed. */
std::uint32_t BorderTest::measure(std::size_t point) {
  const Vector3 place = store_.position(point);
  if (side_.min_dot > -1) side_.normal = store_.normal(point);
  double spacing = spacing_.of(point / PointStore::kBlock);
  const double plane_noise = constants_.plane_noise * noise_;
  Vector3 direction{};
  for (int step = 0; step < kSteps; ++step) {
    const double reach = hole_size_ * spacing;
    SweepPlane plane;
    if (plane_noise > reach) {  // about the point's foot
      gatherEnough(place, plane_noise);
      plane = findPlane(spacing);
      const Vector3 foot = along(place, plane.height, plane.axes[2]);
      gatherEnough(foot, plane_noise);
      plane = findPlane(spacing);
      plane.height += dot(subtract(foot, place), plane.axes[2]);
    }
    const bool all = gatherEnough(place, std::hypot(reach, plane_noise));
    if (plane_noise <= reach) plane = findPlane(spacing);
    double middle = 0;
    if (!findFreeOfAll(place, plane, reach, spacing, all, &middle)) return kInside;
    direction = along(scaled(plane.axes[0], std::cos(middle)), std::sin(middle), plane.axes[1]);
    SweepPlane rim = plane;
    rim.axes = {direction, cross(plane.axes[2], direction), plane.axes[2]};
    if (!isFreeTurned(rim, reach, spacing)) return kInside;
    const double around = spacingAround(place, plane, direction, spacing);
    if (around < constants_.step * spacing) {
      if (around <= spacing) break;
      const double wider = 0.5 * hole_size_ * (spacing + around);
      const bool all_wider = gatherEnough(place, std::hypot(wider, plane_noise));
      if (!findFreeOfAll(place, plane, wider, spacing, all_wider, &middle)) return kInside;
      break;
    }
    spacing = around;
  }
  return packed(direction);
}

}  // namespace pcl_slim::detail
