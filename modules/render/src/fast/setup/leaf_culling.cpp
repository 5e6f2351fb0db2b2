// SPDX-License-Identifier: BSD-3-Clause
// What is seen of surfels, several side by side.
#include "fast/setup/leaf_setup.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fast/setup/leaf_culling.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

#include "fast/setup/camera_axes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/** Lanes whose ball lies beyond one side of the picture. */
HWY_INLINE Mask
beyondSide(bool perspective, Vec x, Vec z, float side, Vec radius)
{
  const Tag d;
  if (!perspective) return hn::Gt(hn::Sub(x, hn::Set(d, side)), radius);
  const Vec stretch = hn::Set(d, __builtin_sqrtf(1.0f + side * side));
  return hn::Gt(hn::NegMulAdd(hn::Set(d, side), z, x), hn::Mul(radius, stretch));
}

HWY_INLINE Mask
outsideFrustum(const FrameView& view, const Triple<Vec>& p, Vec radius)
{
  const Tag d;
  const float right = (static_cast<float>(view.width) - 0.4f - view.center_x) * view.pixel;
  const float left = (view.center_x + 0.6f) * view.pixel;
  const float top = (view.center_y + 0.6f) * view.pixel;
  const float bottom = (static_cast<float>(view.height) - 0.4f - view.center_y) * view.pixel;
  const bool perspective = view.perspective;
  Mask outside = hn::Le(hn::Add(p.z, radius), hn::Zero(d));
  outside = hn::Or(outside, beyondSide(perspective, p.x, p.z, right, radius));
  outside = hn::Or(outside, beyondSide(perspective, hn::Neg(p.x), p.z, left, radius));
  outside = hn::Or(outside, beyondSide(perspective, p.y, p.z, top, radius));
  return hn::Or(outside, beyondSide(perspective, hn::Neg(p.y), p.z, bottom, radius));
}

/** Lanes whose ball lies outside of a half space as a whole, local coordinates. */
HWY_INLINE Mask
outsideHalfSpace(const HalfSpace& cut, const Triple<Vec>& p, Vec radius)
{
  constexpr float kSlack = 1e-6f;  // of the box: floats round
  const Tag d;
  const auto n = [&](std::size_t a)
                     HWY_ATTR { return hn::Set(d, static_cast<float>(cut.normal[a])); };
  const Vec along = hn::MulAdd(n(0), p.x, hn::MulAdd(n(1), p.y, hn::Mul(n(2), p.z)));
  return hn::Lt(hn::Add(along, radius), hn::Set(d, static_cast<float>(cut.offset) - kSlack));
}

/** Lanes all of whose gradients point away from every ray through the ball: the angle between
 * normal and ray is less than what the cones of gradients and of rays leave of a right angle. */
HWY_INLINE Mask
turnedAway(const FrameView& view, const Triple<Vec>& p, const Triple<Vec>& normal, Vec radius,
           Vec sine)
{
  const Tag d;
  const Vec one = hn::Set(d, 1.0f), margin = hn::Set(d, 1e-3f);
  if (!view.perspective) return hn::Gt(normal.z, hn::Add(sine, margin));
  const Vec distance_sq = dot3(p, p);
  const Vec tangent = hn::Sqrt(hn::Max(hn::Zero(d), hn::NegMulAdd(radius, radius, distance_sq)));
  const Vec cosine = hn::Sqrt(hn::Max(hn::Zero(d), hn::NegMulAdd(sine, sine, one)));
  const Vec needed = hn::MulAdd(sine, tangent, hn::Mul(cosine, radius));
  const Mask acute = hn::Gt(hn::Mul(cosine, tangent), hn::Mul(sine, radius));
  const Vec slack = hn::Mul(margin, hn::Sqrt(distance_sq));
  return hn::And(acute, hn::Gt(dot3(normal, p), hn::Add(needed, slack)));
}

/** How far surfels of a size (DetailSizes) at a depth stand for their descendants: 1 where they are seen
 * smaller than the level of detail, 0 where they are larger by kFade. */
HWY_INLINE Vec
coarseShare(const FrameView& view, const DetailRule& rule, Vec half_size, Vec z)
{
  const Tag d;
  const Vec zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  const Vec lod = hn::Mul(hn::Set(d, 0.5f * rule.lod * view.pixel), view.perspective ? z : one);
  const Vec size = hn::Div(half_size, hn::Max(lod, hn::Set(d, 1e-30f)));
  constexpr float kScale = 1.0f / (DetailRule::kFade - 1.0f);
  const Vec rest = hn::Sub(hn::Set(d, DetailRule::kFade), size);
  const Vec t = hn::Clamp(hn::Mul(hn::Set(d, kScale), rest), zero, one);
  const Vec smooth = hn::NegMulAdd(hn::Set(d, 2.0f), t, hn::Set(d, 3.0f));
  return hn::Mul(hn::Mul(t, t), smooth);
}

/** Lanes' reasons not to be drawn, kVisible if there is none; the first given counts. */
class Reasons {
 public:
  HWY_INLINE void add(Mask lanes, Visibility reason)
  {
    HWY_ALIGN std::uint8_t bits[8] = {};
    hn::StoreMaskBits(Tag(), lanes, bits);
    for (std::size_t k = 0; k < hn::Lanes(Tag()); ++k) {
      const bool given = (bits[k / 8] >> (k % 8) & 1) != 0;
      if (given && of_[k] == Visibility::kVisible) of_[k] = reason;
    }
  }
  Visibility operator[](std::size_t lane) const { return of_[lane]; }

 private:
  Visibility of_[16] = {};
};

void
cullLeaves(const LeafIndex& index, std::uint32_t begin, std::uint32_t end, const FrameView& view,
           const VisibilityRules& rules, Visibility* visibility, float* shares)
{
  const Tag d;
  const Axes axes(view);
  for (std::size_t i = begin; i < end; i += hn::Lanes(d)) {
    const auto load = [&](const AlignedVector<float>& column)
                          HWY_ATTR { return hn::LoadU(d, column.data() + i); };
    const Triple<Vec> place{load(index.x), load(index.y), load(index.z)};
    const Triple<Vec> p = axes.turn(fromEye(view, place.x, place.y, place.z));
    const Triple<Vec> normal = axes.turn({load(index.nx), load(index.ny), load(index.nz)});
    const Vec radius = load(index.radius);
    Reasons reasons;
    reasons.add(outsideFrustum(view, p, radius), Visibility::kOutside);
    for (const HalfSpace& cut : rules.cuts) {
      reasons.add(outsideHalfSpace(cut, place, radius), Visibility::kCutAway);
    }
    Vec share = hn::Set(d, 1.0f);
    if (rules.detail.active()) {
      const Vec small = coarseShare(view, rules.detail, load(index.parent_size), p.z);
      const Vec own = coarseShare(view, rules.detail, load(index.own_size), p.z);
      share = hn::NegMulAdd(own, small, own);
      reasons.add(hn::Ge(small, hn::Set(d, 1.0f)), Visibility::kTooSmall);
      reasons.add(hn::Le(share, hn::Zero(d)), Visibility::kTooLarge);
    }
    if (rules.front_only) {
      reasons.add(turnedAway(view, p, normal, radius, load(index.sine)), Visibility::kBackFacing);
    }
    hn::StoreU(share, d, shares + (i - begin));
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

void
cullLeaves(const LeafIndex& index, std::uint32_t begin, std::uint32_t end, const FrameView& view,
           const VisibilityRules& rules, Visibility* visibility, float* shares)
{
  HWY_DYNAMIC_DISPATCH(cullLeaves)(index, begin, end, view, rules, visibility, shares);
}

}  // namespace pcl_slim::detail::kernels
#endif
