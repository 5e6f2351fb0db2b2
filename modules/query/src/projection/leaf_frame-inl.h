// SPDX-License-Identifier: BSD-3-Clause
// One leaf's frame over vector lanes. The guard toggles: Highway compiles a kernel file once per
// instruction set.
#if defined(PCL_SLIM_LEAF_FRAME_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PCL_SLIM_LEAF_FRAME_INL
#undef PCL_SLIM_LEAF_FRAME_INL
#else
#define PCL_SLIM_LEAF_FRAME_INL
#endif

#include "pcl_slim/query/detail/projection_kernel.h"
#include "pcl_slim/surface/detail/kernel_math-inl.h"
#include "projection/height_jets-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

/** Coordinates in a leaf's frame, in units of its radius. */
struct Local {
  Vec u, v, w;

  HWY_INLINE Vec lengthSq() const { return dot3(u, v, w, u, v, w); }
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

  /** A direction in the block's axes, turned into the frame. */
  HWY_INLINE Local turn(Vec x, Vec y, Vec z) const
  {
    return {dot3(x, y, z, u_[0], u_[1], u_[2]), dot3(x, y, z, v_[0], v_[1], v_[2]),
            dot3(x, y, z, w_[0], w_[1], w_[2])};
  }

  /** Points i, i + 1, ... of a block. */
  HWY_INLINE Local place(const BlockPoints& points, std::size_t i) const
  {
    const Tag d;
    const float* const column[3] = {points.x, points.y, points.z};
    Vec p[3];
    for (int a = 0; a < 3; ++a) {
      p[a] = hn::Mul(hn::Add(hn::Load(d, column[a] + i), shift_[a]), inverse_);
    }
    return turn(p[0], p[1], p[2]);
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

/** grad f of a leaf, f = w - h(u, v), from the slopes of its polynomial. */
HWY_INLINE Local
gradientOf(Vec hu, Vec hv)
{
  return {hn::Neg(hu), hn::Neg(hv), set(1.0f)};
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
