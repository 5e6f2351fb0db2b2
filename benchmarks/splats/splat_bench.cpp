// SPDX-License-Identifier: BSD-3-Clause
// splat_bench: time of the colour octree beside pcl::VoxelGrid and pcl::UniformSampling on the
// same cloud at about equal count. Rounds measure every method once; times are medians over rounds
// in microseconds a point, and speed-ups medians of the ratios within a round, so that a machine
// that others slow down for a while slows both sides of a ratio.
#include <pcl/common/common.h>
#include <pcl/filters/uniform_sampling.h>
#include <pcl/filters/voxel_grid.h>
#include <pcl/io/pcd_io.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "common/run_program.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/splat/splat_sampling.h"
#include "support/lab/bench.h"
#include "support/lab/scenes.h"

namespace {

using namespace pcl_slim;
using Point = pcl::PointXYZRGBNormal;
using Cloud = pcl::PointCloud<Point>;

struct Settings {
  std::string input, order = "random", vectors = "best";
  std::uint64_t points = 1000000;
  int repetitions = 9;
  double share = 0;
};

/** An ellipsoid with slanting stripes and an eye, in random order. */
Cloud::Ptr paintedCloud(std::size_t count) {
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

/** Puts points in the order of a scanner that turns about z: rows of equal height, each a turn. */
void scanOrder(Cloud& cloud) {
  const auto rows = static_cast<float>(std::sqrt(static_cast<double>(cloud.size())) / 2.0);
  const auto key = [rows](const Point& p) {
    return std::make_pair(std::floor(p.z * rows), std::atan2(p.y, p.x));
  };
  std::sort(cloud.begin(), cloud.end(),
            [&](const Point& a, const Point& b) { return key(a) < key(b); });
}

/** CPU time of the calling thread. Where the others only help, that is how long a machine that is
 * free takes. */
double ownCpuSeconds() {
  timespec time;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/** What is timed: a name, and the work, which returns how many points or splats it gave. */
struct Method {
  std::string name;
  std::function<std::size_t()> work;
  std::vector<double> cpu, own, wall;
  std::size_t out = 0;

  void measure() {
    const double cpu_before = measure::cpuSeconds(), own_before = ownCpuSeconds();
    const double before = measure::wallSeconds();
    out = work();
    wall.push_back(measure::wallSeconds() - before);
    own.push_back(ownCpuSeconds() - own_before);
    cpu.push_back(measure::cpuSeconds() - cpu_before);
  }
};

double medianRatio(const std::vector<double>& over, const std::vector<double>& under) {
  std::vector<double> ratios(over.size());
  for (std::size_t r = 0; r < over.size(); ++r) ratios[r] = over[r] / under[r];
  return measure::median(ratios);
}

/** Rounds of all methods; the first is what the others are compared with. One round before counts
 * for nothing: memory that a process never used before comes slowly. */
void timeMethods(std::vector<Method>& methods, std::size_t points, int rounds) {
  for (Method& method : methods) method.work();
  for (int r = 0; r < rounds; ++r) {
    for (Method& method : methods) method.measure();
  }
  const double unit = 1e6 / static_cast<double>(points);
  std::printf(
      "| method | out | CPU µs | caller's CPU µs | wall µs | speed-up: CPU | caller | wall |\n");
  std::printf("|---|---|---|---|---|---|---|---|\n");
  for (const Method& m : methods) {
    std::printf("| %s | %zu | %.4f | %.4f | %.4f | %.2f | %.2f | %.2f |\n", m.name.c_str(), m.out,
                unit * measure::median(m.cpu), unit * measure::median(m.own),
                unit * measure::median(m.wall), medianRatio(methods[0].cpu, m.cpu),
                medianRatio(methods[0].own, m.own), medianRatio(methods[0].wall, m.wall));
  }
}

float longestSide(const Cloud& cloud) {
  Eigen::Vector4f low, high;
  pcl::getMinMax3D(cloud, low, high);
  return (high - low).head<3>().maxCoeff();
}

/** Leaf size with which VoxelGrid gives about this many points. */
float leafFor(const Cloud::Ptr& cloud, std::size_t wanted, pcl::VoxelGrid<Point>& grid) {
  float leaf = longestSide(*cloud) / 50.0f;
  Cloud out;
  for (int step = 0; step < 6; ++step) {
    grid.setLeafSize(leaf, leaf, leaf);
    grid.filter(out);
    leaf *= std::sqrt(static_cast<float>(out.size()) / static_cast<float>(wanted));
  }
  return leaf;
}

/** Our sampling of a cloud, which outlives it. */
Method oursOf(const Cloud& cloud, SplatParams params, const std::string& name, int threads) {
  params.threads = threads;
  const auto work = [&cloud, params] {
    CloudView view;
    view.xyz = cloud[0].data;
    view.normal = cloud[0].data_n;
    view.xyz_stride = view.normal_stride = sizeof(Point);
    view.size = cloud.size();
    const ColorView colors{&cloud[0].b, sizeof(Point)};
    SplatSet splats;
    if (const Error error = sampleSplats(view, colors, params, splats)) {
      std::fprintf(stderr, "%s\n", error.message.c_str());
    }
    return splats.size();
  };
  return {name + (threads == 1 ? ", 1 thread" : ", 2 threads"), work, {}, {}, {}, 0};
}

std::vector<Method> methodsOf(const Cloud::Ptr& cloud, double share) {
  std::vector<Method> methods;
  const SplatParams tolerances;
  const std::size_t wanted =
      share > 0 ? static_cast<std::size_t>(share * static_cast<double>(cloud->size()))
                : oursOf(*cloud, tolerances, "", 1).work();
  const auto grid = std::make_shared<pcl::VoxelGrid<Point>>();
  const auto out = std::make_shared<Cloud>();
  grid->setInputCloud(cloud);
  const float leaf = leafFor(cloud, wanted, *grid);
  grid->setLeafSize(leaf, leaf, leaf);
  const auto voxels = [grid, out] {
    grid->filter(*out);
    return out->size();
  };
  methods.push_back({"VoxelGrid, all fields", voxels, {}, {}, {}, 0});
  const auto uniform = std::make_shared<pcl::UniformSampling<Point>>();
  uniform->setInputCloud(cloud);
  uniform->setRadiusSearch(leaf);
  const auto nearest = [uniform, out] {
    uniform->filter(*out);
    return out->size();
  };
  SplatParams even, paper, budget;
  even.initial_resolution = static_cast<int>(std::lround(longestSide(*cloud) / leaf));
  even.max_depth = 0;
  paper.paper_mode = true;
  budget.max_splats = wanted;
  for (const int threads : {1, 2}) {
    methods.push_back(oursOf(*cloud, tolerances, "splats, default tolerances", threads));
    methods.push_back(oursOf(*cloud, even, "splats, uniform", threads));
    methods.push_back(oursOf(*cloud, paper, "splats, paper mode", threads));
    methods.push_back(oursOf(*cloud, budget, "splats, best of that count", threads));
  }
  methods.push_back({"UniformSampling", nearest, {}, {}, {}, 0});
  return methods;
}

Error loadCloud(const Settings& s, Cloud::Ptr& cloud) {
  cloud = std::make_shared<Cloud>();
  if (s.input == "painted") {
    cloud = paintedCloud(s.points);
    if (s.order == "scan") scanOrder(*cloud);
  } else if (pcl::io::loadPCDFile(s.input, *cloud) != 0) {
    return {ErrorCode::kBadInput, "cannot read '" + s.input + "'; name a .pcd file"};
  }
  if (cloud->size() >= 100) return {};
  return {ErrorCode::kBadInput, "the cloud needs 100 points or more; name a larger one"};
}

Exit run(const Settings& s) {
  if (Error error = measure::chooseVectors(s.vectors)) return Exit::usage(error);
  Cloud::Ptr cloud;
  if (Error error = loadCloud(s, cloud)) return Exit::usage(error);
  std::vector<Method> methods = methodsOf(cloud, s.share);
  const bool made = s.input == "painted";
  std::printf("%zu points of %s%s; speed-up over VoxelGrid\n\n", cloud->size(), s.input.c_str(),
              made ? (" in " + s.order + " order").c_str() : "");
  timeMethods(methods, cloud->size(), s.repetitions);
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  Settings s;
  OptionTable options("splat_bench", "1", "Times colour splat sampling beside PCL's filters.");
  options.positional("painted|IN.pcd", &s.input, "a made cloud, or coloured points with normals");
  options.integer("points", &s.points, 100, 100000000, "points of the made cloud");
  options.choice("order", &s.order, {"random", "scan"}, "of the made cloud's points");
  options.text("vectors", &s.vectors, "NAME", "instruction set of the kernels, such as AVX2");
  options.integer("repetitions", &s.repetitions, 1, 1000, "rounds; medians count");
  options.number("share", &s.share, 0, 1,
                 "share of points VoxelGrid keeps; 0: as many as the default tolerances give");
  return runProgram(options, argc, argv, "give smaller -points", [&] { return run(s); });
}
