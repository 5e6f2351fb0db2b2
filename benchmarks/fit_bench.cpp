// SPDX-License-Identifier: BSD-3-Clause
// Fit time in units: one unit is a nanoflann build plus one 10-neighbour pass with eigenvalues on
// the same points in the same run, so that figures compare across machines.
#include <sys/resource.h>

#include <Eigen/Eigenvalues>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <nanoflann.hpp>
#include <string>
#include <vector>

#include "pcl_slim/cloud/kernels.h"
#include "pcl_slim/slim/fit.h"
#include "scenes.h"

namespace {

using namespace pcl_slim;

double
cpuSeconds()
{
  rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) { return t.tv_sec + 1e-6 * t.tv_usec; };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

double
wallSeconds()
{
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

struct FloatCloud {
  const std::vector<float>& xyz;
  std::size_t kdtree_get_point_count() const { return xyz.size() / 3; }
  float kdtree_get_pt(std::size_t i, std::size_t a) const { return xyz[3 * i + a]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const { return false; }
};

/** CPU seconds of one unit, on one thread. */
double
measureUnit(const std::vector<float>& xyz)
{
  using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, FloatCloud>,
                                                   FloatCloud, 3>;
  const double start = cpuSeconds();
  const FloatCloud cloud{xyz};
  Tree tree(3, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(10));
  tree.buildIndex();
  double checksum = 0;
  for (std::size_t i = 0; i < xyz.size() / 3; ++i) {
    std::uint32_t index[10];
    float distance[10];
    const std::size_t found = tree.knnSearch(&xyz[3 * i], 10, index, distance);
    Eigen::Matrix3Xf patch(3, found);
    for (std::size_t j = 0; j < found; ++j) patch.col(j) = Eigen::Vector3f::Map(&xyz[3 * index[j]]);
    patch.colwise() -= Eigen::Vector3f(patch.rowwise().mean());
    const Eigen::Matrix3f covariance = patch * patch.transpose();
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> axes;
    axes.computeDirect(covariance, Eigen::EigenvaluesOnly);
    checksum += axes.eigenvalues()[0];
  }
  const double seconds = cpuSeconds() - start;
  if (checksum < 0) std::puts("");
  return seconds;
}

struct Options {
  std::size_t points = 438000;
  std::string shape = "bumpy";
  double noise = 0, t_mdl = 0;
  int degree = 2, threads = 1, repeats = 3;
  bool normals = true;
};

void
run(const Options& o)
{
  bench::Shape shape;
  if (!bench::parseShape(o.shape, shape)) {
    std::fprintf(stderr, "unknown shape '%s': use sphere, torus, bumpy or relief\n", o.shape.c_str());
    std::exit(2);
  }
  const bench::Scene scene = bench::makeScene(shape, o.points, o.noise, 0.05, 7);
  const std::vector<float> xyz(scene.points.begin(), scene.points.end());
  CloudView view;
  view.xyz = xyz.data();
  view.xyz_stride = 12;
  view.size = o.points;
  if (o.normals) {
    view.normal = scene.normals.data();
    view.normal_stride = 12;
  }
  FitParams params;
  params.degree = o.degree;
  params.t_mdl = o.t_mdl;
  params.threads = o.threads;
  for (int repeat = 0; repeat < o.repeats; ++repeat) {
    const double unit = measureUnit(xyz);
    const double cpu = cpuSeconds(), wall = wallSeconds();
    const auto store = PointStore::build(view, o.threads);
    SLIMSurface surface;
    FitStatistics stats;
    if (!store) std::exit(1);
    if (Error error = fitSurface(*store, params, surface, &stats)) {
      std::fprintf(stderr, "%s\n", error.message.c_str());
      std::exit(1);
    }
    const double cpu_used = cpuSeconds() - cpu, wall_used = wallSeconds() - wall;
    const double n = static_cast<double>(o.points);
    const double memory = (store->memoryBytes() + stats.working_bytes) / n;
    std::printf("| %s %zu | %g | %d | %s | %d | %.3f | %.3f | %.3f | %.3f | %.3f %.3f %.3f %.3f %.3f | "
                "%.4f | %.0f | %.2f | %.3f |\n",
                o.shape.c_str(), o.points, o.t_mdl, o.degree, o.normals ? "given" : "none", o.threads,
                cpu_used / unit, wall_used / unit, 1e6 * cpu_used / n, 1e6 * unit / n,
                1e6 * store->statistics().seconds / n, 1e6 * stats.seconds_noise / n,
                1e6 * stats.seconds_cover / n, 1e6 * stats.seconds_links / n,
                1e6 * stats.seconds_orient / n, stats.leaves / n, memory,
                static_cast<double>(stats.fits) / std::max<double>(1, stats.leaves), stats.gathered / n / 1e3);
    std::fflush(stdout);
  }
}

}  // namespace

int
main(int argc, char** argv)
{
  Options o;
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string key = argv[i];
    const char* value = argv[i + 1];
    if (key == "-points") o.points = std::strtoull(value, nullptr, 10);
    else if (key == "-shape") o.shape = value;
    else if (key == "-noise") o.noise = std::atof(value);
    else if (key == "-t_mdl") o.t_mdl = std::atof(value);
    else if (key == "-degree") o.degree = std::atoi(value);
    else if (key == "-threads") o.threads = std::atoi(value);
    else if (key == "-repeats") o.repeats = std::atoi(value);
    else if (key == "-normals") o.normals = std::atoi(value) != 0;
    else {
      std::fprintf(stderr, "unknown option %s\n", key.c_str());
      return 2;
    }
  }
  std::printf("instruction set %s\n", kernels::instructionSet());
  std::puts("| cloud | T | degree | normals | threads | units CPU | units wall | us/pt CPU | unit us/pt "
            "| wall us/pt: store noise cover links orient | leaves/pt | bytes/pt | fits/leaf | K gathered/pt |");
  run(o);
}
