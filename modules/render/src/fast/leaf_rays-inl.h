// SPDX-License-Identifier: BSD-3-Clause
// One leaf's polynomial along the rays of a block of pixels, a ray a lane. The guard toggles:
// Highway compiles a kernel file once per instruction set.
#if defined(PCL_SLIM_LEAF_RAYS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PCL_SLIM_LEAF_RAYS_INL
#undef PCL_SLIM_LEAF_RAYS_INL
#else
#define PCL_SLIM_LEAF_RAYS_INL
#endif

#include <limits>

#include "fast/isolated_root.h"
#include "fast/lanes-inl.h"
#include "fast/setup/frame_leaf.h"
#include "pcl_slim/surface/detail/kernel_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE::lanes {

/** A polynomial in X and Y of degree D, coefficients read as they are needed. */
template <int D>
HWY_INLINE Vec
planeForm(const float* c, Vec x, Vec y)
{
  if constexpr (D == 0) {
    return set(c[0]);
  } else if constexpr (D == 1) {
    return MulAdd(set(c[1]), x, MulAdd(set(c[2]), y, set(c[0])));
  } else {
    // Horner in x over polynomials in y, from the highest power of x down.
    const auto row = [&](auto power) HWY_ATTR {
      constexpr int kI = power(), kRest = D - kI;
      const auto at = [&](int j) HWY_ATTR { return set(c[(kI + j) * (kI + j + 1) / 2 + j]); };
      Vec r = at(kRest);
      unrolled<kRest>([&](auto step) HWY_ATTR { r = MulAdd(r, y, at(kRest - 1 - step())); });
      return r;
    };
    Vec f = row(std::integral_constant<int, D>());
    unrolled<D>([&](auto step) HWY_ATTR {
      f = MulAdd(f, x, row(std::integral_constant<int, D - 1 - step()>()));
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
    unrolled<D>([&](auto i) HWY_ATTR { f = MulAdd(f, t, a[D - 1 - i()]); });
    return f;
  }

  HWY_INLINE Vec slope(Vec t) const
  {
    Vec f = Mul(set(static_cast<float>(D)), a[D]);
    unrolled<D - 1>([&](auto i) HWY_ATTR {
      constexpr int kPower = D - 1 - i();
      f = MulAdd(f, t, Mul(set(static_cast<float>(kPower)), a[kPower]));
    });
    return f;
  }

  /** Moves the origin to t. */
  HWY_INLINE void shift(Vec t)
  {
    unrolled<D>([&](auto i) HWY_ATTR {
      unrolled<D - i()>([&](auto j) HWY_ATTR {
        constexpr int kAt = D - 1 - j();
        a[kAt] = MulAdd(t, a[kAt + 1], a[kAt]);
      });
    });
  }
};

/** A leaf's ball and the rays of a block in its coordinates. */
struct LeafRays {
  const FrameLeaf& leaf;
  Vec x, y;

  /** m at sigma. */
  HWY_INLINE Vec scaleAt(Vec sigma) const { return NegMulAdd(set(leaf.eps), sigma, set(1.0f)); }
  /** Squared distance from the centre in radii, times m^2. */
  HWY_INLINE Vec distanceSq(Vec sigma) const
  {
    const Vec px = MulAdd(set(leaf.xc), sigma, x), py = MulAdd(set(leaf.yc), sigma, y);
    return dot3(px, py, sigma, px, py, sigma);
  }
  /** Lanes whose point at sigma lies in the ball of a share of the radius. */
  HWY_INLINE Mask inBall(Vec sigma, float share_sq) const
  {
    const Vec m = scaleAt(sigma);
    return Lt(distanceSq(sigma), Mul(set(share_sq), Mul(m, m)));
  }
  /** Where rays enter and leave that ball. \return lanes that do. */
  HWY_INLINE Mask chord(float share_sq, Vec& low, Vec& high) const
  {
    const float bend = share_sq * leaf.eps;
    const float square = 1.0f + leaf.xc * leaf.xc + leaf.yc * leaf.yc - bend * leaf.eps;
    const Vec half = MulAdd(set(leaf.xc), x, MulAdd(set(leaf.yc), y, set(bend)));
    const Vec rest = MulAdd(x, x, MulSub(y, y, set(share_sq)));
    const Vec under = NegMulAdd(set(square), rest, Mul(half, half));
    const Vec root = Sqrt(Max(under, set(0.0f)));
    const Vec inverse = set(1.0f / square);
    low = Mul(Neg(Add(half, root)), inverse);
    high = Mul(Sub(root, half), inverse);
    return Gt(under, set(0.0f));
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
    const Vec *a = f.a, four = set(-4.0f), two = set(2.0f);
    const Vec under = MulAdd(Mul(four, a[2]), a[0], Mul(a[1], a[1]));
    real = Ge(under, set(0.0f));
    const Vec root = Sqrt(Max(under, set(0.0f)));
    slope = Neg(root);
    const Mask descends = Lt(a[1], set(0.0f));
    const Vec apart = Add(Abs(a[1]), root);  // |a1| + root: no difference of like numbers
    const Vec twice0 = Mul(two, a[0]), twice2 = Mul(two, a[2]);
    falling = Div(IfThenElse(descends, twice0, Neg(apart)), IfThenElse(descends, apart, twice2));
    rising = falling;
    if (front_only) return;
    rising = Div(IfThenElse(descends, apart, Neg(twice0)), IfThenElse(descends, twice2, apart));
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
  const Vec zero = set(0.0f), width = Sub(high, low);
  f.shift(low);
  Vec power = width;
  unrolled<D>([&](auto i) HWY_ATTR {
    f.a[i() + 1] = Mul(f.a[i() + 1], power);
    power = Mul(power, width);
  });
  const Vec* a = f.a;
  Vec b[D + 1];
  b[0] = a[0];
  if constexpr (D == 3) {
    b[1] = MulAdd(a[1], set(1.0f / 3.0f), a[0]);
    b[2] = MulAdd(MulAdd(set(2.0f), a[1], a[2]), set(1.0f / 3.0f), a[0]);
    b[3] = Add(Add(a[0], a[1]), Add(a[2], a[3]));
  } else {
    b[1] = MulAdd(a[1], set(0.25f), a[0]);
    b[2] = MulAdd(a[1], set(0.5f), MulAdd(a[2], set(1.0f / 6.0f), a[0]));
    b[3] = MulAdd(a[1], set(0.75f), MulAdd(a[2], set(0.5f), MulAdd(a[3], set(0.25f), a[0])));
    b[4] = Add(Add(a[0], a[1]), Add(Add(a[2], a[3]), a[4]));
  }
  Mask falls = Lt(zero, zero), rises = falls, above = Gt(b[0], zero);
  unrolled<D>([&](auto i) HWY_ATTR {
    const Mask next = Gt(b[i() + 1], zero);
    falls = Or(falls, AndNot(next, above));
    rises = Or(rises, AndNot(above, next));
    above = next;
  });
  Isolation<D> found;
  found.unclear = And(active, And(falls, rises));
  found.one = And(active, AndNot(rises, falls));
  if (!front_only) found.one = And(active, Xor(falls, rises));
  if (AllFalse(found.one)) return found;

  // Newton inside a bracket; F turned to fall.
  const Vec sign = IfThenElse(rises, set(-1.0f), set(1.0f));
  Vec left = zero, right = set(1.0f);
  const Vec span = Sub(b[0], b[D]);
  const Vec safe_span = IfThenElse(Eq(span, zero), set(1.0f), span);
  Vec t = Div(b[0], safe_span);
  for (int step = 0; step < 12; ++step) {
    const Vec value = f.value(t), slope = f.slope(t);
    const Mask before = Gt(Mul(sign, value), zero);  // the root lies right of t
    left = IfThenElse(before, t, left);
    right = IfThenElse(before, right, t);
    Vec next = Sub(t, Div(value, slope));
    const Mask inside = And(Ge(next, left), Le(next, right));
    next = IfThenElse(inside, next, Mul(set(0.5f), Add(left, right)));
    const Mask settled = And(inside, Lt(Abs(Sub(next, t)), set(1e-4f)));
    t = next;
    if (AllTrue(Or(settled, Not(found.one)))) break;
  }
  root = IfThenElse(found.one, MulAdd(width, t, low), root);
  return found;
}

/** Solves the lanes that are unclear one by one, in double. \return lanes with a root that counts. */
template <int D>
HWY_NOINLINE Mask
solveOneByOne(const RayPolynomials<D>& f, Vec low, Vec high, Vec aim, bool front_only, Mask unclear,
              Vec& root, std::uint64_t& solved)
{
  HWY_ALIGN float a[D + 1][16], lows[16], highs[16], aims[16], roots[16], found[16];
  HWY_ALIGN float wanted[16];
  for (int i = 0; i <= D; ++i) store(f.a[i], a[i]);
  store(low, lows);
  store(high, highs);
  store(aim, aims);
  store(root, roots);
  store(set(0.0f), found);
  store(IfThenElseZero(unclear, set(1.0f)), wanted);
  for (std::size_t i = 0; i < kLanes; ++i) {
    if (!(wanted[i] > 0.0f)) continue;
    double c[5] = {};
    for (int k = 0; k <= D; ++k) c[k] = a[k][i];
    found[i] = isolatedRoot(D, c, lows[i], highs[i], aims[i], front_only, roots[i]);
    ++solved;
  }
  root = load(roots);
  return Gt(load(found), set(0.0f));
}

/** Solves lanes that are unclear: by parts of the interval first, then one by one.
 * \return lanes with a root that counts, the one nearest to aim. */
template <int D>
HWY_NOINLINE Mask
solveUnclear(const RayPolynomials<D>& f, Vec low, Vec high, Vec aim, bool front_only, Mask unclear,
             Vec& root, std::uint64_t& solved)
{
  constexpr int kPieces = 4;
  const Vec piece = Mul(set(1.0f / kPieces), Sub(high, low));
  const Vec nothing = set(std::numeric_limits<float>::max());
  Vec distance = nothing, begin = low;
  Mask rest = Lt(low, low);
  for (int k = 0; k < kPieces; ++k) {
    const Vec end = k == kPieces - 1 ? high : Add(begin, piece);
    Vec found = root;
    const auto part = isolate<D>(f, begin, end, front_only, unclear, found);
    const Vec away = IfThenElse(part.one, Abs(Sub(found, aim)), nothing);
    root = IfThenElse(Lt(away, distance), found, root);
    distance = Min(distance, away);
    rest = Or(rest, part.unclear);
    begin = end;
  }
  const Mask clear = AndNot(rest, Lt(distance, nothing));
  if (AllFalse(rest)) return clear;
  return Or(clear, solveOneByOne<D>(f, low, high, aim, front_only, rest, root, solved));
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE::lanes
HWY_AFTER_NAMESPACE();
#endif
