// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <utility>

#include "disc/splat_builder.h"
#include "pcl_slim/cloud/neighbor_planes.h"
#include "pcl_slim/core/parallel.h"

namespace pcl_slim::detail {

namespace {

Eigen::Vector3d positionOf(const PointStore& store, std::size_t i) {
  const auto p = store.position(i);
  return {p[0], p[1], p[2]};
}

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
  std::vector<float> of_store = std::move(
      findNeighborPlanes(store, static_cast<std::size_t>(neighbors), false, threads).normals);
  parallelFor(store.numBlocks(), threads, 64, [&](std::size_t block, int) {
    const std::size_t begin = block * PointStore::kBlock;
    const std::size_t end = std::min(store.size(), begin + PointStore::kBlock);
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
