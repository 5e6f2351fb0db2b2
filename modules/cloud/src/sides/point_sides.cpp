// SPDX-License-Identifier: BSD-3-Clause
// docs/theory.md, "Sides before the cover": each point to the sheet that it is on.
#include "pcl_slim/cloud/detail/point_sides.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "pcl_slim/cloud/knn.h"
#include "pcl_slim/core/parallel.h"

namespace pcl_slim::detail {

namespace {

constexpr float kMargin = 1.4f;  ///< of a squared distance, for as many points

using Normals = std::vector<std::array<float, 3>>;

Eigen::Vector3f
normalAt(const Normals& normals, std::size_t i)
{
  return {normals[i][0], normals[i][1], normals[i][2]};
}

/** Sums of a plane of least squares: heights over two coordinates about a point. */
class PlaneSums {
 public:
  void add(const Eigen::Vector3d& at)
  {
    const Eigen::Vector3d terms(1, at[1], at[2]);
    products_ += terms * terms.transpose();
    right_ += at[0] * terms;
    squares_ += at[0] * at[0];
    ++count_;
  }

  std::size_t count() const { return count_; }

  /** \param[out] rest sum of the squared residuals. \return the plane's height at the point */
  double height(double& rest) const
  {
    const Eigen::Vector3d plane = products_.ldlt().solve(right_);
    rest = std::max(0.0, squares_ - plane.dot(right_));
    return plane[0];
  }

 private:
  Eigen::Matrix3d products_ = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right_ = Eigen::Vector3d::Zero();
  double squares_ = 0;
  std::size_t count_ = 0;
};

/** Decides about one point after another. One per thread. */
class SheetChoice {
 public:
  SheetChoice(const PointStore& store, const SideConstants& constants)
      : store_(store), constants_(constants), search_(store)
  {
  }

  /** The nearest points of a stored point, itself among them. */
  const std::vector<std::uint32_t>& nearest(std::size_t point, std::size_t factor = 1)
  {
    const std::size_t count = factor * constants_.settled_points;
    const float about = kMargin * static_cast<float>(count) * reach_sq_;
    reach_sq_ = search_.nearestSet(point, count, near_, about) / static_cast<float>(count);
    return near_;
  }

  /** Whether some of a block's points are near others that face the other way. */
  bool facesOthers(const Normals& normals, std::size_t block)
  {
    constexpr std::size_t kProbes[] = {PointStore::kBlock / 4, 3 * PointStore::kBlock / 4};
    for (const std::size_t probe : kProbes) {
      const std::size_t i = std::min(block * PointStore::kBlock + probe, store_.size() - 1);
      const Eigen::Vector3f own = normalAt(normals, i);
      const auto faces = [&](std::uint32_t j) { return own.dot(normalAt(normals, j)) < 0; };
      const auto& near = nearest(i, 2);
      if (std::any_of(near.begin(), near.end(), faces)) return true;
    }
    return false;
  }

  /** Whether a point is on the sheet of those neighbours that face the other way. */
  bool isOnOther(const Normals& normals, std::size_t point)
  {
    constexpr std::size_t kPlane = 3;  // coefficients
    const Eigen::Vector3f own = normalAt(normals, point);
    nearest(point);
    same_.clear();
    others_.clear();
    for (const std::uint32_t j : near_) {
      const float cosine = own.dot(normalAt(normals, j));
      if (cosine < 0) others_.push_back(j);
      if (cosine > 0 && j != point) same_.push_back(j);
    }
    if (others_.size() < 2 * kPlane) return false;
    const PlaneSums same = sumsOf(point, same_, own), other = sumsOf(point, others_, own);
    if (same.count() < 2 * kPlane) return 2 * others_.size() > near_.size();
    double same_rest, other_rest;
    const double height = same.height(same_rest), beyond = other.height(other_rest);
    const auto freedom = static_cast<double>(same.count() + other.count() - 2 * kPlane);
    return height * height - beyond * beyond > (same_rest + other_rest) / freedom;
  }

 private:
  /** Sums over some points, of heights along a point's own normal. */
  PlaneSums sumsOf(std::size_t point, const std::vector<std::uint32_t>& points,
                   const Eigen::Vector3f& own) const
  {
    const Eigen::Vector3d normal = own.cast<double>(), u = normal.unitOrthogonal();
    Eigen::Matrix3d axes;
    axes << normal, u, normal.cross(u);
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
  const SideConstants& constants_;
  NeighborSearch search_;
  std::vector<std::uint32_t> near_, same_, others_;
  float reach_sq_ = 0;  ///< squared, over the number of points
};

/** The points of blocks that are near points which face the other way. */
std::vector<std::uint32_t>
pointsFacingOthers(const PointStore& store, const Normals& normals,
                   std::vector<SheetChoice>& choices)
{
  std::vector<char> faces(store.numBlocks());
  parallelFor(faces.size(), static_cast<int>(choices.size()), 16, [&](std::size_t b, int thread) {
    faces[b] = choices[static_cast<std::size_t>(thread)].facesOthers(normals, b);
  });
  std::vector<std::uint32_t> points;
  for (std::size_t i = 0; i < store.size(); ++i) {
    if (faces[i / PointStore::kBlock]) points.push_back(static_cast<std::uint32_t>(i));
  }
  return points;
}

/** The points and their neighbours, once each. */
std::vector<std::uint32_t>
withNeighbors(const std::vector<std::uint32_t>& points, std::size_t count, SheetChoice& choice)
{
  std::vector<char> marked(count, 0);
  std::vector<std::uint32_t> all;
  for (const std::uint32_t i : points) {
    for (const std::uint32_t j : choice.nearest(i)) {
      if (!marked[j]) all.push_back(j);
      marked[j] = 1;
    }
  }
  return all;
}

}  // namespace

void
settleSides(const PointStore& store, const SideConstants& constants, int threads, Normals& normals)
{
  constexpr std::size_t kTask = 256;
  threads = resolveThreads(threads);
  std::vector<SheetChoice> choices(static_cast<std::size_t>(threads),
                                   SheetChoice(store, constants));
  std::vector<std::uint32_t> open = pointsFacingOthers(store, normals, choices);
  std::vector<char> turned;
  for (int round = 0; round < constants.settle_rounds && !open.empty(); ++round) {
    turned.assign(open.size(), 0);
    parallelFor((open.size() + kTask - 1) / kTask, threads, 1, [&](std::size_t task, int thread) {
      for (std::size_t k = task * kTask; k < std::min(open.size(), (task + 1) * kTask); ++k) {
        const bool has_side = normals[open[k]] != std::array<float, 3>{};
        turned[k] =
            has_side && choices[static_cast<std::size_t>(thread)].isOnOther(normals, open[k]);
      }
    });
    std::vector<std::uint32_t> changed;
    for (std::size_t k = 0; k < open.size(); ++k) {
      if (!turned[k]) continue;
      for (float& c : normals[open[k]]) c = -c;
      changed.push_back(open[k]);
    }
    open = withNeighbors(changed, store.size(), choices.front());
  }
}

}  // namespace pcl_slim::detail
