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
kernels::CoverLeaf
TrimMaker::wideSurfel(std::size_t i, const std::array<float, 3>& normal) const
{
  const TrimConstants& constants = settings_.constants.trim;
  const float r = surface_.radius[i];
  kernels::CoverLeaf surfel;
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

void
TrimMaker::gather(std::size_t i)
{
  const std::array<float, 3> normal{surface_.nx[i], surface_.ny[i], surface_.nz[i]};
  const kernels::CoverLeaf surfel = wideSurfel(i, normal);
  if (has_nearby_) {
    nearby_.blocksInBall(surfel.ball.center.data(), surfel.ball.radius, blocks_);
  } else {
    found_.clear();
    store_.tree().blocksInBall(surfel.ball.center.data(), surfel.ball.radius, found_);
    blocks_.assign(found_.begin(), found_.end());
  }
  if (!surface_.isLeaf(i) &&
      blocks_.size() * PointStore::kBlock > settings_.constants.trim.sampled) {
    sampleSheet(store_, blocks_, surfel, points_);
  } else {
    kernels::gatherSheet(store_, blocks_, surfel, points_);
  }
}

void
TrimMaker::prepare(std::size_t begin, std::size_t end)
{
  constexpr float kMostSpread = 16;  // of the balls' box over the widest ball; saves time alone
  const float* centers[3] = {surface_.cx.data(), surface_.cy.data(), surface_.cz.data()};
  float low[3], high[3], widest = 0, spread = 0;
  for (std::size_t i = begin; i < end; ++i) widest = std::max(widest, surface_.radius[i]);
  widest *= static_cast<float>(settings_.constants.trim.known);
  for (std::size_t a = 0; a < 3; ++a) {
    const auto [least, most] = std::minmax_element(centers[a] + begin, centers[a] + end);
    low[a] = *least - widest;
    high[a] = *most + widest;
    spread = std::max(spread, high[a] - low[a]);
  }
  has_nearby_ = spread < kMostSpread * widest;
  if (has_nearby_) nearby_.collect(store_.tree(), low, high);
}

/** Unit normal of surfel i's surface over one of its points. */
Vector3
TrimMaker::normalAt(std::size_t i, std::size_t point, const LocalFrame& frame) const
{
  const HeightJet jet = evaluateJet(surface_.degree[i], surface_.coefficientsOf(i),
                                    points_.u[point], points_.v[point]);
  return normalized(along(along(frame.w, -jet.hu, frame.u), -jet.hv, frame.v));
}

/** Whether the data end at one of the places in gaps, evenly chosen, and do not just turn away from
 * the surfel's plane: at the points next to the place, on each of four sides. */
bool
TrimMaker::dataEndAtGaps(std::size_t i, double spacing)
{
  const double r = surface_.radius[i];
  const LocalFrame frame({surface_.nx[i], surface_.ny[i], surface_.nz[i]});
  const auto most = static_cast<std::size_t>(settings_.constants.border.places);
  const std::size_t count = std::min(most, places_.size());
  for (std::size_t k = 0; k < count; ++k) {
    const auto& [u, v] = places_[k * places_.size() / count];
    const auto rims =
        kernels::nearestInQuadrants(points_, static_cast<float>(u), static_cast<float>(v));
    for (const std::uint32_t rim : rims.nearest) {
      if (rim >= points_.count) continue;
      if (border_.endsAt(points_.index[rim], r * spacing, normalAt(i, rim, frame))) return true;
    }
  }
  return false;
}

int
TrimMaker::make(std::size_t i, std::vector<std::uint8_t>& bits)
{
  const TrimConstants& constants = settings_.constants.trim;
  gather(i);
  const float* c = surface_.coefficientsOf(i);
  // The finest map has a node a spacing, the coarsest five a side.
  double least = 2.0 / (TrimMap::kMostSide - 1);
  if (!surface_.isLeaf(i)) least = 2.0 / (constants.internal_side - 1);
  const double spacing = std::clamp(spacingOf(points_), least, 0.5);
  const TrimScale scale{spacing, hole_size_ * spacing, constants.growth * spacing};
  // Nearer to the rim half of a hole's disc is unknown, and chance leaves the other half empty often.
  const double sure = constants.known - 0.5 * scale.hole;
  if (sure <= 0.0) return 0;
  raster_.findGaps(points_, KnownRegion(surface_.degree[i], c, sure), scale, constants, places_);
  if (places_.empty()) return 0;
  ++candidates_;
  if (!dataEndAtGaps(i, spacing)) return 0;
  raster_.measureDepths(points_, KnownRegion(surface_.degree[i], c, constants.known));
  const double clear = kDepthUnit * constants.clear * spacing / raster_.cell();
  if (raster_.leastDepth(constants.looked_at) > clear) return 0;
  return appendMap(spacing, bits);
}

/** \return the map's side: a node a spacing. */
int
TrimMaker::appendMap(double spacing, std::vector<std::uint8_t>& bits) const
{
  const int side = std::clamp(static_cast<int>(std::ceil(2.0 / spacing)) + 1, TrimMap::kLeastSide,
                              TrimMap::kMostSide);
  const std::size_t begin = bits.size();
  bits.resize(begin + TrimMap::numBytes(side), 0);
  raster_.fillMap(side, bits.data() + begin);
  keepPoints(points_, side, bits.data() + begin);
  return side;
}

}  // namespace pcl_slim::detail
