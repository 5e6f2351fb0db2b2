// SPDX-License-Identifier: BSD-3-Clause
#include "claims/claims.h"

#include <cmath>
#include <cstdio>

#include "claims/claim_runner.h"
#include "common/report.h"

namespace pcl_slim::comparison {

namespace {

struct Claim {
  const char* name;
  const char* title;
  Error (*measure)(ClaimRunner&);
};

constexpr Claim kClaims[] = {
    {"rims", "Open borders: error of the outermost points, over the interior's and beside MLS's",
     measureRims},
    {"normals", "Normals with .3 rad of noise: error over that with exact ones",
     measureNormalNoise},
    {"zones", "One cloud, flat and fine: each zone beside MLS's best for that zone", measureZones},
    {"sheets", "Two sheets .35 % of the diagonal apart, .01 % noise", measureSheets},
    {"moves", "Scans: how far the default moves points, in local spacings", measureMoves},
    {"peers", "Least errors of a sweep beside those of other libraries", measurePeers},
    {"default", "The default's RMS error over the best of a sweep over penalties", measureDefault}};

std::string
quoted(const std::string& text)
{
  return text.find(',') == std::string::npos ? text : "\"" + text + "\"";
}

std::string
verdict(const ClaimRow& row)
{
  if (!std::isfinite(row.goal)) return "";
  return row.met() ? "yes" : "**no**";
}

}  // namespace

std::string
shortNumber(double value)
{
  char text[32] = "";
  if (std::isfinite(value)) std::snprintf(text, sizeof(text), "%.3g", value);
  return text;
}

std::string
sceneTitle(const std::string& name, double noise)
{
  return noise > 0 ? name + ", " + shortNumber(100 * noise) + " % noise" : name;
}

Error
ClaimRunner::step(const std::string& what, const std::function<Error(std::string& detail)>& work)
{
  if (console_.interrupted()) return {ErrorCode::kCancelled, "stopped; nothing is written"};
  const Stopwatch watch;
  console_.begin(what);
  std::string detail;
  Error error = work(detail);
  if (error) {
    console_.failed();
  } else {
    console_.done(watch.seconds(), detail);
  }
  return error;
}

Result<Treated>
ClaimRunner::treated(const Scene& scene, const Setting& setting)
{
  Result<Treated> treated = Error();
  const std::string what = sceneTitle(scene.name, scene.noise) + ", " +
                           std::to_string(scene.size()) + " points: " + setting.fullText();
  const Error error = step(what, [&](std::string& detail) {
    treated = treat(scene, setting);
    if (!treated) return treated.error();
    detail = shortNumber(treated->cpu) + " s CPU";
    return Error();
  });
  if (error) return error;
  return treated;
}

Result<Errors>
ClaimRunner::errors(const Scene& scene, const Setting& setting,
                    const std::vector<std::uint8_t>* among)
{
  const Result<Treated> result = treated(scene, setting);
  if (!result) return result.error();
  return measure(scene, *result, among);
}

void
ClaimRunner::add(const Scene& scene, const std::string& run, const std::string& quantity,
                 double value, double goal, const std::string& beside)
{
  add({sceneTitle(scene.name, scene.noise), scene.size(), run, quantity, value, goal, beside});
}

Setting
ClaimRunner::slim(bool normals) const
{
  Setting setting;
  setting.normals = normals;
  setting.threads = lists().threads();
  return setting;
}

const std::vector<std::string>&
claimNames()
{
  static const std::vector<std::string> names = [] {
    std::vector<std::string> made;
    for (const Claim& claim : kClaims) made.emplace_back(claim.name);
    return made;
  }();
  return names;
}

Result<ClaimTable>
measureClaim(const std::string& name, const ClaimPlan& plan, Console& console)
{
  for (const Claim& claim : kClaims) {
    if (name != claim.name) continue;
    ClaimTable table;
    table.name = name;
    table.title = claim.title;
    ClaimRunner runner(plan, console, table);
    if (Error error = claim.measure(runner)) return error;
    return table;
  }
  return Error{ErrorCode::kBadArgument, "unknown claim '" + name + "'; see the help"};
}

std::string
claimsCsv(const std::vector<ClaimTable>& tables)
{
  std::string text = "claim,scene,points,run,quantity,value,goal,met,beside\n";
  for (const ClaimTable& table : tables) {
    for (const ClaimRow& row : table.rows) {
      const bool judged = std::isfinite(row.goal);
      for (const std::string& cell : {table.name, row.scene, std::to_string(row.points), row.run,
                                      row.quantity, shortNumber(row.value), shortNumber(row.goal),
                                      std::string(judged ? (row.met() ? "1" : "0") : "")}) {
        text += quoted(cell) + ",";
      }
      text += quoted(row.beside) + "\n";
    }
  }
  return text;
}

std::string
claimsMarkdown(const std::vector<ClaimTable>& tables)
{
  std::string text;
  for (const ClaimTable& table : tables) {
    std::size_t judged = 0, met = 0;
    std::string rows;
    for (const ClaimRow& row : table.rows) {
      judged += std::isfinite(row.goal);
      met += row.met();
      rows += "| " + row.scene + " | " + std::to_string(row.points) + " | " + row.run + " | " +
              row.quantity + " | " + shortNumber(row.value) + " | " + shortNumber(row.goal) +
              " | " + verdict(row) + " | " + row.beside + " |\n";
    }
    text += "## " + table.title + "\n\n" + std::to_string(met) + " of " + std::to_string(judged) +
            " goals met.\n\n| scene | points | run | quantity | measured | goal | met | beside "
            "|\n|---|---|---|---|---|---|---|---|\n" +
            rows + "\n";
  }
  return text;
}

}  // namespace pcl_slim::comparison
