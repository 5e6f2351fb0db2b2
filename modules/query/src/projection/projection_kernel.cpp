// SPDX-License-Identifier: BSD-3-Clause
// Sixteen points of one block against one leaf: the blending loop of equations (6)-(8).
#include "pcl_slim/query/detail/projection_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "projection/projection_kernel.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

#include "pcl_slim/surface/detail/kernel_math-inl.h"
#include "projection/height_jets-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr int kNewtonSteps = 3;
constexpr float kConverged = 3e-4f;  ///< of r: the step after one so short is below rounding

HWY_INLINE Vec
blendWeight(WeightKernel kernel, Vec s_sq)
{
  switch (kernel) {
    case WeightKernel::kPower2: return kernelWeight<WeightKernel::kPower2>(s_sq);
    case WeightKernel::kPower4: return kernelWeight<WeightKernel::kPower4>(s_sq);
    case WeightKernel::kPower7: return kernelWeight<WeightKernel::kPower7>(s_sq);
    default: return kernelWeight<WeightKernel::kGaussian>(s_sq);
  }
}

/** Vector coordinates in a leaf's frame, in units of its radius. */
struct Local {
  Vec u, v, w;
};

/** One leaf's frame in registers. */
class LeafFrame {
 public:
  explicit LeafFrame(const BlockLeaf& leaf) : inverse_(set(1.0f / leaf.radius))
  {
    for (int a = 0; a < 3; ++a) {
      shift_[a] = set(leaf.shift[a]);
      u_[a] = set(leaf.u[a]);
      v_[a] = set(leaf.v[a]);
      w_[a] = set(leaf.w[a]);
    }
  }

  HWY_INLINE Local turn(Vec x, Vec y, Vec z) const
  {
    return {dot3(x, y, z, u_[0], u_[1], u_[2]), dot3(x, y, z, v_[0], v_[1], v_[2]),
            dot3(x, y, z, w_[0], w_[1], w_[2])};
  }
  HWY_INLINE Local place(Vec x, Vec y, Vec z) const
  {
    return turn(hn::Mul(hn::Add(x, shift_[0]), inverse_), hn::Mul(hn::Add(y, shift_[1]), inverse_),
                hn::Mul(hn::Add(z, shift_[2]), inverse_));
  }
  /** Coordinate a of a frame vector in the block's axes. */
  HWY_INLINE Vec back(int a, const Local& p) const
  {
    return dot3(u_[a], v_[a], w_[a], p.u, p.v, p.w);
  }
  Vec axisU(int a) const { return u_[a]; }
  Vec axisV(int a) const { return v_[a]; }

 private:
  Vec inverse_, shift_[3], u_[3], v_[3], w_[3];
};

/** Lanes whose point's own normal lets the leaf serve it. */
HWY_INLINE Mask
sameSide(const BlockPoints& points, const BlockLeaf& leaf, std::size_t i)
{
  const Tag d;
  if (points.nx == nullptr) return hn::Eq(hn::Zero(d), hn::Zero(d));
  const Vec cosine =
      dot3(hn::Load(d, points.nx + i), hn::Load(d, points.ny + i), hn::Load(d, points.nz + i),
           set(leaf.w[0]), set(leaf.w[1]), set(leaf.w[2]));
  return hn::Gt(cosine, set(points.min_dot));
}

/** +1 or -1 per lane: the sign that turns b to the side of a sum gathered so far. The first leaf,
 * which meets a zero of either sign, keeps its own side: leaves mostly agree even unoriented. */
HWY_INLINE Vec
alignment(Vec sum_dot_b)
{
  return hn::IfThenElse(hn::Lt(sum_dot_b, hn::Zero(Tag())), set(-1.0f), set(1.0f));
}

template <int D>
void
addDirectionsOf(const BlockPoints& points, const BlockLeaf& leaf, const BlendRules& rules,
                BlockSums& sums)
{
  const Tag d;
  const LeafFrame frame(leaf);
  const HeightJets<D> jets(leaf.c);
  for (std::size_t i = 0; i < 16; i += hn::Lanes(d)) {
    const Local p = frame.place(hn::Load(d, points.x + i), hn::Load(d, points.y + i),
                                hn::Load(d, points.z + i));
    const Vec s_sq = dot3(p.u, p.v, p.w, p.u, p.v, p.w);
    Mask near = hn::And(hn::Lt(s_sq, set(1.0f)), sameSide(points, leaf, i));
    if (hn::AllFalse(d, near)) continue;
    Vec h, hu, hv;
    jets.gradient(p.u, p.v, h, hu, hv);
    if (rules.guarded) {
      near = hn::And(near, hn::Le(hn::Abs(hn::Sub(p.w, h)), set(leaf.max_residual)));
    }
    Vec g = hn::IfThenElseZero(near, hn::Mul(set(leaf.trust), blendWeight(rules.kernel, s_sq)));
    const Local n = {hn::Neg(hu), hn::Neg(hv), set(1.0f)};
    Vec sum[3], normal[3];
    for (int a = 0; a < 3; ++a) {
      sum[a] = hn::Load(d, sums.direction[a] + i);
      normal[a] = frame.back(a, n);
    }
    if (!rules.oriented) {
      g = hn::Mul(g, alignment(dot3(sum[0], sum[1], sum[2], normal[0], normal[1], normal[2])));
    }
    for (int a = 0; a < 3; ++a) {
      const Vec term = hn::IfThenElseZero(near, hn::Mul(g, normal[a]));
      hn::Store(hn::Add(sum[a], term), d, sums.direction[a] + i);
    }
  }
}

HWY_INLINE void
addTo(float* target, Vec value)
{
  hn::Store(hn::Add(hn::Load(Tag(), target), value), Tag(), target);
}

/** Adds scale times the third derivatives, turned from the frame's axes to the block's. */
HWY_INLINE void
addThird(const LeafFrame& frame, const ThirdDerivatives& h, Mask near, Vec scale, std::size_t i,
         BlockSums& sums)
{
  for (int a = 0, k = 0; a < 3; ++a) {
    for (int b = a; b < 3; ++b) {
      const Vec uu = hn::Mul(frame.axisU(a), frame.axisU(b));
      const Vec vv = hn::Mul(frame.axisV(a), frame.axisV(b));
      const Vec uv =
          hn::MulAdd(frame.axisU(a), frame.axisV(b), hn::Mul(frame.axisV(a), frame.axisU(b)));
      const Vec along_u = hn::MulAdd(h.uuu, uu, hn::MulAdd(h.uuv, uv, hn::Mul(h.uvv, vv)));
      const Vec along_v = hn::MulAdd(h.uuv, uu, hn::MulAdd(h.uvv, uv, hn::Mul(h.vvv, vv)));
      for (int c = b; c < 3; ++c, ++k) {
        const Vec entry = hn::MulAdd(along_u, frame.axisU(c), hn::Mul(along_v, frame.axisV(c)));
        addTo(sums.third[k] + i, hn::IfThenElseZero(near, hn::Mul(scale, entry)));
      }
    }
  }
}

template <int D>
void
addIntersectionsOf(const BlockPoints& points, const BlockLeaf& leaf, const BlendRules& rules,
                   BlockSums& sums)
{
  const Tag d;
  const LeafFrame frame(leaf);
  const HeightJets<D> jets(leaf.c);
  const Vec zero = hn::Zero(d), one = set(1.0f), radius = set(leaf.radius);
  for (std::size_t i = 0; i < 16; i += hn::Lanes(d)) {
    const Local p = frame.place(hn::Load(d, points.x + i), hn::Load(d, points.y + i),
                                hn::Load(d, points.z + i));
    const Vec p_sq = dot3(p.u, p.v, p.w, p.u, p.v, p.w);
    Mask near = hn::And(hn::Lt(p_sq, one), sameSide(points, leaf, i));
    if (hn::AllFalse(d, near)) continue;
    const Local ray =
        frame.turn(hn::Load(d, sums.direction[0] + i), hn::Load(d, sums.direction[1] + i),
                   hn::Load(d, sums.direction[2] + i));
    // Newton from t = 0 on F(t) = f(p + t d); points lie within noise of the leaf.
    Vec t = zero, u = p.u, v = p.v, w = p.w, h, hu, hv, slope;
    for (int step = 0; step < kNewtonSteps; ++step) {
      jets.gradient(u, v, h, hu, hv);
      slope = hn::NegMulAdd(hu, ray.u, hn::NegMulAdd(hv, ray.v, ray.w));
      // A grazing ray has no usable root: its lane is masked off below.
      const Vec safe = hn::IfThenElse(hn::Gt(hn::Abs(slope), set(0.1f)), slope, set(1e9f));
      const Vec change = hn::Div(hn::Sub(w, h), safe);
      t = hn::Sub(t, change);
      u = hn::MulAdd(t, ray.u, p.u);
      v = hn::MulAdd(t, ray.v, p.v);
      w = hn::MulAdd(t, ray.w, p.w);
      if (hn::AllTrue(d, hn::Or(hn::Not(near), hn::Lt(hn::Abs(change), set(kConverged))))) break;
    }
    jets.gradient(u, v, h, hu, hv);
    const Vec q_sq = dot3(u, v, w, u, v, w);
    near = hn::And(near, hn::And(hn::Lt(q_sq, one), hn::Gt(hn::Abs(slope), set(0.1f))));
    Vec s_sq = q_sq;
    if (rules.guarded) {
      near = hn::And(near, hn::Le(hn::Abs(t), set(leaf.max_offset)));
      if (rules.oriented) near = hn::And(near, hn::Gt(slope, zero));
      s_sq = hn::Max(p_sq, q_sq);
    }
    if (hn::AllFalse(d, near)) continue;
    const Vec g =
        hn::IfThenElseZero(near, hn::Mul(set(leaf.trust), blendWeight(rules.kernel, s_sq)));
    const Vec moved = hn::IfThenElseZero(near, hn::Mul(g, hn::Mul(t, radius)));
    hn::Store(hn::Add(hn::Load(d, sums.weight + i), g), d, sums.weight + i);
    hn::Store(hn::Add(hn::Load(d, sums.offset + i), moved), d, sums.offset + i);
    // Signed so that every gradient points along the ray.
    const Vec signed_g = rules.oriented ? g : hn::Mul(g, alignment(slope));
    const Local n = {hn::Neg(hu), hn::Neg(hv), one};
    for (int a = 0; a < 3; ++a) {
      const Vec term = hn::IfThenElseZero(near, hn::Mul(signed_g, frame.back(a, n)));
      hn::Store(hn::Add(hn::Load(d, sums.gradient[a] + i), term), d, sums.gradient[a] + i);
    }
    if (!rules.with_hessian) continue;
    Vec huu, huv, hvv;
    jets.second(u, v, huu, huv, hvv);
    const Vec scale = hn::IfThenElseZero(near, hn::Neg(hn::Mul(signed_g, set(1.0f / leaf.radius))));
    for (int a = 0, k = 0; a < 3; ++a) {
      // Row a of H u v products: H = huu u u^T + huv (u v^T + v u^T) + hvv v v^T.
      const Vec along_u = hn::MulAdd(huu, frame.axisU(a), hn::Mul(huv, frame.axisV(a)));
      const Vec along_v = hn::MulAdd(huv, frame.axisU(a), hn::Mul(hvv, frame.axisV(a)));
      for (int b = a; b < 3; ++b, ++k) {
        const Vec entry = hn::MulAdd(along_u, frame.axisU(b), hn::Mul(along_v, frame.axisV(b)));
        addTo(sums.hessian[k] + i, hn::IfThenElseZero(near, hn::Mul(scale, entry)));
      }
    }
    if (rules.with_third) {
      const Vec scale_sq = hn::Mul(scale, set(1.0f / leaf.radius));
      addThird(frame, jets.third(u, v), near, scale_sq, i, sums);
    }
  }
}

void
addDirections(const BlockPoints& points, const BlockLeaf& leaf, const BlendRules& rules,
              BlockSums& sums)
{
  switch (leaf.degree) {
    case 1: return addDirectionsOf<1>(points, leaf, rules, sums);
    case 2: return addDirectionsOf<2>(points, leaf, rules, sums);
    case 3: return addDirectionsOf<3>(points, leaf, rules, sums);
    default: return addDirectionsOf<4>(points, leaf, rules, sums);
  }
}

void
finishDirections(BlockSums& sums)
{
  const Tag d;
  const Vec zero = hn::Zero(d);
  for (std::size_t i = 0; i < 16; i += hn::Lanes(d)) {
    Vec n[3];
    for (int a = 0; a < 3; ++a) n[a] = hn::Load(d, sums.direction[a] + i);
    const Vec length_sq = dot3(n[0], n[1], n[2], n[0], n[1], n[2]);
    const Mask usable = hn::Gt(length_sq, set(1e-30f));
    const Vec inverse = hn::Div(set(1.0f), hn::Sqrt(hn::IfThenElse(usable, length_sq, set(1.0f))));
    for (int a = 0; a < 3; ++a) {
      hn::Store(hn::IfThenElseZero(usable, hn::Mul(n[a], inverse)), d, sums.direction[a] + i);
      hn::Store(zero, d, sums.gradient[a] + i);
    }
    hn::Store(zero, d, sums.weight + i);
    hn::Store(zero, d, sums.offset + i);
    for (auto& column : sums.hessian) hn::Store(zero, d, column + i);
    for (auto& column : sums.third) hn::Store(zero, d, column + i);
  }
}

void
addIntersections(const BlockPoints& points, const BlockLeaf& leaf, const BlendRules& rules,
                 BlockSums& sums)
{
  switch (leaf.degree) {
    case 1: return addIntersectionsOf<1>(points, leaf, rules, sums);
    case 2: return addIntersectionsOf<2>(points, leaf, rules, sums);
    case 3: return addIntersectionsOf<3>(points, leaf, rules, sums);
    default: return addIntersectionsOf<4>(points, leaf, rules, sums);
  }
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_slim::detail::kernels {

HWY_EXPORT(addDirections);
HWY_EXPORT(finishDirections);
HWY_EXPORT(addIntersections);

void
addDirections(const BlockPoints& points, const BlockLeaf& leaf, const BlendRules& rules,
              BlockSums& sums)
{
  HWY_DYNAMIC_DISPATCH(addDirections)(points, leaf, rules, sums);
}

void
finishDirections(BlockSums& sums)
{
  HWY_DYNAMIC_DISPATCH(finishDirections)(sums);
}

void
addIntersections(const BlockPoints& points, const BlockLeaf& leaf, const BlendRules& rules,
                 BlockSums& sums)
{
  HWY_DYNAMIC_DISPATCH(addIntersections)(points, leaf, rules, sums);
}

}  // namespace pcl_slim::detail::kernels
#endif
