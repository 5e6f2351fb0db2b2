// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "pcl_slim/cloud/knn.h"
#include "pcl_slim/core/parallel.h"
#include "planes/planes.h"

namespace pcl_slim {

namespace {

using namespace detail;

Eigen::Vector3d positionOf(const PointStore& store, std::size_t i) {
  const auto p = store.position(i);
  return {p[0], p[1], p[2]};
}

/** The plane of some points. */
struct Plane {
  Eigen::Vector3f normal;
  float variation;
};

Plane planeOf(const PointStore& store, const std::vector<std::uint32_t>& near) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const std::uint32_t j : near) mean += positionOf(store, j);
  mean /= static_cast<double>(near.size());
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const std::uint32_t j : near) {
    const Eigen::Vector3d d = positionOf(store, j) - mean;
    covariance += d * d.transpose();
  }
  // The closed form needs entries near one.
  const double largest = covariance.cwiseAbs().maxCoeff();
  if (!(largest > 0.0)) return {Eigen::Vector3f::UnitZ(), 0.0f};
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(covariance / largest);
  const double least = std::max(0.0, solver.eigenvalues()[0]);
  return {solver.eigenvectors().col(0).cast<float>(),
          static_cast<float>(least / (covariance.trace() / largest))};
}

/** The planes of a store's blocks, one after another. One per thread: it keeps its memory. */
class PlaneFinder {
 public:
  PlaneFinder(const PointStore& store, std::size_t neighbors)
      : store_(store), neighbors_(neighbors), search_(store) {}

  /** The planes of a block's points: normals, three floats each, and variations unless null. */
  void find(std::size_t block, float* normals, float* variation) {
    const std::size_t begin = block * PointStore::kBlock;
    const std::size_t count = std::min(PointStore::kBlock, store_.size() - begin);
    findTogether(block, count);
    for (std::size_t i = 0; i < count; ++i) {
      Eigen::Map<Eigen::Vector3f> n(normals + 3 * i);
      if ((found_.found >> i & 1) != 0) {
        n = Eigen::Vector3f(found_.x[i], found_.y[i], found_.z[i]);
        if (variation != nullptr) variation[i] = found_.variation[i];
        continue;
      }
      search_.nearestSet(begin + i, neighbors_, near_);
      const Plane plane = planeOf(store_, near_);
      n = plane.normal;
      if (variation != nullptr) variation[i] = plane.variation;
    }
  }

 private:
  struct Box {
    float low[3], high[3];
  };

  static constexpr std::size_t kRun = 4;           ///< points of a block that are near each other
  static constexpr float kFilled = 0.5f;           ///< of the longer two sides' product, by points
  static constexpr float kStep = 4.5f;             ///< [reach] from a point to the next, at a gap
  static constexpr float kMargin = 1.45f;          ///< of the reach: balls are no wider
  static constexpr std::size_t kMostAround = 160;  ///< [neighbours] points around a block

  /** Finds the planes of a block's points together, or of each of its parts where gaps split it.
   */
  void findTogether(std::size_t block, std::size_t count) {
    found_.found = 0;
    if (count < PointStore::kBlock) return;
    std::array<float, PointStore::kBlock / kRun> reaches;
    for (std::size_t r = 0; r < reaches.size(); ++r)
      reaches[r] = reachOf(boxOf(block, r * kRun, (r + 1) * kRun), kRun);
    std::sort(reaches.begin(), reaches.end());
    const float usual = reaches[1];
    for (std::size_t first = 0; first < count;) {
      std::size_t last = first + 1;
      while (last < count && stepSq(block, last) < kStep * kStep * usual * usual) ++last;
      const Box box = boxOf(block, first, last);
      const bool whole = last - first == count;
      const float reach = whole ? reachOf(box, count) : usual;
      findWithin(block, box, reach, (1u << last) - (1u << first));
      first = last;
    }
  }

  /** Squared distance of a block's point to the one before. */
  float stepSq(std::size_t block, std::size_t point) const {
    const std::size_t i = block * PointStore::kBlock + point;
    const float x = store_.x()[i] - store_.x()[i - 1], y = store_.y()[i] - store_.y()[i - 1],
                z = store_.z()[i] - store_.z()[i - 1];
    return x * x + y * y + z * z;
  }

  /** Finds the planes of chosen points of a block, which are in a box. */
  void findWithin(std::size_t block, Box box, float reach, std::uint32_t chosen) {
    for (std::size_t a = 0; a < 3; ++a) {
      box.low[a] -= kMargin * reach;
      box.high[a] += kMargin * reach;
    }
    blocks_.clear();
    store_.tree().blocksInBox(box.low, box.high, blocks_);
    if (blocks_.size() * PointStore::kBlock > kMostAround * neighbors_) return;
    plane_kernels::gatherSurroundings(store_, block, blocks_, box.low, box.high, around_);
    plane_kernels::findPlanes(store_, block, around_, chosen, reach, kMargin * reach,
                              static_cast<float>(neighbors_), found_);
  }

  Box boxOf(std::size_t block, std::size_t first, std::size_t last) const {
    const float* columns[3] = {store_.x(), store_.y(), store_.z()};
    const float origin[3] = {store_.blockOriginX()[block], store_.blockOriginY()[block],
                             store_.blockOriginZ()[block]};
    Box box;
    for (std::size_t a = 0; a < 3; ++a) {
      const float* begin = columns[a] + block * PointStore::kBlock;
      const auto [low, high] = std::minmax_element(begin + first, begin + last);
      box.low[a] = *low + origin[a];
      box.high[a] = *high + origin[a];
    }
    return box;
  }

  /** About the radius of a ball with neighbors_ points of a plane, of which a box has some: they
   * extend by half a point's share beyond it. */
  float reachOf(const Box& box, std::size_t points) const {
    std::array<float, 3> sides;
    for (std::size_t a = 0; a < 3; ++a) sides[a] = box.high[a] - box.low[a];
    std::sort(sides.begin(), sides.end());
    const float root = std::sqrt(static_cast<float>(points)), whole = root / (root - 1.0f);
    const float area = kFilled * whole * whole * sides[2] * std::max(sides[1], 0.1f * sides[2]);
    return std::sqrt(area * static_cast<float>(neighbors_) /
                     (static_cast<float>(M_PI) * root * root));
  }

  const PointStore& store_;
  std::size_t neighbors_;
  NeighborSearch search_;
  BlockSurroundings around_;
  BlockPlanes found_;
  std::vector<std::uint32_t> blocks_, near_;
};

}  // namespace

NeighborPlanes findNeighborPlanes(const PointStore& store, std::size_t k, bool variation,
                                  int threads, const std::vector<std::uint32_t>* only) {
  threads = resolveThreads(threads);
  std::vector<char> wanted(store.numBlocks(), only == nullptr ? 1 : 0);
  for (std::size_t i = 0; only != nullptr && i < only->size(); ++i)
    wanted[(*only)[i] / PointStore::kBlock] = 1;
  NeighborPlanes planes;
  planes.normals.resize(3 * store.size());
  if (variation) planes.variation.resize(store.size());
  std::vector<PlaneFinder> finders(static_cast<std::size_t>(threads), PlaneFinder(store, k));
  parallelFor(store.numBlocks(), threads, 64, [&](std::size_t block, int thread) {
    if (wanted[block] == 0) return;
    const std::size_t begin = block * PointStore::kBlock;
    finders[static_cast<std::size_t>(thread)].find(
        block, planes.normals.data() + 3 * begin,
        variation ? planes.variation.data() + begin : nullptr);
  });
  return planes;
}

std::vector<float> surfaceVariation(const CloudView& cloud, int threads) {
  constexpr std::size_t kLeastPoints = 3;
  std::vector<float> values(cloud.count(), std::numeric_limits<float>::quiet_NaN());
  CloudView places = cloud;
  places.normal = places.sensors = nullptr;
  places.frame_numbers = nullptr;
  const Result<PointStore> store = PointStore::build(places, threads);
  if (!store || store->size() < kLeastPoints) return values;
  const NeighborPlanes planes = findNeighborPlanes(*store, kVariationNeighbors, true, threads);
  const std::vector<std::uint32_t> place = store->storeOfInput();
  for (std::size_t i = 0; i < values.size(); ++i)
    if (place[i] != PointStore::kSkipped) values[i] = planes.variation[place[i]];
  return values;
}

}  // namespace pcl_slim
