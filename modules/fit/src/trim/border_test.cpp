// SPDX-License-Identifier: BSD-3-Clause
#include "trim/border_test.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "pcl_slim/cloud/detail/block_kernels.h"

namespace pcl_slim::detail {

namespace {

constexpr double kWidest = 2.0;  ///< local length: no cloud is wider
constexpr float kNoBorder = -1.0f;
constexpr float kAny = std::numeric_limits<float>::infinity();

/** Angles at which sectors begin. */
std::array<double, kBorderSectors>
sectorAngles()
{
  std::array<double, kBorderSectors> angles{};
  for (int k = 0; k < kBorderSectors; ++k) {
    const double along = (k % (kBorderSectors / 4)) * (4.0 / kBorderSectors);
    const int quarter = k / (kBorderSectors / 4);
    angles[static_cast<std::size_t>(k)] = std::atan2(along, 1 - along) + 0.5 * M_PI * quarter;
  }
  return angles;
}

const std::array<double, kBorderSectors> kAngles = sectorAngles();

/** The widest angle between sectors that are taken, in radians, and its middle. */
double
widestSector(std::uint64_t taken, double* middle)
{
  if (taken == 0) return 2 * M_PI;
  double widest = 0;
  const int first = __builtin_ctzll(taken);
  int begin = first + 1;
  for (int k = first + 1; k <= first + kBorderSectors; ++k) {
    if ((taken >> (k % kBorderSectors) & 1) == 0) continue;
    const double from = kAngles[static_cast<std::size_t>(begin % kBorderSectors)];
    double to = kAngles[static_cast<std::size_t>(k % kBorderSectors)];
    if (k > begin && to <= from) to += 2 * M_PI;
    if (k > begin && to - from > widest) {
      widest = to - from;
      *middle = 0.5 * (from + to);
    }
    begin = k + 1;
  }
  return widest;
}

constexpr std::uint32_t kNoPlane = 0;  // no unit normal has this code
constexpr int kHalfTen = 511;          ///< ten bits hold -1 to 1 in as many steps to each side

std::uint32_t
packed(const Vector3& normal)
{
  std::uint32_t bits = 0;
  for (const double x : normal)
    bits = bits << 10 | static_cast<std::uint32_t>(std::lround(kHalfTen * (1.0 + x)));
  return bits;
}

Vector3
unpacked(std::uint32_t bits)
{
  const auto coordinate = [&](int shift) {
    return static_cast<int>(bits >> shift & 1023) / static_cast<double>(kHalfTen) - 1.0;
  };
  return {coordinate(20), coordinate(10), coordinate(0)};
}

/** Sums of x, y, z, xx, xy, xz, yy, yz, zz in four columns, as every processor adds them. */
std::array<double, 9>
sumOffsets(const NearPoints& points)
{
  constexpr std::size_t kColumns = 4;
  double sums[9][kColumns] = {};
  for (std::size_t i = 0; i < points.count; i += kColumns) {  // zeros pad the last columns
    for (std::size_t k = 0; k < kColumns; ++k) {
      const double x = points.x[i + k], y = points.y[i + k], z = points.z[i + k];
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
  std::array<double, 9> totals;
  for (std::size_t j = 0; j < 9; ++j)
    totals[j] = (sums[j][0] + sums[j][1]) + (sums[j][2] + sums[j][3]);
  return totals;
}

}  // namespace

BorderTest::BorderTest(const PointStore& store, const BorderConstants& constants, double noise,
                       double hole_size, float min_dot, PointBorders& borders)
    : store_(store),
      constants_(constants),
      thick_(constants.noise * noise),
      least_disc_(constants.disc * hole_size),
      side_{{}, min_dot},
      borders_(borders)
{
}

bool
BorderTest::endsAt(std::size_t point, double spacing, const Vector3& normal)
{
  PointBorder& border = borders_[point];
  float largest = border.spacing.load(std::memory_order_acquire);
  if (largest == 0.0f) {
    largest = measure(point, spacing);
    border.plane.store(plane_, std::memory_order_relaxed);
    border.spacing.store(largest, std::memory_order_release);
  }
  if (spacing <= largest) return true;
  const std::uint32_t bits = border.plane.load(std::memory_order_relaxed);
  if (bits == kNoPlane) return false;
  const Vector3 plane = unpacked(bits);
  return std::abs(dot(plane, normal)) < constants_.edge;
}

void
BorderTest::gather(const Vector3& place, double reach)
{
  reach_ = reach;
  const float center[3] = {static_cast<float>(place[0]), static_cast<float>(place[1]),
                           static_cast<float>(place[2])};
  blocks_.clear();
  store_.tree().blocksInBall(center, static_cast<float>(reach), blocks_);
  kernels::gatherOffsets(store_, blocks_, place, reach, side_, near_);
}

/** The nearest neighbours, enough for a plane and for sectors, and those within the noise's thickness.
 * \param[in] reach to begin with; the outcome does not depend on it. \return whether there are enough. */
bool
BorderTest::gatherNear(const Vector3& place, double reach)
{
  const std::size_t enough = constants_.near_points;
  gather(place, std::max(reach, thick_));
  while (near_.count < enough && reach_ < kWidest) gather(place, 1.5 * reach_);
  if (near_.count < enough) return false;
  const double nearest = std::sqrt(
      static_cast<double>(kernels::kthSmallest(near_.distance_sq.data(), near_.count, enough)));
  const double least = std::max(nearest, thick_);
  if (least < reach_) kernels::gatherOffsets(store_, blocks_, place, least, side_, near_);
  reach_ = least;
  return true;
}

void
BorderTest::findPlane()
{
  const double n = static_cast<double>(near_.count);
  const std::array<double, 9> sums = sumOffsets(near_);
  const Eigen::Vector3d mean = Eigen::Vector3d(sums[0], sums[1], sums[2]) / n;
  Eigen::Matrix3d moments;
  moments << sums[3], sums[4], sums[5], sums[4], sums[6], sums[7], sums[5], sums[7], sums[8];
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(moments / n - mean * mean.transpose());
  for (std::size_t a = 0; a < 3; ++a) {
    const auto row = static_cast<Eigen::Index>(a);
    axes_[2][a] = solver.eigenvectors()(row, 0);
    axes_[1][a] = solver.eigenvectors()(row, 1);
  }
  axes_[0] = cross(axes_[1], axes_[2]);
}

/** The discs in the middle of the empty sector and to either side, at most as wide as the reach. */
void
BorderTest::findDiscs(double middle, std::array<EmptyDisc, 3>& discs) const
{
  for (std::size_t k = 0; k < 3; ++k) {
    const double direction = middle + constants_.turn * (static_cast<double>(k) - 1.0);
    discs[k].u = static_cast<float>(std::cos(direction));
    discs[k].v = static_cast<float>(std::sin(direction));
    discs[k].width = static_cast<float>(reach_);
    discs[k].next_sq = static_cast<float>(reach_ * reach_);
    discs[k].next = -1;
    kernels::findDisc(near_, thick_, discs[k]);
  }
}

/** Whether the points at a rim, which have a half disc of neighbours, have a given spacing or less. */
bool
BorderTest::isAsDense(const Vector3& place, double spacing)
{
  const double reach = constants_.near * spacing;
  const float center[3] = {static_cast<float>(place[0]), static_cast<float>(place[1]),
                           static_cast<float>(place[2])};
  blocks_.clear();
  store_.tree().blocksInBall(center, static_cast<float>(reach), blocks_);
  const std::size_t most = (blocks_.size() + 1) * PointStore::kBlock;
  found_.resize(std::max(found_.size(), most));
  distances_sq_.resize(std::max(distances_sq_.size(), most));
  const auto count = static_cast<double>(
      kernels::pointsUpTo(store_, blocks_.data(), blocks_.size(), place.data(),
                          static_cast<float>(reach * reach), distances_sq_.data(), found_.data()));
  return count > constants_.rim_share * 0.5 * M_PI * constants_.near * constants_.near;
}

/** The spacing that the gathered neighbours have, and the direction of the widest sector without any.
 * \return 0 if none is wide enough for a border */
double
BorderTest::findSector(double* middle)
{
  const double sector =
      widestSector(kernels::projectOffsets(axes_, constants_.blind * reach_, near_), middle);
  if (sector < constants_.sector) return 0;
  const double filled = 0.5 * reach_ * reach_ * (2 * M_PI - sector);
  return std::sqrt(filled / static_cast<double>(near_.count));
}

/** The largest spacing at which the data end at a point, kNoBorder if they do not.
 * \param[in] spacing about that of the points; the outcome does not depend on it */
float
BorderTest::measure(std::size_t point, double spacing)
{
  const Vector3 place = store_.position(point);
  if (side_.min_dot > -1) side_.normal = store_.normal(point);
  plane_ = kNoPlane;
  // A half disc of neighbours, and some more.
  const double guess = std::sqrt(3.0 / M_PI * static_cast<double>(constants_.near_points));
  if (!gatherNear(place, guess * spacing)) return kAny;
  findPlane();
  if (thick_ < constants_.exact * reach_) plane_ = packed(axes_[2]);
  double middle = 0;
  const double own = findSector(&middle), least = least_disc_ * own;
  if (own == 0) return kNoBorder;
  std::array<EmptyDisc, 3> discs;
  findDiscs(middle, discs);
  const double least_near = std::min(reach_, least);
  const auto isNarrow = [&](const EmptyDisc& disc) { return disc.width < least_near; };
  if (std::all_of(discs.begin(), discs.end(), isNarrow)) return kNoBorder;
  gather(place, constants_.far * own);
  kernels::projectOffsets(axes_, 0.0, near_);
  findDiscs(middle, discs);
  float largest = kNoBorder;
  for (const EmptyDisc& disc : discs)
    if (disc.width >= least) largest = std::max(largest, spacingAcross(place, disc));
  return largest;
}

/** The largest spacing at which an empty disc, of at most the reach, is a border and no chance: of points on
 * its other side, if there are any. */
float
BorderTest::spacingAcross(const Vector3& place, const EmptyDisc& disc)
{
  const auto spacing = static_cast<float>(disc.width / least_disc_);
  if (disc.next < 0) return disc.width < static_cast<float>(reach_) ? spacing : kAny;
  const auto next = static_cast<std::size_t>(disc.next);
  const Vector3 other{place[0] + near_.x[next], place[1] + near_.y[next], place[2] + near_.z[next]};
  return isAsDense(other, spacing) ? spacing : kNoBorder;
}

}  // namespace pcl_slim::detail
