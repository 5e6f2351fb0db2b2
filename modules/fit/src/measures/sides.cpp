// SPDX-License-Identifier: BSD-3-Clause
#include "measures/measures.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "pcl_slim/cloud/detail/noise.h"
#include "pcl_slim/cloud/detail/sides.h"

namespace pcl_slim::detail {

namespace {

constexpr float kUnsidedPass = -0.01f;  ///< a normal bound that points without a side are within

/** Given sides win, and a viewpoint gives the side of every point. Points on scan lines have no
 * normals of cells, and those of cells are too coarse to keep sharp edges apart. */
bool mayNeedSides(const PointStore& store, const FitParams& params, const FitStatistics& stats) {
  return params.sides && !params.sharp_features && !store.hasNormals() && !params.viewpoint &&
         !params.paper_mode && !params.hasThreshold() && stats.noise.line == 0;
}

/** What the sides of a cloud must meet. */
struct SideSearch {
  double share = 0;         ///< of the places that have two sides
  double least_apart = 0;   ///< share of the points that must come to face apart
  double doubt = 0;         ///< most of the agreements that may be unmet, ...
  double first_doubt = 0;   ///< ... or this by the first sides, if it is more
  bool needed = false;      ///< a fit does not part these by itself
  double noise = 0;         ///< by which the first cells are cut
  double least = 0;         ///< noise below which the spacing alone sets the width of cells
  double unsided = 0;       ///< noise measured without sides
  double moved = HUGE_VAL;  ///< noise from which points are moved where sides are in doubt
  bool unknown = false;     ///< no place of one side shows the noise
  bool for_cover = false;   ///< a fit finds little noise: sides are for the cover alone
  bool capped = true;       ///< lambda may not exceed the noise that cells are cut by
};

/** Share of thin places that sides are worth. Where there is little noise small balls part sheets
 * by themselves, and cells are about as many as points. \param[in] noise in spacings */
double leastShare(double noise, const SideConstants& rules) {
  const double clean = (rules.full_noise - noise) / (rules.full_noise - rules.clean_noise);
  return rules.least_thin + std::clamp(clean, 0.0, 1.0) * (rules.clean_thin - rules.least_thin);
}

/** The least noise for which points are moved to planes of enough neighbours. A given noise is not
 * that of moved points. */
double leastMoved(double spacing, const FitParams& params, const SideConstants& rules) {
  if (params.lambda || params.noise_model) return HUGE_VAL;
  return spacing * std::sqrt(static_cast<double>(rules.least_plane) / rules.plane);
}

/** \return nothing where a cloud has too few thin places. */
std::optional<SideSearch> searchFor(const ThinPlaces& thin, double unsided, bool measured,
                                    const SideConstants& rules) {
  SideSearch search;
  search.unsided = search.noise = unsided;
  if (measured && thin.noise > 0) search.noise = std::min(unsided, thin.noise);
  search.least = rules.least_cells * thin.spacing;
  search.capped = measured;
  search.unknown = measured && !(thin.noise > 0);
  // Merged frames face each other here and there, where their errors differ: such sheets must be
  // surer.
  const bool most = thin.share + thin.facing >= rules.least_facing;
  search.for_cover = (most ? unsided : search.noise) < rules.full_noise * thin.spacing;
  search.needed = most || thin.share >= leastShare(search.noise / thin.spacing, rules);
  search.share = most            ? thin.share + thin.facing
                 : search.needed ? std::max(thin.share, thin.facing)
                                 : thin.share + thin.near;
  if (!search.needed && search.share < rules.clean_thin) return {};
  search.least_apart = rules.part * std::max(0.0, search.share - thin.flat);
  // Wrong sides break up the wide leaves of a clean cloud.
  search.doubt = rules.doubt * search.share;
  if (search.for_cover) search.doubt = std::min(search.doubt, rules.clean_doubt);
  return search;
}

/** Sides by cells of one width, and the noise that they show. */
struct SidedFit {
  Sides sides;
  double spacing = 0;      ///< of the points
  double noise = 0;        ///< from few places
  double most = HUGE_VAL;  ///< noise that a fit may have with these sides
  double scanned = 0;      ///< noise of the points before they were moved
  std::size_t plane_neighbors = 0;
  std::vector<std::array<double, 3>> feet{};  ///< where the points are moved to; none: they stay

  /** The noise over the agreement of the sides and the share of points that face apart: the noise
   * rises or one of the others falls where sides are wrong, or cells contain both. */
  double cost() const { return noise / (sides.confidence * sides.thin); }
  double doubt() const { return 1 - sides.confidence; }

  /** Whether sides are in doubt and noise is so much wider than the spacing that moving points
   * removes it. */
  bool isMoved(const SideSearch& search, const SideConstants& rules) const {
    return sides.confidence < rules.sure && noise >= search.moved;
  }
};

/** The least noise by which the next cells are cut: less where sides are in doubt and cells contain
 * more than noise. \param[in] noise by which the last ones were cut, or that they show if it is
 * less */
double leastCells(const SideSearch& search, double noise, double spacing,
                  const std::optional<SidedFit>& best, const SideConstants& rules) {
  const bool narrower = noise <= search.least && best && best->sides.confidence < rules.sure &&
                        best->noise < rules.cell_noise * search.least;
  return narrower ? rules.doubtful_cells * spacing : search.least;
}

/** Constants with which noise is measured at few places, where sides are compared. */
FitConstants fewPlaces(FitConstants constants) {
  constants.noise.shared.most_places = constants.noise.shared.places;
  return constants;
}

/** The RMS noise that a store's sides show. */
Result<double> noiseOf(const PointStore& store, const FitConstants& constants, FitParams params,
                       int threads) {
  if (!params.noise_model) params.local_noise = false;
  FitStatistics unused;
  const Result<CloudMeasures> measured = measureCloud(store, params, constants, threads, unused);
  if (!measured) return measured.error();
  return std::sqrt(measured->lambda);
}

/** Seeks sides by narrower and narrower cells: cells with both sides leave doubts, or too few faces
 * separated. Keeps the sides of the least cost. Leaves doubts that moving the points answers
 * better. Where no place shows the noise, cells wider than parts show parts as rough sheets, and
 * all widths are tried until they add to the noise: the cost rises before it falls. */
Error seekSides(const SideSearch& search, double spacing, const FitConstants& constants,
                const FitParams& params, int threads, SidedStore& sided,
                std::optional<SidedFit>& best) {
  const SideConstants& rules = constants.sides;
  double noise = std::max(search.noise, search.least);
  bool settled = false;  // narrower cells show the same noise
  for (int pass = 0; pass < rules.noise_passes; ++pass) {
    sided.clearSides();
    SidedFit next{findSides(sided.store(), noise, spacing, SideScope::kAll, rules, threads),
                  spacing};
    const bool few = next.sides.thin < search.least_apart;
    const double most_doubt = best ? search.doubt : std::max(search.doubt, search.first_doubt);
    const bool doubtful = next.doubt() > most_doubt;
    const bool narrower = few || doubtful || search.unknown || next.sides.confidence < rules.sure;
    if (doubtful && best) break;
    double found = noise;
    if (!few && !doubtful) {
      sided.setSides(next.sides.normals);
      const Result<double> measured = noiseOf(sided.store(), fewPlaces(constants), params, threads);
      if (!measured) return measured.error();
      found = next.noise = *measured;
      if (!search.needed && found > rules.same_noise * search.unsided) break;
      settled = best && next.noise > rules.same_noise * best->noise;
      const bool worse = best && (next.cost() > best->cost() ||
                                  (settled && next.doubt() > rules.much_doubt * best->doubt()));
      // Wrong sides add to the noise: cells are too narrow to show it.
      const bool noisier = best && rules.same_noise * next.noise > best->noise;
      if (worse && (!search.unknown || noisier)) break;
      // Wider balls would contain what these cells separate. Sides never add to the noise: a patch
      // of one side alone of a thin tube bends more than its cubic.
      if (search.capped)
        next.most = std::min(std::max(noise, search.least),
                             std::max(search.unsided, rules.least_noise * spacing));
      if (!worse) best = std::move(next);
    }
    const bool same = found > rules.same_noise * noise;
    const double least = leastCells(search, std::min(noise, found), spacing, best, rules);
    if (noise <= least || (same && !narrower)) break;
    if (settled && !search.unknown && best->isMoved(search, rules)) break;
    noise = std::max(least, same ? 0.5 * noise : found);
  }
  sided.clearSides();
  return {};
}

/** Seeks sides of the points' feet on local planes: feet have less noise, and parts are as thick as
 * before. Sides that it finds replace the others, with the feet. */
Error seekSidesOfFeet(const ThinPlaces& thin, double unsided, const FitConstants& constants,
                      const FitParams& params, int threads, const PointStore& store,
                      std::optional<SidedFit>& best) {
  const SideConstants& rules = constants.sides;
  const double noise = std::min(best->noise, unsided), ratio = best->noise / thin.spacing;
  const auto k = static_cast<std::size_t>(std::min(rules.plane * ratio * ratio, rules.most_plane));
  PointStore moved = store;
  if (best->sides.confidence > rules.plane_sides) moved.setSides(best->sides.normals);
  std::vector<std::array<double, 3>> feet = feetOnLocalPlanes(moved, k, threads);
  moved.clearSides();
  moved.moveTo(feet, threads);

  const Result<double> measured = noiseOf(moved, fewPlaces(constants), params, threads);
  if (!measured) return measured.error();
  const ThinPlaces left = findThinPlaces(moved, rules, constants.noise, threads);
  auto search = searchFor(left, *measured, true, rules);
  if (!search) return {};  // no sides are left to be found
  // Moved points show fewer thin places, but no fewer doubts.
  search->first_doubt = rules.doubt * thin.share;
  // Neighbours share what is left of the noise: small patches do not show all of it.
  search->noise = std::max(search->noise, rules.feet_noise * noise);
  search->unsided = std::max(search->unsided, rules.feet_noise * noise);
  SidedStore sided(moved);
  std::optional<SidedFit> found;
  if (Error error = seekSides(*search, left.spacing, constants, params, threads, sided, found))
    return error;
  if (!found) return {};
  found->scanned = noise;
  found->plane_neighbors = k;
  found->feet = std::move(feet);
  best = std::move(found);
  return {};
}

/** The share of the noise variance that leaves may leave: balls that noise makes wide contain both
 * sheets where these are few spacings apart, and wrong sides do not keep them apart. */
double noiseShare(const SidedFit& fit, double lambda, const SideConstants& rules) {
  const auto ramp = [](double x, double all, double none) {
    return std::clamp((none - x) / (none - all), 0.0, 1.0);
  };
  const double gap = fit.sides.gap, followed = rules.followed * gap;
  const double least = std::min(1.0, followed * followed / lambda);
  return std::pow(least, ramp(fit.sides.confidence, rules.more_doubt, rules.less_doubt) *
                             ramp(gap / fit.spacing, rules.near_gap, rules.far_gap));
}

/** The points around some of the thin places, by which a large cloud is judged. */
PointStore pointsAround(const PointStore& store, const ThinPlaces& thin, const SideConstants& rules,
                        int threads) {
  const double radius = thin.spacing * std::sqrt(static_cast<double>(rules.probe_points) / M_PI);
  const std::size_t step = 1 + (thin.thin.size() - 1) / rules.probe_places;
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

/** Gives sides to the points near another sheet for the cover, and to all points for the steps
 * after it. */
void sideFacingPlaces(const ThinPlaces& thin, const FitConstants& constants, SidedStore& sided,
                      CloudMeasures& measures, FitStatistics& stats) {
  const SideConstants& rules = constants.sides;
  double noise = std::sqrt(measures.lambda);
  if (thin.noise > 0) noise = std::min(noise, thin.noise);
  noise = std::max(noise, rules.least_cells * thin.spacing);
  const auto sidesIn = [&](const PointStore& store) {
    return findSides(store, noise, thin.spacing, SideScope::kFacing, rules, stats.threads);
  };
  const bool large =
      sided.store().size() > rules.probe_part * rules.probe_places * rules.probe_points;
  if (large &&
      !(sidesIn(pointsAround(sided.store(), thin, rules, stats.threads)).sure >= rules.probe_sure))
    return;
  Sides sides = sidesIn(sided.store());
  if (!(sides.thin > 0) || sides.outward_confidence < rules.outward) return;
  settleSides(sided.store(), sides.on_rods, rules, stats.threads, sides.normals);
  if (!sided.store().hasSensors())  // else a point's own beam gives its side
    settleSides(sided.store(), sides.on_rods, rules, stats.threads, sides.outward);
  sided.setSidesForCover(sides.normals, std::move(sides.outward));
  measures.min_dot = std::min(normalBound(sided.store(), constants.normal_bound), kUnsidedPass);
  stats.sides.points = static_cast<std::size_t>(
      std::count_if(sides.normals.begin(), sides.normals.end(),
                    [](const std::array<float, 3>& n) { return n != std::array<float, 3>{}; }));
  stats.sides.confidence = sides.confidence;
  stats.sides.for_cover = true;
}

/** Seeks sides of all points: as they are and, where this leaves doubts under wide noise, moved to
 * local planes. */
Error seekSidesOfAll(const ThinPlaces& thin, double unsided, const FitConstants& constants,
                     const FitParams& params, SideSearch& search, SidedStore& sided,
                     const FitStatistics& stats, std::optional<SidedFit>& best) {
  const SideConstants& rules = constants.sides;
  const auto seek = [&] {
    return seekSides(search, thin.spacing, constants, params, stats.threads, sided, best);
  };
  search.moved = leastMoved(thin.spacing, params, rules);
  if (Error error = seek()) return error;
  // Doubtful sides are better than none: a leaf about both sheets is farther from the points than
  // the noise.
  if (!best && search.needed && !search.for_cover && stats.noise.correlation < rules.terraces) {
    search.doubt = rules.last_doubt;
    if (Error error = seek()) return error;
  }
  if (!best || !best->isMoved(search, rules)) return {};
  sided.setSides(best->sides.normals);
  const Result<double> measured = noiseOf(sided.store(), constants, params, stats.threads);
  sided.clearSides();
  if (!measured) return measured.error();
  best->noise = *measured;
  if (Error error =
          seekSidesOfFeet(thin, unsided, constants, params, stats.threads, sided.store(), best))
    return error;
  if (!best->feet.empty()) return {};
  search.moved = HUGE_VAL;
  best.reset();
  return seek();
}

/** Gives a fit the sides that were found, and measures the cloud anew with them. */
Error takeSides(SidedFit& found, const SideSearch& search, const FitConstants& constants,
                const FitParams& params, SidedStore& sided, CloudMeasures& measures,
                FitStatistics& stats) {
  const SideConstants& rules = constants.sides;
  if (!found.feet.empty()) sided.moveTo(found.feet, stats.threads);
  sided.setSides(found.sides.normals);
  Result<CloudMeasures> measured =
      measureCloud(sided.store(), params, constants, stats.threads, stats);
  if (!measured) return measured.error();
  measures = std::move(*measured);
  measures.lambda = std::min(measures.lambda, found.most * found.most);
  measures.scanned = found.scanned * found.scanned;
  SideStatistics& sides = stats.sides;
  if (search.capped) sides.noise_share = noiseShare(found, measures.lambda, rules);
  if (sides.noise_share < 1 && !(measures.scanned > 0)) measures.scanned = measures.lambda;
  measures.lambda *= sides.noise_share;
  sided.clearSides();
  if (!sided.store().hasSensors())
    settleSides(sided.store(), found.sides.on_rods, rules, stats.threads, found.sides.normals);
  // Where there is little noise, leaves may start at points whose neighbours face elsewhere.
  sides.for_cover = search.for_cover;
  if (sides.for_cover)
    sided.setSidesForCover(found.sides.normals, found.sides.normals);
  else
    sided.setSides(found.sides.normals);
  measures.skip_lone_sides = !sides.for_cover;
  sides.points = sided.store().size();
  sides.confidence = found.sides.confidence;
  sides.in_doubt = sides.confidence < rules.sure;
  sides.plane_neighbors = found.plane_neighbors;
  if (found.sides.gap < HUGE_VAL) sides.gap = found.sides.gap / found.spacing;
  return {};
}

}  // namespace

Error giveSides(const FitConstants& constants, const FitParams& params, SidedStore& sided,
                CloudMeasures& measures, FitStatistics& stats) {
  if (!mayNeedSides(sided.store(), params, stats)) return {};
  SideConstants rules = constants.sides;
  if (stats.noise.step > 0) rules.flatter = HUGE_VAL;  // rounding errors are flatter, too
  const ThinPlaces thin = findThinPlaces(sided.store(), rules, constants.noise, stats.threads);
  stats.sides.thin_places = thin.share;
  const double unsided = std::sqrt(measures.lambda);
  auto search = searchFor(thin, unsided, !params.lambda, rules);
  if (!search) {
    // Errors that neighbours share make terraces, which look like sheets.
    const bool white = !(stats.noise.correlation > 1);
    if (white && thin.share + thin.facing + thin.near >= rules.few_thin)
      sideFacingPlaces(thin, constants, sided, measures, stats);
    return {};
  }
  std::optional<SidedFit> best;
  if (Error error = seekSidesOfAll(thin, unsided, constants, params, *search, sided, stats, best))
    return error;
  return best ? takeSides(*best, *search, constants, params, sided, measures, stats) : Error{};
}

}  // namespace pcl_slim::detail
