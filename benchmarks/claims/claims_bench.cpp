// SPDX-License-Identifier: BSD-3-Clause
// claims_bench: tables of what SLIM is claimed to do, figure by figure, each with its goal.
#include <string>
#include <vector>

#include "benchmark/tables.h"
#include "claims/claims.h"
#include "common/run_program.h"
#include "measure/clocks.h"

namespace {

using namespace pcl_slim;

struct Settings {
  std::string prefix;
  comparison::ClaimPlan plan;
  bool quiet = false;
};

Error
measureClaims(const Settings& s, const std::string& command)
{
  if (Error error = comparison::checkTables(s.prefix)) return error;
  Console console(s.quiet);
  std::vector<comparison::ClaimTable> tables;
  for (const std::string& name : s.plan.claims()) {
    const Result<comparison::ClaimTable> table = measureClaim(name, s.plan, console);
    if (!table) return table.error();
    tables.push_back(*table);
  }
  return comparison::writeTables(s.prefix, claimsCsv(tables),
                                 comparison::machineText(command) + claimsMarkdown(tables),
                                 console);
}

}  // namespace

int
main(int argc, char** argv)
{
  measure::keepFreedMemory();
  Settings s;
  OptionTable options("claims_bench", "1",
                      "Measures what SLIM is claimed to do, beside pcl::MovingLeastSquares and "
                      "other libraries.");
  options.positional("OUT_PREFIX", &s.prefix, "writes OUT_PREFIX.csv and OUT_PREFIX.md");
  s.plan.declareOptions(options);
  options.toggle("quiet", &s.quiet, "say nothing but errors");
  return runProgram(
      options, argc, argv, "give smaller -points", [&] { return s.plan.finishOptions(); },
      [&] { return measureClaims(s, commandLine(argc, argv)); });
}
