// SPDX-License-Identifier: BSD-3-Clause
// Claims on exact surfaces: open borders, noisy normals, zones of one cloud, two sheets.
#include <algorithm>
#include <cmath>
#include <functional>

#include "claims/claim_runner.h"

namespace pcl_slim::comparison {

namespace {

constexpr double kRimGoal = 1.2, kNormalNoiseGoal = 1.1;
constexpr double kRim = 0.02;  // 1 % of the relief's side, from its border inwards
constexpr double kBadNormals = 0.3;
constexpr double kZoneNoise = 0.005, kSheetGap = 0.0035, kSheetNoise = 1e-4;

/** A part of the relief, by the clean points' x and y. */
struct Zone {
  const char* name;
  double low, high;  ///< of x
};

/** Where the relief is flat, where it bears its coarse waves alone, and where fine ones too. */
constexpr Zone kFlat = {"flat zone", -1.0, -0.5}, kFine = {"fine zone", 0.7, 1.0};

using Places = pcl::PointCloud<pcl::PointXYZ>;

/** Which points a rule chooses, by the clean places of a scene's points. */
std::vector<std::uint8_t>
choose(const Places& clean, const std::function<bool(const pcl::PointXYZ&)>& rule)
{
  std::vector<std::uint8_t> chosen(clean.size());
  std::transform(clean.begin(), clean.end(), chosen.begin(),
                 [&](const pcl::PointXYZ& p) { return rule(p) ? 1 : 0; });
  return chosen;
}

bool
onRim(const pcl::PointXYZ& p)
{
  return std::max(std::abs(p.x), std::abs(p.y)) > 1 - kRim;
}

/** Every scene of the plan's sizes and some noises, with the same points free of noise. */
Error
forEachRelief(const ClaimRunner& runner, const std::vector<double>& noises,
              const std::function<Error(const Scene&, const Places&)>& work)
{
  for (const std::size_t count : runner.lists().pointCounts()) {
    const Result<Scene> clean = makeScene("relief", count, 0);
    if (!clean) return clean.error();
    for (const double noise : noises) {
      const Result<Scene> scene = makeScene("relief", count, noise);
      if (!scene) return scene.error();
      if (Error error = work(*scene, *clean->points)) return error;
    }
  }
  return {};
}

/** MLS's least RMS position error among chosen points, and the setting that gave it. */
struct Rival {
  double error = INFINITY;
  std::string name;
};

/** The best of the plan's MLS runs for each choice of points, each at its own setting. */
Error
findRivals(ClaimRunner& runner, const Scene& scene,
           const std::vector<std::vector<std::uint8_t>>& choices, std::vector<Rival>& rivals)
{
  rivals.assign(choices.size(), Rival());
  for (const Setting& setting : runner.lists().mlsSettings()) {
    const Result<Treated> treated = runner.treated(scene, setting);
    if (!treated) return treated.error();
    for (std::size_t c = 0; c < choices.size(); ++c) {
      const double error = measure(scene, *treated, &choices[c]).position;
      if (error < rivals[c].error) rivals[c] = {error, setting.fullText()};
    }
  }
  return {};
}

Error
addRims(ClaimRunner& runner, const Scene& scene, const Places& clean)
{
  const Zone zones[] = {{"all", -1.0, 1.0}, kFlat, kFine};
  std::vector<std::vector<std::uint8_t>> rims, interiors;
  for (const Zone& zone : zones) {
    const auto inside = [&](const pcl::PointXYZ& p) { return p.x >= zone.low && p.x <= zone.high; };
    rims.push_back(choose(clean, [&](const pcl::PointXYZ& p) { return inside(p) && onRim(p); }));
    interiors.push_back(
        choose(clean, [&](const pcl::PointXYZ& p) { return inside(p) && !onRim(p); }));
  }
  std::vector<Rival> rivals;
  if (Error error = findRivals(runner, scene, rims, rivals)) return error;
  std::vector<Setting> settings = {runner.slim(false), runner.slim(true)};
  if (scene.noise > 0) {
    settings.push_back(settings.back());
    settings.back().data = true;
  }
  for (const Setting& setting : settings) {
    const Result<Treated> treated = runner.treated(scene, setting);
    if (!treated) return treated.error();
    for (std::size_t z = 0; z < rims.size(); ++z) {
      const double rim = measure(scene, *treated, &rims[z]).position;
      const double interior = measure(scene, *treated, &interiors[z]).position;
      const std::string where = std::string(", ") + zones[z].name;
      runner.add(scene, setting.fullText(), "rim over interior" + where, rim / interior, kRimGoal,
                 "interior " + shortNumber(interior));
      runner.add(scene, setting.fullText(), "RMS position of the rim" + where, rim, rivals[z].error,
                 rivals[z].name);
    }
  }
  return {};
}

Error
addNormalNoise(ClaimRunner& runner, const Scene& exact, const Scene& bad)
{
  const Result<Errors> with = runner.errors(exact, runner.slim(true));
  if (!with) return with.error();
  const Result<Errors> without = runner.errors(bad, runner.slim(true));
  if (!without) return without.error();
  runner.add(bad, "default", "RMS position over that of exact normals",
             without->position / with->position, kNormalNoiseGoal,
             "exact normals " + shortNumber(with->position));
  runner.add(bad, "default", "RMS normal over that of exact normals",
             without->normal / with->normal, kNormalNoiseGoal,
             "exact normals " + shortNumber(with->normal) + "°");
  return {};
}

Error
addZones(ClaimRunner& runner, const Scene& scene, const Places& clean)
{
  std::vector<std::vector<std::uint8_t>> among;
  for (const Zone& zone : {kFlat, kFine}) {
    among.push_back(
        choose(clean, [&](const pcl::PointXYZ& p) { return p.x >= zone.low && p.x <= zone.high; }));
  }
  std::vector<Rival> rivals;
  if (Error error = findRivals(runner, scene, among, rivals)) return error;
  for (const bool normals : {false, true}) {
    const Setting setting = runner.slim(normals);
    const Result<Treated> treated = runner.treated(scene, setting);
    if (!treated) return treated.error();
    for (std::size_t z = 0; z < among.size(); ++z) {
      runner.add(scene, setting.fullText(),
                 std::string("RMS position, ") + (z == 0 ? kFlat : kFine).name,
                 measure(scene, *treated, &among[z]).position, rivals[z].error, rivals[z].name);
    }
  }
  return {};
}

Error
addSheets(ClaimRunner& runner, const Scene& scene, const Setting& setting)
{
  const Result<Treated> treated = runner.treated(scene, setting);
  if (!treated) return treated.error();
  const double half_gap = 0.5 * kSheetGap * std::sqrt(8.0);
  std::size_t crossed = 0;
  for (std::size_t i = 0; i < scene.size(); ++i) {
    const pcl::PointNormal& p = treated->points[i];
    crossed += std::abs(scene.truth(i, {p.x, p.y, p.z}).distance) > half_gap;
  }
  const double sigma = kSheetNoise * std::sqrt(8.0);
  runner.add(scene, setting.fullText(), "points nearer to the other sheet, %",
             100.0 * static_cast<double>(crossed) / static_cast<double>(scene.size()), 0,
             "RMS " + shortNumber(measure(scene, *treated).position / sigma) + " of the noise");
  return {};
}

}  // namespace

Error
measureRims(ClaimRunner& runner)
{
  return forEachRelief(
      runner, runner.lists().noises(),
      [&](const Scene& scene, const Places& clean) { return addRims(runner, scene, clean); });
}

Error
measureNormalNoise(ClaimRunner& runner)
{
  for (const std::size_t count : runner.lists().pointCounts()) {
    for (const std::string& shape : runner.lists().shapes()) {
      for (const double noise : runner.lists().noises()) {
        const Result<Scene> exact = makeScene(shape, count, noise, 7, 0);
        if (!exact) return exact.error();
        const Result<Scene> bad = makeScene(shape, count, noise, 7, kBadNormals);
        if (!bad) return bad.error();
        if (Error error = addNormalNoise(runner, *exact, *bad)) return error;
      }
    }
  }
  return {};
}

Error
measureZones(ClaimRunner& runner)
{
  return forEachRelief(runner, {kZoneNoise}, [&](const Scene& scene, const Places& clean) {
    return addZones(runner, scene, clean);
  });
}

Error
measureSheets(ClaimRunner& runner)
{
  for (const std::size_t count : runner.lists().pointCounts()) {
    for (const bool waved : {false, true}) {
      const Scene scene = makeSheets(waved, count, kSheetGap, kSheetNoise);
      for (const bool normals : {false, true}) {
        if (Error error = addSheets(runner, scene, runner.slim(normals))) return error;
      }
    }
  }
  return {};
}

}  // namespace pcl_slim::comparison
