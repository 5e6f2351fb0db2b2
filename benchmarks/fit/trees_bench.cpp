// SPDX-License-Identifier: BSD-3-Clause
// Nearest neighbours of every point of a cloud by this package's block index, by PCL's search objects (FLANN's
// tree and an octree), by FLANN's tree itself and by nanoflann's: time to build and to answer.
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>
#include <pcl/search/octree.h>

#include <cmath>
#include <cstdio>
#include <flann/flann.hpp>
#include <functional>
#include <memory>
#include <nanoflann.hpp>
#include <string>
#include <vector>

#include "float_cloud.h"
#include "measure/clocks.h"
#include "measure/scenes.h"
#include "pcl_slim/cloud/knn.h"
#include "pcl_slim/cloud/point_store.h"

namespace {

using namespace pcl_slim;
using measure::cpuSeconds;
using measure::FloatCloud;

constexpr int kLeaf = 15;  ///< points in a leaf of FLANN's and nanoflann's trees: PCL's choice

struct Timed {
  double build = 0, query = 0;  ///< CPU time of one thread, us a point
  double checksum = 0;          ///< sum of the distances to the k-th neighbours
};

/** \param[in] build makes an index \param[in] distance of a point's k-th neighbour */
Timed
timed(std::size_t count, const std::function<void()>& build,
      const std::function<double(std::size_t)>& distance)
{
  Timed result;
  double begin = cpuSeconds();
  build();
  result.build = 1e6 * (cpuSeconds() - begin) / static_cast<double>(count);
  begin = cpuSeconds();
  for (std::size_t i = 0; i < count; ++i) result.checksum += distance(i);
  result.query = 1e6 * (cpuSeconds() - begin) / static_cast<double>(count);
  return result;
}

Timed
ofBlocks(const std::vector<float>& xyz, std::size_t k)
{
  CloudView view;
  view.xyz = xyz.data();
  view.xyz_stride = 3 * sizeof(float);
  view.size = xyz.size() / 3;
  PointStore store;
  std::vector<std::uint32_t> found;
  std::vector<float> distances;
  std::unique_ptr<NeighborSearch> search;
  return timed(
      view.size,
      [&] {
        store = std::move(*PointStore::build(view, 1));
        search = std::make_unique<NeighborSearch>(store);
      },
      [&](std::size_t i) {
        search->nearest(i, k, found, distances);
        return std::sqrt(double{distances.back()}) * store.scale();
      });
}

template <typename Search>
Timed
ofPCL(const std::vector<float>& xyz, std::size_t k, Search&& search)
{
  auto cloud = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  for (std::size_t i = 0; i < xyz.size(); i += 3)
    cloud->push_back({xyz[i], xyz[i + 1], xyz[i + 2]});
  pcl::Indices found;
  std::vector<float> distances;
  return timed(
      cloud->size(), [&] { search.setInputCloud(cloud); },
      [&](std::size_t i) {
        search.nearestKSearch((*cloud)[i], static_cast<int>(k), found, distances);
        return std::sqrt(double{distances.back()});
      });
}

Timed
ofFlann(const std::vector<float>& xyz, std::size_t k)
{
  using Tree = flann::KDTreeSingleIndex<flann::L2_Simple<float>>;
  const flann::Matrix<float> points(const_cast<float*>(xyz.data()), xyz.size() / 3, 3);
  std::unique_ptr<Tree> tree;
  std::vector<int> found(k);
  std::vector<float> distances(k);
  flann::Matrix<int> rows(found.data(), 1, k);
  flann::Matrix<float> away(distances.data(), 1, k);
  return timed(
      points.rows,
      [&] {
        tree = std::make_unique<Tree>(points, flann::KDTreeSingleIndexParams(kLeaf, true));
        tree->buildIndex();
      },
      [&](std::size_t i) {
        const flann::Matrix<float> query(points[i], 1, 3);
        tree->knnSearch(query, rows, away, k, flann::SearchParams(-1));
        return std::sqrt(double{distances.back()});
      });
}

Timed
ofNanoflann(const std::vector<float>& xyz, std::size_t k)
{
  using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, FloatCloud>,
                                                   FloatCloud, 3>;
  const FloatCloud cloud{xyz};
  std::unique_ptr<Tree> tree;
  std::vector<std::uint32_t> found(k);
  std::vector<float> distances(k);
  return timed(
      xyz.size() / 3,
      [&] {
        tree = std::make_unique<Tree>(3, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(kLeaf));
        tree->buildIndex();
      },
      [&](std::size_t i) {
        tree->knnSearch(&xyz[3 * i], k, found.data(), distances.data());
        return std::sqrt(double{distances.back()});
      });
}

}  // namespace

int
main(int argc, char** argv)
{
  const std::size_t count = argc > 1 ? std::stoul(argv[1]) : 1000000;
  std::printf(
      "| index | k | build, us a point | neighbours, us a point |\n| --- | --- | --- | --- |\n");
  const measure::Scene scene = measure::makeScene(measure::Shape::kBumpy, count, 1e-4, 0.0, 1);
  const std::vector<float> xyz(scene.points.begin(), scene.points.end());
  for (const std::size_t k : {std::size_t{10}, std::size_t{50}}) {
    const Timed blocks = ofBlocks(xyz, k);
    const auto row = [&](const char* name, const Timed& result) {
      std::printf("| %s | %zu | %.2f | %.2f |\n", name, k, result.build, result.query);
      if (std::abs(result.checksum / blocks.checksum - 1) > 1e-4)
        std::printf("%s finds others: %g, not %g\n", name, result.checksum, blocks.checksum);
    };
    row("block index (one thread)", blocks);
    row("nanoflann", ofNanoflann(xyz, k));
    row("FLANN", ofFlann(xyz, k));
    row("pcl::search::KdTree (FLANN)", ofPCL(xyz, k, pcl::search::KdTree<pcl::PointXYZ>()));
    row("pcl::search::Octree", ofPCL(xyz, k, pcl::search::Octree<pcl::PointXYZ>(0.02)));
  }
  return 0;
}
