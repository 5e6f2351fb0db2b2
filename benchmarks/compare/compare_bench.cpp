// SPDX-License-Identifier: BSD-3-Clause
// Changes between two scans: errors of distances, false alarms, power; time and memory of distances.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <random>

#include "common/run_program.h"
#include "compare/change_scene.h"
#include "compare/m3c2.h"
#include "compare/rival_distances.h"
#include "pcl_slim/compare/deviation.h"
#include "pcl_slim/fit/fit.h"
#include "support/lab/bench.h"

namespace {

using namespace pcl_slim;
using change::Dent;
using change::Estimate;
using change::Scan;
using change::Score;

struct Settings {
  std::string what = "change", shapes = "sphere,torus,bumpy,relief", noises = "0.002",
              offs = "0,0.001,0.01,0.1";
  int threads = 1, seed = 1, repeats = 1;
  double points = 100000, reference_points = 60000, reference_noise = 0.001, radius = 0.15,
         cores = 2000, triangles = 1000000;
  std::vector<double> off_values;
};

OptionTable declareOptions(Settings& s) {
  OptionTable options("compare_bench", "1",
                      "Measures distances between scans with known changes, and what they cost.");
  options.text("what", &s.what, "change|cost",
               "change: errors, false alarms and power; cost: time and memory");
  options.text("shapes", &s.shapes, "NAME,...", "sphere, torus, bumpy, relief");
  options.text("noise", &s.noises, "S,...", "of the scan that changes, share of the diagonal");
  options.number("reference_noise", &s.reference_noise, 0, 1, "of the other scan");
  options.number("points", &s.points, 1000, 1e8, "of the scan that changes; places of -what cost");
  options.number("reference_points", &s.reference_points, 1000, 1e8, "of the other scan");
  options.number("radius", &s.radius, 0, 1, "of the dent, share of the diagonal");
  options.number("cores", &s.cores, 100, 1e7, "points that are judged");
  options.text("off", &s.offs, "S,...", "deviation of the places of -what cost from the reference");
  options.number("triangles", &s.triangles, 100, 1e8, "of the mesh of -what cost");
  options.integer("seed", &s.seed, 0, 1000000, "of points and noise");
  options.integer("repeats", &s.repeats, 1, 1000, "pairs of scans, whose figures are averaged");
  options.integer("threads", &s.threads, 0, 4096, "threads of -what cost; 0: all cores");
  return options;
}

/** The value below which a share of the sizes are. */
double quantile(const std::vector<double>& values, double share) {
  std::vector<double> sizes;
  for (const double v : values) {
    if (std::isfinite(v)) sizes.push_back(std::abs(v));
  }
  if (sizes.empty()) return 0;
  std::sort(sizes.begin(), sizes.end());
  return sizes[static_cast<std::size_t>(share * static_cast<double>(sizes.size() - 1))];
}

/** A pair of scans: unchanged and with a dent, against one reference. */
struct Pair {
  Scan same, dented, reference;
  std::vector<std::size_t> chosen;  ///< of all points
  std::vector<std::size_t> inside;  ///< in the dent
};

/** Sums over pairs of what a method found. */
struct Row {
  std::string name;
  bool has_detection = true;
  double count = 0, rms = 0, alarms = 0, detected = 0, volume = 0, volume_square = 0, detection = 0,
         known = 0, seconds = 0;

  void add(const Pair& pair, const Estimate& same, const Estimate& dented, double threshold);
  void print() const;
};

void Row::add(const Pair& pair, const Estimate& same, const Estimate& dented, double threshold) {
  const Score flat = scoreOf(pair.same, pair.chosen, same, threshold);
  const Score hole = scoreOf(pair.dented, pair.inside, dented, threshold);
  has_detection = !same.detection.empty();
  ++count;
  rms += flat.rms / pair.same.diagonal;
  alarms += 1 - flat.within;
  detected += hole.detected;
  volume += hole.volume;
  volume_square += hole.volume * hole.volume;
  detection += flat.detection / pair.same.diagonal;
  known += flat.known;
  seconds += same.seconds;
}

void Row::print() const {
  const double mean = volume / count;
  const double spread = std::sqrt(std::max(0.0, volume_square / count - mean * mean));
  std::printf("| %s | %.3f | %s%.1f | %.1f | %.3f +- %.3f | %.3f | %.1f | %.2f |\n", name.c_str(),
              1e3 * rms / count, has_detection ? "" : "*", 100 * alarms / count,
              100 * detected / count, mean, spread, 1e3 * detection / count, 100 * known / count,
              seconds / count);
}

std::vector<std::size_t> chooseEvenly(std::vector<std::size_t> from, std::size_t most) {
  std::vector<std::size_t> chosen;
  const std::size_t step = std::max<std::size_t>(1, from.size() / most);
  for (std::size_t k = 0; k < from.size(); k += step) chosen.push_back(from[k]);
  return chosen;
}

/** The scales of M3C2 that are best by the truth: of the least error of the unchanged scan and of the
 * dent together, of those that leave out no more than 5 % of the points. */
change::M3C2Scales bestScales(const Pair& pair) {
  const double spacing =
      pair.same.diagonal / std::sqrt(static_cast<double>(pair.reference.points.size()));
  double least = Bounds::kInfinity;
  change::M3C2Scales best;
  for (const double normal : {4.0, 8.0, 16.0, 32.0}) {
    for (const double projection : {2.0, 4.0, 8.0, 16.0}) {
      const change::M3C2Scales scales = {normal * spacing, projection * spacing,
                                         0.02 * pair.same.diagonal};
      const Estimate same = m3c2(pair.same, pair.reference, pair.chosen, scales);
      const Estimate dented = m3c2(pair.dented, pair.reference, pair.inside, scales);
      const Score flat = scoreOf(pair.same, pair.chosen, same, 0);
      const double score = std::hypot(flat.rms, scoreOf(pair.dented, pair.inside, dented, 0).rms);
      if (!(score < least) || flat.known < 0.95) continue;
      least = score;
      best = scales;
    }
  }
  return best;
}

/** Makes a pair of scans, whose dent is two levels of detection deep, and compares the surfaces. */
Error makePair(const Settings& s, measure::Shape shape, double noise, std::uint64_t seed,
               Pair& pair, TriangleMesh& mesh, double& mesh_seconds, Row& row) {
  const auto count = static_cast<std::size_t>(s.points);
  const auto cores = static_cast<std::size_t>(s.cores);
  pair.reference = change::scanOf(shape, static_cast<std::size_t>(s.reference_points),
                                  s.reference_noise, 1000 + seed, {});
  pair.same = change::scanOf(shape, count, noise, 2000 + seed, {});
  std::vector<std::size_t> all(count);
  std::iota(all.begin(), all.end(), 0);
  pair.chosen = chooseEvenly(all, cores);
  const Result<Estimate> same =
      surfaceDistances(pair.same, pair.reference, pair.chosen, mesh, mesh_seconds);
  if (!same) return same.error();
  Dent dent;
  dent.radius = s.radius * pair.same.diagonal;
  dent.depth = 2 * scoreOf(pair.same, pair.chosen, *same, 0).detection;
  pair.dented = change::scanOf(shape, count, noise, 3000 + seed, dent);
  std::vector<std::size_t> inside;
  for (std::size_t i = 0; i < count; ++i) {
    if (pair.dented.change[i] != 0) inside.push_back(i);
  }
  pair.inside = chooseEvenly(inside, cores);
  const Result<Estimate> dented =
      surfaceDistances(pair.dented, pair.reference, pair.inside, mesh, mesh_seconds);
  if (!dented) return dented.error();
  row.add(pair, *same, *dented, 0);
  return {};
}

Error printShape(const Settings& s, const std::string& name, double noise) {
  measure::Shape shape;
  measure::parseShape(name, shape);
  Row surfaces{"surfaces"}, best{"M3C2"}, nearest{"nearest points"}, to_mesh{"points to mesh"};
  change::M3C2Scales scales;
  for (int k = 0; k < s.repeats; ++k) {
    Pair pair;
    TriangleMesh mesh;
    double mesh_seconds = 0;
    if (Error error = makePair(s, shape, noise, static_cast<std::uint64_t>(s.seed + 17 * k), pair,
                               mesh, mesh_seconds, surfaces)) {
      return error;
    }
    if (k == 0) scales = bestScales(pair);
    best.add(pair, m3c2(pair.same, pair.reference, pair.chosen, scales),
             m3c2(pair.dented, pair.reference, pair.inside, scales), 0);
    const Estimate near = nearestPoints(pair.same, pair.reference, pair.chosen);
    nearest.add(pair, near, nearestPoints(pair.dented, pair.reference, pair.inside),
                quantile(near.distance, 0.95));
    const Estimate meshed = distancesToMesh(pair.same, mesh, mesh_seconds, pair.chosen);
    to_mesh.add(pair, meshed, distancesToMesh(pair.dented, mesh, mesh_seconds, pair.inside),
                quantile(meshed.distance, 0.95));
  }
  std::printf("\n%s, noise %.2f %% and %.2f %%, dent of radius %.2f L\n\n", name.c_str(),
              100 * noise, 100 * s.reference_noise, s.radius);
  std::printf(
      "| method | RMS error [1e-3 L] | false alarms [%%] | dent found [%%] | its volume "
      "| detection [1e-3 L] | known [%%] | CPU s |\n|---|---|---|---|---|---|---|---|\n");
  for (const Row* row : {&surfaces, &best, &nearest, &to_mesh}) row->print();
  std::printf("\nM3C2's radii, of the normal and of the cylinder: %.3f and %.3f\n", scales.normal,
              scales.projection);
  std::fflush(stdout);
  return {};
}

/** A bumpy sphere of about so many triangles. */
TriangleMesh bumpyMesh(double triangles) {
  const auto rows = static_cast<std::uint32_t>(std::sqrt(triangles / 4));
  const std::uint32_t columns = 2 * rows;
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i <= rows; ++i) {
    for (std::uint32_t j = 0; j < columns; ++j) {
      const double a = 3.14159265358979323846 * i / rows, b = 6.283185307179586 * j / columns;
      const Vector3 d = {std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a)};
      const double r = 1 + 0.1 * std::sin(5 * d[0]) * std::sin(5 * d[1]) * std::cos(5 * d[2]);
      mesh.vertices.push_back(scaled(d, r));
    }
  }
  for (std::uint32_t i = 0; i < rows; ++i) {
    for (std::uint32_t j = 0; j < columns; ++j) {
      const std::uint32_t a = columns * i + j, b = columns * i + (j + 1) % columns;
      mesh.triangles.push_back({a, a + columns, b + columns});
      mesh.triangles.push_back({a, b + columns, b});
    }
  }
  return mesh;
}

void printCost(const Settings& s, const std::string& name, const DeviationReference& reference,
               double seconds) {
  for (const double noise : s.off_values) {
    std::vector<Vector3> positions;
    {
      const Scan scan =
          change::scanOf(measure::Shape::kBumpy, static_cast<std::size_t>(s.points), noise, 5, {});
      positions = scan.points;
    }
    DeviationPlaces places;
    places.positions = positions.data();
    places.count = positions.size();
    DeviationParams params;
    params.feet.threads = s.threads;
    Deviations deviations;
    const measure::MemoryGauge gauge;
    const double start = measure::cpuSeconds(), wall = measure::wallSeconds();
    if (measureDeviations(reference, places, params, deviations)) return;
    const double n = s.points;
    std::printf("| %s | %.1f | %.2f | %.1f %% | %.2f | %.2f | %.0f |\n", name.c_str(),
                static_cast<double>(reference.memoryBytes()) / 1e6, seconds, 100 * noise,
                1e6 * (measure::cpuSeconds() - start) / n,
                1e6 * (measure::wallSeconds() - wall) / n, gauge.peakBytes() / 1e6);
    std::fflush(stdout);
  }
}

Error printCosts(const Settings& s) {
  std::printf(
      "%.0f places, %d threads\n\n| reference | MB | build [CPU s] | off it, of L | CPU "
      "[us a place] | wall [us a place] | memory at its peak [MB] "
      "|\n|---|---|---|---|---|---|---|\n",
      s.points, s.threads);
  double start = measure::cpuSeconds();
  {
    const TriangleMesh mesh = bumpyMesh(s.triangles);
    const Result<DeviationReference> to_mesh = DeviationReference::make(mesh, {}, s.threads);
    if (!to_mesh) return to_mesh.error();
    printCost(s, "mesh", *to_mesh, measure::cpuSeconds() - start);
  }
  const Scan scan =
      change::scanOf(measure::Shape::kBumpy, static_cast<std::size_t>(s.reference_points),
                     s.reference_noise, 3, {});
  auto store = PointStore::build(scan.view(), 1);
  if (!store) return store.error();
  SLIMSurface surface;
  if (Error error = fitSurface(*store, {}, surface)) return error;
  start = measure::cpuSeconds();
  const Result<DeviationReference> to_surface = DeviationReference::make(surface, s.threads);
  if (!to_surface) return to_surface.error();
  printCost(s, "surface", *to_surface, measure::cpuSeconds() - start);
  return {};
}

Exit run(Settings& s) {
  if (s.what != "change" && s.what != "cost") {
    return {kExitUsage, "-what is neither change nor cost; give one of them"};
  }
  std::vector<std::string> shapes;
  std::vector<double> noises;
  if (Error error = measure::parseShapes(s.shapes, shapes)) return Exit::usage(error);
  if (Error error = measure::parseLists({{"noise", &s.noises, 0, 1, false, &noises}})) {
    return Exit::usage(error);
  }
  if (Error error = measure::parseLists({{"off", &s.offs, 0, 10, false, &s.off_values}})) {
    return Exit::usage(error);
  }
  if (s.what == "cost") return printCosts(s);
  for (const std::string& shape : shapes) {
    for (const double noise : noises) {
      if (Error error = printShape(s, shape, noise)) return error;
    }
  }
  std::printf(
      "\n*: the method has no level of detection; the threshold is the 95 %% quantile of the "
      "unchanged scan.\n");
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  Settings s;
  OptionTable options = declareOptions(s);
  return runProgram(options, argc, argv, "give fewer points", [&] { return run(s); });
}
