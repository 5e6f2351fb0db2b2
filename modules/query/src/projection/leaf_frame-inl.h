// SPDX-License-Identifier: BSD-3-Clause
// One leaf's frame over vector lanes. The guard toggles: Highway compiles a kernel file once per
// instruction set.
#if defined(PCL_SLIM_LEAF_FRAME_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PCL_SLIM_LEAF_FRAME_INL
#undef PCL_SLIM_LEAF_FRAME_INL
#else
#define PCL_SLIM_LEAF_FRAME_INL
#endif

#include "pcl_slim/leaf/detail/height-inl.h"
#include "pcl_slim/surface/detail/kernel_math-inl.h"
#include "projection/projection.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

/** A leaf's coefficients in registers. */
template <int D>
class LeafCoefficients {
 public:
  explicit LeafCoefficients(const float* c) {
    for (int k = 0; k < numCoefficients(D); ++k) c_[k] = set(c[k]);
  }
  HWY_INLINE Vec operator()(int k) const { return c_[k]; }

 private:
  Vec c_[numCoefficients(D)];
};

/** Coordinates in a leaf's frame, in units of its radius. */
struct Local {
  Vec u, v, w;

  HWY_INLINE Vec lengthSq() const { return dot3(u, v, w, u, v, w); }
};

/** One leaf's frame in registers. */
class LeafFrame {
 public:
  explicit LeafFrame(const BlockLeaf& leaf) : inverse_(set(1.0f / leaf.radius)) {
    for (int a = 0; a < 3; ++a) {
      shift_[a] = set(leaf.shift[a]);
      u_[a] = set(leaf.u[a]);
      v_[a] = set(leaf.v[a]);
      w_[a] = set(leaf.w[a]);
    }
  }

  /** A direction in the block's axes, turned into the frame. */
  HWY_INLINE Local turn(Vec x, Vec y, Vec z) const {
    return {dot3(x, y, z, u_[0], u_[1], u_[2]), dot3(x, y, z, v_[0], v_[1], v_[2]),
            dot3(x, y, z, w_[0], w_[1], w_[2])};
  }

  /** Points i, i + 1, ... of a block. */
  HWY_INLINE Local place(const BlockPoints& points, std::size_t i) const {
    const Tag d;
    const float* const column[3] = {points.x, points.y, points.z};
    Vec p[3];
    for (int a = 0; a < 3; ++a) {
      p[a] = (Load(d, column[a] + i) + shift_[a]) * inverse_;
    }
    return turn(p[0], p[1], p[2]);
  }

  /** Coordinate a of a frame vector in the block's axes. */
  HWY_INLINE Vec back(int a, const Local& p) const {
    return dot3(u_[a], v_[a], w_[a], p.u, p.v, p.w);
  }

  const Vec* axisU() const { return u_; }
  const Vec* axisV() const { return v_; }

 private:
  Vec inverse_, shift_[3], u_[3], v_[3], w_[3];
};

/** grad f of a leaf, f = w - h(u, v), from the slopes of its polynomial. */
HWY_INLINE Local gradientOf(const Slopes<Vec>& h) {
  return {Neg(h.u), Neg(h.v), set(1.0f)};
}

/** Adds the lanes of mask; 0 to the others, whatever value is there. */
HWY_INLINE void addTo(float* target, Mask mask, Vec value) {
  const Tag d;
  Store(Load(d, target) + IfThenElseZero(mask, value), d, target);
}

/** Adds scale times the Hessian of h, in the block's axes. */
template <int D>
HWY_INLINE void addHessian(const LeafFrame& frame, const LeafCoefficients<D>& c, const Local& q,
                           Mask near, Vec scale, std::size_t i, BlockSums& sums) {
  Vec hessian[6];
  hessianIn(frame.axisU(), frame.axisV(), secondDerivatives<D>(c, q.u, q.v), hessian);
  for (int k = 0; k < 6; ++k) addTo(sums.hessian[k] + i, near, scale * hessian[k]);
}

/** Adds scale times the third derivatives, turned from the frame's axes to the block's. */
HWY_INLINE void addThird(const LeafFrame& frame, const ThirdDerivatives<Vec>& h, Mask near,
                         Vec scale, std::size_t i, BlockSums& sums) {
  const Vec *const u = frame.axisU(), *const v = frame.axisV();
  for (int a = 0, k = 0; a < 3; ++a) {
    for (int b = a; b < 3; ++b) {
      const Vec uu = u[a] * u[b];
      const Vec vv = v[a] * v[b];
      const Vec uv = MulAdd(u[a], v[b], v[a] * u[b]);
      const Vec along_u = MulAdd(h.uuu, uu, MulAdd(h.uuv, uv, h.uvv * vv));
      const Vec along_v = MulAdd(h.uuv, uu, MulAdd(h.uvv, uv, h.vvv * vv));
      for (int c = b; c < 3; ++c, ++k) {
        const Vec entry = MulAdd(along_u, u[c], along_v * v[c]);
        addTo(sums.third[k] + i, near, scale * entry);
      }
    }
  }
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
