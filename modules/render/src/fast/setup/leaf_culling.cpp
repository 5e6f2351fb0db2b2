// SPDX-License-Identifier: BSD-3-Clause
// Visibility of surfels, several side by side.
#include "fast/setup/leaf_setup.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fast/setup/leaf_culling.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

#include "fast/setup/camera_axes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/** Lanes whose ball is beyond one side of the picture. */
HWY_INLINE Mask beyondSide(bool perspective, Vec x, Vec z, float side, Vec radius) {
  if (!perspective) return x - set(side) > radius;
  const Vec stretch = set(__builtin_sqrtf(1.0f + side * side));
  return NegMulAdd(set(side), z, x) > radius * stretch;
}

HWY_INLINE Mask outsideFrustum(const FrameView& view, const Triple<Vec>& p, Vec radius) {
  const Tag d;
  const float right = (static_cast<float>(view.width) - 0.4f - view.center_x) * view.pixel;
  const float left = (view.center_x + 0.6f) * view.pixel;
  const float top = (view.center_y + 0.6f) * view.pixel;
  const float bottom = (static_cast<float>(view.height) - 0.4f - view.center_y) * view.pixel;
  const bool perspective = view.perspective;
  Mask outside = p.z + radius <= Zero(d);
  outside = Or(outside, beyondSide(perspective, p.x, p.z, right, radius));
  outside = Or(outside, beyondSide(perspective, Neg(p.x), p.z, left, radius));
  outside = Or(outside, beyondSide(perspective, p.y, p.z, top, radius));
  return Or(outside, beyondSide(perspective, Neg(p.y), p.z, bottom, radius));
}

/** Lanes whose ball is completely outside of a half space, local coordinates. */
HWY_INLINE Mask outsideHalfSpace(const HalfSpace& cut, const Triple<Vec>& p, Vec radius) {
  constexpr float kSlack = 1e-6f;  // of the box: floats round
  const auto n = [&](std::size_t a) HWY_ATTR { return set(static_cast<float>(cut.normal[a])); };
  const Vec along = MulAdd(n(0), p.x, MulAdd(n(1), p.y, n(2) * p.z));
  return along + radius < set(static_cast<float>(cut.offset) - kSlack);
}

/** Lanes all of whose gradients point away from every ray through the ball: the angle between
 * normal and ray is less than what the cones of gradients and of rays leave of a right angle. */
HWY_INLINE Mask turnedAway(const FrameView& view, const Triple<Vec>& p, const Triple<Vec>& normal,
                           Vec radius, Vec sine) {
  const Tag d;
  const Vec one = set(1.0f), margin = set(1e-3f);
  if (!view.perspective) return normal.z > sine + margin;
  const Vec distance_sq = dot3(p, p);
  const Vec tangent = Sqrt(Max(Zero(d), NegMulAdd(radius, radius, distance_sq)));
  const Vec cosine = Sqrt(Max(Zero(d), NegMulAdd(sine, sine, one)));
  const Vec needed = MulAdd(sine, tangent, cosine * radius);
  const Mask acute = cosine * tangent > sine * radius;
  const Vec slack = margin * Sqrt(distance_sq);
  return And(acute, dot3(normal, p) > needed + slack);
}

/** The share with which surfels of a size (DetailSizes) at a depth replace their descendants: 1
 * where they are seen smaller than the level of detail, 0 where they are larger by kFade. */
HWY_INLINE Vec coarseShare(const FrameView& view, const DetailRule& rule, Vec half_size, Vec z) {
  const Tag d;
  const Vec zero = Zero(d), one = set(1.0f);
  const Vec lod = set(0.5f * rule.lod * view.pixel) * (view.perspective ? z : one);
  const Vec size = half_size / Max(lod, set(1e-30f));
  constexpr float kScale = 1.0f / (DetailRule::kFade - 1.0f);
  const Vec rest = set(DetailRule::kFade) - size;
  const Vec t = Clamp(set(kScale) * rest, zero, one);
  const Vec smooth = NegMulAdd(set(2.0f), t, set(3.0f));
  return t * t * smooth;
}

/** Lanes' reasons not to be drawn, kVisible if there is none; the first given counts. */
class Reasons {
 public:
  HWY_INLINE void add(Mask lanes, Visibility reason) {
    HWY_ALIGN std::uint8_t bits[8] = {};
    StoreMaskBits(Tag(), lanes, bits);
    for (std::size_t k = 0; k < hn::Lanes(Tag()); ++k) {
      const bool given = (bits[k / 8] >> (k % 8) & 1) != 0;
      if (given && of_[k] == Visibility::kVisible) of_[k] = reason;
    }
  }
  Visibility operator[](std::size_t lane) const { return of_[lane]; }

 private:
  Visibility of_[16] = {};
};

void cullLeaves(const LeafClusters& leaves, std::uint32_t begin, std::uint32_t end,
                const FrameView& view, const VisibilityRules& rules, Visibility* visibility,
                float* shares) {
  const Tag d;
  const Axes axes(view);
  for (std::size_t i = begin; i < end; i += hn::Lanes(d)) {
    const auto load = [&](const AlignedVector<float>& column)
                          HWY_ATTR { return LoadU(d, column.data() + i); };
    const Triple<Vec> place{load(leaves.x), load(leaves.y), load(leaves.z)};
    const Triple<Vec> p = axes.turn(fromEye(view, place.x, place.y, place.z));
    const Triple<Vec> normal = axes.turn({load(leaves.nx), load(leaves.ny), load(leaves.nz)});
    const Vec radius = load(leaves.radius);
    Reasons reasons;
    reasons.add(outsideFrustum(view, p, radius), Visibility::kOutside);
    for (const HalfSpace& cut : rules.cuts) {
      reasons.add(outsideHalfSpace(cut, place, radius), Visibility::kCutAway);
    }
    Vec share = set(1.0f);
    if (rules.detail.active()) {
      const Vec small = coarseShare(view, rules.detail, load(leaves.parent_size), p.z);
      const Vec own = coarseShare(view, rules.detail, load(leaves.own_size), p.z);
      share = NegMulAdd(own, small, own);
      reasons.add(small >= set(1.0f), Visibility::kTooSmall);
      reasons.add(share <= Zero(d), Visibility::kTooLarge);
    }
    if (rules.front_only) {
      reasons.add(turnedAway(view, p, normal, radius, load(leaves.sine)), Visibility::kBackFacing);
    }
    StoreU(share, d, shares + (i - begin));
    for (std::size_t k = 0; k < hn::Lanes(d) && i + k < end; ++k) {
      visibility[i + k - begin] = reasons[k];
    }
  }
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_slim::detail::kernels {

HWY_EXPORT(cullLeaves);

void cullLeaves(const LeafClusters& leaves, std::uint32_t begin, std::uint32_t end,
                const FrameView& view, const VisibilityRules& rules, Visibility* visibility,
                float* shares) {
  HWY_DYNAMIC_DISPATCH(cullLeaves)(leaves, begin, end, view, rules, visibility, shares);
}

}  // namespace pcl_slim::detail::kernels
#endif
