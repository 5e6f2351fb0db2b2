// SPDX-License-Identifier: BSD-3-Clause
#include "trim/border_test.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

#include "pcl_slim/cloud/detail/block_kernels.h"

namespace pcl_slim::detail {

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr int kSectors = 64;  ///< of directions, equal in the circle |u| + |v| = 1

/** Which sector a direction belongs to. */
int
sectorOf(double u, double v)
{
  const double along = v / (std::abs(u) + std::abs(v));  // -1 to 1
  const double turn = u >= 0 ? (v >= 0 ? along : 4 + along) : 2 - along;
  return static_cast<int>(turn * (kSectors / 4)) % kSectors;
}

/** Angles at which sectors begin. */
std::array<double, kSectors>
sectorAngles()
{
  std::array<double, kSectors> angles{};
  for (int k = 0; k < kSectors; ++k) {
    const double along = (k % (kSectors / 4)) * (4.0 / kSectors);
    angles[static_cast<std::size_t>(k)] =
        std::atan2(along, 1 - along) + 0.5 * kPi * (k / (kSectors / 4));
  }
  return angles;
}

const std::array<double, kSectors> kAngles = sectorAngles();

}  // namespace

BorderTest::BorderTest(const PointStore& store, const BorderConstants& constants, double noise,
                       double hole_size)
    : store_(store), constants_(constants), noise_(noise), least_disc_(constants.disc * hole_size)
{
}

/** Finds the stored points within reach of a place. \return how many. */
std::size_t
BorderTest::count(const Vector3& place, double reach)
{
  const float center[3] = {static_cast<float>(place[0]), static_cast<float>(place[1]),
                           static_cast<float>(place[2])};
  blocks_.clear();
  store_.tree().blocksInBall(center, static_cast<float>(reach), blocks_);
  const std::size_t most = (blocks_.size() + 1) * PointStore::kBlock;
  if (found_.size() < most) {
    found_.resize(most);
    distances_sq_.resize(most);
  }
  return kernels::pointsUpTo(store_, blocks_.data(), blocks_.size(), place.data(),
                             static_cast<float>(reach * reach), distances_sq_.data(),
                             found_.data());
}

/** The offsets of the stored points within reach of a place. */
void
BorderTest::gather(const Vector3& place, double reach)
{
  reach_ = reach;
  offsets_.resize(count(place, reach));
  for (std::size_t k = 0; k < offsets_.size(); ++k)
    offsets_[k] = subtract(store_.position(found_[k]), place);
}

/** Neighbours enough for a plane and for sectors, and wider than the noise is thick. */
void
BorderTest::gatherNear(const Vector3& place, double spacing)
{
  const double thick = constants_.noise * noise_;
  const auto enough = static_cast<double>(constants_.least_points);
  gather(place, std::max(constants_.near * spacing, thick));
  const auto count = static_cast<double>(offsets_.size());
  if (count > 4 * enough && reach_ > thick)
    gather(place, std::max(thick, reach_ * std::sqrt(2 * enough / count)));
  for (int pass = 0; pass < 8 && offsets_.size() < constants_.least_points; ++pass)
    gather(place, 1.5 * reach_);
}

void
BorderTest::findPlane()
{
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  for (const Vector3& offset : offsets_) {
    const Eigen::Map<const Eigen::Vector3d> p(offset.data());
    mean += p;
    moments += p * p.transpose();
  }
  const double n = static_cast<double>(offsets_.size());
  mean /= n;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes;
  axes.computeDirect(moments / n - mean * mean.transpose());
  for (std::size_t a = 0; a < 3; ++a) {
    const auto row = static_cast<Eigen::Index>(a);
    w_[a] = axes.eigenvectors()(row, 0);
    v_[a] = axes.eigenvectors()(row, 1);
  }
  u_ = cross(v_, w_);
}

void
BorderTest::project()
{
  flat_.clear();
  for (const Vector3& offset : offsets_)
    flat_.push_back({dot(offset, u_), dot(offset, v_), dot(offset, w_)});
}

/** The widest angle without neighbours, in radians, and its middle. Those next to the place point
 * anywhere. */
double
BorderTest::widestSector(double* direction) const
{
  std::uint64_t taken = 0;
  const double least_sq = constants_.blind * constants_.blind * reach_ * reach_;
  for (const Neighbor& p : flat_)
    if (p.u * p.u + p.v * p.v > least_sq) taken |= std::uint64_t{1} << sectorOf(p.u, p.v);
  if (taken == 0) return 2 * kPi;
  double widest = 0;
  int first = 0;
  while ((taken >> first & 1) == 0) ++first;
  for (int k = first + 1, begin = first + 1; k <= first + kSectors; ++k) {
    if ((taken >> (k % kSectors) & 1) == 0) continue;
    const double from = kAngles[static_cast<std::size_t>(begin % kSectors)];
    double to = kAngles[static_cast<std::size_t>(k % kSectors)];
    if (k > begin && to <= from) to += 2 * kPi;
    if (k > begin && to - from > widest) {
      widest = to - from;
      *direction = 0.5 * (from + to);
    }
    begin = k + 1;
  }
  return widest;
}

/** Whether a neighbour belongs to the sheet of the place: what is steeply over or under it does not. */
bool
BorderTest::isOfSheet(const Neighbor& p) const
{
  const double thick = constants_.noise * noise_;
  return p.w * p.w <= p.u * p.u + p.v * p.v + thick * thick;
}

/** Measures the widest empty discs that touch the place, at most as wide as the reach. */
void
BorderTest::findDiscs(std::array<Disc, 3>& discs) const
{
  for (Disc& disc : discs) {
    disc.u = std::cos(disc.direction);
    disc.v = std::sin(disc.direction);
    disc.width = reach_;
    disc.next = nullptr;
    disc.next_sq = reach_ * reach_;
  }
  for (const Neighbor& p : flat_) {
    if (!isOfSheet(p)) continue;
    const double square = p.u * p.u + p.v * p.v;
    for (Disc& disc : discs) {
      const double ahead = disc.u * p.u + disc.v * p.v;
      if (ahead <= 0) continue;
      if (square < disc.width * ahead) disc.width = square / ahead;
      if (square < disc.next_sq && 4 * ahead * ahead > square) {
        disc.next_sq = square;
        disc.next = &p;
      }
    }
  }
}

/** Whether the points at a rim, which have a half disc of neighbours, have a given spacing or less. */
bool
BorderTest::isAsDense(const Vector3& place, double spacing)
{
  const double expected = 0.5 * kPi * constants_.near * constants_.near;
  return static_cast<double>(count(place, constants_.near * spacing)) >
         constants_.rim_share * expected;
}

bool
BorderTest::endsAt(const Vector3& place, double spacing)
{
  gatherNear(place, spacing);
  if (offsets_.size() < constants_.least_points) return true;
  findPlane();
  project();
  double middle = 0;
  const double sector = widestSector(&middle);
  if (sector < constants_.sector) return false;
  const double filled = 0.5 * reach_ * reach_ * (2 * kPi - sector);
  const double own = std::max(spacing, std::sqrt(filled / static_cast<double>(offsets_.size())));
  const double least = least_disc_ * own;
  std::array<Disc, 3> discs;
  discs[0].direction = middle;
  discs[1].direction = middle - constants_.turn;
  discs[2].direction = middle + constants_.turn;
  findDiscs(discs);
  const double least_near = std::min(reach_, least);
  if (std::none_of(discs.begin(), discs.end(),
                   [&](const Disc& disc) { return disc.width >= least_near; }))
    return false;
  gather(place, constants_.far * own);
  project();
  findDiscs(discs);
  return std::any_of(discs.begin(), discs.end(), [&](const Disc& disc) {
    if (disc.width < least) return false;
    if (disc.next == nullptr) return true;
    const Vector3 other =
        along(along(along(place, disc.next->u, u_), disc.next->v, v_), disc.next->w, w_);
    return isAsDense(other, disc.width / least_disc_);
  });
}

}  // namespace pcl_slim::detail
