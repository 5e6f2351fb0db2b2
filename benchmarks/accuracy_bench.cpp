// SPDX-License-Identifier: BSD-3-Clause
// Error of fit and projection against exact truth: position, normal and mean curvature.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <string>
#include <vector>

#include "pcl_slim/slim/fit.h"
#include "pcl_slim/slim/projection.h"
#include "scenes.h"

namespace {

using namespace pcl_slim;

struct Options {
  std::size_t points = 100000;
  std::string shapes = "sphere,torus,bumpy,relief";
  std::string noises = "0,0.0001,0.001,0.005";
  std::string degrees = "4";
  double t_mdl = 0, penalty = 3, lambda = 0;
  double normal_noise = 0.05;
  int normals = 2;  ///< 0: none, 1: given, 2: both
  int threads = 2;
  bool float_input = false;
  double alpha = 2.0 / 3;
  bool paper = false;
};

std::vector<std::string>
split(const std::string& list)
{
  std::vector<std::string> parts;
  std::stringstream stream(list);
  for (std::string part; std::getline(stream, part, ',');) parts.push_back(part);
  return parts;
}

struct Errors {
  double position = 0, worst = 0, normal = 0, curvature = 0;
};

Errors
measure(bench::Shape shape, const PointStore& store, const Projection& projection)
{
  Errors e;
  double curvature_scale = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < store.size(); ++i) {
    std::array<double, 3> p = projection.position[i];
    for (int a = 0; a < 3; ++a) p[a] = store.origin()[a] + store.scale() * p[a];
    const bench::Truth truth = bench::truthAt(shape, p);
    e.position += truth.distance * truth.distance;
    e.worst = std::max(e.worst, std::abs(truth.distance));
    if (!projection.supported[i] || truth.rim) continue;
    const auto& n = projection.normal[i];
    double cross_sq = 0, dot = 0;
    for (int a = 0; a < 3; ++a) {
      const int b = (a + 1) % 3, c = (a + 2) % 3;
      const double x = n[b] * truth.normal[c] - n[c] * truth.normal[b];
      cross_sq += x * x;
      dot += n[a] * truth.normal[a];
    }
    const double angle = std::atan2(std::sqrt(cross_sq), std::abs(dot));
    e.normal += angle * angle;
    const double sign = dot < 0 ? -1 : 1;
    const double h = sign * projection.curvature[i][0] / store.scale();
    e.curvature += (h - truth.mean_curvature) * (h - truth.mean_curvature);
    curvature_scale += truth.mean_curvature * truth.mean_curvature;
    ++count;
  }
  e.position = std::sqrt(e.position / store.size());
  e.normal = std::sqrt(e.normal / count) * 180 / M_PI;
  e.curvature = std::sqrt(e.curvature / curvature_scale);
  return e;
}

void
run(const Options& o, const std::string& name, double noise, int degree, bool normals)
{
  bench::Shape shape;
  if (!bench::parseShape(name, shape)) {
    std::fprintf(stderr, "unknown shape '%s': use sphere, torus, bumpy or relief\n", name.c_str());
    std::exit(2);
  }
  const bench::Scene scene = bench::makeScene(shape, o.points, noise, o.normal_noise, 7);
  const std::vector<float> floats(scene.points.begin(), scene.points.end());
  CloudView view;
  view.xyz = o.float_input ? static_cast<const void*>(floats.data()) : scene.points.data();
  view.scalar = o.float_input ? CloudView::Scalar::kFloat : CloudView::Scalar::kDouble;
  view.xyz_stride = o.float_input ? 12 : 24;
  view.size = o.points;
  if (normals) {
    view.normal = scene.normals.data();
    view.normal_stride = 12;
  }
  FitParams params;
  params.degree = degree;
  params.t_mdl = o.t_mdl;
  params.penalty = o.penalty;
  params.lambda = o.lambda;
  params.threads = o.threads;
  params.cover_radius = o.alpha;
  params.paper_mode = o.paper;
  const auto store = PointStore::build(view, o.threads);
  SLIMSurface surface;
  FitStatistics stats;
  Projection projection;
  ProjectionParams projection_params;
  projection_params.curvature = true;
  projection_params.threads = o.threads;
  projection_params.paper_mode = o.paper;
  if (!store) std::exit(1);
  Error error = fitSurface(*store, params, surface, &stats);
  if (!error) error = projectPoints(*store, surface, projection_params, projection);
  if (error) {
    std::fprintf(stderr, "%s\n", error.message.c_str());
    std::exit(1);
  }
  const Errors e = measure(shape, *store, projection);
  std::printf("| %s | %g | %d | %s | %.2e | %.2e | %.3g | %.3g | %.2e | %.2e | %.3f | %.0f%% | %d-%d | %llu | %llu |\n",
              name.c_str(), noise, degree, normals ? "given" : "none", e.position,
              e.position / scene.diagonal, e.normal, e.curvature, e.worst,
              std::sqrt(stats.lambda) * store->diagonal() * store->scale() / scene.diagonal,
              static_cast<double>(stats.leaves) / o.points, 100.0 * stats.forced / stats.leaves,
              stats.first_level, stats.last_level, (unsigned long long)stats.uncovered,
              (unsigned long long)projection.num_unsupported);
  std::fflush(stdout);
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
    else if (key == "-shapes") o.shapes = value;
    else if (key == "-noises") o.noises = value;
    else if (key == "-degrees") o.degrees = value;
    else if (key == "-t_mdl") o.t_mdl = std::atof(value);
    else if (key == "-penalty") o.penalty = std::atof(value);
    else if (key == "-lambda") o.lambda = std::atof(value);
    else if (key == "-normals") o.normals = std::atoi(value);
    else if (key == "-normal_noise") o.normal_noise = std::atof(value);
    else if (key == "-threads") o.threads = std::atoi(value);
    else if (key == "-float") o.float_input = std::atoi(value) != 0;
    else if (key == "-alpha") o.alpha = std::atof(value);
    else if (key == "-paper") o.paper = std::atoi(value) != 0;
    else {
      std::fprintf(stderr, "unknown option %s\n", key.c_str());
      return 2;
    }
  }
  std::puts("| shape | noise | degree | normals | RMS position | of L | normal deg | H relative | worst | "
            "sqrt(lambda)/L | leaves/pt | forced | levels | uncovered | unsupported |");
  std::puts("|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|");
  for (const auto& shape : split(o.shapes)) {
    for (const auto& noise : split(o.noises)) {
      for (const auto& degree : split(o.degrees)) {
        for (int normals = 0; normals < 2; ++normals) {
          if (o.normals != 2 && o.normals != normals) continue;
          run(o, shape, std::atof(noise.c_str()), std::atoi(degree.c_str()), normals != 0);
        }
      }
    }
  }
}
