// SPDX-License-Identifier: BSD-3-Clause
// What the default does to real scans: how far it moves points, against their local spacing.
#include <algorithm>
#include <cmath>
#include <filesystem>

#include "claims/claim_runner.h"
#include "pcl_slim/cloud/knn.h"
#include "pcl_slim/core/parallel.h"

namespace pcl_slim::comparison {

namespace {

constexpr double kFar = 3, kFarthest = 15, kFarShare = 0.05, kLatticeShare = 0.2;
constexpr std::size_t kNeighbours = 10;

constexpr double kLatticeRepeats = 0.01;

/** sqrt(area / points) around each point, from its ten nearest distinct neighbours; 0 where there
 * are fewer. */
struct LocalSpacings {
  std::vector<double> at;
  double repeated = 0;  ///< share of points that lie where another one does
};

Result<LocalSpacings>
localSpacings(const Scene& scene, int threads)
{
  CloudView view;
  view.xyz = scene.points->data();
  view.xyz_stride = sizeof(pcl::PointXYZ);
  view.size = scene.size();
  const Result<PointStore> store = PointStore::build(view, threads);
  if (!store) return store.error();
  std::vector<double> stored(store->size());
  parallelFor(store->numBlocks(), threads, 16, [&](std::size_t block, int) {
    NeighborSearch search(*store);
    std::vector<std::uint32_t> neighbours;
    std::vector<float> squared;
    const std::size_t end = std::min((block + 1) * PointStore::kBlock, store->size());
    for (std::size_t i = block * PointStore::kBlock; i < end; ++i) {
      search.nearest(i, kNeighbours + 1, neighbours, squared);
      if (squared.size() <= kNeighbours) continue;
      stored[i] = store->scale() * std::sqrt(squared.back() * M_PI / kNeighbours);
    }
  });
  const std::vector<std::uint32_t> place = store->storeOfInput();
  LocalSpacings spacings;
  for (const std::uint32_t i : place) spacings.at.push_back(stored[i]);
  spacings.repeated =
      static_cast<double>(store->statistics().duplicates) / static_cast<double>(scene.size());
  return spacings;
}

Error
addMoves(ClaimRunner& runner, const Scene& scene, const Setting& setting,
         const LocalSpacings& spacings)
{
  const Result<Treated> treated = runner.treated(scene, setting);
  if (!treated) return treated.error();
  double farthest = 0;
  std::size_t far = 0, kept = 0;
  for (std::size_t i = 0; i < scene.size(); ++i) {
    kept += treated->done[i] == 0;
    if (!(spacings.at[i] > 0)) continue;
    const auto step = (treated->points[i].getVector3fMap() - (*scene.points)[i].getVector3fMap());
    const double spaces = step.norm() / spacings.at[i];
    far += spaces > kFar;
    farthest = std::max(farthest, spaces);
  }
  const auto percent = [&](std::size_t count) {
    return 100.0 * static_cast<double>(count) / static_cast<double>(scene.size());
  };
  // Coordinates rounded to a coarse lattice: the spacing says little of the surface there.
  const bool lattice = spacings.repeated > kLatticeRepeats;
  runner.add(scene, setting.fullText(), "moved more than 3 spacings, %", percent(far),
             lattice ? kLatticeShare : kFarShare,
             "without support " + shortNumber(percent(kept)) + " %");
  runner.add(scene, setting.fullText(), "farthest, spacings", farthest, kFarthest);
  return {};
}

}  // namespace

Error
measureMoves(ClaimRunner& runner)
{
  for (const std::string& file : runner.plan().scans()) {
    const Result<Scene> scene = loadScan(std::filesystem::path(file).stem().string(), file);
    if (!scene) return scene.error();
    const Result<LocalSpacings> spacings = localSpacings(*scene, runner.lists().threads());
    if (!spacings) return spacings.error();
    for (const bool normals : {false, true}) {
      if (normals && scene->normals.empty()) continue;
      if (Error error = addMoves(runner, *scene, runner.slim(normals), *spacings)) return error;
    }
  }
  return {};
}

}  // namespace pcl_slim::comparison
