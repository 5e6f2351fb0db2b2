// SPDX-License-Identifier: BSD-3-Clause
// The loops over a point's neighbours, compiled for each instruction set, and the test that uses
// them.
#include "trim/trim.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "pcl_slim/cloud/detail/block_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "trim/border_test.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

#include "pcl_slim/core/detail/lane_packing-inl.h"
#include "pcl_slim/surface/detail/kernel_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/** Collects the points of some blocks within a distance of a place, those of its side. */
void gatherOffsets(const PointStore& store, const std::vector<std::uint32_t>& blocks,
                   const Vector3& place, double reach, const PlaceSide& side, NearPoints& points) {
  const Tag d;
  const auto limit = set(static_cast<float>(reach * reach));
  points.reserve(blocks.size() * PointStore::kBlock);
  std::size_t count = 0;
  for (const std::size_t b : blocks) {
    const auto sx = set(static_cast<float>(store.blockOriginX()[b] - place[0]));
    const auto sy = set(static_cast<float>(store.blockOriginY()[b] - place[1]));
    const auto sz = set(static_cast<float>(store.blockOriginZ()[b] - place[2]));
    for (std::size_t i = b * PointStore::kBlock; i < (b + 1) * PointStore::kBlock;
         i += hn::Lanes(d)) {
      const auto dx = Load(d, store.x() + i) + sx;
      const auto dy = Load(d, store.y() + i) + sy;
      const auto dz = Load(d, store.z() + i) + sz;
      const auto distance_sq = dot3(dx, dy, dz, dx, dy, dz);
      auto near = distance_sq <= limit;
      if (AllFalse(d, near)) continue;
      if (side.min_dot > -1) {
        const auto cosine =
            dot3(Load(d, store.nx() + i), Load(d, store.ny() + i), Load(d, store.nz() + i),
                 set(side.normal[0]), set(side.normal[1]), set(side.normal[2]));
        near = And(near, cosine > set(side.min_dot));
      }
      if (AllFalse(d, near)) continue;
      const LanePacking packing(d, near);
      packing.store(dx, points.x.data() + count);
      packing.store(dy, points.y.data() + count);
      packing.store(dz, points.z.data() + count);
      packing.store(distance_sq, points.distance_sq.data() + count);
      count += packing.count();
    }
  }
  points.count = count;
  for (auto* column : {&points.x, &points.y, &points.z}) {
    StoreU(Zero(d), d, column->data() + count);
  }
}

/** The sectors of directions; 0 where a lane does not count. */
HWY_INLINE hn::Vec<hn::RebindToSigned<Tag>> sectorsOf(Vec u, Vec v, Mask counts) {
  const Tag d;
  const hn::RebindToSigned<Tag> di;
  const auto along = v / (Abs(u) + Abs(v));  // -1 to 1
  const auto right = along + IfThenElseZero(along < Zero(d), set(4.0f));
  const auto turn = IfThenElse(u >= Zero(d), right, set(2.0f) - along);
  const auto sector = IfThenElseZero(counts, turn * set(kBorderSectors / 4.0f));
  return ConvertTo(di, sector) & Set(di, kBorderSectors - 1);
}

/** Brings offsets into the axes u, v, w. \return bit k: sector k has a point whose distance from
 * the place, in the plane, exceeds blind. */
std::uint64_t projectOffsets(const std::array<Vector3, 3>& axes, double blind, NearPoints& points) {
  const Tag d;
  const hn::RebindToSigned<Tag> di;
  const auto axis = [&](std::size_t k, std::size_t a)
                        HWY_ATTR { return set(static_cast<float>(axes[k][a])); };
  const auto ux = axis(0, 0), uy = axis(0, 1), uz = axis(0, 2);
  const auto vx = axis(1, 0), vy = axis(1, 1), vz = axis(1, 2);
  const auto wx = axis(2, 0), wy = axis(2, 1), wz = axis(2, 2);
  const auto blind_sq = set(static_cast<float>(blind * blind));
  std::uint64_t taken = 0;
  HWY_ALIGN std::int32_t sectors[HWY_MAX_BYTES / 4];
  for (std::size_t i = 0; i < points.count; i += hn::Lanes(d)) {
    const auto x = Load(d, points.x.data() + i), y = Load(d, points.y.data() + i),
               z = Load(d, points.z.data() + i);
    const auto u = dot3(x, y, z, ux, uy, uz), v = dot3(x, y, z, vx, vy, vz);
    Store(u, d, points.u.data() + i);
    Store(v, d, points.v.data() + i);
    Store(dot3(x, y, z, wx, wy, wz), d, points.w.data() + i);
    const auto far = MulAdd(u, u, v * v) > blind_sq;
    Store(sectorsOf(u, v, far), di, sectors);
    std::uint8_t bits[8] = {};
    StoreMaskBits(d, far, bits);
    for (unsigned mask = bits[0] | static_cast<unsigned>(bits[1]) << 8; mask != 0;
         mask &= mask - 1) {
      taken |= std::uint64_t{1} << sectors[__builtin_ctz(mask)];
    }
  }
  return taken;
}

/** Takes the lane of the nearest point, the first of equally near ones. */
HWY_INLINE void takeNearest(Vec squares, hn::Vec<hn::RebindToSigned<Tag>> numbers,
                            EmptyDisc& disc) {
  const Tag d;
  HWY_ALIGN float square[HWY_MAX_BYTES / 4];
  HWY_ALIGN std::int32_t number[HWY_MAX_BYTES / 4];
  Store(squares, d, square);
  Store(numbers, hn::RebindToSigned<Tag>(), number);
  for (std::size_t k = 0; k < hn::Lanes(d); ++k) {
    if (number[k] < 0 || square[k] > disc.next_sq) continue;
    if (square[k] == disc.next_sq && disc.next >= 0 && number[k] > disc.next) continue;
    disc.next_sq = square[k];
    disc.next = number[k];
  }
}

/** Narrows a disc to the points of the place's sheet: those no higher over the plane than away from
 * the place, or than thick. Its width and next_sq are upper bounds before. */
void findDisc(const NearPoints& points, double thick, EmptyDisc& disc) {
  const Tag d;
  const hn::RebindToSigned<Tag> di;
  const auto thick_sq = set(static_cast<float>(thick * thick));
  const auto du = set(disc.u), dv = set(disc.v);
  auto width = set(disc.width), next_sq = set(disc.next_sq);
  auto next = Set(di, -1);
  for (std::size_t i = 0; i < points.count; i += hn::Lanes(d)) {
    const auto u = Load(d, points.u.data() + i), v = Load(d, points.v.data() + i),
               w = Load(d, points.w.data() + i);
    const auto square = MulAdd(u, u, v * v);
    const auto ahead = MulAdd(du, u, dv * v);
    const auto counts = And(w * w <= square + thick_sq, ahead > Zero(d));
    width = IfThenElse(counts, Min(width, square / ahead), width);
    const auto within = set(4.0f) * (ahead * ahead) > square;
    const auto nearer = And(counts, And(square < next_sq, within));
    next_sq = IfThenElse(nearer, square, next_sq);
    next = IfThenElse(RebindMask(di, nearer), Iota(di, static_cast<std::int32_t>(i)), next);
  }
  disc.width = GetLane(MinOfLanes(d, width));
  takeNearest(next_sq, next, disc);
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_slim::detail {

void NearPoints::reserve(std::size_t capacity) {
  constexpr std::size_t kPadding = 2 * PointStore::kBlock;
  if (x.size() >= capacity + kPadding) return;
  const std::size_t grown = capacity + capacity / 2 + kPadding;
  for (auto* column : {&x, &y, &z, &distance_sq, &u, &v, &w}) column->resize(grown);
}

namespace kernels {

HWY_EXPORT(gatherOffsets);
HWY_EXPORT(projectOffsets);
HWY_EXPORT(findDisc);

void gatherOffsets(const PointStore& store, const std::vector<std::uint32_t>& blocks,
                   const Vector3& place, double reach, const PlaceSide& side, NearPoints& points) {
  HWY_DYNAMIC_DISPATCH(gatherOffsets)(store, blocks, place, reach, side, points);
}

std::uint64_t projectOffsets(const std::array<Vector3, 3>& axes, double blind, NearPoints& points) {
  return HWY_DYNAMIC_DISPATCH(projectOffsets)(axes, blind, points);
}

void findDisc(const NearPoints& points, double thick, EmptyDisc& disc) {
  HWY_DYNAMIC_DISPATCH(findDisc)(points, thick, disc);
}

}  // namespace kernels

namespace {

constexpr double kWidest = 2.0;  ///< local length: no cloud is wider
constexpr float kNoBorder = -1.0f;
constexpr float kAny = std::numeric_limits<float>::infinity();

/** Angles at which sectors begin. */
std::array<double, kBorderSectors> sectorAngles() {
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
double widestSector(std::uint64_t taken, double* middle) {
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
constexpr int kHalfTen = 511;          ///< ten bits encode -1 to 1 in this many steps to each side

std::uint32_t packed(const Vector3& normal) {
  std::uint32_t bits = 0;
  for (const double x : normal)
    bits = bits << 10 | static_cast<std::uint32_t>(std::lround(kHalfTen * (1.0 + x)));
  return bits;
}

Vector3 unpacked(std::uint32_t bits) {
  const auto coordinate = [&](int shift) {
    return static_cast<int>(bits >> shift & 1023) / static_cast<double>(kHalfTen) - 1.0;
  };
  return {coordinate(20), coordinate(10), coordinate(0)};
}

/** Sums of x, y, z, xx, xy, xz, yy, yz, zz in four columns, as every processor adds them. */
std::array<double, 9> sumOffsets(const NearPoints& points) {
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
      borders_(borders) {}

bool BorderTest::endsAt(std::size_t point, double spacing, const Vector3& normal) {
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

void BorderTest::gather(const Vector3& place, double reach) {
  reach_ = reach;
  const float center[3] = {static_cast<float>(place[0]), static_cast<float>(place[1]),
                           static_cast<float>(place[2])};
  blocks_.clear();
  store_.tree().blocksInBall(center, static_cast<float>(reach), blocks_);
  kernels::gatherOffsets(store_, blocks_, place, reach, side_, near_);
}

/** The nearest neighbours, enough for a plane and for sectors, and those within the noise's
 * thickness.
 * \param[in] reach to begin with; the outcome does not depend on it. \return whether there are
 * enough. */
bool BorderTest::gatherNear(const Vector3& place, double reach) {
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

void BorderTest::findPlane() {
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
void BorderTest::findDiscs(double middle, std::array<EmptyDisc, 3>& discs) const {
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

/** Whether the points at a rim, which have a half disc of neighbours, have a given spacing or less.
 */
bool BorderTest::isAsDense(const Vector3& place, double spacing) {
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

/** The spacing that the gathered neighbours have, and the direction of the widest sector without
 * any.
 * \return 0 if none is wide enough for a border */
double BorderTest::findSector(double* middle) {
  const double sector =
      widestSector(kernels::projectOffsets(axes_, constants_.blind * reach_, near_), middle);
  if (sector < constants_.sector) return 0;
  const double filled = 0.5 * reach_ * reach_ * (2 * M_PI - sector);
  return std::sqrt(filled / static_cast<double>(near_.count));
}

/** The largest spacing at which the data end at a point, kNoBorder if they do not.
 * \param[in] spacing about that of the points; the outcome does not depend on it */
float BorderTest::measure(std::size_t point, double spacing) {
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

/** The largest spacing at which an empty disc, of at most the reach, is a border and no chance: of
 * points on its other side, if there are any. */
float BorderTest::spacingAcross(const Vector3& place, const EmptyDisc& disc) {
  const auto spacing = static_cast<float>(disc.width / least_disc_);
  if (disc.next < 0) return disc.width < static_cast<float>(reach_) ? spacing : kAny;
  const auto next = static_cast<std::size_t>(disc.next);
  const Vector3 other{place[0] + near_.x[next], place[1] + near_.y[next], place[2] + near_.z[next]};
  return isAsDense(other, spacing) ? spacing : kNoBorder;
}

}  // namespace pcl_slim::detail
#endif
