// SPDX-License-Identifier: BSD-3-Clause
// The search for sides of thin parts: over the width of cells, the doubt that is allowed and points
// moved to local planes (docs/sides.md, "Sides before the cover").
#include "pcl_slim/cloud/detail/sides.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "measures/measures.h"
#include "pcl_slim/cloud/detail/noise.h"

namespace pcl_slim::detail {

namespace {

using Places = std::vector<std::array<double, 3>>;
using Normals = std::vector<std::array<float, 3>>;

// Shares are those of the places examined, noise and widths are in spacings.
constexpr double kFullNoise = 0.45;  ///< least noise of a noisy cloud
constexpr double kSure = 0.95;       ///< confidence from which narrower cells are not tried
constexpr double kLeastCells = 1.0;  ///< least noise that sets the width of cells
constexpr double kMostDoubt = 0.45;  ///< largest doubt [share of thin places]

/** Points, and what every step of the search reads beside them. */
struct SideTask {
  const PointStore& store;
  const FitParams& params;
  const FitConstants& constants;
  int threads;

  SideTask with(const PointStore& other) const { return {other, params, constants, threads}; }
};

PointStore withSides(PointStore store, const Normals& normals) {
  store.setSides(normals);
  return store;
}

PointStore movedTo(PointStore store, const Places& places, int threads) {
  store.moveTo(places, threads);
  return store;
}

/** Given sides win, and a viewpoint gives the side of every point. Points on scan lines have no
 * normals of cells, and those of cells are too coarse to keep sharp edges apart. */
bool mayNeedSides(const SideTask& task, const CloudMeasures& measures) {
  const FitParams& params = task.params;
  return params.sides && !params.sharp_features && !task.store.hasNormals() && !params.viewpoint &&
         !params.paper_mode && !params.hasThreshold() && measures.statistics.line == 0;
}

/** What the sides of a cloud must meet. */
struct SideSearch {
  double spacing = 0;       ///< of the points, local length
  double least_apart = 0;   ///< share of the points that must come to face apart
  double doubt = 0;         ///< largest doubt
  double noise = 0;         ///< sets the width of the first cells
  double least = 0;         ///< noise below which the spacing alone sets the width of cells
  double unsided = 0;       ///< noise measured without sides
  double moved = HUGE_VAL;  ///< noise from which points are moved where sides are in doubt
  bool unknown = false;     ///< no place of one side shows the noise
  bool for_cover = false;   ///< a fit finds little noise: sides are for the cover alone
  bool capped = true;       ///< lambda may not exceed the noise that sets the width of cells
};

/** Least share of thin places from which sides are sought. Where there is little noise small balls
 * separate sheets by themselves, and cells are about as many as points. \param[in] noise in
 * spacings */
double leastShare(double noise) {
  constexpr double kLeastThin = 0.07;  // from kFullNoise on
  constexpr double kCleanThin = 0.35;  // in a clean cloud
  constexpr double kCleanNoise = 0.4;  // largest noise of a clean cloud
  const double clean = (kFullNoise - noise) / (kFullNoise - kCleanNoise);
  return kLeastThin + std::clamp(clean, 0.0, 1.0) * (kCleanThin - kLeastThin);
}

/** \return nothing where a cloud has too few thin places. */
std::optional<SideSearch> searchFor(const ThinPlaces& thin, double unsided,
                                    const FitParams& params) {
  // Least share of thin and facing places together from which sides are sought. The noise without
  // sides then decides whether the cloud is clean, and both kinds of places bound the doubt.
  constexpr double kLeastFacing = 0.4;
  constexpr double kLeastApart = 0.25;  // share of the points that face apart [thin places]
  constexpr double kCleanDoubt = 0.03;  // largest doubt in a clean cloud
  const bool measured = !params.lambda;
  SideSearch search;
  search.spacing = thin.spacing;
  search.unsided = search.noise = unsided;
  if (measured && thin.noise > 0) search.noise = std::min(unsided, thin.noise);
  search.least = kLeastCells * thin.spacing;
  search.capped = measured;
  search.unknown = measured && !(thin.noise > 0);
  // Merged frames face each other here and there, where their errors differ: such sheets must be
  // surer.
  const bool most = thin.share + thin.facing >= kLeastFacing;
  search.for_cover = (most ? unsided : search.noise) < kFullNoise * thin.spacing;
  if (!most && thin.share < leastShare(search.noise / thin.spacing)) return {};
  const double share = most ? thin.share + thin.facing : std::max(thin.share, thin.facing);
  search.least_apart = kLeastApart * std::max(0.0, share - thin.flat);
  search.doubt = kMostDoubt * share;
  // Wrong sides break up the wide leaves of a clean cloud.
  if (search.for_cover) search.doubt = std::min(search.doubt, kCleanDoubt);
  return search;
}

/** Sides by cells of one width, and the noise that they show. */
struct TriedSides {
  Sides sides;
  double spacing = 0;      ///< of the points
  double noise = 0;        ///< from few places
  double most = HUGE_VAL;  ///< noise that a fit may have with these sides
  double scanned = 0;      ///< noise of the points before they were moved
  std::size_t plane_neighbors = 0;
  Places feet{};  ///< where the points are moved to; none: they stay

  /** The noise over the agreement of the sides and the share of points that face apart: the noise
   * rises or one of the others falls where sides are wrong, or cells contain both. */
  double cost() const { return noise / (sides.confidence * sides.thin); }
  double doubt() const { return 1 - sides.confidence; }

  /** Whether sides are in doubt and noise is so much wider than the spacing that moving points
   * removes it. */
  bool isMoved(const SideSearch& search) const {
    return sides.confidence < kSure && noise >= search.moved;
  }
};

/** RMS noise of the points, as their sides show it. */
double noiseOf(const SideTask& task) {
  FitParams params = task.params;
  if (!params.noise_model) params.local_noise = false;
  return std::sqrt(measureCloud(task.store, params, task.constants, task.threads).lambda);
}

/** The same from few places, to compare sides. */
double noiseAtFewPlaces(const SideTask& task) {
  FitConstants constants = task.constants;
  constants.noise.shared.most_places = constants.noise.shared.places;
  return noiseOf({task.store, task.params, constants, task.threads});
}

/** The least noise that sets the width of the next cells: less where sides are in doubt and cells
 * contain more than noise. \param[in] noise that set the last width, or that these sides show if it
 * is less */
double leastCells(const SideSearch& search, double noise, const std::optional<TriedSides>& best,
                  const SideConstants& cells) {
  constexpr double kDoubtfulCells = 0.8;
  const bool narrower = noise <= search.least && best && best->sides.confidence < kSure &&
                        best->noise < cells.cell_noise * search.least;
  return narrower ? kDoubtfulCells * search.spacing : search.least;
}

/** Seeks sides by narrower and narrower cells: cells with both sides leave doubts, or too few faces
 * separated. Leaves doubts that moving the points answers better. Where no place shows the noise,
 * cells wider than parts show parts as rough sheets, and all widths are tried until they add to the
 * noise: the cost rises before it falls. \return the sides of the least cost, if any are enough */
std::optional<TriedSides> seekSides(const SideTask& task, const SideSearch& search) {
  constexpr int kMostWidths = 5;
  constexpr double kSameNoise = 0.75;   // least ratio of two noises that count as the same
  constexpr double kDoubtGrowth = 4;    // most, from wider to narrower cells of the same noise
  constexpr double kLeastNoise = 0.05;  // least upper bound of the noise that sides give a fit
  const SideConstants& cells = task.constants.sides;
  std::optional<TriedSides> best;
  double noise = std::max(search.noise, search.least);  // sets the width
  for (int width = 0; width < kMostWidths; ++width) {
    TriedSides next{
        findSides(task.store, noise, search.spacing, SideScope::kAll, cells, task.threads),
        search.spacing};
    const bool doubtful = next.doubt() > search.doubt;
    if (doubtful && best) break;
    if (doubtful || next.sides.thin < search.least_apart) {
      const double least = leastCells(search, noise, best, cells);
      if (noise <= least) break;
      noise = std::max(least, 0.5 * noise);
      continue;
    }
    const double shown = noiseAtFewPlaces(task.with(withSides(task.store, next.sides.normals)));
    next.noise = shown;
    const bool settled = best && shown > kSameNoise * best->noise;  // narrower cells add nothing
    const bool worse = best && (next.cost() > best->cost() ||
                                (settled && next.doubt() > kDoubtGrowth * best->doubt()));
    // Wrong sides add to the noise: cells are too narrow to show it.
    const bool noisier = best && kSameNoise * shown > best->noise;
    if (worse && (!search.unknown || noisier)) break;
    const bool sure = !search.unknown && !(next.sides.confidence < kSure);
    // Wider balls would contain what these cells separate. Sides never add to the noise: a patch of
    // one side alone of a thin tube bends more than its cubic.
    if (search.capped)
      next.most = std::min(std::max(noise, search.least),
                           std::max(search.unsided, kLeastNoise * search.spacing));
    if (!worse) best = std::move(next);
    const bool same = shown > kSameNoise * noise;
    const double least = leastCells(search, std::min(noise, shown), best, cells);
    if (noise <= least || (same && sure)) break;
    if (settled && !search.unknown && best->isMoved(search)) break;
    noise = std::max(least, same ? 0.5 * noise : shown);
  }
  return best;
}

constexpr double kPlaneNeighbors = 10;  ///< of a plane, for a noise of one spacing

/** The least noise for which points are moved to planes of enough neighbours. A given noise is not
 * that of moved points. */
double leastMoved(const SideTask& task, double spacing) {
  if (task.params.lambda || task.params.noise_model) return HUGE_VAL;
  const auto least = static_cast<double>(task.constants.side_search.least_plane_neighbors);
  return spacing * std::sqrt(least / kPlaneNeighbors);
}

/** Seeks sides of the points' feet on local planes: feet have less noise, and parts are as thick as
 * before. \param[in] doubtful sides of the points \return sides of the feet, and these */
std::optional<TriedSides> seekSidesOfFeet(const SideTask& task, const ThinPlaces& thin,
                                          double unsided, const TriedSides& doubtful) {
  constexpr double kMostNeighbors = 48;
  constexpr double kOneSided = 0.85;  // confidence from which a plane has points of one side only
  const double noise = std::min(doubtful.noise, unsided), ratio = doubtful.noise / thin.spacing;
  const auto k =
      static_cast<std::size_t>(std::min(kPlaneNeighbors * ratio * ratio, kMostNeighbors));
  Places feet =
      doubtful.sides.confidence > kOneSided
          ? feetOnLocalPlanes(withSides(task.store, doubtful.sides.normals), k, task.threads)
          : feetOnLocalPlanes(task.store, k, task.threads);
  const PointStore store = movedTo(task.store, feet, task.threads);
  const SideTask moved = task.with(store);
  const ThinPlaces left =
      findThinPlaces(store, task.constants.sides, task.constants.noise, task.threads);
  auto search = searchFor(left, noiseAtFewPlaces(moved), task.params);
  if (!search) return {};  // no sides are left to be found
  // Neighbours share what is left of the noise: small patches do not show all of it.
  const double least = task.constants.side_search.least_moved_noise * noise;
  search->noise = std::max(search->noise, least);
  search->unsided = std::max(search->unsided, least);
  std::optional<TriedSides> found = seekSides(moved, *search);
  if (!found) return {};
  found->scanned = noise;
  found->plane_neighbors = k;
  found->feet = std::move(feet);
  return found;
}

/** Seeks sides of all points: as they are and, where this leaves doubts under wide noise, moved to
 * local planes. */
std::optional<TriedSides> seekSidesOfAll(const SideTask& task, const ThinPlaces& thin,
                                         double correlation, SideSearch search) {
  constexpr double kTerraces = 3;  // least correlation of noise whose terraces look like sheets
  search.moved = leastMoved(task, thin.spacing);
  std::optional<TriedSides> found = seekSides(task, search);
  // Doubtful sides are better than none: a leaf about both sheets is farther from the points than
  // the noise.
  if (!found && !search.for_cover && correlation < kTerraces) {
    search.doubt = task.constants.side_search.last_doubt;
    found = seekSides(task, search);
  }
  if (!found || !found->isMoved(search)) return found;
  found->noise = noiseOf(task.with(withSides(task.store, found->sides.normals)));
  std::optional<TriedSides> of_feet = seekSidesOfFeet(task, thin, search.unsided, *found);
  if (of_feet) return of_feet;
  search.moved = HUGE_VAL;
  return seekSides(task, search);
}

/** The share of the noise variance that leaves may leave: balls that noise makes wide contain both
 * sheets where these are few spacings apart, and wrong sides do not keep them apart. The variance
 * that follows the points has an exponent that is linear in the gap and in the confidence. */
double noiseShare(const TriedSides& found, double lambda, double follow_distance) {
  constexpr double kNearGap = 4, kFarGap = 6;             // exponents 1 and 0 [spacings]
  constexpr double kMoreDoubt = 0.88, kLessDoubt = 0.93;  // confidence of exponents 1 and 0
  const auto ramp = [](double x, double all, double none) {
    return std::clamp((none - x) / (none - all), 0.0, 1.0);
  };
  const double gap = found.sides.gap, followed = follow_distance * gap;
  const double least = std::min(1.0, followed * followed / lambda);
  return std::pow(least, ramp(found.sides.confidence, kMoreDoubt, kLessDoubt) *
                             ramp(gap / found.spacing, kNearGap, kFarGap));
}

/** The cloud with sides of all its points, measured anew. */
CloudSides sidesOfAll(const SideTask& task, const SideSearch& search, TriedSides found,
                      const CloudSides& unsided) {
  CloudSides result;
  PointStore& store = result.for_cover.emplace(
      found.feet.empty() ? task.store : movedTo(task.store, found.feet, task.threads));
  store.setSides(found.sides.normals);
  CloudMeasures& measures = result.measures;
  measures = measureCloud(store, task.params, task.constants, task.threads);
  measures.statistics.patches += unsided.measures.statistics.patches;
  measures.lambda = std::min(measures.lambda, found.most * found.most);
  measures.scanned = found.scanned * found.scanned;
  SideStatistics& sides = result.statistics;
  sides = unsided.statistics;
  if (search.capped)
    sides.noise_share =
        noiseShare(found, measures.lambda, task.constants.side_search.follow_distance);
  if (sides.noise_share < 1 && !(measures.scanned > 0)) measures.scanned = measures.lambda;
  measures.lambda *= sides.noise_share;
  measures.skip_lone_sides = true;
  if (!store.hasSensors()) {
    settleSides(store, found.sides.on_rods, task.threads, found.sides.normals);
    store.setSides(found.sides.normals);
  }
  sides.for_cover = search.for_cover;
  sides.points = store.size();
  sides.confidence = found.sides.confidence;
  sides.in_doubt = sides.confidence < kSure;
  sides.plane_neighbors = found.plane_neighbors;
  if (found.sides.gap < HUGE_VAL) sides.gap = found.sides.gap / found.spacing;
  return result;
}

// Test of a large cloud by some of its few thin places.
constexpr std::size_t kProbePlaces = 16;
constexpr std::size_t kProbePoints = 1000;  ///< around each

/** The points around some of the thin places, by which a large cloud is judged. */
PointStore pointsAround(const PointStore& store, const ThinPlaces& thin, int threads) {
  const double radius = thin.spacing * std::sqrt(static_cast<double>(kProbePoints) / M_PI);
  const std::size_t step = 1 + (thin.thin.size() - 1) / kProbePlaces;
  std::vector<char> kept(store.numBlocks(), 0);
  std::vector<std::uint32_t> blocks, dropped;
  for (std::size_t k = 0; k < thin.thin.size(); k += step) {
    const std::array<double, 3> at = store.position(thin.thin[k]);
    const float center[3] = {static_cast<float>(at[0]), static_cast<float>(at[1]),
                             static_cast<float>(at[2])};
    blocks.clear();
    store.tree().blocksInBall(center, static_cast<float>(radius), blocks);
    for (const std::uint32_t b : blocks) kept[b] = 1;
  }
  for (std::size_t i = 0; i < store.size(); ++i) {
    if (!kept[i / PointStore::kBlock]) dropped.push_back(static_cast<std::uint32_t>(i));
  }
  return store.without(dropped, threads);
}

/** Sides for the cover of the points near another sheet, and of all points after it. \return the
 * cloud without sides where these are unsure */
CloudSides sidesNearSheets(const SideTask& task, const ThinPlaces& thin, CloudSides unsided) {
  constexpr std::size_t kLarge = 4;          // a large cloud has more points than this many tests
  constexpr double kProbeSure = 0.2;         // least share of edges between sheets in sure parts
  constexpr double kLeastConfidence = 0.95;  // of the signs of all cells
  constexpr float kUnsidedPass = -0.01f;     // a normal bound that points without a side are within
  double noise = std::sqrt(unsided.measures.lambda);
  if (thin.noise > 0) noise = std::min(noise, thin.noise);
  noise = std::max(noise, kLeastCells * thin.spacing);
  const auto sidesIn = [&](const PointStore& store) {
    return findSides(store, noise, thin.spacing, SideScope::kFacing, task.constants.sides,
                     task.threads);
  };
  const bool large = task.store.size() > kLarge * kProbePlaces * kProbePoints;
  if (large && !(sidesIn(pointsAround(task.store, thin, task.threads)).sure >= kProbeSure))
    return unsided;
  Sides sides = sidesIn(task.store);
  if (!(sides.thin > 0) || sides.outward_confidence < kLeastConfidence) return unsided;
  settleSides(task.store, sides.on_rods, task.threads, sides.normals);
  if (!task.store.hasSensors())  // else a point's own beam gives its side
    settleSides(task.store, sides.on_rods, task.threads, sides.outward);
  CloudSides result = std::move(unsided);
  result.for_cover = withSides(task.store, sides.normals);
  result.after_cover = withSides(task.store, sides.outward);
  result.measures.min_dot =
      std::min(normalBound(*result.for_cover, task.constants.normal_bound), kUnsidedPass);
  result.statistics.points = static_cast<std::size_t>(
      std::count_if(sides.normals.begin(), sides.normals.end(),
                    [](const std::array<float, 3>& n) { return n != std::array<float, 3>{}; }));
  result.statistics.confidence = sides.confidence;
  result.statistics.for_cover = true;
  return result;
}

}  // namespace

CloudSides sidesBeforeCover(const PointStore& store, const FitParams& params,
                            const FitConstants& constants, int threads, CloudMeasures measures) {
  // Least share of places of all kinds from which points near them get sides.
  constexpr double kLeastNearSheets = 0.04;
  // Sides change the noise, and a sensor's was measured without them.
  FitParams anew = params;
  anew.sensor_noise.reset();
  anew.keep_sensor_noise = false;
  const SideTask task{store, anew, constants, threads};
  CloudSides unsided;
  unsided.measures = std::move(measures);
  if (!mayNeedSides(task, unsided.measures)) return unsided;
  const NoiseStatistics& noise = unsided.measures.statistics;
  SideConstants rules = constants.sides;
  if (noise.step > 0) rules.two_sheet_kurtosis = HUGE_VAL;  // rounding errors are flatter, too
  const ThinPlaces thin = findThinPlaces(store, rules, constants.noise, threads);
  unsided.statistics.thin_places = thin.share;
  if (const auto search = searchFor(thin, std::sqrt(unsided.measures.lambda), params)) {
    std::optional<TriedSides> found = seekSidesOfAll(task, thin, noise.correlation, *search);
    if (!found) return unsided;
    return sidesOfAll(task, *search, std::move(*found), unsided);
  }
  // Errors that neighbours share make terraces, which look like sheets.
  const bool white = !(noise.correlation > 1);
  if (!white || thin.share + thin.facing < kLeastNearSheets) return unsided;
  return sidesNearSheets(task, thin, std::move(unsided));
}

}  // namespace pcl_slim::detail
