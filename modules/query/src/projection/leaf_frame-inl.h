// SPDX-License-Identifier: BSD-3-Clause
// One leaf's frame over vector lanes. The guard toggles: Highway compiles a kernel file once per
// instruction set.
#if defined(PCL_SLIM_LEAF_FRAME_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PCL_SLIM_LEAF_FRAME_INL
#undef PCL_SLIM_LEAF_FRAME_INL
#else
#define PCL_SLIM_LEAF_FRAME_INL
#endif

#include "pcl_slim/surface/detail/kernel_math-inl.h"
#include "projection/projection.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

struct ThirdDerivatives {
  Vec uuu, uuv, uvv, vvv;
};

/** Height and its derivatives, evaluated by rows of the graded coefficients. */
template <int D>
class HeightJets {
 public:
  explicit HeightJets(const float* c) {
    for (int k = 0; k < numCoefficients(D); ++k) c_[k] = set(c[k]);
  }

  HWY_INLINE void gradient(Vec u, Vec v, Vec& h, Vec& hu, Vec& hv) const {
    h = MulAdd(c_[1], u, MulAdd(c_[2], v, c_[0]));
    hu = c_[1];
    hv = c_[2];
    if constexpr (D >= 2) {
      h = MulAdd(u, MulAdd(c_[3], u, c_[4] * v), MulAdd(c_[5] * v, v, h));
      hu = MulAdd(c_[3] + c_[3], u, MulAdd(c_[4], v, hu));
      hv = MulAdd(c_[5] + c_[5], v, MulAdd(c_[4], u, hv));
    }
    if constexpr (D >= 3) {
      const Vec uu = u * u, uv = u * v, vv = v * v;
      h = MulAdd(uu, MulAdd(c_[6], u, c_[7] * v), MulAdd(vv, MulAdd(c_[8], u, c_[9] * v), h));
      hu = MulAdd(set(3) * c_[6], uu, MulAdd(c_[7] + c_[7], uv, MulAdd(c_[8], vv, hu)));
      hv = MulAdd(c_[7], uu, MulAdd(c_[8] + c_[8], uv, MulAdd(set(3) * c_[9], vv, hv)));
    }
    if constexpr (D >= 4) {
      const Vec uu = u * u, uv = u * v, vv = v * v;
      const Vec high = MulAdd(c_[10], uu, MulAdd(c_[11], uv, c_[12] * vv));
      h = MulAdd(uu, high, MulAdd(vv, MulAdd(c_[13], uv, c_[14] * vv), h));
      const Vec hu4 = MulAdd(uu, MulAdd(set(4) * c_[10], u, set(3) * c_[11] * v),
                             vv * MulAdd(c_[12] + c_[12], u, c_[13] * v));
      const Vec hv4 = MulAdd(uu, MulAdd(c_[11], u, (c_[12] + c_[12]) * v),
                             vv * MulAdd(set(3) * c_[13], u, set(4) * c_[14] * v));
      hu += hu4;
      hv += hv4;
    }
  }

  HWY_INLINE void second(Vec u, Vec v, Vec& huu, Vec& huv, Vec& hvv) const {
    const Vec two = set(2);
    huu = huv = hvv = Zero(Tag());
    if constexpr (D >= 2) {
      huu = two * c_[3];
      huv = c_[4];
      hvv = two * c_[5];
    }
    if constexpr (D >= 3) {
      huu = MulAdd(set(6) * c_[6], u, MulAdd(two * c_[7], v, huu));
      huv = MulAdd(two * c_[7], u, MulAdd(two * c_[8], v, huv));
      hvv = MulAdd(two * c_[8], u, MulAdd(set(6) * c_[9], v, hvv));
    }
    if constexpr (D >= 4) {
      const Vec uu = u * u, uv = u * v, vv = v * v;
      huu += MulAdd(set(12) * c_[10], uu, MulAdd(set(6) * c_[11], uv, two * c_[12] * vv));
      huv += MulAdd(set(3) * c_[11], uu, MulAdd(set(4) * c_[12], uv, set(3) * c_[13] * vv));
      hvv += MulAdd(two * c_[12], uu, MulAdd(set(6) * c_[13], uv, set(12) * c_[14] * vv));
    }
  }

  HWY_INLINE ThirdDerivatives third(Vec u, Vec v) const {
    const Vec zero = Zero(Tag());
    ThirdDerivatives h{zero, zero, zero, zero};
    if constexpr (D >= 3) {
      h = {set(6) * c_[6], set(2) * c_[7], set(2) * c_[8], set(6) * c_[9]};
    }
    if constexpr (D >= 4) {
      const auto add = [&](Vec& target, float ku, Vec cu, float kv, Vec cv)
                           HWY_ATTR { target += MulAdd(set(ku) * cu, u, set(kv) * cv * v); };
      add(h.uuu, 24, c_[10], 6, c_[11]);
      add(h.uuv, 6, c_[11], 4, c_[12]);
      add(h.uvv, 4, c_[12], 6, c_[13]);
      add(h.vvv, 6, c_[13], 24, c_[14]);
    }
    return h;
  }

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

  Vec axisU(int a) const { return u_[a]; }
  Vec axisV(int a) const { return v_[a]; }

 private:
  Vec inverse_, shift_[3], u_[3], v_[3], w_[3];
};

/** grad f of a leaf, f = w - h(u, v), from the slopes of its polynomial. */
HWY_INLINE Local gradientOf(Vec hu, Vec hv) {
  return {Neg(hu), Neg(hv), set(1.0f)};
}

/** Adds the lanes of mask; 0 to the others, whatever value is there. */
HWY_INLINE void addTo(float* target, Mask mask, Vec value) {
  const Tag d;
  Store(Load(d, target) + IfThenElseZero(mask, value), d, target);
}

/** Adds scale times the Hessian H = huu u u^T + huv (u v^T + v u^T) + hvv v v^T. */
template <int D>
HWY_INLINE void addHessian(const LeafFrame& frame, const HeightJets<D>& jets, const Local& q,
                           Mask near, Vec scale, std::size_t i, BlockSums& sums) {
  Vec huu, huv, hvv;
  jets.second(q.u, q.v, huu, huv, hvv);
  for (int a = 0; a < 3; ++a) {
    const Vec along_u = MulAdd(huu, frame.axisU(a), huv * frame.axisV(a));
    const Vec along_v = MulAdd(huv, frame.axisU(a), hvv * frame.axisV(a));
    for (int b = a; b < 3; ++b) {
      const Vec entry = MulAdd(along_u, frame.axisU(b), along_v * frame.axisV(b));
      addTo(sums.hessian[kSymmetricEntry[a][b]] + i, near, scale * entry);
    }
  }
}

/** Adds scale times the third derivatives, turned from the frame's axes to the block's. */
HWY_INLINE void addThird(const LeafFrame& frame, const ThirdDerivatives& h, Mask near, Vec scale,
                         std::size_t i, BlockSums& sums) {
  for (int a = 0, k = 0; a < 3; ++a) {
    for (int b = a; b < 3; ++b) {
      const Vec uu = frame.axisU(a) * frame.axisU(b);
      const Vec vv = frame.axisV(a) * frame.axisV(b);
      const Vec uv = MulAdd(frame.axisU(a), frame.axisV(b), frame.axisV(a) * frame.axisU(b));
      const Vec along_u = MulAdd(h.uuu, uu, MulAdd(h.uuv, uv, h.uvv * vv));
      const Vec along_v = MulAdd(h.uuv, uu, MulAdd(h.uvv, uv, h.vvv * vv));
      for (int c = b; c < 3; ++c, ++k) {
        const Vec entry = MulAdd(along_u, frame.axisU(c), along_v * frame.axisV(c));
        addTo(sums.third[k] + i, near, scale * entry);
      }
    }
  }
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
