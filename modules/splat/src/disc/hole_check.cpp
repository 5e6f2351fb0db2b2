// SPDX-License-Identifier: BSD-3-Clause
// The check of docs/color_octree_splat_sampler.md, "Radius": rays between the points.
#include "pcl_slim/splat/hole_check.h"

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "pcl_slim/cloud/block_tree.h"
#include "pcl_slim/cloud/knn.h"
#include "pcl_slim/core/order_statistics.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/core/random.h"

namespace pcl_slim {

using namespace detail;

namespace {

/** Discs in a store's coordinates under a tree of boxes. */
class DiscTree {
 public:
  /** depth: how far above or below a place, beyond its radius, a disc may be met; least_cosine: of
   * the largest angle of a ray to the normal. */
  DiscTree(const PointStore& store, const SplatSet& splats, double depth, double least_cosine);

  /** Discs that a ray meets near a place. cosine: of its angle to the normals; near: scratch
   * memory. */
  std::uint32_t count(const Eigen::Vector3d& place, const Eigen::Vector3d& direction, double cosine,
                      std::vector<std::uint32_t>& near) const;

 private:
  /** The box of a disc. */
  void setBox(std::size_t i, double least_cosine, BlockTree::Level& boxes) const;

  std::vector<Eigen::Vector3d> center_, normal_;
  std::vector<double> radius_;
  double depth_;
  BlockTree tree_;
};

using Eigen::Vector3d;

DiscTree::DiscTree(const PointStore& store, const SplatSet& splats, double depth,
                   double least_cosine)
    : center_(splats.size()), normal_(splats.size()), radius_(splats.size()), depth_(depth) {
  Vector3d shift;
  for (std::size_t a = 0; a < 3; ++a) {
    shift[static_cast<Eigen::Index>(a)] = splats.origin[a] - store.origin()[a];
  }
  BlockTree::Level boxes;
  boxes.allocate(splats.size());
  for (std::size_t i = 0; i < splats.size(); ++i) {
    center_[i] = (Vector3d(splats.x[i], splats.y[i], splats.z[i]) + shift) / store.scale();
    normal_[i] = Vector3d(splats.nx[i], splats.ny[i], splats.nz[i]);
    radius_[i] = splats.radius[i] / store.scale();
    setBox(i, least_cosine, boxes);
  }
  tree_ = BlockTree(std::move(boxes));
}

void DiscTree::setBox(std::size_t i, double least_cosine, BlockTree::Level& boxes) const {
  // A place whose ray, at an angle of least_cosine to the normal, pierces the disc at most radius +
  // depth above or below is in this box.
  const double reach = radius_[i] + (radius_[i] + depth_) / least_cosine;
  float* const low[3] = {&boxes.min_x[i], &boxes.min_y[i], &boxes.min_z[i]};
  float* const high[3] = {&boxes.max_x[i], &boxes.max_y[i], &boxes.max_z[i]};
  for (int a = 0; a < 3; ++a) {
    *low[a] = static_cast<float>(center_[i][a] - reach);
    *high[a] = static_cast<float>(center_[i][a] + reach);
  }
}

std::uint32_t DiscTree::count(const Vector3d& place, const Vector3d& direction, double cosine,
                              std::vector<std::uint32_t>& near) const {
  const float at[3] = {static_cast<float>(place[0]), static_cast<float>(place[1]),
                       static_cast<float>(place[2])};
  near.clear();
  tree_.blocksInBall(at, 1e-6f, near);
  std::uint32_t met = 0;
  for (const std::uint32_t i : near) {
    const double slope = direction.dot(normal_[i]);
    if (std::abs(slope) < 1e-6) continue;
    const Vector3d to_center = center_[i] - place;
    const double along = to_center.dot(normal_[i]) / slope;
    if (std::abs(along) * cosine > radius_[i] + depth_) continue;
    met += (along * direction - to_center).squaredNorm() <= radius_[i] * radius_[i];
  }
  return met;
}

using Eigen::Vector3d;

constexpr std::size_t kNeighbors = 8;
constexpr std::size_t kSheet = 24;      ///< neighbours for the surface's normal
constexpr double kUsual = 3.0;          ///< times the middle spacing that still counts as dense
constexpr std::size_t kSamples = 1000;  ///< points for the middle spacing
constexpr double kDepthSpacings = 2.0;
constexpr std::uint32_t kSparse = 0xffffffffu, kRough = 0xfffffffeu;

/** Random numbers that depend on nothing but the ray. */
SplitMix randomOf(std::uint64_t seed, std::uint64_t ray) {
  return {seed * SplitMix::kStep ^ ray << 20};
}

struct Triangle {
  Vector3d a, b, c;

  double longestSide() const { return std::max({(a - b).norm(), (b - c).norm(), (c - a).norm()}); }

  /** A place inside, every one as likely. */
  Vector3d randomPlace(SplitMix& random) const {
    const double u = std::sqrt(random.nextShare()), v = random.nextShare();
    return (1.0 - u) * a + u * (1.0 - v) * b + u * v * c;
  }
};

/** Cosine of the largest angle of a ray to the normal. */
double leastCosine(const HoleCheckParams& params) {
  return std::cos(params.tilt * M_PI / 180.0);
}

/** One thread's way of casting rays. */
class Caster {
 public:
  Caster(const PointStore& store, const DiscTree& discs, const HoleCheckParams& params,
         double usual)
      : store_(store), discs_(discs), params_(params), usual_(usual), search_(store) {}

  /** Discs that one ray meets, or kSparse, or kRough. */
  std::uint32_t cast(std::uint64_t ray) {
    SplitMix random = randomOf(params_.seed, ray);
    const auto i =
        static_cast<std::size_t>(random.nextShare() * static_cast<double>(store_.size()));
    search_.nearest(i, kSheet + 1, near_, distances_sq_);
    if (near_.size() < 3) return kSparse;
    const std::size_t others = std::min(kNeighbors, near_.size() - 1);
    const Triangle triangle = triangleAt(i, others, random);
    const double spacing = meanDistance(others);
    if (triangle.longestSide() > params_.density * spacing || spacing > kUsual * usual_) {
      return kSparse;
    }
    const Vector3d place = triangle.randomPlace(random);
    Vector3d normal;
    if (!(thickness(normal) <= params_.thickness)) return kRough;
    const double turn = 2.0 * M_PI * random.nextShare();
    const double cosine = 1.0 - random.nextShare() * (1.0 - leastCosine(params_));
    return discs_.count(place, directionAt(normal, cosine, turn), cosine, hits_);
  }

  /** Mean distance of a point to its neighbours; 0 where it has none. */
  double spacing(std::size_t i) {
    search_.nearest(i, kNeighbors + 1, near_, distances_sq_);
    double sum = 0;
    for (std::size_t m = 1; m < near_.size(); ++m) sum += std::sqrt(distances_sq_[m]);
    return near_.size() > 1 ? sum / static_cast<double>(near_.size() - 1) : 0.0;
  }

 private:
  Vector3d at(std::size_t i) const {
    const auto p = store_.position(i);
    return {p[0], p[1], p[2]};
  }

  /** A point and two of its nearest others, which were found last. */
  Triangle triangleAt(std::size_t i, std::size_t others, SplitMix& random) const {
    const auto choices = static_cast<double>(others);
    const auto j = 1 + static_cast<std::size_t>(random.nextShare() * choices);
    const auto k =
        1 + (j + static_cast<std::size_t>(random.nextShare() * (choices - 1.0))) % others;
    return {at(i), at(near_[j]), at(near_[k])};
  }

  /** Mean distance to the nearest of the points found last. */
  double meanDistance(std::size_t others) const {
    double mean = 0;
    for (std::size_t m = 1; m <= others; ++m) {
      mean += std::sqrt(distances_sq_[m]) / static_cast<double>(others);
    }
    return mean;
  }

  /** Spread of the points found last across their plane over the lesser spread along it; not a
   * number on a line. */
  double thickness(Vector3d& normal) const {
    Vector3d mean = Vector3d::Zero();
    for (const std::uint32_t m : near_) mean += at(m);
    mean /= static_cast<double>(near_.size());
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (const std::uint32_t m : near_) covariance += (at(m) - mean) * (at(m) - mean).transpose();
    const double largest = covariance.cwiseAbs().maxCoeff();
    if (!(largest > 0.0)) return std::numeric_limits<double>::quiet_NaN();
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
    solver.computeDirect(covariance / largest);
    normal = solver.eigenvectors().col(0);
    const double across = std::max(0.0, solver.eigenvalues()[0]);
    const double along = std::max(0.0, solver.eigenvalues()[1]);
    return std::sqrt(across / along);
  }

  static Vector3d directionAt(const Vector3d& normal, double cosine, double turn) {
    const double sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
    const Vector3d side = normal.unitOrthogonal(), other = normal.cross(side);
    return cosine * normal + sine * (std::cos(turn) * side + std::sin(turn) * other);
  }

  const PointStore& store_;
  const DiscTree& discs_;
  const HoleCheckParams& params_;
  double usual_;
  NeighborSearch search_;
  std::vector<std::uint32_t> near_, hits_;
  std::vector<float> distances_sq_;
};

double middleSpacing(const PointStore& store, const DiscTree& discs,
                     const HoleCheckParams& params) {
  Caster caster(store, discs, params, 0.0);
  const std::size_t samples = std::min(kSamples, store.size());
  std::vector<double> spacings(samples);
  for (std::size_t s = 0; s < samples; ++s) {
    spacings[s] = caster.spacing((2 * s + 1) * store.size() / (2 * samples));
  }
  return median(spacings);
}

HoleCheck summed(const std::vector<std::uint32_t>& met) {
  HoleCheck check;
  std::uint64_t hits = 0;
  for (const std::uint32_t count : met) {
    if (count >= kRough) {
      ++(count == kSparse ? check.sparse : check.rough);
      continue;
    }
    ++check.rays;
    check.missed += count == 0;
    hits += count;
  }
  if (check.rays > 0) check.overlap = static_cast<double>(hits) / static_cast<double>(check.rays);
  return check;
}

}  // namespace

Result<HoleCheck> checkHoles(const PointStore& store, const SplatSet& splats,
                             const HoleCheckParams& params) {
  if (!(params.tilt >= 0.0 && params.tilt <= 80.0) || !(params.density > 0.0) ||
      !(params.thickness >= 0.0)) {
    return Error{ErrorCode::kBadArgument,
                 "rays lean 0 to 80 degrees, the density is positive, the thickness 0 or more"};
  }
  if (splats.empty() || store.size() == 0) {
    return Error{ErrorCode::kBadInput, "there are no splats to look through; sample some first"};
  }
  const double usual = middleSpacing(store, DiscTree(store, SplatSet(), 0.0, 1.0), params);
  const DiscTree discs(store, splats, kDepthSpacings * usual, leastCosine(params));
  const int threads = resolveThreads(params.threads);
  std::vector<Caster> casters(static_cast<std::size_t>(threads),
                              Caster(store, discs, params, usual));
  std::vector<std::uint32_t> met(params.rays);
  parallelFor(params.rays, threads, 256, [&](std::size_t ray, int thread) {
    met[ray] = casters[static_cast<std::size_t>(thread)].cast(ray);
  });
  return summed(met);
}

}  // namespace pcl_slim
