// SPDX-License-Identifier: BSD-3-Clause
// splat_relations: how the number of splats follows the tolerances, as Figs 11, 12 and 14 of the
// colour splat paper give it.
#include <cstdio>
#include <string>
#include <vector>

#include "common/run_program.h"
#include "splats/colored_scan.h"

namespace {

using namespace pcl_slim;
using namespace pcl_slim::measure;

struct Settings {
  std::string input;
  SplatParams params;
};

std::size_t countAt(const ColoredScan& scan, SplatParams params, double geometry, double color) {
  params.geometric_error = geometry;
  params.color_error = color;
  return splatsOf(scan, params).size();
}

std::string row(const ColoredScan& scan, const SplatParams& params, double geometry,
                const std::vector<double>& colors) {
  std::string text;
  char cell[48];
  std::snprintf(cell, sizeof(cell), "| geometry %g |", geometry);
  text += cell;
  for (const double color : colors) {
    std::snprintf(cell, sizeof(cell), " %zu |", countAt(scan, params, geometry, color));
    text += cell;
  }
  return text;
}

Exit run(const Settings& s) {
  const Result<ColoredScan> scan = loadColoredScan(s.input);
  if (!scan) return Exit::usage(scan.error());
  const std::vector<double> colors{1.0, 0.99, 0.3, 0.2, 0.15, 0.1, 0.08, 0.05};
  std::printf("%s: %zu points%s\n\n|  |", s.input.c_str(), scan->size(),
              s.params.paper_mode ? ", paper mode" : "");
  for (const double color : colors) std::printf(" colour %g |", color);
  std::printf("\n|---|");
  for (std::size_t k = 0; k < colors.size(); ++k) std::printf("---|");
  std::printf("\n");
  for (const double geometry : {0.3, 0.2, 0.15, 0.1, 0.08}) {
    std::printf("%s\n", row(*scan, s.params, geometry, colors).c_str());
  }
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  Settings s;
  OptionTable options("splat_relations", "1", "Numbers of splats over both tolerances.");
  options.positional("IN.pcd|.ply", &s.input, "a coloured scan");
  options.toggle("paper", &s.params.paper_mode, "the published method");
  options.integer("initial", &s.params.initial_resolution, 0, RootGrid::kMaxResolution,
                  "cells of the initial grid along the longest side; 0: about 50 points a cell");
  return runProgram(options, argc, argv, "use a smaller scan", [&] { return run(s); });
}
