// SPDX-License-Identifier: BSD-3-Clause
// Floats that a surface takes at an L2 error, by degree (Fig. 21).
#include <cmath>

#include "paper/study.h"

namespace pcl_slim::paper {

namespace {

/** The paper's .01 %, and what scans with detail of their own reach in few floats. */
constexpr double kErrors[] = {1e-4, 3e-4};
constexpr double kLeastError = 0.7e-4;

Error sweepModel(const Model& model, int degree, bool paper, int threads, LeafSweep& sweep) {
  std::vector<double> settings;
  for (int i = 0; i < 15; ++i) {
    // The paper's T, or the penalty's noise level: both go down by halves.
    settings.push_back((paper ? 5.12 : 0.0256) / std::pow(2.0, i));
  }
  for (const double value : settings) {
    FitParams params;
    params.degree = degree;
    params.threads = threads;
    params.paper_mode = paper;
    if (paper)
      params.size = MDLThreshold{value};
    else
      params.lambda = value * value;
    const auto fitted = fitModel(model, params);
    if (!fitted) return fitted.error();
    const double error = projectionError(*fitted);
    const auto leaves = static_cast<double>(fitted->statistics.leaves);
    // Neither the widest balls nor the finest that points support change with the setting.
    if (!sweep.error.empty() && error > 0.97 * sweep.error.back()) continue;
    sweep.error.push_back(error);
    sweep.leaves.push_back(leaves);
    if (error < kLeastError) break;
  }
  return {};
}

std::string thousands(double value) {
  return number("%.1fK", value / 1000);
}

std::string cellOf(const LeafSweep& sweep, int degree, double error) {
  const double leaves = sweep.leavesAt(error);
  if (leaves < 0) return sweep.error.front() < error ? "below at once" : "out of reach";
  return thousands(leaves * floatsOf(degree)) + " (" + thousands(leaves) + ")";
}

Error addModel(const StudySettings& settings, const Model& model, bool paper, Table& table,
               std::vector<Curve>& panel) {
  const char* const kColors[] = {"", "#999", "#36c", "#c33", "#393"};
  const char* const kNames[] = {"", "linear", "quadratic", "cubic", "quartic"};
  std::vector<std::vector<std::string>> rows;
  for (const double error : kErrors) {
    rows.push_back({model.name, std::to_string(model.points.size()), paper ? "paper" : "default",
                    number("%g", error)});
  }
  for (int degree = 1; degree <= 4; ++degree) {
    LeafSweep sweep;
    if (Error error = sweepModel(model, degree, paper, settings.threads, sweep)) return error;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      rows[i].push_back(cellOf(sweep, degree, kErrors[i]));
    }
    std::vector<double> floats;
    for (const double leaves : sweep.leaves) floats.push_back(leaves * floatsOf(degree));
    panel.push_back({kNames[degree], kColors[degree], floats, sweep.error});
  }
  for (const auto& row : rows) table.row(row);
  return {};
}

/** The paper's figures for its own hand, as dots. */
void addPapersHand(std::vector<Curve>& panel) {
  panel.push_back({"dots: the paper's hand", "#999", {37.8e3}, {1e-4}});
  panel.push_back({"", "#36c", {22.8e3}, {1e-4}});
  panel.push_back({"", "#c33", {20.8e3}, {1e-4}});
}

}  // namespace

Error sparsity(const StudySettings& settings) {
  std::vector<Model> models = {handModel(100000)};
  for (const char* file :
       {"stanford_bunny_zipper.ply", "armadillo_50k.ply", "stanford_dragon_res2.ply"}) {
    auto model = loadModel(settings, file);
    if (!model) return model.error();
    models.push_back(std::move(*model));
  }
  Table table("Floats (and leaves) at an L2 error (Fig. 21)",
              {"model", "points", "fit", "error / L", "linear", "quadratic", "cubic", "quartic"});
  table.row({"hand (the paper)", "?", "paper", "0.0001", "37.8K (5.4K)", "22.8K (1.9K)",
             "20.8K (1.3K)", ""});
  for (const bool paper : {true, false}) {
    std::vector<std::string> titles;
    std::vector<std::vector<Curve>> panels;
    for (const Model& model : models) {
      panels.emplace_back();
      titles.push_back(model.name);
      if (Error error = addModel(settings, model, paper, table, panels.back())) return error;
    }
    addPapersHand(panels.front());
    Error error = savePlot(settings.out + (paper ? "/fig21_paper.svg" : "/fig21.svg"), titles,
                           panels, "floats", "L2 error / L");
    if (error) return error;
  }
  return table.save(settings, "fig21");
}

}  // namespace pcl_slim::paper
