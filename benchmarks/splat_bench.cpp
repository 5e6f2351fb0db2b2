// SPDX-License-Identifier: BSD-3-Clause
// splat_bench: time of the colour octree beside pcl::VoxelGrid and pcl::UniformSampling on the
// same cloud at about equal count. Times are the least of some repetitions, in microseconds of CPU
// time a point: other programs' load leaves that alone.
#include <pcl/common/common.h>
#include <pcl/filters/uniform_sampling.h>
#include <pcl/filters/voxel_grid.h>
#include <pcl/io/pcd_io.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <memory>
#include <random>
#include <string>

#include "bench_common.h"
#include "common/options.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/splat/splat_sampling.h"

namespace {

using namespace pcl_slim;
using Point = pcl::PointXYZRGBNormal;
using Cloud = pcl::PointCloud<Point>;

struct Settings {
  std::string input;
  std::uint64_t points = 1000000;
  int repetitions = 5;
  double share = 0.05;
};

/** An ellipsoid with slanting stripes and an eye, in random order. */
Cloud::Ptr
paintedCloud(std::size_t count)
{
  auto cloud = std::make_shared<Cloud>();
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  const double axes[3] = {1.0, 0.8, 0.6};
  for (std::size_t i = 0; i < count; ++i) {
    double d[3] = {normal(random), normal(random), normal(random)};
    const double length = std::hypot(d[0], d[1], d[2]);
    Eigen::Vector3d p, n;
    for (int a = 0; a < 3; ++a) {
      p[a] = axes[a] * d[a] / length;
      n[a] = d[a] / axes[a];
    }
    Point q;
    q.getVector3fMap() = p.cast<float>();
    q.getNormalVector3fMap() = n.normalized().cast<float>();
    const bool stripe = std::fmod(0.36 * p[0] + 0.48 * p[1] + 0.8 * p[2] + 2.0, 0.3) < 0.1;
    const bool eye = std::hypot(p[0] - 0.7, p[1] - 0.4) < 0.12 && p[2] > 0.0;
    q.r = eye ? 20 : stripe ? 220 : 240;
    q.g = eye ? 20 : stripe ? 60 : 200;
    q.b = eye ? 30 : stripe ? 40 : 60;
    q.a = 255;
    cloud->push_back(q);
  }
  return cloud;
}

struct Cost {
  double wall = std::numeric_limits<double>::infinity(), cpu = wall;
};

Cost
least(int repetitions, const std::function<void()>& work)
{
  Cost cost;
  for (int r = 0; r < repetitions; ++r) {
    const double cpu = bench::cpuSeconds(), wall = bench::wallSeconds();
    work();
    cost.wall = std::min(cost.wall, bench::wallSeconds() - wall);
    cost.cpu = std::min(cost.cpu, bench::cpuSeconds() - cpu);
  }
  return cost;
}

void
print(const std::string& what, std::size_t points, std::size_t out, const Cost& cost,
      const Cost& reference)
{
  const double unit = 1e6 / static_cast<double>(points);
  std::printf("%-34s %9zu %9.4f %9.4f %8.2f\n", what.c_str(), out, unit * cost.cpu,
              unit * cost.wall, reference.cpu / cost.cpu);
}

float
longestSide(const Cloud& cloud)
{
  Eigen::Vector4f low, high;
  pcl::getMinMax3D(cloud, low, high);
  return (high - low).head<3>().maxCoeff();
}

/** Leaf size with which VoxelGrid gives about this many points. */
float
leafFor(const Cloud::Ptr& cloud, std::size_t wanted, pcl::VoxelGrid<Point>& grid)
{
  float leaf = longestSide(*cloud) / 50.0f;
  Cloud out;
  for (int step = 0; step < 6; ++step) {
    grid.setLeafSize(leaf, leaf, leaf);
    grid.filter(out);
    leaf *= std::sqrt(static_cast<float>(out.size()) / static_cast<float>(wanted));
  }
  return leaf;
}

void
measureOurs(const Cloud& cloud, const Settings& s, const SplatParams& base, const std::string& name,
            const Cost& reference)
{
  CloudView view;
  view.xyz = cloud[0].data;
  view.normal = cloud[0].data_n;
  view.xyz_stride = view.normal_stride = sizeof(Point);
  view.size = cloud.size();
  const ColorView colors{&cloud[0].b, sizeof(Point)};
  for (int threads : {1, 2}) {
    SplatParams params = base;
    params.threads = threads;
    SplatSet splats;
    const Cost cost = least(s.repetitions, [&] {
      if (const Error error = sampleSplats(view, colors, params, splats)) {
        std::fprintf(stderr, "%s\n", error.message.c_str());
      }
    });
    print(name + ", " + std::to_string(threads) + (threads == 1 ? " thread" : " threads"),
          cloud.size(), splats.size(), cost, reference);
  }
}

int
run(const Settings& s)
{
  Cloud::Ptr cloud = std::make_shared<Cloud>();
  if (s.input == "painted") {
    cloud = paintedCloud(s.points);
  } else if (pcl::io::loadPCDFile(s.input, *cloud) != 0) {
    std::fprintf(stderr, "splat_bench: cannot read '%s'\n", s.input.c_str());
    return kExitUsage;
  }
  if (cloud->size() < 100) {
    std::fprintf(stderr, "splat_bench: the cloud needs 100 points or more\n");
    return kExitUsage;
  }
  const auto wanted = static_cast<std::size_t>(s.share * static_cast<double>(cloud->size()));
  std::printf("%zu points of %s; speed-up in CPU time over VoxelGrid\n", cloud->size(),
              s.input.c_str());
  std::printf("%-34s %9s %9s %9s %8s\n", "method", "out", "cpu us", "wall us", "speed-up");
  Cloud out;
  pcl::VoxelGrid<Point> grid;
  grid.setInputCloud(cloud);
  const float leaf = leafFor(cloud, wanted, grid);
  grid.setLeafSize(leaf, leaf, leaf);
  const Cost reference = least(s.repetitions, [&] { grid.filter(out); });
  const std::size_t count = out.size();
  print("VoxelGrid, all fields", cloud->size(), count, reference, reference);
  pcl::UniformSampling<Point> uniform;
  uniform.setInputCloud(cloud);
  uniform.setRadiusSearch(leaf);
  const Cost sampled = least(s.repetitions, [&] { uniform.filter(out); });
  print("UniformSampling", cloud->size(), out.size(), sampled, reference);

  measureOurs(*cloud, s, SplatParams(), "splats, default tolerances", reference);
  SplatParams even;
  even.initial_resolution = static_cast<int>(std::lround(longestSide(*cloud) / leaf));
  even.max_depth = 0;
  measureOurs(*cloud, s, even, "splats, uniform at that count", reference);
  SplatParams paper;
  paper.paper_mode = true;
  measureOurs(*cloud, s, paper, "splats, paper mode", reference);
  SplatParams budget;
  budget.max_splats = count;
  measureOurs(*cloud, s, budget, "splats, best of that count", reference);
  return kExitDone;
}

}  // namespace

int
main(int argc, char** argv)
{
  Settings s;
  OptionTable options("splat_bench", "1", "Times colour splat sampling beside PCL's filters.");
  options.positional("painted|IN.pcd", &s.input, "a made cloud, or coloured points with normals");
  options.integer("points", &s.points, 100, 100000000, "points of the made cloud");
  options.integer("repetitions", &s.repetitions, 1, 1000, "runs of each; the least time counts");
  options.number("share", &s.share, 1e-4, 1, "share of points to keep");
  if (const auto status = options.parse(argc, argv)) return *status;
  return run(s);
}
