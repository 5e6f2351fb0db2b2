// SPDX-License-Identifier: BSD-3-Clause
// Times and counts of fits at the paper's T (Table 1).
#include <cstdio>

#include "paper/study.h"
#include "pcl_slim/surface/surface_io.h"
#include "support/lab/bench.h"
#include "support/lab/scenes.h"

namespace pcl_slim::paper {

namespace {

struct Row {
  const char* file;  ///< null: a bumpy sphere of so many points
  std::size_t points;
  double t_mdl;
  int degree;
  const char* paper;  ///< the paper's row of like size
};

constexpr Row kRows[] = {
    {"armadillo_50k.ply", 0, 0.02, 2, "Dinosaur 56K: 6K leaves, 8 s"},
    {"stanford_bunny_raw_scans.pcd", 0, 0.01, 2, "Dragon 438K: 44K, 67 s"},
    {"stanford_bunny_raw_scans.pcd", 0, 0.01, 3, "Dragon 438K: 31K, 86 s"},
    {"lion_takanawa.pcd", 0, 0.01, 2, "Dragon 438K: 44K, 67 s"},
    {"lion_takanawa.pcd", 0, 0.01, 3, "Dragon 438K: 31K, 86 s"},
    {"stanford_dragon_res2.ply", 0, 0.01, 2, "Dragon 438K: 44K, 67 s"},
    {"stanford_dragon_res2.ply", 0, 0.01, 3, "Dragon 438K: 31K, 86 s"},
    {nullptr, 438000, 0.01, 2, "Dragon 438K: 44K, 67 s"},
    {nullptr, 5000000, 0.005, 2, "Thai statue 5M: 345K, 15 min"},
};

/** Folder and file of a row's points; those that are made are written to the folder of tables. */
Result<StudySettings> placeOf(const StudySettings& settings, const Row& row, std::string& file) {
  StudySettings place = settings;
  if (row.file != nullptr) {
    file = row.file;
    return place;
  }
  const measure::Scene scene =
      measure::makeScene(measure::Shape::kBumpy, row.points, 1e-4, 0.02, 7);
  Model model;
  for (std::size_t i = 0; i < scene.points.size(); i += 3) {
    model.points.push_back({scene.points[i], scene.points[i + 1], scene.points[i + 2]});
  }
  model.normals = scene.normals;
  place.data = settings.out;
  file = "bumpy sphere, noise 1e-4.ply";
  if (Error error = savePoints(model, place.data + "/" + file)) return error;
  return place;
}

}  // namespace

Error fitTimes(const StudySettings& settings) {
  Table table(
      "Fits at the paper's T, store and fit, CPU seconds, " + std::to_string(settings.threads) +
          " thread(s) (Table 1)",
      {"model", "points", "T", "degree", "leaves", "of points", "fit, s", "us/point",
       "with reading and writing, s", "us/point", "the paper's row of like size, Pentium 4"});
  for (const Row& row : kRows) {
    std::string file;
    const auto place = placeOf(settings, row, file);
    if (!place) return place.error();
    const double begin = measure::cpuSeconds();
    const auto model = loadModel(*place, file);
    if (!model) return model.error();
    const double read = measure::cpuSeconds() - begin;
    FitParams params;
    params.paper_mode = true;
    params.degree = row.degree;
    params.size = MDLThreshold{row.t_mdl};
    params.threads = settings.threads;
    const auto fitted = fitModel(*model, params);
    if (!fitted) return fitted.error();
    const double fitted_at = measure::cpuSeconds();
    if (Error error = saveSlim(settings.out + "/fit_times.slim", fitted->surface)) return error;
    const double whole = read + fitted->seconds + measure::cpuSeconds() - fitted_at;
    const auto points = static_cast<double>(model->points.size());
    const auto leaves = static_cast<double>(fitted->statistics.leaves);
    table.row({model->name, number("%.0f", points), number("%g", row.t_mdl),
               std::to_string(row.degree), number("%.0f", leaves),
               number("%.1f %%", 100 * leaves / points), number("%.2f", fitted->seconds),
               number("%.2f", 1e6 * fitted->seconds / points), number("%.2f", whole),
               number("%.2f", 1e6 * whole / points), row.paper});
  }
  std::remove((settings.out + "/fit_times.slim").c_str());
  return table.save(settings, "table1");
}

}  // namespace pcl_slim::paper
