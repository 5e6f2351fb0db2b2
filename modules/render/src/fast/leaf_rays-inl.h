// SPDX-License-Identifier: BSD-3-Clause
// One leaf's polynomial along the rays of a block of pixels, a ray a lane. The guard toggles:
// Highway compiles a kernel file once per instruction set.
#if defined(PCL_SLIM_LEAF_RAYS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PCL_SLIM_LEAF_RAYS_INL
#undef PCL_SLIM_LEAF_RAYS_INL
#else
#define PCL_SLIM_LEAF_RAYS_INL
#endif

#include "fast/frame_leaf.h"
#include "fast/isolated_root.h"
#include "pcl_slim/surface/detail/kernel_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

HWY_INLINE Vec
set(float value)
{
  return hn::Set(Tag(), value);
}

/** A polynomial in X and Y of degree D, coefficients read as they are needed. */
template <int D>
HWY_INLINE Vec
planeForm(const float* c, Vec x, Vec y)
{
  if constexpr (D == 0) {
    return set(c[0]);
  } else if constexpr (D == 1) {
    return hn::MulAdd(set(c[1]), x, hn::MulAdd(set(c[2]), y, set(c[0])));
  } else {
    // Horner in x over polynomials in y, from the highest power of x down.
    const auto row = [&](auto power) HWY_ATTR {
      constexpr int kI = power(), kRest = D - kI;
      const auto at = [&](int j) HWY_ATTR { return set(c[(kI + j) * (kI + j + 1) / 2 + j]); };
      Vec r = at(kRest);
      unrolled<kRest>([&](auto step) HWY_ATTR { r = hn::MulAdd(r, y, at(kRest - 1 - step())); });
      return r;
    };
    Vec f = row(std::integral_constant<int, D>());
    unrolled<D>([&](auto step) HWY_ATTR {
      f = hn::MulAdd(f, x, row(std::integral_constant<int, D - 1 - step()>()));
    });
    return f;
  }
}

/** F along each ray: a[0] + a[1] sigma + ... */
template <int D>
struct RayPolynomials {
  Vec a[D + 1];

  HWY_INLINE RayPolynomials(const float* form, Vec x, Vec y)
  {
    unrolled<D + 1>([&](auto i) HWY_ATTR {
      a[i()] = planeForm<D - i()>(form, x, y);
      form += numCoefficients(D - i());
    });
  }

  HWY_INLINE Vec value(Vec t) const
  {
    Vec f = a[D];
    unrolled<D>([&](auto i) HWY_ATTR { f = hn::MulAdd(f, t, a[D - 1 - i()]); });
    return f;
  }

  HWY_INLINE Vec slope(Vec t) const
  {
    Vec f = hn::Mul(set(static_cast<float>(D)), a[D]);
    unrolled<D - 1>([&](auto i) HWY_ATTR {
      constexpr int kPower = D - 1 - i();
      f = hn::MulAdd(f, t, hn::Mul(set(static_cast<float>(kPower)), a[kPower]));
    });
    return f;
  }

  /** Moves the origin to t. */
  HWY_INLINE void shift(Vec t)
  {
    unrolled<D>([&](auto i) HWY_ATTR {
      unrolled<D - i()>([&](auto j) HWY_ATTR {
        constexpr int kAt = D - 1 - j();
        a[kAt] = hn::MulAdd(t, a[kAt + 1], a[kAt]);
      });
    });
  }
};

/** A leaf's ball and the rays of a block in its coordinates. */
struct LeafRays {
  const FrameLeaf& leaf;
  Vec x, y;

  /** m at sigma. */
  HWY_INLINE Vec scaleAt(Vec sigma) const { return hn::NegMulAdd(set(leaf.eps), sigma, set(1.0f)); }
  /** Squared distance from the centre in radii, times m^2. */
  HWY_INLINE Vec distanceSq(Vec sigma) const
  {
    const Vec px = hn::MulAdd(set(leaf.xc), sigma, x), py = hn::MulAdd(set(leaf.yc), sigma, y);
    return dot3(px, py, sigma, px, py, sigma);
  }
  /** Lanes whose point at sigma lies in the ball of a share of the radius. */
  HWY_INLINE Mask inBall(Vec sigma, float share_sq) const
  {
    const Vec m = scaleAt(sigma);
    return hn::Lt(distanceSq(sigma), hn::Mul(set(share_sq), hn::Mul(m, m)));
  }
  /** Where rays enter and leave that ball. \return lanes that do. */
  HWY_INLINE Mask chord(float share_sq, Vec& low, Vec& high) const
  {
    const float bend = share_sq * leaf.eps;
    const float square = 1.0f + leaf.xc * leaf.xc + leaf.yc * leaf.yc - bend * leaf.eps;
    const Vec half = hn::MulAdd(set(leaf.xc), x, hn::MulAdd(set(leaf.yc), y, set(bend)));
    const Vec rest = hn::MulAdd(x, x, hn::MulSub(y, y, set(share_sq)));
    const Vec under = hn::NegMulAdd(set(square), rest, hn::Mul(half, half));
    const Vec root = hn::Sqrt(hn::Max(under, hn::Zero(Tag())));
    const Vec inverse = set(1.0f / square);
    low = hn::Mul(hn::Neg(hn::Add(half, root)), inverse);
    high = hn::Mul(hn::Sub(root, half), inverse);
    return hn::Gt(under, hn::Zero(Tag()));
  }
};

/** Both roots of a quadratic, the falling one (F' < 0) first where front_only asks for no other. */
struct QuadraticRoots {
  Vec falling, rising;
  Vec slope;  ///< of F at the falling root
  Mask real;

  /** Without cancellation, and for any leading coefficient. */
  HWY_INLINE explicit QuadraticRoots(const RayPolynomials<2>& f, bool front_only)
  {
    const Tag d;
    const Vec *a = f.a, four = set(-4.0f), two = set(2.0f);
    const Vec under = hn::MulAdd(hn::Mul(four, a[2]), a[0], hn::Mul(a[1], a[1]));
    real = hn::Ge(under, hn::Zero(d));
    const Vec root = hn::Sqrt(hn::Max(under, hn::Zero(d)));
    slope = hn::Neg(root);
    const Mask descends = hn::Lt(a[1], hn::Zero(d));
    const Vec apart = hn::Add(hn::Abs(a[1]), root);  // |a1| + root: no difference of like numbers
    const Vec twice0 = hn::Mul(two, a[0]), twice2 = hn::Mul(two, a[2]);
    falling = hn::Div(hn::IfThenElse(descends, twice0, hn::Neg(apart)),
                      hn::IfThenElse(descends, apart, twice2));
    rising = falling;
    if (front_only) return;
    rising = hn::Div(hn::IfThenElse(descends, apart, hn::Neg(twice0)),
                     hn::IfThenElse(descends, twice2, apart));
  }
};

/** What Descartes' rule says of F on an interval. */
template <int D>
struct Isolation {
  Mask one;      ///< exactly one root that counts
  Mask unclear;  ///< there may be several
};

/** Tells lanes with one root of F between low and high from those with none, and finds it.
 * With front_only only roots at which F falls count. */
template <int D>
HWY_INLINE Isolation<D>
isolate(RayPolynomials<D> f, Vec low, Vec high, bool front_only, Mask active, Vec& root)
{
  static_assert(D == 3 || D == 4);
  const Tag d;
  const Vec zero = hn::Zero(d), width = hn::Sub(high, low);
  f.shift(low);
  Vec power = width;
  unrolled<D>([&](auto i) HWY_ATTR {
    f.a[i() + 1] = hn::Mul(f.a[i() + 1], power);
    power = hn::Mul(power, width);
  });
  const Vec* a = f.a;
  Vec b[D + 1];
  b[0] = a[0];
  if constexpr (D == 3) {
    b[1] = hn::MulAdd(a[1], set(1.0f / 3.0f), a[0]);
    b[2] = hn::MulAdd(hn::MulAdd(set(2.0f), a[1], a[2]), set(1.0f / 3.0f), a[0]);
    b[3] = hn::Add(hn::Add(a[0], a[1]), hn::Add(a[2], a[3]));
  } else {
    b[1] = hn::MulAdd(a[1], set(0.25f), a[0]);
    b[2] = hn::MulAdd(a[1], set(0.5f), hn::MulAdd(a[2], set(1.0f / 6.0f), a[0]));
    b[3] = hn::MulAdd(a[1], set(0.75f),
                      hn::MulAdd(a[2], set(0.5f), hn::MulAdd(a[3], set(0.25f), a[0])));
    b[4] = hn::Add(hn::Add(a[0], a[1]), hn::Add(hn::Add(a[2], a[3]), a[4]));
  }
  Mask falls = hn::Lt(zero, zero), rises = falls, above = hn::Gt(b[0], zero);
  unrolled<D>([&](auto i) HWY_ATTR {
    const Mask next = hn::Gt(b[i() + 1], zero);
    falls = hn::Or(falls, hn::AndNot(next, above));
    rises = hn::Or(rises, hn::AndNot(above, next));
    above = next;
  });
  Isolation<D> found;
  found.unclear = hn::And(active, hn::And(falls, rises));
  found.one = hn::And(active, hn::AndNot(rises, falls));
  if (!front_only) found.one = hn::And(active, hn::Xor(falls, rises));
  if (hn::AllFalse(d, found.one)) return found;

  // Newton inside a bracket; F turned to fall.
  const Vec sign = hn::IfThenElse(rises, set(-1.0f), set(1.0f));
  Vec left = zero, right = set(1.0f);
  const Vec span = hn::Sub(b[0], b[D]);
  const Vec safe_span = hn::IfThenElse(hn::Eq(span, zero), set(1.0f), span);
  Vec t = hn::Div(b[0], safe_span);
  for (int step = 0; step < 12; ++step) {
    const Vec value = f.value(t), slope = f.slope(t);
    const Mask before = hn::Gt(hn::Mul(sign, value), zero);  // the root lies right of t
    left = hn::IfThenElse(before, t, left);
    right = hn::IfThenElse(before, right, t);
    Vec next = hn::Sub(t, hn::Div(value, slope));
    const Mask inside = hn::And(hn::Ge(next, left), hn::Le(next, right));
    next = hn::IfThenElse(inside, next, hn::Mul(set(0.5f), hn::Add(left, right)));
    const Mask settled = hn::And(inside, hn::Lt(hn::Abs(hn::Sub(next, t)), set(1e-4f)));
    t = next;
    if (hn::AllTrue(d, hn::Or(settled, hn::Not(found.one)))) break;
  }
  root = hn::IfThenElse(found.one, hn::MulAdd(width, t, low), root);
  return found;
}

/** Solves the lanes that are unclear one by one, in double. \return lanes with a root that counts. */
template <int D>
HWY_NOINLINE Mask
solveOneByOne(const RayPolynomials<D>& f, Vec low, Vec high, Vec aim, bool front_only, Mask unclear,
              Vec& root, std::uint64_t& solved)
{
  const Tag d;
  HWY_ALIGN float a[D + 1][16], lows[16], highs[16], aims[16], roots[16], found[16];
  HWY_ALIGN std::uint8_t bits[8] = {};
  for (int i = 0; i <= D; ++i) hn::Store(f.a[i], d, a[i]);
  hn::Store(low, d, lows);
  hn::Store(high, d, highs);
  hn::Store(aim, d, aims);
  hn::Store(root, d, roots);
  hn::Store(hn::Zero(d), d, found);
  hn::StoreMaskBits(d, unclear, bits);
  for (std::size_t i = 0; i < hn::Lanes(d); ++i) {
    if (!(bits[i / 8] >> (i % 8) & 1)) continue;
    double c[5] = {};
    for (int k = 0; k <= D; ++k) c[k] = a[k][i];
    found[i] = isolatedRoot(D, c, lows[i], highs[i], aims[i], front_only, roots[i]);
    ++solved;
  }
  root = hn::Load(d, roots);
  return hn::Gt(hn::Load(d, found), hn::Zero(d));
}

/** Solves lanes that are unclear: by halves of the interval first, then one by one.
 * \return lanes with a root that counts, the one nearest to aim. */
template <int D>
HWY_NOINLINE Mask
solveUnclear(const RayPolynomials<D>& f, Vec low, Vec high, Vec aim, bool front_only, Mask unclear,
             Vec& root, std::uint64_t& solved)
{
  const Tag d;
  const Vec middle = hn::Mul(set(0.5f), hn::Add(low, high));
  Vec near = root, far = root;
  const auto first = isolate<D>(f, low, middle, front_only, unclear, near);
  const auto second = isolate<D>(f, middle, high, front_only, unclear, far);
  const Mask rest = hn::Or(first.unclear, second.unclear);
  const Mask nearer = hn::Le(hn::Abs(hn::Sub(near, aim)), hn::Abs(hn::Sub(far, aim)));
  const Mask take_first = hn::And(first.one, hn::Or(hn::Not(second.one), nearer));
  root = hn::IfThenElse(take_first, near, hn::IfThenElse(second.one, far, root));
  const Mask clear = hn::AndNot(rest, hn::Or(first.one, second.one));
  if (hn::AllFalse(d, rest)) return clear;
  return hn::Or(clear, solveOneByOne<D>(f, low, high, aim, front_only, rest, root, solved));
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
