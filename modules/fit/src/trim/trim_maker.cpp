// SPDX-License-Identifier: BSD-3-Clause
#include "trim/trim_maker.h"

#include <algorithm>
#include <cmath>
#include <limits>

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
  found_.clear();
  store_.tree().blocksInBall(surfel.ball.center.data(), surfel.ball.radius, found_);
  if (!surface_.isLeaf(i) &&
      found_.size() * PointStore::kBlock > settings_.constants.trim.sampled) {
    sampleSheet(store_, found_, surfel, points_);
  } else {
    blocks_.assign(found_.begin(), found_.end());
    kernels::gatherSheet(store_, blocks_, surfel, points_);
  }
}

/** The points next to a place in a gap, on each of four sides. */
std::array<std::size_t, 4>
TrimMaker::rimsOf(float u, float v) const
{
  constexpr float kNone = std::numeric_limits<float>::max();
  float least[4] = {kNone, kNone, kNone, kNone};
  std::array<std::size_t, 4> nearest{};
  for (std::size_t i = 0; i < points_.count; ++i) {
    const float du = points_.u[i] - u, dv = points_.v[i] - v;
    const float square = du * du + dv * dv;
    const std::size_t side = (du < 0.0f ? 1u : 0u) + (dv < 0.0f ? 2u : 0u);
    if (square >= least[side]) continue;
    least[side] = square;
    nearest[side] = i;
  }
  const std::size_t closest = static_cast<std::size_t>(std::min_element(least, least + 4) - least);
  for (std::size_t side = 0; side < 4; ++side)
    if (least[side] > 4 * least[closest]) nearest[side] = nearest[closest];
  return nearest;
}

/** Whether the data end at one of some gaps, evenly chosen, and do not just turn away from surfel i's
 * plane. */
bool
TrimMaker::dataEndAtGaps(std::size_t i, double spacing)
{
  const auto most = static_cast<std::size_t>(settings_.constants.border.places);
  const std::size_t count = std::min(most, places_.size());
  const double r = surface_.radius[i];
  const LocalFrame frame({surface_.nx[i], surface_.ny[i], surface_.nz[i]});
  const Vector3 center{surface_.cx[i], surface_.cy[i], surface_.cz[i]};
  tested_.clear();
  for (std::size_t k = 0; k < count; ++k) {
    const auto& [u, v] = places_[k * places_.size() / count];
    for (const std::size_t rim : rimsOf(static_cast<float>(u), static_cast<float>(v))) {
      if (std::find(tested_.begin(), tested_.end(), rim) != tested_.end()) continue;
      tested_.push_back(rim);
      const Vector3 place =
          along(along(along(center, r * points_.u[rim], frame.u), r * points_.v[rim], frame.v),
                r * points_.w[rim], frame.w);
      if (border_.endsAt(place, r * spacing)) return true;
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
  const KnownRegion known(surface_.degree[i], c, constants.known);
  const double spacing = std::clamp(spacingOf(points_), least, 0.5);
  const TrimScale scale{spacing, hole_size_ * spacing, constants.growth * spacing};
  gaps_.find(points_, known, scale.hole, constants, places_);
  if (places_.empty()) return 0;
  ++candidates_;
  if (!dataEndAtGaps(i, spacing) || !raster_.measure(points_, known, scale, constants)) return 0;
  const double sure = constants.known - 0.5 * constants.sure * scale.hole;
  if (!raster_.hasGapWithin(KnownRegion(surface_.degree[i], c, std::max(sure, 0.0)))) return 0;
  const double clear = kDepthUnit * constants.clear * spacing / raster_.cell();
  if (raster_.leastDepth(constants.looked_at) > clear) return 0;
  const int side = std::clamp(static_cast<int>(std::ceil(2.0 / spacing)) + 1, TrimMap::kLeastSide,
                              TrimMap::kMostSide);
  const std::size_t begin = bits.size();
  bits.resize(begin + TrimMap::numBytes(side), 0);
  raster_.fillMap(side, bits.data() + begin);
  keepPoints(points_, side, bits.data() + begin);
  return side;
}

}  // namespace pcl_slim::detail
