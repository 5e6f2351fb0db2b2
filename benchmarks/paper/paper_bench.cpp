// SPDX-License-Identifier: BSD-3-Clause
// Remakes figures, tables and claims of Ohtake, Belyaev, Alexa 2005 that no other program shows.
#include <cstdio>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "common/options.h"
#include "paper/study.h"

namespace {

using namespace pcl_slim;
using namespace pcl_slim::paper;

struct Study {
  const char* name;
  Error (*run)(const StudySettings&);
};

constexpr Study kStudies[] = {
    {"4", energyCurves},
    {"5", radiusIntervals},
    {"6", treeOfBalls},
    {"7", ballsByLevel},
    {"8", blendingOnRays},
    {"18", splatsBeside},
    {"21", sparsity},
    {"hand", saveHand},
    {"table1", fitTimes},
    {"s37", rotationDrift},
    {"s42", costOfRays},
    {"s43", parabolicLines},
    {"compactness", compactness},
    {"s46", ellipsoidalSupports},
};

}  // namespace

int main(int argc, char** argv) {
  StudySettings settings;
  std::string figure = "all";
  OptionTable options("paper_bench", "1", "Remakes figures and tables of the SLIM paper.");
  options.positional("DATA", &settings.data, "folder of scans");
  options.positional("OUT", &settings.out, "folder for tables and pictures, which must exist");
  std::vector<std::string> names = {"all"};
  for (const Study& study : kStudies) names.emplace_back(study.name);
  options.choice("figure", &figure, names,
                 "what to remake: a figure, the hand of Fig. 22, Table 1, compactness, rotation, "
                 "cost of rays, parabolic lines, ellipsoidal supports");
  options.integer("threads", &settings.threads, 0, 4096, "threads of fits, 0: all cores");
  if (const auto status = options.parse(argc, argv)) return *status;
  for (const Study& study : kStudies) {
    if (figure != "all" && figure != study.name) continue;
    std::printf("\n## %s\n", study.name);
    if (const Error error = study.run(settings)) {
      std::fprintf(stderr, "paper_bench: %s\n", error.message.c_str());
      return 2;
    }
  }
  return 0;
}
