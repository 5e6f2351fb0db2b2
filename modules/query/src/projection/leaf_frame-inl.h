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

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

HWY_INLINE Vec
set(float value)
{
  return hn::Set(Tag(), value);
}

struct ThirdDerivatives {
  Vec uuu, uuv, uvv, vvv;
};

/** Height and its derivatives, evaluated by rows of the graded coefficients. */
template <int D>
class HeightJets {
 public:
  explicit HeightJets(const float* c)
  {
    for (int k = 0; k < numCoefficients(D); ++k) c_[k] = set(c[k]);
  }

  HWY_INLINE void gradient(Vec u, Vec v, Vec& h, Vec& hu, Vec& hv) const
  {
    h = hn::MulAdd(c_[1], u, hn::MulAdd(c_[2], v, c_[0]));
    hu = c_[1];
    hv = c_[2];
    if constexpr (D >= 2) {
      h = hn::MulAdd(u, hn::MulAdd(c_[3], u, hn::Mul(c_[4], v)),
                     hn::MulAdd(hn::Mul(c_[5], v), v, h));
      hu = hn::MulAdd(hn::Add(c_[3], c_[3]), u, hn::MulAdd(c_[4], v, hu));
      hv = hn::MulAdd(hn::Add(c_[5], c_[5]), v, hn::MulAdd(c_[4], u, hv));
    }
    if constexpr (D >= 3) {
      const Vec uu = hn::Mul(u, u), uv = hn::Mul(u, v), vv = hn::Mul(v, v);
      h = hn::MulAdd(uu, hn::MulAdd(c_[6], u, hn::Mul(c_[7], v)),
                     hn::MulAdd(vv, hn::MulAdd(c_[8], u, hn::Mul(c_[9], v)), h));
      hu = hn::MulAdd(hn::Mul(set(3), c_[6]), uu,
                      hn::MulAdd(hn::Add(c_[7], c_[7]), uv, hn::MulAdd(c_[8], vv, hu)));
      hv = hn::MulAdd(
          c_[7], uu,
          hn::MulAdd(hn::Add(c_[8], c_[8]), uv, hn::MulAdd(hn::Mul(set(3), c_[9]), vv, hv)));
    }
    if constexpr (D >= 4) {
      const Vec uu = hn::Mul(u, u), uv = hn::Mul(u, v), vv = hn::Mul(v, v);
      const Vec high = hn::MulAdd(c_[10], uu, hn::MulAdd(c_[11], uv, hn::Mul(c_[12], vv)));
      h = hn::MulAdd(uu, high, hn::MulAdd(vv, hn::MulAdd(c_[13], uv, hn::Mul(c_[14], vv)), h));
      const Vec hu4 = hn::MulAdd(
          uu, hn::MulAdd(hn::Mul(set(4), c_[10]), u, hn::Mul(hn::Mul(set(3), c_[11]), v)),
          hn::Mul(vv, hn::MulAdd(hn::Add(c_[12], c_[12]), u, hn::Mul(c_[13], v))));
      const Vec hv4 = hn::MulAdd(
          uu, hn::MulAdd(c_[11], u, hn::Mul(hn::Add(c_[12], c_[12]), v)),
          hn::Mul(vv, hn::MulAdd(hn::Mul(set(3), c_[13]), u, hn::Mul(hn::Mul(set(4), c_[14]), v))));
      hu = hn::Add(hu, hu4);
      hv = hn::Add(hv, hv4);
    }
  }

  HWY_INLINE void second(Vec u, Vec v, Vec& huu, Vec& huv, Vec& hvv) const
  {
    const Vec two = set(2);
    huu = huv = hvv = hn::Zero(Tag());
    if constexpr (D >= 2) {
      huu = hn::Mul(two, c_[3]);
      huv = c_[4];
      hvv = hn::Mul(two, c_[5]);
    }
    if constexpr (D >= 3) {
      huu = hn::MulAdd(hn::Mul(set(6), c_[6]), u, hn::MulAdd(hn::Mul(two, c_[7]), v, huu));
      huv = hn::MulAdd(hn::Mul(two, c_[7]), u, hn::MulAdd(hn::Mul(two, c_[8]), v, huv));
      hvv = hn::MulAdd(hn::Mul(two, c_[8]), u, hn::MulAdd(hn::Mul(set(6), c_[9]), v, hvv));
    }
    if constexpr (D >= 4) {
      const Vec uu = hn::Mul(u, u), uv = hn::Mul(u, v), vv = hn::Mul(v, v);
      huu = hn::Add(huu, hn::MulAdd(hn::Mul(set(12), c_[10]), uu,
                                    hn::MulAdd(hn::Mul(set(6), c_[11]), uv,
                                               hn::Mul(hn::Mul(two, c_[12]), vv))));
      huv = hn::Add(huv, hn::MulAdd(hn::Mul(set(3), c_[11]), uu,
                                    hn::MulAdd(hn::Mul(set(4), c_[12]), uv,
                                               hn::Mul(hn::Mul(set(3), c_[13]), vv))));
      hvv = hn::Add(hvv, hn::MulAdd(hn::Mul(two, c_[12]), uu,
                                    hn::MulAdd(hn::Mul(set(6), c_[13]), uv,
                                               hn::Mul(hn::Mul(set(12), c_[14]), vv))));
    }
  }

  HWY_INLINE ThirdDerivatives third(Vec u, Vec v) const
  {
    const Vec zero = hn::Zero(Tag());
    ThirdDerivatives h{zero, zero, zero, zero};
    if constexpr (D >= 3) {
      h = {hn::Mul(set(6), c_[6]), hn::Mul(set(2), c_[7]), hn::Mul(set(2), c_[8]),
           hn::Mul(set(6), c_[9])};
    }
    if constexpr (D >= 4) {
      const auto add = [&](Vec& target, float ku, Vec cu, float kv, Vec cv) HWY_ATTR {
        target =
            hn::Add(target, hn::MulAdd(hn::Mul(set(ku), cu), u, hn::Mul(hn::Mul(set(kv), cv), v)));
      };
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

/** Adds the lanes of mask; 0 to the others, whatever value is there. */
HWY_INLINE void
addTo(float* target, Mask mask, Vec value)
{
  const Tag d;
  hn::Store(hn::Add(hn::Load(d, target), hn::IfThenElseZero(mask, value)), d, target);
}

/** Adds scale times the Hessian H = huu u u^T + huv (u v^T + v u^T) + hvv v v^T. */
template <int D>
HWY_INLINE void
addHessian(const LeafFrame& frame, const HeightJets<D>& jets, const Local& q, Mask near, Vec scale,
           std::size_t i, BlockSums& sums)
{
  Vec huu, huv, hvv;
  jets.second(q.u, q.v, huu, huv, hvv);
  for (int a = 0; a < 3; ++a) {
    const Vec along_u = hn::MulAdd(huu, frame.axisU(a), hn::Mul(huv, frame.axisV(a)));
    const Vec along_v = hn::MulAdd(huv, frame.axisU(a), hn::Mul(hvv, frame.axisV(a)));
    for (int b = a; b < 3; ++b) {
      const Vec entry = hn::MulAdd(along_u, frame.axisU(b), hn::Mul(along_v, frame.axisV(b)));
      addTo(sums.hessian[kSymmetricEntry[a][b]] + i, near, hn::Mul(scale, entry));
    }
  }
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
        addTo(sums.third[k] + i, near, hn::Mul(scale, entry));
      }
    }
  }
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
