// SPDX-License-Identifier: BSD-3-Clause
// How often the 95 % intervals of standard errors contain the truth: exact shapes with white noise,
// depth cameras with white, correlated and quantised noise, and what the errors cost.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "common/run_program.h"
#include "pcl_slim/fit/fit.h"
#include "pcl_slim/query/projection.h"
#include "support/lab/bench.h"
#include "support/lab/line_truth.h"
#include "support/lab/scenes.h"
#include "support/lab/sensor.h"

namespace {

using namespace pcl_slim;

constexpr double kWithin = 1.96;         ///< deviations of a normal distribution, 95 %
constexpr double kWithinOfTwo = 1.7308;  ///< of the length of two components, over their RMS length
constexpr double kEdge = 0.08;           ///< [m] nearer to two surfaces of a room is an edge

struct Settings {
  std::string shape = "sphere,torus,bumpy,relief", noise = "0.0003,0.001,0.003,0.01";
  std::string points = "5000,20000,80000";
  int seeds = 2, threads = 0;
  bool flat = true, cameras = true, cost = false;

  std::vector<std::string> shapes;
  std::vector<double> noises, counts;
};

OptionTable declareOptions(Settings& s) {
  OptionTable options("errors_bench", "1", "Measures how often error bars contain the truth.");
  options.text("shape", &s.shape, "NAME,...", "sphere, torus, bumpy, relief");
  options.text("noise", &s.noise, "S,...", "noise, as a share of the box diagonal");
  options.text("points", &s.points, "N,...", "sizes of the cloud");
  options.integer("seeds", &s.seeds, 1, 100, "scans of each row");
  options.toggle("flat", &s.flat, "rows of a cube, away from its edges, and of plates, too");
  options.toggle("cameras", &s.cameras, "rows of depth cameras, too");
  options.toggle("cost", &s.cost, "time of a projection with and without errors");
  options.integer("threads", &s.threads, 0, 4096, "threads, 0: all cores; changes no result");
  return options;
}

Error finishOptions(Settings& s) {
  if (Error error = measure::parseShapes(s.shape, s.shapes)) return error;
  return measure::parseLists({{"noise", &s.noise, 0, 1, false, &s.noises},
                              {"points", &s.points, 100, 4e9, true, &s.counts}});
}

/** The true surface at a place; of no use at a rim or an edge. */
struct TruePlace {
  double distance = 0, curvature = 0;
  Vector3 normal{};
  bool usable = true;
};

/** Sums over the points of a row. */
struct Row {
  double points = 0, position = 0, normal = 0, curvature = 0;
  double said_sq = 0, true_sq = 0;

  void add(const StandardErrors& said, double distance, double angle, double bent) {
    ++points;
    position += std::abs(distance) <= kWithin * said.position ? 1 : 0;
    normal += angle <= kWithinOfTwo * said.normal ? 1 : 0;
    curvature += std::abs(bent) <= kWithin * said.curvature ? 1 : 0;
    said_sq += double{said.position} * said.position;
    true_sq += distance * distance;
  }

  void print(const std::string& name, bool curved) const {
    std::printf("| %s | %.3f | %.3f |", name.c_str(), position / points, normal / points);
    if (curved) std::printf(" %.3f", curvature / points);
    std::printf(" | %.2f |\n", std::sqrt(said_sq / true_sq));
    std::fflush(stdout);
  }
};

/** Adds a cloud's projected points. \param[in] truth gives the TruePlace of stored point i at a
 * place in world coordinates */
template <typename Truth>
void addPoints(const PointStore& store, const Projection& projection, const Truth& truth,
               Row& row) {
  const double scale = store.scale();
  for (std::size_t i = 0; i < store.size(); ++i) {
    if (projection.supported[i] == 0) continue;
    Vector3 place;
    for (std::size_t a = 0; a < 3; ++a)
      place[a] = store.origin()[a] + scale * projection.position[i][a];
    const TruePlace t = truth(i, place);
    if (!t.usable) continue;
    const auto& n = projection.normal[i];
    const double cosine = n[0] * t.normal[0] + n[1] * t.normal[1] + n[2] * t.normal[2];
    const double bent =
        projection.curvature.empty()
            ? 0
            : (cosine < 0 ? -1 : 1) * projection.curvature[i][0] - t.curvature * scale;
    row.add(projection.errors[i], t.distance / scale, std::acos(std::min(1.0, std::abs(cosine))),
            bent);
  }
}

struct Scan {
  PointStore store;
  SLIMSurface surface;
};

Error fit(const CloudView& view, const FitParams& params, Scan& scan) {
  auto built = PointStore::build(view, params.threads);
  if (!built) return built.error();
  scan.store = std::move(*built);
  return fitSurface(scan.store, params, scan.surface);
}

/** Fits a cloud of doubles without normals and adds its points. */
template <typename Truth>
Error addCloud(const Settings& s, const std::vector<double>& points, const Truth& truth, Row& row) {
  CloudView view;
  view.xyz = points.data();
  view.xyz_stride = 3 * sizeof(double);
  view.scalar = CloudView::Scalar::kDouble;
  view.size = points.size() / 3;
  FitParams params;
  params.threads = s.threads;
  Scan scan;
  if (Error error = fit(view, params, scan)) return error;
  ProjectionParams wanted;
  wanted.curvature = wanted.errors = true;
  wanted.threads = s.threads;
  Projection projection;
  if (Error error = projectPoints(scan.store, scan.surface, wanted, projection)) return error;
  addPoints(scan.store, projection, truth, row);
  return {};
}

constexpr double kAwayFromEdges = 0.8;  ///< of half an edge: places within are usable

/** A cube with edges of 2, noise as a share of its diagonal. */
Error addCube(const Settings& s, double noise, std::uint64_t seed, Row& row) {
  const measure::Scene scene = measure::sampleCube(1, 20000, noise, seed);
  const auto truth = [](std::size_t, const Vector3& place) {
    std::size_t face = 0, inner = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      if (std::abs(place[a]) > std::abs(place[face])) face = a;
    }
    for (std::size_t a = 0; a < 3; ++a) inner += std::abs(place[a]) < kAwayFromEdges ? 1 : 0;
    TruePlace t;
    t.distance = std::abs(place[face]) - 1;
    t.normal[face] = place[face] < 0 ? -1 : 1;
    t.usable = inner == 2;
    return t;
  };
  return addCloud(s, scene.points, truth, row);
}

/** Two square sheets of 2 some spacings apart; noise in spacings. */
Error addPlate(const Settings& s, double apart, double noise, std::uint64_t seed, Row& row) {
  constexpr int kPoints = 10000;  // of a sheet
  const double spacing = 2.0 / std::sqrt(double{kPoints}), half = 0.5 * apart * spacing;
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> side(-1, 1);
  std::normal_distribution<double> error(0, noise * spacing);
  std::vector<double> points;
  for (int i = 0; i < 2 * kPoints; ++i) {
    const double x = side(random), y = side(random);
    const double z = (i < kPoints ? half : -half) + error(random);
    points.insert(points.end(), {x, y, z});
  }
  const auto truth = [half](std::size_t, const Vector3& place) {
    TruePlace t;
    t.distance = std::abs(place[2]) - half;
    t.normal[2] = place[2] < 0 ? -1 : 1;
    t.usable = std::max(std::abs(place[0]), std::abs(place[1])) < kAwayFromEdges;
    return t;
  };
  return addCloud(s, points, truth, row);
}

Error printFlat(const Settings& s) {
  for (const double noise : {0.001, 0.003}) {
    Row row;
    for (int seed = 1; seed <= s.seeds; ++seed) {
      if (Error error = addCube(s, noise, static_cast<std::uint64_t>(seed), row)) return error;
    }
    row.print("cube " + numberText(noise, 3), true);
  }
  for (const double apart : {8.0, 4.0}) {
    Row row;
    for (int seed = 1; seed <= s.seeds; ++seed) {
      if (Error error = addPlate(s, apart, 0.3, static_cast<std::uint64_t>(seed), row))
        return error;
    }
    row.print("plate " + numberText(apart, 3) + " spacings thick", true);
  }
  return {};
}

Error addScene(const Settings& s, measure::Shape shape, std::size_t count, double noise,
               std::uint64_t seed, Row& row) {
  const measure::Scene scene = measure::makeScene(shape, count, noise, 0, seed);
  const auto truth = [shape](std::size_t, const Vector3& place) {
    const measure::Truth t = measure::truthAt(shape, place);
    return TruePlace{t.distance, t.mean_curvature, t.normal, !t.rim};
  };
  return addCloud(s, scene.points, truth, row);
}

/** The nearest surface of a scan's scene; an edge has two near ones. */
TruePlace truthOfScan(const measure::SensorScan& scan, const Vector3& place) {
  TruePlace truth;
  std::vector<double> distances;
  for (const measure::Solid& solid : scan.solids) {
    const measure::Foot foot = measure::footOn(solid, place);
    if (distances.empty() || std::abs(foot.distance) < std::abs(truth.distance)) {
      truth.distance = foot.distance;
      truth.normal = foot.normal;
    }
    distances.push_back(std::abs(foot.distance));
  }
  truth.usable =
      std::count_if(distances.begin(), distances.end(), [](double d) { return d < kEdge; }) == 1;
  return truth;
}

struct CameraRow {
  const char* name;
  const char* scene;
  int correlated;      ///< [px]
  double sigma, step;  ///< [px] of disparity
};

Error addCamera(const Settings& s, const CameraRow& kind, std::uint64_t seed, Row& row) {
  measure::DepthCamera camera;
  camera.sigma = kind.sigma;
  camera.correlated_x = camera.correlated_y = kind.correlated;
  camera.step = kind.step;
  const measure::SensorScan seen =
      measure::scanByCamera(measure::namedSolids(kind.scene), camera, seed);
  CloudView view;
  view.xyz = seen.points.data();
  view.xyz_stride = 3 * sizeof(float);
  view.size = seen.size();
  FitParams params;
  params.threads = s.threads;
  params.viewpoint = seen.sensor;
  Scan scan;
  if (Error error = fit(view, params, scan)) return error;
  ProjectionParams wanted;
  wanted.errors = true;
  wanted.threads = s.threads;
  Projection projection;
  if (Error error = projectPoints(scan.store, scan.surface, wanted, projection)) return error;
  addPoints(
      scan.store, projection,
      [&](std::size_t, const Vector3& place) { return truthOfScan(seen, place); }, row);
  return {};
}

/** CPU seconds of projections of one cloud, the least of five. */
Error printCost(const Settings& s, measure::Shape shape, std::size_t count) {
  const measure::Scene scene = measure::makeScene(shape, count, 0.001, 0, 1);
  FitParams params;
  params.threads = s.threads;
  Scan scan;
  if (Error error = fit(measure::viewOf(scene, nullptr, false), params, scan)) return error;
  double seconds[2] = {1e300, 1e300};
  for (int run = 0; run < 5; ++run) {
    for (const bool errors : {false, true}) {
      ProjectionParams wanted;
      wanted.errors = errors;
      wanted.threads = s.threads;
      Projection projection;
      const double start = measure::cpuSeconds();
      if (Error error = projectPoints(scan.store, scan.surface, wanted, projection)) return error;
      seconds[errors ? 1 : 0] = std::min(seconds[errors ? 1 : 0], measure::cpuSeconds() - start);
    }
  }
  std::printf("projection of %zu points: %.3f CPU s, with errors %.3f\n", count, seconds[0],
              seconds[1]);
  return {};
}

Error run(const Settings& s) {
  if (s.cost) return printCost(s, measure::Shape::kBumpy, 400000);
  std::printf(
      "| scene | position | normal | curvature | said / true RMS |\n|---|---|---|---|---|\n");
  for (const std::string& name : s.shapes) {
    measure::Shape shape{};
    measure::parseShape(name, shape);
    for (const double noise : s.noises) {
      for (const double count : s.counts) {
        Row row;
        for (int seed = 1; seed <= s.seeds; ++seed) {
          if (Error error = addScene(s, shape, static_cast<std::size_t>(count), noise,
                                     static_cast<std::uint64_t>(seed), row))
            return error;
        }
        row.print(name + " " + numberText(noise, 3) + " " + numberText(count, 7), true);
      }
    }
  }
  if (s.flat) {
    if (Error error = printFlat(s)) return error;
  }
  if (!s.cameras) return {};
  constexpr CameraRow kCameras[] = {{"white", "balls", 1, 0.06, 0},
                                    {"shared by 3 px", "balls", 3, 0.06, 0},
                                    {"shared by 5 px", "balls", 5, 0.06, 0},
                                    {"shared by 7 px", "balls", 7, 0.06, 0},
                                    {"steps of 1/8 px", "balls", 1, 0, .125},
                                    {"both", "balls", 3, 0.06, .125},
                                    {"white", "room", 1, 0.06, 0},
                                    {"shared by 3 px", "room", 3, 0.06, 0},
                                    {"shared by 5 px", "room", 5, 0.06, 0},
                                    {"shared by 7 px", "room", 7, 0.06, 0},
                                    {"shared by 3 px", "wave40", 3, 0.06, 0}};
  for (const CameraRow& camera : kCameras) {
    Row row;
    for (int seed = 1; seed <= s.seeds; ++seed) {
      if (Error error = addCamera(s, camera, static_cast<std::uint64_t>(seed), row)) return error;
    }
    row.print(std::string(camera.scene) + ", " + camera.name, false);
  }
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  Settings s;
  OptionTable options = declareOptions(s);
  return runProgram(options, argc, argv, "give smaller -points", [&]() -> Exit {
    if (Error error = finishOptions(s)) return Exit::usage(error);
    return run(s);
  });
}
