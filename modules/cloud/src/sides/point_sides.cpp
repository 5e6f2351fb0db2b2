// SPDX-License-Identifier: BSD-3-Clause
// Sides of single points by their nearest points, and points on local planes (docs/sides.md,
// "Sides before the cover", "Points" and "Feet").
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "noise/patch.h"
#include "pcl_slim/cloud/detail/sides.h"
#include "pcl_slim/cloud/knn.h"
#include "pcl_slim/core/parallel.h"

namespace pcl_slim::detail {

namespace {

/// Factor of the last point's squared search radius that probably suffices for the next point.
constexpr float kRadiusMargin = 1.4f;
/// Number of nearest points that decide which sheet a point is on.
constexpr std::size_t kNearest = 32;

using Normal = std::array<float, 3>;
using Normals = std::vector<Normal>;

Eigen::Vector3f normalAt(const Normals& normals, std::size_t i) {
  return {normals[i][0], normals[i][1], normals[i][2]};
}

/** Sums for a least-squares plane of heights over two coordinates, relative to a point. */
class PlaneSums {
 public:
  static constexpr std::size_t kCoefficients = 3;

  void add(const Eigen::Vector3d& at) {
    const Eigen::Vector3d terms(1, at[1], at[2]);
    products_ += terms * terms.transpose();
    right_ += at[0] * terms;
    squares_ += at[0] * at[0];
    ++count_;
  }

  std::size_t count() const { return count_; }
  /** Whether there are twice as many points as coefficients. */
  bool determined() const { return count_ >= 2 * kCoefficients; }

  /** The plane. \return its height at the point, and its two slopes */
  Eigen::Vector3d plane() const { return products_.ldlt().solve(right_); }

  /** Sum of the squared residuals from the plane. */
  double squaredResiduals(const Eigen::Vector3d& plane) const {
    return std::max(0.0, squares_ - plane.dot(right_));
  }

 private:
  Eigen::Matrix3d products_ = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right_ = Eigen::Vector3d::Zero();
  double squares_ = 0;
  std::size_t count_ = 0;
};

/** A right-handed frame whose first axis is a normal. */
Eigen::Matrix3d axesOf(const Eigen::Vector3f& own) {
  const Eigen::Vector3d normal = own.cast<double>(), u = normal.unitOrthogonal();
  Eigen::Matrix3d axes;
  axes << normal, u, normal.cross(u);
  return axes;
}

/** The kNearest nearest points of some points, themselves included: rounds look at them again and
 * again. */
class NearestPoints {
 public:
  /** A list of points. */
  struct List {
    const std::uint32_t *first, *last;

    const std::uint32_t* begin() const { return first; }
    const std::uint32_t* end() const { return last; }
    std::size_t size() const { return static_cast<std::size_t>(last - first); }
  };

  /** \param[in] listOf called once for each of the points, by several threads */
  template <class ListOf>
  void collect(const std::vector<std::uint32_t>& points, std::size_t stored, int threads,
               const ListOf& listOf) {
    constexpr std::size_t kTask = 256;
    each_ = std::min(kNearest, stored);
    lists_.resize(each_ * points.size());
    parallelFor(points.size(), threads, kTask, [&](std::size_t k, int thread) {
      const List list = listOf(points[k], thread);
      std::copy(list.begin(), list.end(), lists_.begin() + static_cast<std::ptrdiff_t>(each_ * k));
    });
    index_.assign(stored, kNone);
    for (std::size_t k = 0; k < points.size(); ++k)
      index_[points[k]] = static_cast<std::uint32_t>(k);
  }

  bool has(std::size_t point) const { return !index_.empty() && index_[point] != kNone; }
  List of(std::size_t point) const {
    const std::uint32_t* const first = lists_.data() + each_ * index_[point];
    return {first, first + each_};
  }

 private:
  static constexpr std::uint32_t kNone = 0xffffffffu;

  std::size_t each_ = 0;
  std::vector<std::uint32_t> index_;  ///< of each stored point's list
  std::vector<std::uint32_t> lists_;
};

/** Decides which sheet a point is on, one point at a time. Each thread has one. */
class SheetChoice {
 public:
  using Points = NearestPoints::List;

  /** \param[in] known lists, which may be collected later */
  SheetChoice(const PointStore& store, const NearestPoints& known)
      : store_(store), known_(known), search_(store) {}

  /** The nearest points of a stored point, itself included. \param[in] factor of kNearest */
  Points nearest(std::size_t point, std::size_t factor = 1) {
    if (factor == 1 && known_.has(point)) return near_ = known_.of(point);
    const std::size_t count = factor * kNearest;
    const float about = kRadiusMargin * static_cast<float>(count) * reach_sq_;
    reach_sq_ = search_.nearestSet(point, count, found_, about) / static_cast<float>(count);
    return near_ = {found_.data(), found_.data() + found_.size()};
  }

  /** Whether one of two points of a block is near points that face the other way. */
  bool facesOthers(const Normals& normals, std::size_t block) {
    constexpr std::size_t kProbes[] = {PointStore::kBlock / 4, 3 * PointStore::kBlock / 4};
    for (const std::size_t probe : kProbes) {
      const std::size_t i = std::min(block * PointStore::kBlock + probe, store_.size() - 1);
      const Eigen::Vector3f own = normalAt(normals, i);
      const auto faces = [&](std::uint32_t j) { return own.dot(normalAt(normals, j)) < 0; };
      const Points near = nearest(i, 2);
      if (std::any_of(near.begin(), near.end(), faces)) return true;
    }
    return false;
  }

  /** The normal of a point on the sheet that the point is on. */
  Eigen::Vector3f settled(const Normals& normals, std::size_t point) {
    nearest(point);
    const Eigen::Vector3f own = straightened(normals, point);
    return isOnOther(normals, point, own) ? Eigen::Vector3f(-own) : own;
  }

  /** The normal of the plane through the neighbours that face as the point does. */
  Eigen::Vector3f planeNormal(const Normals& normals, std::size_t point) {
    nearest(point);
    Eigen::Vector3f own = normalAt(normals, point);
    sortByFacing(normals, point, own);
    const PlaneSums same = sumsOf(point, same_, own);
    if (!same.determined()) return own;
    const Eigen::Vector3d plane = same.plane(), normal(1, -plane[1], -plane[2]);
    return (axesOf(own) * normal).normalized().cast<float>();
  }

 private:
  /** A point's normal; the common direction of its neighbours' normals if they have one and the
   * point's differs from it. Cells of few points or of two sheets have arbitrary normals. */
  Eigen::Vector3f straightened(const Normals& normals, std::size_t point) const {
    // Mean squared cosine to the neighbours' normals below which a normal is replaced.
    constexpr float kLeastAlignment = 0.5f;
    // Share of the squares of the neighbours' normals along one direction that is common.
    constexpr float kCommonDirection = 0.6f;
    Eigen::Vector3f own = normalAt(normals, point);
    Eigen::Matrix3f products = Eigen::Matrix3f::Zero();
    for (const std::uint32_t j : near_) {
      const Eigen::Vector3f n = normalAt(normals, j);
      products += n * n.transpose();
    }
    const float all = products.trace();
    if (own.dot(products * own) > kLeastAlignment * all) return own;
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> axes;
    axes.computeDirect(products);
    if (!(axes.eigenvalues()[2] > kCommonDirection * all)) return own;
    const Eigen::Vector3f common = axes.eigenvectors().col(2);
    return own.dot(common) < 0 ? Eigen::Vector3f(-common) : common;
  }

  /** Sorts a point's neighbours into those that face as a normal does and the others. */
  void sortByFacing(const Normals& normals, std::size_t point, const Eigen::Vector3f& own) {
    same_.clear();
    others_.clear();
    for (const std::uint32_t j : near_) {
      const float cosine = own.dot(normalAt(normals, j));
      if (cosine < 0) others_.push_back(j);
      if (cosine > 0 && j != point) same_.push_back(j);
    }
  }

  /** Whether a point is on the sheet of the neighbours that face the other way: their plane is
   * nearer than that of the others by more than the residuals explain. */
  bool isOnOther(const Normals& normals, std::size_t point, const Eigen::Vector3f& own) {
    sortByFacing(normals, point, own);
    const PlaneSums other = sumsOf(point, others_, own);
    if (!other.determined()) return false;
    const PlaneSums same = sumsOf(point, same_, own);
    if (!same.determined()) return 2 * others_.size() > near_.size();
    const Eigen::Vector3d here = same.plane(), there = other.plane();
    const auto freedom =
        static_cast<double>(same.count() + other.count() - 2 * PlaneSums::kCoefficients);
    return here[0] * here[0] - there[0] * there[0] >
           (same.squaredResiduals(here) + other.squaredResiduals(there)) / freedom;
  }

  /** Plane sums of some points, with heights along a normal. */
  PlaneSums sumsOf(std::size_t point, const std::vector<std::uint32_t>& points,
                   const Eigen::Vector3f& own) const {
    const Eigen::Matrix3d axes = axesOf(own);
    const auto center = store_.position(point);
    PlaneSums sums;
    for (const std::uint32_t j : points) {
      const auto p = store_.position(j);
      const Eigen::Vector3d offset(p[0] - center[0], p[1] - center[1], p[2] - center[2]);
      sums.add(axes.transpose() * offset);
    }
    return sums;
  }

  const PointStore& store_;
  const NearestPoints& known_;
  NeighborSearch search_;
  Points near_{};
  std::vector<std::uint32_t> found_, same_, others_;
  float reach_sq_ = 0;  ///< squared radius of the last search over its number of points
};

/** The points of blocks near points that face the other way, without those on rods. */
std::vector<std::uint32_t> pointsFacingOthers(const PointStore& store,
                                              const std::vector<char>& on_rods,
                                              const Normals& normals,
                                              std::vector<SheetChoice>& choices) {
  std::vector<char> faces(store.numBlocks());
  parallelFor(faces.size(), static_cast<int>(choices.size()), 16, [&](std::size_t b, int thread) {
    faces[b] = choices[static_cast<std::size_t>(thread)].facesOthers(normals, b);
  });
  std::vector<std::uint32_t> points;
  for (std::size_t i = 0; i < store.size(); ++i) {
    if (faces[i / PointStore::kBlock] && (on_rods.empty() || !on_rods[i]))
      points.push_back(static_cast<std::uint32_t>(i));
  }
  return points;
}

/** The points and their neighbours, once each, without those on rods. */
std::vector<std::uint32_t> withNeighbors(const std::vector<std::uint32_t>& points,
                                         const std::vector<char>& on_rods, std::size_t count,
                                         SheetChoice& choice) {
  std::vector<char> marked = on_rods;
  marked.resize(count, 0);
  std::vector<std::uint32_t> all;
  for (const std::uint32_t i : points) {
    for (const std::uint32_t j : choice.nearest(i)) {
      if (!marked[j]) all.push_back(j);
      marked[j] = 1;
    }
  }
  return all;
}

/** Computes new normals of some points in parallel. Points without a side get none. */
template <class NormalOf>
Normals normalsOf(const std::vector<std::uint32_t>& points, const Normals& normals,
                  std::vector<SheetChoice>& choices, const NormalOf& normalOf) {
  constexpr std::size_t kTask = 256;
  Normals found(points.size());
  parallelFor((points.size() + kTask - 1) / kTask, static_cast<int>(choices.size()), 1,
              [&](std::size_t task, int thread) {
                SheetChoice& choice = choices[static_cast<std::size_t>(thread)];
                for (std::size_t k = task * kTask; k < std::min(found.size(), (task + 1) * kTask);
                     ++k) {
                  found[k] = normals[points[k]];
                  if (found[k] == Normal{}) continue;
                  const Eigen::Vector3f normal = normalOf(choice, points[k]);
                  found[k] = {normal[0], normal[1], normal[2]};
                }
              });
  return found;
}

}  // namespace

void settleSides(const PointStore& store, const std::vector<char>& on_rods, int threads,
                 Normals& normals) {
  constexpr int kMostRounds = 30;
  threads = resolveThreads(threads);
  NearestPoints known;
  std::vector<SheetChoice> choices(static_cast<std::size_t>(threads), SheetChoice(store, known));
  const std::vector<std::uint32_t> facing = pointsFacingOthers(store, on_rods, normals, choices);
  known.collect(facing, store.size(), threads, [&](std::size_t point, int thread) {
    return choices[static_cast<std::size_t>(thread)].nearest(point);
  });
  std::vector<std::uint32_t> open = facing, changed;
  for (int round = 0; round < kMostRounds && !open.empty(); ++round) {
    const Normals settled = normalsOf(
        open, normals, choices,
        [&](SheetChoice& choice, std::size_t point) { return choice.settled(normals, point); });
    changed.clear();
    for (std::size_t k = 0; k < open.size(); ++k) {
      if (settled[k] == normals[open[k]]) continue;
      normals[open[k]] = settled[k];
      changed.push_back(open[k]);
    }
    open = withNeighbors(changed, on_rods, store.size(), choices.front());
  }
  const Normals planes = normalsOf(
      facing, normals, choices,
      [&](SheetChoice& choice, std::size_t point) { return choice.planeNormal(normals, point); });
  for (std::size_t k = 0; k < facing.size(); ++k) normals[facing[k]] = planes[k];
}

std::vector<std::array<double, 3>> feetOnLocalPlanes(const PointStore& store, std::size_t k,
                                                     int threads) {
  threads = resolveThreads(threads);
  std::vector<std::array<double, 3>> feet(store.size());
  std::vector<NeighborSearch> searches(static_cast<std::size_t>(threads), NeighborSearch(store));
  parallelFor(store.size(), threads, 256, [&](std::size_t i, int thread) {
    thread_local Patch patch;
    // The patch is about as wide as that of the last point.
    patchAbout(store, searches[static_cast<std::size_t>(thread)], i, k, patch,
               probableSquare(patch.radius, 1));
    const Eigen::Vector3d normal = principalAxes(patch.points).eigenvectors().col(0);
    const Eigen::Vector3d sum = kernels::sumPatch(patch.points).first;
    const double height = normal.dot(sum) / static_cast<double>(patch.points.size());
    const std::array<double, 3> at = store.position(i);
    for (std::size_t a = 0; a < 3; ++a)
      feet[i][a] = at[a] + height * normal[static_cast<Eigen::Index>(a)];
  });
  return feet;
}

}  // namespace pcl_slim::detail
