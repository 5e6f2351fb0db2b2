// SPDX-License-Identifier: BSD-3-Clause
// Curvature of implicit surfaces under noise, after the survey of CGF 45(2), 2026: errors of the
// default beside those of methods that take a radius, each at its best one with hindsight.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <sstream>

#include "common/run_program.h"
#include "curvature/estimators.h"
#include "fit/smoothed_points.h"
#include "pcl_slim/core/parallel.h"
#include "rivals/jets.h"
#include "rivals/point_tree.h"
#include "support/lab/bench.h"

namespace {

using namespace pcl_slim;
using curvature::Differential;
using curvature::Estimator;
using curvature::SurfaceSample;

constexpr double kDegreesPerRadian = 57.29577951308232;
constexpr std::size_t kLeastNeighbors = 20;  ///< a quartic has 15 coefficients

struct Settings {
  std::string surfaces, noise = "0,0.0025,0.005,0.01,0.015";
  std::string radii = "0.03,0.045,0.06,0.08,0.1,0.13,0.16";
  int points = 50000, sample = 1000, seed = 1, threads = 0;
  double normal_noise = 0.1;
  bool each = false;

  std::vector<double> noise_list, radius_list;
};

OptionTable declareOptions(Settings& s) {
  OptionTable options("curvature_bench", "1",
                      "Measures curvature of noisy implicit surfaces beside other estimators.");
  options.text("surfaces", &s.surfaces, "NAME,...", "surfaces; all nine if empty");
  options.text("noise", &s.noise, "S,...", "RMS errors along each axis; surfaces are 2 wide");
  options.text("radii", &s.radii, "R,...", "radii of the other estimators");
  options.integer("points", &s.points, 1000, 10000000, "points of a surface");
  options.integer("sample", &s.sample, 10, 10000000, "points at which errors are taken");
  options.number("normal_noise", &s.normal_noise, 0, 1,
                 "RMS error of noisy normals along each axis [rad]");
  options.toggle("each", &s.each, "print each surface, too");
  options.integer("seed", &s.seed, 0, 1000000, "seed of points and noise");
  options.integer("threads", &s.threads, 0, 4096, "threads, 0: all cores; changes no result");
  return options;
}

Error finishOptions(Settings& s) {
  return measure::parseLists({{"noise", &s.noise, 0, 1, false, &s.noise_list},
                              {"radii", &s.radii, 1e-6, 2, false, &s.radius_list}});
}

/** RMS errors of mean, Gaussian and greatest curvature, and of normals [degrees]. */
using Errors = std::array<double, 4>;

/** Errors by name of method; a radius free for each kind of error. */
using Table = std::map<std::string, Errors>;

/** A noisy cloud with the truth, and the points that are measured. */
struct Cloud {
  SurfaceSample clean;
  std::vector<Vector3> points, normals;
  std::vector<std::size_t> measured;
};

Errors errorsOf(const Cloud& cloud, const std::vector<Differential>& found) {
  Errors sums{};
  for (std::size_t m = 0; m < found.size(); ++m) {
    const Differential& truth = cloud.clean.truth[cloud.measured[m]];
    const double side = dot(found[m].normal, truth.normal);
    const Differential own = side < 0 ? found[m].flipped() : found[m];
    const double angle = std::atan2(length(cross(own.normal, truth.normal)), std::abs(side));
    sums[0] += std::pow(own.mean - truth.mean, 2);
    sums[1] += std::pow(own.gaussian - truth.gaussian, 2);
    sums[2] += std::pow(own.k1() - truth.k1(), 2);
    sums[3] += std::pow(kDegreesPerRadian * angle, 2);
  }
  for (double& sum : sums) sum = std::sqrt(sum / static_cast<double>(found.size()));
  return sums;
}

Result<Errors> errorsOfOurs(const Settings& s, const Cloud& cloud, bool normals, bool as_data) {
  CloudView view = measure::viewOf(cloud.points);
  std::vector<float> given;
  if (normals) {
    for (const Vector3& n : cloud.normals) given.insert(given.end(), n.begin(), n.end());
    view.normal = given.data();
    view.normal_stride = 3 * sizeof(float);
  }
  FitParams params;
  params.trim = false;
  params.threads = s.threads;
  params.normals_as_data = as_data;
  ProjectionParams projection;
  projection.curvature = true;
  const auto smoothed = measure::smoothPoints(view, params, projection);
  if (!smoothed) return smoothed.error();
  std::vector<Differential> found;
  for (const std::size_t i : cloud.measured) {
    found.push_back({smoothed->normals[i], smoothed->mean[i], smoothed->gaussian[i]});
  }
  return errorsOf(cloud, found);
}

/** Normals by PCA at every point. */
std::vector<Vector3> pcaNormals(const Settings& s, const Cloud& cloud,
                                const rivals::PointTree& tree, double radius) {
  std::vector<Vector3> normals(cloud.points.size());
  parallelFor(normals.size(), s.threads, 64, [&](std::size_t i, int) {
    std::vector<Vector3> near;
    for (const std::size_t j : tree.within(cloud.points[i], radius))
      near.push_back(cloud.points[j]);
    normals[i] = near.size() < 3 ? Vector3{0, 0, 1} : curvature::pcaNormal(near, radius);
  });
  return normals;
}

curvature::Neighborhood neighborhoodOf(const Cloud& cloud, const std::vector<Vector3>& normals,
                                       const rivals::PointTree& tree, std::size_t i,
                                       double radius) {
  std::vector<std::size_t> indices = tree.within(cloud.points[i], radius);
  curvature::Neighborhood near;
  near.radius = radius;
  if (indices.size() < kLeastNeighbors) {
    indices = tree.nearest(cloud.points[i], kLeastNeighbors);
    near.radius = 1.1 * length(subtract(cloud.points[indices.back()], cloud.points[i]));
  }
  for (const std::size_t j : indices) {
    near.points.push_back(cloud.points[j]);
    near.normals.push_back(scaled(normals[j], dot(normals[j], normals[i]) < 0 ? -1 : 1));
  }
  return near;
}

/** The estimators over their radii; least errors of each kind. */
void addRivals(const Settings& s, const Cloud& cloud, bool normals, Table& table) {
  const rivals::PointTree tree(cloud.points);
  for (const double radius : s.radius_list) {
    const std::vector<Vector3> used = normals ? cloud.normals : pcaNormals(s, cloud, tree, radius);
    for (const Estimator& estimator : curvature::allEstimators()) {
      if (normals && !estimator.needs_normals) continue;
      std::vector<Differential> found(cloud.measured.size());
      parallelFor(found.size(), s.threads, 8, [&](std::size_t m, int) {
        found[m] = estimator.estimate(neighborhoodOf(cloud, used, tree, cloud.measured[m], radius));
      });
      const Errors errors = errorsOf(cloud, found);
      Errors& best = table.emplace(estimator.name, errors).first->second;
      for (std::size_t e = 0; e < errors.size(); ++e) best[e] = std::min(best[e], errors[e]);
    }
  }
}

enum class Given { kNone, kExact, kNoisy };

Cloud makeCloud(const Settings& s, const SurfaceSample& clean, double noise, Given given) {
  std::mt19937_64 rng(static_cast<std::uint64_t>(s.seed) + 1000);
  std::normal_distribution<double> gauss;
  Cloud cloud;
  cloud.clean = clean;
  const auto perturbed = [&](const Vector3& v, double sigma) {
    return Vector3{v[0] + sigma * gauss(rng), v[1] + sigma * gauss(rng), v[2] + sigma * gauss(rng)};
  };
  for (const Vector3& p : clean.points) cloud.points.push_back(perturbed(p, noise));
  for (const Differential& truth : clean.truth) {
    const double sigma = given == Given::kNoisy ? s.normal_noise : 0;
    cloud.normals.push_back(normalized(perturbed(truth.normal, sigma)));
  }
  const std::size_t step =
      std::max<std::size_t>(1, clean.points.size() / static_cast<std::size_t>(s.sample));
  for (std::size_t i = 0; i < clean.points.size(); i += step) cloud.measured.push_back(i);
  return cloud;
}

Error measureSurface(const Settings& s, const SurfaceSample& clean, double noise, Given given,
                     Table& table) {
  const Cloud cloud = makeCloud(s, clean, noise, given);
  const bool normals = given != Given::kNone;
  for (const bool as_data : {false, true}) {
    if (as_data && !normals) continue;
    const auto errors = errorsOfOurs(s, cloud, normals, as_data);
    if (!errors) return errors.error();
    table[as_data ? "ours, normals as data" : "ours"] = *errors;
  }
  Table rivals;
  addRivals(s, cloud, normals, rivals);
  Errors& best = rivals["best of these"] = rivals.begin()->second;
  for (const auto& [name, errors] : rivals) {
    for (std::size_t e = 0; e < errors.size(); ++e) best[e] = std::min(best[e], errors[e]);
  }
  table.merge(rivals);
  return {};
}

void printTable(const std::string& title, const Table& table) {
  std::printf(
      "\n%s\n\n| method | H | K | k1 | normal, degrees | ours / it: H | K | k1 | normal |\n"
      "|---|---|---|---|---|---|---|---|---|\n",
      title.c_str());
  const Errors& ours = table.at("ours");
  for (const auto& [name, errors] : table) {
    std::printf("| %s |", name.c_str());
    for (const double error : errors) std::printf(" %.3g |", error);
    for (std::size_t e = 0; e < errors.size(); ++e) std::printf(" %.2g |", ours[e] / errors[e]);
    std::printf("\n");
  }
  std::fflush(stdout);
}

/** Geometric means over surfaces. */
Table meanOf(const std::vector<Table>& tables) {
  Table mean;
  for (const auto& [name, first] : tables.front()) {
    Errors logs{};
    for (const Table& table : tables) {
      for (std::size_t e = 0; e < logs.size(); ++e) logs[e] += std::log(table.at(name)[e] + 1e-12);
    }
    for (double& value : logs) value = std::exp(value / static_cast<double>(tables.size()));
    mean[name] = logs;
  }
  return mean;
}

Result<std::vector<curvature::ImplicitSurface>> chosenSurfaces(const Settings& s) {
  if (s.surfaces.empty()) return curvature::implicitSurfaces();
  std::vector<curvature::ImplicitSurface> chosen;
  std::istringstream list(s.surfaces);
  for (std::string name; std::getline(list, name, ',');) {
    for (const auto& surface : curvature::implicitSurfaces()) {
      if (surface.name == name) chosen.push_back(surface);
    }
    if (chosen.empty() || chosen.back().name != name) {
      return Error{ErrorCode::kBadArgument, "no surface '" + name + "'; see the source's list"};
    }
  }
  return chosen;
}

Exit run(Settings& s) {
  if (Error error = finishOptions(s)) return Exit::usage(error);
  const auto surfaces = chosenSurfaces(s);
  if (!surfaces) return surfaces.error();
  if (!rivals::hasJets()) std::printf("Without jets: CGAL is not installed.\n\n");
  std::vector<SurfaceSample> samples;
  for (const auto& surface : *surfaces) {
    samples.push_back(curvature::sampleSurface(surface, static_cast<std::size_t>(s.points),
                                               static_cast<std::uint64_t>(s.seed)));
  }
  const std::pair<Given, const char*> kinds[] = {{Given::kNone, "normals not given"},
                                                 {Given::kExact, "exact normals"},
                                                 {Given::kNoisy, "noisy normals"}};
  for (const double noise : s.noise_list) {
    for (const auto& [given, text] : kinds) {
      char title[96];
      std::snprintf(title, sizeof(title), ", sigma %g, %s", noise, text);
      std::vector<Table> tables(samples.size());
      for (std::size_t i = 0; i < samples.size(); ++i) {
        if (Error error = measureSurface(s, samples[i], noise, given, tables[i])) return error;
        if (s.each) printTable((*surfaces)[i].name + title, tables[i]);
      }
      printTable("geometric mean of " + std::to_string(samples.size()) + " surfaces" + title,
                 meanOf(tables));
    }
  }
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  Settings s;
  OptionTable options = declareOptions(s);
  return runProgram(options, argc, argv, "give fewer -points", [&] { return run(s); });
}
