// SPDX-License-Identifier: BSD-3-Clause
// What each rule and constant of the fit is worth: fits with it switched off, or halved and doubled,
// beside the library's own over the same scenes.
#include <cstdio>

#include "ablation/cases.h"
#include "ablation/changes.h"
#include "ablation/table.h"
#include "common/run_program.h"

namespace {

using namespace pcl_slim;
using ablation::Case;
using ablation::Cases;
using ablation::Change;
using ablation::Figures;

struct Settings {
  ablation::CaseRequest request;
  std::string only;
  int points = 30000;
  bool rules = true, constants = false, exact = true, sensors = true, each = false;
};

OptionTable
declareOptions(Settings& s)
{
  OptionTable options("ablation_bench", "1",
                      "Measures what each rule and constant of the fit is worth.");
  options.toggle("rules", &s.rules, "switch each rule off");
  options.toggle("constants", &s.constants, "halve and double each constant");
  options.text("only", &s.only, "TEXT", "changes whose names hold this text; all if empty");
  options.toggle("exact", &s.exact, "exact surfaces under white noise");
  options.toggle("sensors", &s.sensors, "scans as sensors make them");
  options.text("data", &s.request.data, "FOLDER", "none");
  options.integer("points", &s.points, 1000, 100000000, "points of an exact surface");
  options.integer("seeds", &s.request.seeds, 1, 100, "scenes a case");
  options.integer("threads", &s.request.threads, 0, 4096, "threads, 0: all cores");
  options.toggle("each", &s.each, "print the library's figures of each case as well");
  return options;
}

Result<Cases>
gatherCases(const Settings& s)
{
  Cases all;
  std::vector<decltype(&ablation::scanCases)> kinds = {ablation::scanCases};
  if (s.exact) kinds.insert(kinds.end(), {ablation::exactCases, ablation::heightCases});
  if (s.sensors) kinds.push_back(ablation::sensorCases);
  for (const auto gather : kinds) {
    auto cases = gather(s.request);
    if (!cases) return cases.error();
    for (auto& one : *cases) all.push_back(std::move(one));
  }
  return all;
}

Result<std::vector<Figures>>
measureAll(const Cases& cases, const detail::FitConstants& constants)
{
  std::vector<Figures> figures;
  for (const auto& one : cases) {
    const auto measured = one->measure(constants);
    if (!measured)
      return Error{measured.error().code, one->name() + ": " + measured.error().message};
    figures.push_back(*measured);
  }
  return figures;
}

void
printEach(const Cases& cases, const std::vector<Figures>& figures)
{
  std::printf(
      "| case | position | normals | curvature | leaves | uncovered | farthest | s |\n"
      "|---|---|---|---|---|---|---|---|\n");
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const Figures& f = figures[i];
    std::printf("| %s | %.3e | %.3f | %.4f | %.0f | %.0f | %.4f | %.2f |\n",
                cases[i]->name().c_str(), f.position, f.normal, f.curvature, f.leaves, f.uncovered,
                f.farthest, f.seconds);
  }
}

Error
run(Settings& s)
{
  s.request.points = static_cast<std::size_t>(s.points);
  const auto cases = gatherCases(s);
  if (!cases) return cases.error();
  const auto library = measureAll(*cases, {});
  if (!library) return library.error();
  if (s.each) printEach(*cases, *library);

  std::vector<Change> changes;
  if (s.rules) changes = ablation::rulesOff();
  if (s.constants) {
    for (Change& change : ablation::constantsScaled()) changes.push_back(std::move(change));
  }
  std::printf("%s", ablation::tableHeader().c_str());
  for (const Change& change : changes) {
    if (change.name.find(s.only) == std::string::npos) continue;
    detail::FitConstants constants;
    change.apply(constants);
    const auto changed = measureAll(*cases, constants);
    const std::string row =
        changed
            ? tableRow(change.name, change.becomes, compareFigures(*cases, *library, *changed))
            : "| " + change.name + " | " + change.becomes + " | " + changed.error().message + "\n";
    std::printf("%s", row.c_str());
    std::fflush(stdout);
  }
  return {};
}

}  // namespace

int
main(int argc, char** argv)
{
  return runProgram<Settings>(
      argc, argv, "use fewer -points", declareOptions,
      [](const OptionTable&, Settings&) { return Error(); }, run);
}
