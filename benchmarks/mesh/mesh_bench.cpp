// SPDX-License-Identifier: BSD-3-Clause
// Smooths noisy meshes by SLIM surfaces and by other filters, and compares with the originals.
#include <cstdio>
#include <string>

#include "common/options.h"
#include "measure/clocks.h"
#include "mesh/measures.h"
#include "mesh/rivals.h"
#include "ours.h"

namespace {

using namespace pcl_slim;
using namespace pcl_slim::mesh_bench;

void
printRow(const std::string& name, const std::string& method, const Measures& m, double seconds)
{
  std::printf("| %s | %s | %.4f | %.4f | %.2f | %+.2e | %.4f | %.2f | %zu | %zu | %.2f |\n",
              name.c_str(), method.c_str(), m.surface_rms, m.vertex_rms, m.angle, m.volume,
              m.sharp_rms, m.sharp_angle, m.folded, m.newly_folded, seconds);
  std::fflush(stdout);
}

/** The best of a sweep, by distance and by normals. */
class Sweep {
 public:
  Sweep(const Pair& pair, std::string method) : pair_(pair), method_(std::move(method)) {}

  void add(const std::string& setting, const Points& vertices, double seconds)
  {
    const Measures m = compare(pair_, vertices);
    if (!any_ || m.surface_rms < nearest_.m.surface_rms) nearest_ = {setting, m, seconds};
    if (!any_ || m.angle < straightest_.m.angle) straightest_ = {setting, m, seconds};
    any_ = true;
  }

  void print() const
  {
    printRow(pair_.name, method_ + ", best RMS: " + nearest_.setting, nearest_.m, nearest_.seconds);
    if (straightest_.setting == nearest_.setting) return;
    printRow(pair_.name, method_ + ", best normals: " + straightest_.setting, straightest_.m,
             straightest_.seconds);
  }

 private:
  struct Run {
    std::string setting;
    Measures m;
    double seconds = 0;
  };
  const Pair& pair_;
  std::string method_;
  Run nearest_, straightest_;
  bool any_ = false;
};

std::string
text(const char* format, double a, double b)
{
  char buffer[64];
  std::snprintf(buffer, sizeof(buffer), format, a, b);
  return buffer;
}

void
sweepJones(const Pair& pair)
{
  Sweep sweep(pair, "Jones");
  for (const double spatial : {0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 4.0}) {
    for (const double range : {0.1, 0.2, 0.35, 0.5, 0.75, 1.0, 1.5, 2.0}) {
      const double begin = measure::cpuSeconds();
      const Points made = jonesFilter(pair.noisy, pair.faces, {spatial, range});
      sweep.add(text("sigma_f %g, sigma_g %g", spatial, range), made,
                measure::cpuSeconds() - begin);
    }
  }
  sweep.print();
}

template <typename Filter>
void
sweepNormals(const Pair& pair, const std::string& name, const Filter& filter,
             const std::vector<double>& ranges, const std::vector<int>& snapshots)
{
  Sweep sweep(pair, name);
  for (const double range : ranges) {
    for (const int vertex_iterations : {10, 20}) {
      const double begin = measure::cpuSeconds();
      filter(pair.noisy, pair.faces, NormalFilterParams{range, snapshots, vertex_iterations},
             [&](int iterations, const Points& made) {
               sweep.add(text("sigma_r %g, %g iterations", range, iterations) + ", " +
                             std::to_string(vertex_iterations) + " of vertices",
                         made, measure::cpuSeconds() - begin);
             });
    }
  }
  sweep.print();
}

}  // namespace

int
main(int argc, char** argv)
{
  const std::string folder = argv[1];
  const std::string which = argc > 2 ? argv[2] : "all";
  const std::string names = argc > 3 ? argv[3] : "julius_02 fandisk_03 block_04";
  std::printf(
      "| pair | method | RMS | vertex RMS | normals | volume | sharp RMS | sharp angle | folded | "
      "new | s |\n");
  for (const char* name : {"julius_02", "fandisk_03", "block_04"}) {
    if (names.find(name) == std::string::npos) continue;
    const auto pair = loadPair(folder, name);
    if (!pair) {
      std::fprintf(stderr, "mesh_bench: %s\n", pair.error().message.c_str());
      return 2;
    }
    printRow(name, "truth", compare(*pair, pair->truth), 0);
    printRow(name, "noisy", compare(*pair, pair->noisy), 0);
    if (which.find("ours") != std::string::npos) ours(*pair, argc > 4 ? argv[4] : "", printRow);
    if (which == "rivals" || which == "all") {
      sweepJones(*pair);
    }
    if (which == "rivals" || which == "all" || which == "guided") {
      sweepNormals(*pair, "Zheng", bilateralNormalFilter,
                   {0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.5, 0.6, 0.8},
                   {1, 2, 3, 5, 8, 12, 20, 30, 50});
      sweepNormals(*pair, "Guided", guidedNormalFilter, {0.2, 0.25, 0.3, 0.35, 0.4, 0.5, 0.6},
                   {1, 2, 3, 5, 8, 12, 20, 30, 50});
    }
  }
  return 0;
}
