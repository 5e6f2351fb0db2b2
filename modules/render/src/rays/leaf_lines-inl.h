// SPDX-License-Identifier: BSD-3-Clause
// The polynomials of a block's leaves along one ray, a leaf a lane. The guard toggles: Highway
// compiles a kernel file once per instruction set.
#if defined(PCL_SLIM_LEAF_LINES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PCL_SLIM_LEAF_LINES_INL
#undef PCL_SLIM_LEAF_LINES_INL
#else
#define PCL_SLIM_LEAF_LINES_INL
#endif

#include "hwy/highway.h"
#include "pcl_slim/surface/detail/kernel_math-inl.h"
#include "rays/leaf_blocks.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Lane = hn::CappedTag<float, kWide>;
using Lanes = hn::Vec<Lane>;
using Some = hn::Mask<Lane>;

HWY_INLINE Lanes
all(float value)
{
  return hn::Set(Lane(), value);
}

/** One bit a lane. */
HWY_INLINE unsigned
bitsOf(Some mask)
{
  std::uint8_t bits[8] = {};
  hn::StoreMaskBits(Lane(), mask, bits);
  return bits[0];
}

using Triad = Triple<Lanes>;

/** p + s d. */
HWY_INLINE Triad
pointAt(const Triad& p, Lanes s, const Triad& d)
{
  return {hn::MulAdd(s, d.x, p.x), hn::MulAdd(s, d.y, p.y), hn::MulAdd(s, d.z, p.z)};
}

/** Lanes k, k + 1, ... of a block. */
struct BlockLanes {
  const float* columns;
  std::size_t k;

  HWY_INLINE Lanes column(std::size_t c) const { return hn::Load(Lane(), columns + c * kWide + k); }
  HWY_INLINE Lanes coefficient(std::size_t c) const { return column(kBlockCoefficients + c); }

  /** The leaves' frames. */
  HWY_INLINE FrameLanes<Lanes> frames() const
  {
    return FrameLanes<Lanes>({column(kBlockNX), column(kBlockNY), column(kBlockNZ)});
  }

  /** A point relative to the block, relative to the centres and in radii. */
  HWY_INLINE Triad place(const float point[3]) const
  {
    const Lanes inverse = column(kBlockInverseRadius);
    return {hn::Mul(hn::Sub(all(point[0]), column(kBlockX)), inverse),
            hn::Mul(hn::Sub(all(point[1]), column(kBlockY)), inverse),
            hn::Mul(hn::Sub(all(point[2]), column(kBlockZ)), inverse)};
  }
};

/** f / r along p + s d as a polynomial in s, p and s in radii, as RayPolynomial. D: 2, 3 or 4. */
template <int D>
struct LeafLines {
  Lanes a[5];
  Lanes u, v, du, dv;  ///< p and d in the leaves' frames

  LeafLines(const BlockLanes& block, const FrameLanes<Lanes>& frame, const Triad& p, const Triad& d)
      : u(dot3(p, frame.u)), v(dot3(p, frame.v)), du(dot3(d, frame.u)), dv(dot3(d, frame.v))
  {
    const Lanes c1 = block.coefficient(1), c2 = block.coefficient(2);
    a[0] = hn::MulAdd(c1, u, hn::MulAdd(c2, v, block.coefficient(0)));
    a[1] = hn::MulAdd(c1, du, hn::Mul(c2, dv));
    addQuadratic(block);
    a[3] = a[4] = hn::Zero(Lane());
    if constexpr (D >= 3) addCubic(block);
    if constexpr (D >= 4) addQuartic(block);
    a[0] = hn::Sub(dot3(p, frame.w), a[0]);
    a[1] = hn::Sub(dot3(d, frame.w), a[1]);
    for (int i = 2; i <= D; ++i) a[i] = hn::Neg(a[i]);
  }

  HWY_INLINE Lanes slope(Lanes s) const
  {
    Lanes value = hn::Mul(all(static_cast<float>(D)), a[D]);
    for (int i = D - 1; i >= 1; --i) {
      value = hn::MulAdd(value, s, hn::Mul(all(static_cast<float>(i)), a[i]));
    }
    return value;
  }
  HWY_INLINE Lanes value(Lanes s) const
  {
    Lanes value = a[D];
    for (int i = D - 1; i >= 0; --i) value = hn::MulAdd(value, s, a[i]);
    return value;
  }

 private:
  /** x u + y v times a factor. */
  static HWY_INLINE Lanes both(Lanes x, Lanes u, Lanes y, Lanes v)
  {
    return hn::MulAdd(x, u, hn::Mul(y, v));
  }

  HWY_INLINE void addQuadratic(const BlockLanes& block)
  {
    const Lanes c0 = block.coefficient(3), c1 = block.coefficient(4), c2 = block.coefficient(5);
    const Lanes gu = both(hn::Add(c0, c0), u, c1, v), gv = both(c1, u, hn::Add(c2, c2), v);
    a[0] = hn::MulAdd(all(0.5f), both(gu, u, gv, v), a[0]);
    a[1] = hn::Add(a[1], both(gu, du, gv, dv));
    a[2] = hn::MulAdd(hn::MulAdd(c0, du, hn::Mul(c1, dv)), du, hn::Mul(c2, hn::Mul(dv, dv)));
  }

  HWY_INLINE void addCubic(const BlockLanes& block)
  {
    Lanes c[4];
    for (std::size_t i = 0; i < 4; ++i) c[i] = block.coefficient(6 + i);
    const Lanes two = all(2.0f), three = all(3.0f);
    const auto gradient_u = [&](Lanes x, Lanes y) HWY_ATTR {
      return hn::MulAdd(hn::MulAdd(hn::Mul(three, c[0]), x, hn::Mul(hn::Mul(two, c[1]), y)), x,
                        hn::Mul(c[2], hn::Mul(y, y)));
    };
    const auto gradient_v = [&](Lanes x, Lanes y) HWY_ATTR {
      return hn::MulAdd(hn::MulAdd(c[1], x, hn::Mul(hn::Mul(two, c[2]), y)), x,
                        hn::Mul(hn::Mul(three, c[3]), hn::Mul(y, y)));
    };
    const Lanes pu = gradient_u(u, v), pv = gradient_v(u, v);
    const Lanes qu = gradient_u(du, dv), qv = gradient_v(du, dv);
    const Lanes third = all(1.0f / 3.0f);
    a[0] = hn::MulAdd(third, both(pu, u, pv, v), a[0]);
    a[1] = hn::Add(a[1], both(pu, du, pv, dv));
    a[2] = hn::Add(a[2], both(qu, u, qv, v));
    a[3] = hn::Mul(third, both(qu, du, qv, dv));
  }

  HWY_INLINE void addQuartic(const BlockLanes& block)
  {
    Lanes c[5];
    for (std::size_t i = 0; i < 5; ++i) c[i] = block.coefficient(10 + i);
    const auto times = [](float f, Lanes x) HWY_ATTR { return hn::Mul(all(f), x); };
    const auto gradient_u = [&](Lanes x, Lanes y) HWY_ATTR {
      const Lanes xx = hn::Mul(x, x), yy = hn::Mul(y, y);
      return hn::MulAdd(xx, both(times(4.0f, c[0]), x, times(3.0f, c[1]), y),
                        hn::Mul(yy, both(times(2.0f, c[2]), x, c[3], y)));
    };
    const auto gradient_v = [&](Lanes x, Lanes y) HWY_ATTR {
      const Lanes xx = hn::Mul(x, x), yy = hn::Mul(y, y);
      return hn::MulAdd(xx, both(c[1], x, times(2.0f, c[2]), y),
                        hn::Mul(yy, both(times(3.0f, c[3]), x, times(4.0f, c[4]), y)));
    };
    const Lanes pu = gradient_u(u, v), pv = gradient_v(u, v);
    const Lanes qu = gradient_u(du, dv), qv = gradient_v(du, dv);
    const Lanes uu = hn::Mul(u, u), uv = hn::Mul(u, v), vv = hn::Mul(v, v);
    const Lanes huu =
        hn::MulAdd(times(12.0f, c[0]), uu, both(times(6.0f, c[1]), uv, times(2.0f, c[2]), vv));
    const Lanes huv =
        hn::MulAdd(times(3.0f, c[1]), uu, both(times(4.0f, c[2]), uv, times(3.0f, c[3]), vv));
    const Lanes hvv =
        hn::MulAdd(times(2.0f, c[2]), uu, both(times(6.0f, c[3]), uv, times(12.0f, c[4]), vv));
    const Lanes bend = hn::MulAdd(huu, hn::Mul(du, du),
                                  both(times(2.0f, huv), hn::Mul(du, dv), hvv, hn::Mul(dv, dv)));
    a[0] = hn::MulAdd(all(0.25f), both(pu, u, pv, v), a[0]);
    a[1] = hn::Add(a[1], both(pu, du, pv, dv));
    a[2] = hn::MulAdd(all(0.5f), bend, a[2]);
    a[3] = hn::Add(a[3], both(qu, u, qv, v));
    a[4] = times(0.25f, both(qu, du, qv, dv));
  }
};

/** Both roots of quadratics, without cancellation. */
struct QuadraticRootLanes {
  Lanes one, other;
  Some real;
  Some one_falls;  ///< the quadratic falls at one and rises at other; elsewhere the reverse

  explicit QuadraticRootLanes(const LeafLines<2>& line)
  {
    const Lanes *a = line.a, zero = hn::Zero(Lane());
    const Lanes under = hn::NegMulAdd(hn::Mul(all(4.0f), a[2]), a[0], hn::Mul(a[1], a[1]));
    real = hn::Ge(under, zero);
    const Lanes root = hn::Sqrt(hn::Max(under, zero));
    const Lanes q = hn::Mul(all(-0.5f), hn::Add(a[1], hn::CopySign(root, a[1])));
    one = hn::Div(a[0], q);
    other = hn::Div(q, a[2]);
    one_falls = hn::Lt(a[1], zero);
  }
};

/** Slopes and bends of the height polynomials at (u, v). */
template <int D>
struct LaneJets {
  Lanes hu, hv, huu, huv, hvv;

  LaneJets(const BlockLanes& block, Lanes u, Lanes v)
  {
    // Slopes of each power of u, from the highest degree down to 2, added to the linear terms.
    const Lanes two = all(2.0f);
    const auto c = [&](std::size_t i) HWY_ATTR { return block.coefficient(i); };
    huu = hn::Mul(two, c(3));
    huv = c(4);
    hvv = hn::Mul(two, c(5));
    hu = hn::MulAdd(huu, u, hn::MulAdd(huv, v, c(1)));
    hv = hn::MulAdd(huv, u, hn::MulAdd(hvv, v, c(2)));
    if constexpr (D >= 3) addForm<3, 6>(block, u, v);
    if constexpr (D >= 4) addForm<4, 10>(block, u, v);
  }

 private:
  /** Adds the derivatives of the form of degree N whose coefficients begin at First. */
  template <int N, int First>
  HWY_INLINE void addForm(const BlockLanes& block, Lanes u, Lanes v)
  {
    Lanes pu[N], pv[N];
    pu[0] = pv[0] = all(1.0f);
    for (int i = 1; i < N; ++i) {
      pu[i] = hn::Mul(pu[i - 1], u);
      pv[i] = hn::Mul(pv[i - 1], v);
    }
    unrolled<N + 1>([&](auto step) HWY_ATTR {
      constexpr int kJ = step(), kI = N - kJ;
      const Lanes c = block.coefficient(static_cast<std::size_t>(First + kJ));
      const auto term = [&](int factor, int i, int j) HWY_ATTR {
        return hn::Mul(hn::Mul(all(static_cast<float>(factor)), c), hn::Mul(pu[i], pv[j]));
      };
      if constexpr (kI >= 1) hu = hn::Add(hu, term(kI, kI - 1, kJ < N ? kJ : 0));
      if constexpr (kJ >= 1) hv = hn::Add(hv, term(kJ, kI < N ? kI : 0, kJ - 1));
      if constexpr (kI >= 2) huu = hn::Add(huu, term(kI * (kI - 1), kI - 2, kJ));
      if constexpr (kI >= 1 && kJ >= 1) huv = hn::Add(huv, term(kI * kJ, kI - 1, kJ - 1));
      if constexpr (kJ >= 2) hvv = hn::Add(hvv, term(kJ * (kJ - 1), kI, kJ - 2));
    });
  }
};

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
