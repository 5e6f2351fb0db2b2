// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

#include "disc/splat_builder.h"
#include "kernels/splat_kernels.h"
#include "pcl_slim/cloud/knn.h"
#include "pcl_slim/core/parallel.h"

namespace pcl_slim::detail {

namespace {

Eigen::Vector3d positionOf(const PointStore& store, std::size_t i) {
  const auto p = store.position(i);
  return {p[0], p[1], p[2]};
}

Eigen::Vector3d normalOf(const PointStore& store, const std::vector<std::uint32_t>& near) {
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
  if (!(largest > 0.0)) return Eigen::Vector3d::UnitZ();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(covariance / largest);
  return solver.eigenvectors().col(0);
}

/** The normals of a store's blocks, one after another. One per thread: it keeps its memory. */
class NormalFinder {
 public:
  NormalFinder(const PointStore& store, std::size_t neighbors)
      : store_(store), neighbors_(neighbors), search_(store) {}

  /** The normals of a block's points, of either side; three floats each. */
  void find(std::size_t block, float* normals) {
    const std::size_t begin = block * PointStore::kBlock;
    const std::size_t count = std::min(PointStore::kBlock, store_.size() - begin);
    findTogether(block, count);
    for (std::size_t i = 0; i < count; ++i) {
      Eigen::Map<Eigen::Vector3f> n(normals + 3 * i);
      if ((found_.found >> i & 1) != 0) {
        n = Eigen::Vector3f(found_.x[i], found_.y[i], found_.z[i]);
      } else {
        search_.nearest(begin + i, neighbors_, near_, distances_sq_);
        n = normalOf(store_, near_).cast<float>();
      }
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

  /** Finds the normals of a block's points together, or of each of its parts where gaps split it.
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

  /** Finds the normals of chosen points of a block, which are in a box. */
  void findWithin(std::size_t block, Box box, float reach, std::uint32_t chosen) {
    for (std::size_t a = 0; a < 3; ++a) {
      box.low[a] -= kMargin * reach;
      box.high[a] += kMargin * reach;
    }
    blocks_.clear();
    store_.tree().blocksInBox(box.low, box.high, blocks_);
    if (blocks_.size() * PointStore::kBlock > kMostAround * neighbors_) return;
    splat_kernels::gatherSurroundings(store_, block, blocks_, box.low, box.high, around_);
    splat_kernels::findNormals(store_, block, around_, chosen, reach, kMargin * reach,
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
  BlockNormals found_;
  std::vector<std::uint32_t> blocks_, near_;
  std::vector<float> distances_sq_;
};

/** Turns the normals of a block's points to what they face. */
void faceSensors(const PointStore& store, bool own_sensors, const Eigen::Vector3d& eye,
                 std::size_t begin, std::size_t end, float* normals) {
  for (std::size_t i = begin; i < end; ++i) {
    Eigen::Map<Eigen::Vector3f> n(normals + 3 * i);
    Eigen::Vector3d sensor = eye;
    if (own_sensors) {
      const auto own = store.sensor(i);
      sensor = {own[0], own[1], own[2]};
    }
    if (n.cast<double>().dot(sensor - positionOf(store, i)) < 0.0) n = -n;
  }
}

/** The middle of the blocks. */
Eigen::Vector3d middleOf(const PointStore& store) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t b = 0; b < store.numBlocks(); ++b)
    sum += positionOf(store, b * PointStore::kBlock);
  return sum / static_cast<double>(store.numBlocks());
}

}  // namespace

std::vector<float> estimateNormals(const PointStore& store, const CloudView& cloud, int neighbors,
                                   const SideEvidence& evidence, int threads) {
  threads = resolveThreads(threads);
  Eigen::Vector3d eye = middleOf(store);
  for (std::size_t a = 0; a < 3 && evidence.eye; ++a)
    eye[static_cast<Eigen::Index>(a)] = ((*evidence.eye)[a] - store.origin()[a]) / store.scale();
  std::vector<float> of_store(3 * store.size());
  const auto k = static_cast<std::size_t>(neighbors);
  std::vector<NormalFinder> finders(static_cast<std::size_t>(threads), NormalFinder(store, k));
  parallelFor(store.numBlocks(), threads, 64, [&](std::size_t block, int thread) {
    const std::size_t begin = block * PointStore::kBlock;
    const std::size_t end = std::min(store.size(), begin + PointStore::kBlock);
    finders[static_cast<std::size_t>(thread)].find(block, of_store.data() + 3 * begin);
    faceSensors(store, evidence.source == SideSource::kSensors, eye, begin, end, of_store.data());
  });
  const auto stored = store.storeOfInput();
  std::vector<float> normals(3 * cloud.size, 0.0f);
  for (std::size_t i = 0; i < stored.size(); ++i) {
    if (stored[i] == PointStore::kSkipped) continue;
    const std::size_t input = cloud.inputIndex(i);
    for (std::size_t a = 0; a < 3; ++a)
      normals[3 * input + a] = of_store[3 * std::size_t{stored[i]} + a];
  }
  return normals;
}

}  // namespace pcl_slim::detail
