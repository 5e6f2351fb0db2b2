// SPDX-License-Identifier: BSD-3-Clause
#include "trim/trim_maker.h"

#include <algorithm>
#include <cmath>

namespace pcl_slim::detail {

namespace {

constexpr int kDepthUnit = 64;  ///< of a raster's depths, a cell

/** Sets the bit of the node next to each point: smoothing wipes out points that stand alone or in a
 * single row. */
void
keepPoints(const SheetPoints& points, int side, std::uint8_t* bits)
{
  const float per_unit = 0.5f * static_cast<float>(side - 1);
  for (std::size_t i = 0; i < points.count; ++i) {
    const float u = points.u[i], v = points.v[i];
    if (std::max(std::abs(u), std::abs(v)) > 1.0f) continue;
    const int column = static_cast<int>((u + 1.0f) * per_unit + 0.5f);
    const int k = static_cast<int>((v + 1.0f) * per_unit + 0.5f) * side + column;
    bits[k >> 3] |= static_cast<std::uint8_t>(1 << (k & 7));
  }
}

}  // namespace

/** Surfel i as the cover sees it, with a wider ball and more patience for what lies beside it.
 * \param[in] normal its own, which must outlive the result */
kernels::SheetQuery
TrimMaker::wideSurfel(std::size_t i, const std::array<float, 3>& normal) const
{
  const TrimConstants& constants = settings_.constants.trim;
  const float r = surface_.radius[i];
  kernels::SheetQuery surfel;
  surfel.ball = {{surface_.cx[i], surface_.cy[i], surface_.cz[i]},
                 static_cast<float>(constants.known * r),
                 settings_.with_normals ? normal.data() : nullptr,
                 settings_.min_dot};
  surfel.frame = LocalFrame({normal[0], normal[1], normal[2]});
  surfel.degree = surface_.degree[i];
  surfel.support_radius = r;
  surfel.c = surface_.coefficientsOf(i);
  surfel.max_residual = static_cast<float>(
      std::max(constants.gate * r, settings_.constants.cover.residual_bound * surface_.error[i]));
  return surfel;
}

/** Collects the points of a surfel's sheet. An internal surfel's many points are sampled. */
void
TrimMaker::gather(std::size_t i)
{
  const TrimConstants& constants = settings_.constants.trim;
  const std::array<float, 3> normal{surface_.nx[i], surface_.ny[i], surface_.nz[i]};
  const kernels::SheetQuery surfel = wideSurfel(i, normal);
  found_.clear();
  store_.tree().blocksInBall(surfel.ball.center.data(), surfel.ball.radius, found_);
  if (!surface_.isLeaf(i) && found_.size() * PointStore::kBlock > constants.sampled) {
    sampleSheet(store_, found_, surfel, points_);
  } else {
    blocks_.assign(found_.begin(), found_.end());
    kernels::gatherSheet(store_, blocks_, surfel, points_);
  }
  // The finest map has a node a spacing, the coarsest five a side.
  double least = 2.0 / (TrimMap::kMostSide - 1);
  if (!surface_.isLeaf(i)) least = 2.0 / (constants.internal_side - 1);
  spacing_ = std::clamp(spacingOf(points_), least, 0.5);
}

/** Collects the points around a leaf, beyond its ball. */
void
TrimMaker::gatherWidely(std::size_t i, double view)
{
  const TrimConstants& constants = settings_.constants.trim;
  const std::array<float, 3> normal{surface_.nx[i], surface_.ny[i], surface_.nz[i]};
  kernels::SheetQuery surfel = wideSurfel(i, normal);
  surfel.ball.radius = static_cast<float>(view * surface_.radius[i]);
  surfel.ball.min_dot = std::min(surfel.ball.min_dot, 0.0f);
  surfel.known = static_cast<float>(constants.known);
  surfel.view_slope = static_cast<float>(constants.view_slope);
  found_.clear();
  store_.tree().blocksInBall(surfel.ball.center.data(), surfel.ball.radius, found_);
  blocks_.assign(found_.begin(), found_.end());
  kernels::gatherSheet(store_, blocks_, surfel, seen_);
}

LeafGaps
TrimMaker::findGaps(std::size_t i, bool with_folds)
{
  const TrimConstants& constants = settings_.constants.trim;
  gather(i);
  const KnownRegion known = knownOf(i, constants.known);
  const double hole = hole_size_ * spacing_;
  may_have_gaps_ = search_.mayHaveGap(points_, known, hole, constants);
  if (!may_have_gaps_) return {};
  if (!evidence_.findGaps(points_, sheetOf(i), known, spacing_, hole, with_folds)) return {};
  LeafGaps gaps = leafGapsOf(evidence_.gaps(), static_cast<std::uint32_t>(i));
  return with_folds || evidence_.mayBeReal() ? gaps : LeafGaps();
}

bool
TrimMaker::findReal(const LeafGaps& gaps, std::vector<std::uint32_t>& real)
{
  const std::size_t i = gaps.surfel;
  gather(i);
  const KnownRegion known = knownOf(i, settings_.constants.trim.known);
  const double hole = hole_size_ * spacing_;
  if (!evidence_.findGaps(points_, sheetOf(i), known, spacing_, hole, false)) return false;
  const double view = evidence_.view(spacing_);
  const bool wider = view > settings_.constants.trim.known;
  if (wider) gatherWidely(i, view);
  evidence_.findReal(wider ? seen_ : points_, sheetOf(i), places_);
  for (const LeafGaps::Place& place : places_) {
    const int gap = gaps.gapAt(place.u, place.v);
    if (gap >= 0) real.push_back(static_cast<std::uint32_t>(gap));
  }
  return !places_.empty();
}

/** Closes the gaps that are not real by points on the middles of their empty discs. */
void
TrimMaker::fillUnreal(const LeafGaps& gaps)
{
  if (std::find(gaps.real.begin(), gaps.real.end(), 0) == gaps.real.end()) return;
  for (const LeafGaps::Run& run : gaps.runs) {
    if (gaps.real[run.gap]) continue;
    points_.reserve(points_.count + static_cast<std::size_t>(run.last - run.first + 1));
    for (int x = run.first; x <= run.last; ++x) {
      points_.u[points_.count] = (static_cast<float>(x) + 0.5f - gaps.half) / gaps.cells_per_unit;
      points_.v[points_.count++] =
          (static_cast<float>(run.y) + 0.5f - gaps.half) / gaps.cells_per_unit;
    }
  }
}

int
TrimMaker::make(std::size_t i, const LeafGaps* gaps, std::vector<std::uint8_t>& bits)
{
  const TrimConstants& constants = settings_.constants.trim;
  gather(i);
  const TrimScale scale{spacing_, hole_size_ * spacing_, constants.growth * spacing_};
  const std::size_t count = points_.count;
  if (gaps != nullptr) fillUnreal(*gaps);
  const bool has_gap = raster_.measure(points_, knownOf(i, constants.known), scale, constants);
  points_.count = count;
  if (!has_gap) return 0;
  const double sure = constants.known - 0.5 * constants.sure * scale.hole;
  if (!raster_.hasGapWithin(knownOf(i, std::max(sure, 0.0)))) return 0;
  const double clear = kDepthUnit * constants.clear * spacing_ / raster_.cell();
  if (raster_.leastDepth(constants.looked_at) > clear) return 0;
  const int side = std::clamp(static_cast<int>(std::ceil(2.0 / spacing_)) + 1, TrimMap::kLeastSide,
                              TrimMap::kMostSide);
  const std::size_t begin = bits.size();
  bits.resize(begin + TrimMap::numBytes(side), 0);
  raster_.fillMap(side, bits.data() + begin);
  keepPoints(points_, side, bits.data() + begin);
  return side;
}

}  // namespace pcl_slim::detail
