// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "borders/drawn_area.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/surface/polynomial.h"

namespace pcl_slim::borders {
namespace {

constexpr int kPlaces = 9;           ///< the foot and 8 around it
constexpr double kAround = 0.5;      ///< spacings that those are away
constexpr double kSameSheet = 0.25;  ///< radii a place may be beside a leaf's own surface

/** \brief What leaves say of a place: the renderer's blend, met at the place itself. */
struct PlaceBlend {
  float weight = 0.0f, coverage = 0.0f, outside = 0.0f, offset_sum[3] = {0.0f, 0.0f, 0.0f};
  int leaves = 0;

  bool isDrawn(double min_coverage) const {
    if (leaves == 0 || outside > 0.5f * weight) return false;
    if (coverage >= min_coverage) return true;
    const float offset_sq = offset_sum[0] * offset_sum[0] + offset_sum[1] * offset_sum[1] +
                            offset_sum[2] * offset_sum[2];
    return leaves >= 3 && offset_sq < weight * weight / 16.0f;
  }
};

/** \brief Adds one leaf to a place, given from the leaf's centre in its radii. */
void addLeaf(const SLIMSurface& surface, std::size_t i, const Vector3& offset, bool trim,
             PlaceBlend& sum) {
  const LocalFrame frame({surface.nx[i], surface.ny[i], surface.nz[i]});
  const double u = dot(offset, frame.u), v = dot(offset, frame.v);
  const double beside =
      dot(offset, frame.w) - evaluateHeight(surface.degree[i], surface.coefficientsOf(i), u, v);
  if (std::abs(beside) >= kSameSheet) return;
  const double s_sq = dot(offset, offset), alpha = surface.info.cover_radius;
  const double w = surface.varianceWeight(i) * evaluateKernel(surface.info.blend_kernel, s_sq);
  if (!(w > 0.0)) return;
  sum.weight += static_cast<float>(w);
  sum.coverage +=
      static_cast<float>(evaluateKernel(surface.info.blend_kernel, s_sq / (alpha * alpha)));
  if (trim) sum.outside += static_cast<float>(w * outsideShare(surface.trimMap(i), u, v));
  for (std::size_t a = 0; a < 3; ++a) sum.offset_sum[a] += static_cast<float>(w * offset[a]);
  ++sum.leaves;
}

/** \brief A foot's nine places, the store's units. */
Vector3 placeOf(const Feet& feet, std::size_t foot, int k) {
  const auto p = feet.store.position(foot);
  if (k == 0) return p;
  const auto n = feet.normal[foot];
  const LocalFrame frame({n[0], n[1], n[2]});
  const double angle = 0.25 * M_PI * k;
  const double step = kAround * feet.spacing[foot];
  return along(along(p, step * std::cos(angle), frame.u), step * std::sin(angle), frame.v);
}

/** \brief Nine places a foot, and what the leaves say of them. */
class Places {
 public:
  Places(const SLIMSurface& surface, const Feet& feet, bool trim)
      : surface_(surface), feet_(feet), trim_(trim), blends_(feet.store.size() * kPlaces) {
    for (const float s : feet.spacing) widest_ = std::max(widest_, s);
    const SurfaceInfo& info = surface.info;
    factor_ = info.scale / feet.store.scale();
    origin_ = scaled(subtract(info.origin, feet.store.origin()), 1.0 / feet.store.scale());
  }

  void addLeaf(std::size_t i) {
    const Vector3 center =
        along(origin_, factor_, {surface_.cx[i], surface_.cy[i], surface_.cz[i]});
    const double radius = factor_ * surface_.radius[i];
    const float at[3] = {static_cast<float>(center[0]), static_cast<float>(center[1]),
                         static_cast<float>(center[2])};
    blocks_.clear();
    feet_.store.tree().blocksInBall(at, static_cast<float>(radius + kAround * widest_), blocks_);
    for (const std::uint32_t b : blocks_) {
      const std::size_t first = b * PointStore::kBlock;
      const std::size_t end = std::min(first + PointStore::kBlock, feet_.store.size());
      for (std::size_t foot = first; foot < end; ++foot) addToFoot(i, center, radius, foot);
    }
  }

  /** \brief Feet at none of whose places anything is drawn. */
  std::size_t countLost() const {
    const auto drawn = [this](const PlaceBlend& blend) {
      return blend.isDrawn(surface_.info.cover_threshold);
    };
    std::size_t lost = 0;
    for (auto at = blends_.begin(); at != blends_.end(); at += kPlaces) {
      lost += std::none_of(at, at + kPlaces, drawn);
    }
    return lost;
  }

 private:
  void addToFoot(std::size_t i, const Vector3& center, double radius, std::size_t foot) {
    const double apart = length(subtract(feet_.store.position(foot), center));
    if (apart > radius + feet_.spacing[foot]) return;
    for (int k = 0; k < kPlaces; ++k) {
      const Vector3 offset = scaled(subtract(placeOf(feet_, foot, k), center), 1.0 / radius);
      PlaceBlend& blend = blends_[foot * kPlaces + static_cast<std::size_t>(k)];
      if (dot(offset, offset) < 1.0) borders::addLeaf(surface_, i, offset, trim_, blend);
    }
  }

  const SLIMSurface& surface_;
  const Feet& feet_;
  bool trim_;
  float widest_ = 0.0f;  ///< spacing
  double factor_;        ///< from the surface's units to the feet's
  Vector3 origin_;
  std::vector<PlaceBlend> blends_;
  std::vector<std::uint32_t> blocks_;
};

}  // namespace

double lostShare(const SLIMSurface& surface, const Feet& feet, const RenderParams& params) {
  Places places(surface, feet, params.trim);
  for (std::size_t i = 0; i < surface.size(); ++i) {
    if (surface.isLeaf(i)) places.addLeaf(i);
  }
  const auto n = static_cast<double>(std::max<std::size_t>(feet.store.size(), 1));
  return static_cast<double>(places.countLost()) / n;
}

}  // namespace pcl_slim::borders
