// SPDX-License-Identifier: BSD-3-Clause
// Smooths noisy meshes by SLIM surfaces and by other filters, and compares with the originals.
#include <cstdio>
#include <string>

#include "common/options.h"
#include "mesh/measures.h"
#include "mesh/rivals.h"
#include "pcl_slim/mesh/mesh_smoothing.h"
#include "pcl_slim/query/projection.h"
#include "support/lab/bench.h"

namespace {

using namespace pcl_slim;
using namespace pcl_slim::mesh_bench;

struct Settings {
  std::string folder, names = "julius_02,fandisk_03,block_04", save;
  std::string filters = "all";
  int threads = 1;
};

void printRow(const std::string& name, const std::string& method, const Measures& m,
              double seconds) {
  std::printf("| %s | %s | %.4f | %.4f | %.2f | %+.4f | %.4f | %.2f | %zu | %zu | %.2f |\n",
              name.c_str(), method.c_str(), m.surface_rms, m.vertex_rms, m.angle, 100 * m.volume,
              m.sharp_rms, m.sharp_angle, m.folded, m.newly_folded, seconds);
  std::fflush(stdout);
}

/** One method's setting and what it gave. */
struct Run {
  std::string setting;
  Points vertices;
  Measures measures;
  double seconds = 0;
};

/** A pair of meshes, and what is done with it. */
struct Task {
  const Settings& settings;
  const Pair& pair;
  Comparison compare;
};

/** The best runs of a sweep, by distance and by normals. */
class Sweep {
 public:
  Sweep(const Task& task, std::string method) : task_(task), method_(std::move(method)) {}

  void add(const std::string& setting, const Points& vertices, double seconds) {
    const Measures m = task_.compare.of(vertices);
    if (!any_ || m.surface_rms < nearest_.measures.surface_rms) {
      nearest_ = {setting, vertices, m, seconds};
    }
    if (!any_ || m.angle < straightest_.measures.angle) {
      straightest_ = {setting, vertices, m, seconds};
    }
    any_ = true;
  }

  void print() const {
    const bool same = straightest_.setting == nearest_.setting;
    printOne(nearest_, same ? "" : ", best RMS");
    if (!same) printOne(straightest_, ", best normals");
  }

 private:
  void printOne(const Run& run, const std::string& what) const {
    printRow(task_.pair.name, method_ + what + (run.setting.empty() ? "" : ": ") + run.setting,
             run.measures, run.seconds);
    if (task_.settings.save.empty()) return;
    const std::string file =
        task_.settings.save + "/" + task_.pair.name + " " + method_ + what + ".ply";
    if (Error error = saveMesh(file, run.vertices, task_.pair.faces)) {
      std::fprintf(stderr, "mesh_bench: %s\n", error.message.c_str());
    }
  }

  const Task& task_;
  std::string method_;
  Run nearest_, straightest_;
  bool any_ = false;
};

std::string settingText(const char* first, double a, const char* second, double b) {
  char buffer[80];
  std::snprintf(buffer, sizeof(buffer), "%s %g, %s %g", first, a, second, b);
  return buffer;
}

void sweepJones(const Task& task) {
  const Pair& pair = task.pair;
  Sweep sweep(task, "Jones");
  for (const double spatial : {0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 4.0}) {
    for (const double range : {0.1, 0.2, 0.35, 0.5, 0.75, 1.0, 1.5, 2.0}) {
      const double begin = measure::cpuSeconds();
      const Points made = jonesFilter(pair.noisy, pair.faces, {spatial, range});
      sweep.add(settingText("sigma_f", spatial, "sigma_g", range), made,
                measure::cpuSeconds() - begin);
    }
  }
  sweep.print();
}

template <typename Filter>
void sweepNormals(Sweep sweep, const Pair& pair, const Filter& filter,
                  const std::vector<double>& ranges) {
  const std::vector<int> snapshots = {1, 2, 3, 5, 8, 12, 20, 30, 50, 75, 100};
  for (const double range : ranges) {
    for (const int vertex_iterations : {10, 20}) {
      double begin = measure::cpuSeconds();
      filter(pair.noisy, pair.faces, NormalFilterParams{range, snapshots, vertex_iterations},
             [&](int iterations, const Points& made) {
               const double seconds = measure::cpuSeconds() - begin;
               sweep.add(settingText("sigma_r", range, "iterations", iterations) + " x " +
                             std::to_string(vertex_iterations),
                         made, seconds);
               begin = measure::cpuSeconds() - seconds;  // comparing is no part of the filter
             });
    }
  }
  sweep.print();
}

Error projectVertices(const Task& task) {
  const Pair& pair = task.pair;
  Sweep sweep(task, "plain projection");
  for (const bool sharp : {false, true}) {
    const double begin = measure::cpuSeconds();
    Points made;
    if (Error error = plainProjection(pair.noisy, pair.faces, sharp, task.settings.threads, made)) {
      return error;
    }
    sweep.add(sharp ? "sharp" : "default", made, measure::cpuSeconds() - begin);
  }
  sweep.print();
  return {};
}

Error smooth(const Pair& pair, const MeshSmoothParams& params, const std::string& setting,
             Sweep& sweep) {
  CloudView view;
  view.xyz = pair.noisy.data();
  view.xyz_stride = sizeof(Vector3);
  view.scalar = CloudView::Scalar::kDouble;
  view.size = pair.noisy.size();
  SmoothedMesh made;
  const double begin = measure::cpuSeconds();
  if (Error error = smoothMesh(view, pair.faces, params, nullptr, made)) return error;
  sweep.add(setting, made.vertices, measure::cpuSeconds() - begin);
  return {};
}

Error smooth(const Task& task, const std::string& method, const MeshSmoothParams& params) {
  Sweep sweep(task, method);
  if (Error error = smooth(task.pair, params, "", sweep)) return error;
  sweep.print();
  return {};
}

/** The published method, its T as in the paper's fits and at its best. */
Error smoothAsPaper(const Task& task, MeshSmoothParams params) {
  params.fit.paper_mode = true;
  if (Error error = smooth(task, "SLIM, -paper 1", params)) return error;
  Sweep sweep(task, "SLIM, -paper 1, any T");
  for (const double t : {0.005, 0.01, 0.02, 0.03, 0.04, 0.06, 0.08, 0.1, 0.15, 0.2, 0.4}) {
    params.fit.size = MDLThreshold{t};
    char setting[24];
    std::snprintf(setting, sizeof(setting), "T %g", t);
    if (Error error = smooth(task.pair, params, setting, sweep)) return error;
  }
  sweep.print();
  return {};
}

Error smoothOurs(const Task& task) {
  MeshSmoothParams params;
  params.fit.threads = task.settings.threads;
  if (Error error = smooth(task, "SLIM, default", params)) return error;
  params.edges = MeshEdges::kRounded;
  if (Error error = smooth(task, "SLIM, -sharp 0", params)) return error;
  params.edges = MeshEdges::kSharp;
  if (Error error = smooth(task, "SLIM, -sharp 1", params)) return error;
  params.edges = MeshEdges::kMeasured;
  return smoothAsPaper(task, params);
}

Error runPair(const Settings& settings, const std::string& name) {
  const auto pair = loadPair(settings.folder, name);
  if (!pair) return pair.error();
  const Task task{settings, *pair, Comparison(*pair)};
  printRow(name, "original", task.compare.of(pair->truth), 0);
  printRow(name, "noisy", task.compare.of(pair->noisy), 0);
  if (Error error = smoothOurs(task)) return error;
  if (settings.filters == "none") return {};
  if (Error error = projectVertices(task)) return error;
  sweepJones(task);
  if (settings.filters == "paper") return {};
  sweepNormals(Sweep(task, "Zheng"), *pair, bilateralNormalFilter,
               {0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.5, 0.6, 0.8});
  sweepNormals(Sweep(task, "guided"), *pair, guidedNormalFilter,
               {0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.5, 0.6});
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  Settings settings;
  OptionTable options("mesh_bench", "1", "Measures filters of meshes against the originals.");
  options.positional("FOLDER", &settings.folder, "holds NAME_noisy.ply and NAME_original.ply");
  options.text("pairs", &settings.names, "NAME,...", "pairs to run");
  options.text("save", &settings.save, "FOLDER", "keep the meshes that rows tell of");
  options.choice(
      "filters", &settings.filters, {"none", "paper", "all"},
      "filters beside ours: the paper's projection and Jones's, all with Zheng's and Zhang's");
  options.integer("threads", &settings.threads, 0, 4096, "threads of SLIM, 0: all cores");
  if (const auto status = options.parse(argc, argv)) return *status;
  std::printf(
      "| pair | method | RMS | to own vertex | normals | volume %% | RMS at edges | edges | folded "
      "| new | s |\n|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (std::size_t at = 0; at <= settings.names.size();) {
    const std::size_t comma = std::min(settings.names.find(',', at), settings.names.size());
    if (Error error = runPair(settings, settings.names.substr(at, comma - at))) {
      std::fprintf(stderr, "mesh_bench: %s\n", error.message.c_str());
      return 2;
    }
    at = comma + 1;
  }
  return 0;
}
