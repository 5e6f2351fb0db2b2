// SPDX-License-Identifier: BSD-3-Clause
// One leaf's polynomial along the rays of a block of pixels, a ray a lane, and its roots if it is a
// cubic or quartic. The guard toggles: Highway compiles a kernel file once per instruction set.
#if defined(PCL_SLIM_LEAF_RAYS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PCL_SLIM_LEAF_RAYS_INL
#undef PCL_SLIM_LEAF_RAYS_INL
#else
#define PCL_SLIM_LEAF_RAYS_INL
#endif

#include "fast/fast_rasterizer.h"
#include "fast/lanes-inl.h"
#include "fast/setup/leaf_setup.h"
#include "pcl_slim/leaf/detail/roots.h"
#include "pcl_slim/surface/detail/kernel_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE::lanes {

/** A polynomial in X and Y of degree D, coefficients read as they are needed. */
template <int D>
HWY_INLINE Vec planeForm(const float* c, Vec x, Vec y) {
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

  HWY_INLINE RayPolynomials(const float* form, Vec x, Vec y) {
    unrolled<D + 1>([&](auto i) HWY_ATTR {
      a[i()] = planeForm<D - i()>(form, x, y);
      form += numCoefficients(D - i());
    });
  }

  /** As keep() stored it. */
  HWY_INLINE RayPolynomials(const float* form, const float* kept) {
    unrolled<D>([&](auto i) HWY_ATTR { a[i()] = load(kept + i() * KeptRays::kRow); });
    a[D] = set(form[(D + 1) * (D + 2) * (D + 3) / 6 - 1]);
  }

  /** Stores all coefficients but the last, which is the same on all rays. */
  HWY_INLINE void keep(float* kept) const {
    unrolled<D>([&](auto i) HWY_ATTR { store(a[i()], kept + i() * KeptRays::kRow); });
  }

  HWY_INLINE Vec value(Vec t) const {
    Vec f = a[D];
    unrolled<D>([&](auto i) HWY_ATTR { f = MulAdd(f, t, a[D - 1 - i()]); });
    return f;
  }

  HWY_INLINE Vec slope(Vec t) const {
    Vec f = set(static_cast<float>(D)) * a[D];
    unrolled<D - 1>([&](auto i) HWY_ATTR {
      constexpr int kPower = D - 1 - i();
      f = MulAdd(f, t, set(static_cast<float>(kPower)) * a[kPower]);
    });
    return f;
  }

  /** Moves the origin to t. */
  HWY_INLINE void shift(Vec t) {
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
  HWY_INLINE Vec distanceSq(Vec sigma) const {
    const Vec px = MulAdd(set(leaf.xc), sigma, x), py = MulAdd(set(leaf.yc), sigma, y);
    return dot3(px, py, sigma, px, py, sigma);
  }
  /** Lanes whose point at sigma is in the ball of a share of the radius. */
  HWY_INLINE Mask inBall(Vec sigma, float share_sq) const {
    const Vec m = scaleAt(sigma);
    return distanceSq(sigma) < set(share_sq) * (m * m);
  }
  /** Where rays enter and leave that ball. \return lanes that do. */
  HWY_INLINE Mask chord(float share_sq, Vec& low, Vec& high) const {
    const float bend = share_sq * leaf.eps;
    const float square = 1.0f + leaf.xc * leaf.xc + leaf.yc * leaf.yc - bend * leaf.eps;
    const Vec half = MulAdd(set(leaf.xc), x, MulAdd(set(leaf.yc), y, set(bend)));
    const Vec rest = MulAdd(x, x, MulSub(y, y, set(share_sq)));
    const Vec under = NegMulAdd(set(square), rest, half * half);
    const Vec root = Sqrt(Max(under, set(0.0f)));
    const Vec inverse = set(1.0f / square);
    low = Neg(half + root) * inverse;
    high = (root - half) * inverse;
    return under > set(0.0f);
  }
};

/** Both roots of a quadratic, the falling one (F' < 0) alone where front_only is set. */
struct QuadraticRoots {
  Vec falling, rising;
  Vec slope;  ///< of F at the falling root
  Mask real;

  /** Without cancellation, and for any leading coefficient. */
  HWY_INLINE explicit QuadraticRoots(const RayPolynomials<2>& f, bool front_only) {
    const Vec *a = f.a, four = set(-4.0f), two = set(2.0f);
    const Vec under = MulAdd(four * a[2], a[0], a[1] * a[1]);
    real = under >= set(0.0f);
    const Vec root = Sqrt(Max(under, set(0.0f)));
    slope = Neg(root);
    const Mask descends = a[1] < set(0.0f);
    const Vec apart = Abs(a[1]) + root;  // |a1| + root: no difference of like numbers
    const Vec twice0 = two * a[0], twice2 = two * a[2];
    falling = IfThenElse(descends, twice0, Neg(apart)) / IfThenElse(descends, apart, twice2);
    rising = falling;
    if (front_only) return;
    rising = IfThenElse(descends, apart, Neg(twice0)) / IfThenElse(descends, twice2, apart);
  }
};

/** The root of a polynomial between two places of each ray, in lanes where it has one alone there:
 * Newton's steps inside a bracket.
 * \param[in] sign of the polynomial left of its root \param[in] start a place between the two */
template <int D>
HWY_INLINE Vec rootInBracket(const RayPolynomials<D>& f, Vec left, Vec right, Vec start, Vec sign,
                             Mask wanted) {
  const Vec zero = set(0.0f);
  Vec t = start;
  for (int step = 0; step < 12; ++step) {
    const Vec value = f.value(t), slope = f.slope(t);
    const Mask before = sign * value > zero;  // the root is right of t
    left = IfThenElse(before, t, left);
    right = IfThenElse(before, right, t);
    Vec next = t - value / slope;
    const Mask inside = And(next >= left, next <= right);
    next = IfThenElse(inside, next, set(0.5f) * (left + right));
    const Mask settled = And(inside, Abs(next - t) < set(1e-4f));
    t = next;
    if (AllTrue(Or(settled, Not(wanted)))) break;
  }
  return t;
}

/** A polynomial on a stretch that starts at 0, as f on [0, 1] and by Descartes' rule. */
template <int D>
struct Stretch {
  RayPolynomials<D> f;
  Vec first, last;    ///< f at 0 and 1
  Mask falls, rises;  ///< f's Bernstein coefficients change sign downwards, upwards

  HWY_INLINE Stretch(const RayPolynomials<D>& whole, Vec begin, Vec width) : f(whole) {
    static_assert(D == 3 || D == 4);
    f.shift(begin);
    Vec power = width;
    unrolled<D>([&](auto i) HWY_ATTR {
      f.a[i() + 1] *= power;
      power *= width;
    });
    const Vec* a = f.a;
    Vec b[D + 1];
    b[0] = a[0];
    if constexpr (D == 3) {
      b[1] = MulAdd(a[1], set(1.0f / 3.0f), a[0]);
      b[2] = MulAdd(MulAdd(set(2.0f), a[1], a[2]), set(1.0f / 3.0f), a[0]);
      b[3] = a[0] + a[1] + (a[2] + a[3]);
    } else {
      b[1] = MulAdd(a[1], set(0.25f), a[0]);
      b[2] = MulAdd(a[1], set(0.5f), MulAdd(a[2], set(1.0f / 6.0f), a[0]));
      b[3] = MulAdd(a[1], set(0.75f), MulAdd(a[2], set(0.5f), MulAdd(a[3], set(0.25f), a[0])));
      b[4] = a[0] + a[1] + (a[2] + a[3] + a[4]);
    }
    const Vec zero = set(0.0f);
    Mask above = b[0] > zero;
    falls = rises = zero < zero;
    unrolled<D>([&](auto i) HWY_ATTR {
      const Mask next = b[i() + 1] > zero;
      falls = Or(falls, AndNot(next, above));
      rises = Or(rises, AndNot(above, next));
      above = next;
    });
    first = b[0];
    last = b[D];
  }

  /** Lanes that may contain several roots. */
  HWY_INLINE Mask many() const { return And(falls, rises); }
  /** Lanes with exactly one root that counts; with front_only those at which f falls do. */
  HWY_INLINE Mask one(bool front_only) const {
    return front_only ? AndNot(rises, falls) : Xor(falls, rises);
  }

  /** The root in lanes with one, from 0 to 1. */
  HWY_INLINE Vec root(Mask wanted) const {
    const Vec sign = IfThenElse(rises, set(-1.0f), set(1.0f)), zero = set(0.0f);
    const Vec span = first - last;
    const Vec start = first / IfThenElse(span == zero, set(1.0f), span);
    return rootInBracket<D>(f, zero, set(1.0f), start, sign, wanted);
  }
};

/** Roots that lanes have, and lanes that need another way. */
struct FoundRoots {
  Vec at;
  Mask found, unclear;
};

/** Solves lanes one by one, in double: the root from 0 to length nearest to 0 that counts. */
template <int D>
HWY_NOINLINE void solveOneByOne(const RayPolynomials<D>& f, Vec length, bool front_only,
                                std::uint64_t& solved, FoundRoots& roots) {
  HWY_ALIGN float a[D + 1][16], lengths[16], at[16], found[16], wanted[16];
  for (int i = 0; i <= D; ++i) store(f.a[i], a[i]);
  store(length, lengths);
  store(roots.at, at);
  store(IfThenElseZero(roots.found, set(1.0f)), found);
  store(IfThenElseZero(roots.unclear, set(1.0f)), wanted);
  for (std::size_t i = 0; i < kLanes; ++i) {
    if (!(wanted[i] > 0.0f)) continue;
    double c[5] = {};
    for (int k = 0; k <= D; ++k) c[k] = a[k][i];
    double root = at[i];
    found[i] = nearestRootInInterval(D, c, 0.0, lengths[i], 0.0, front_only, root) ? 1.0f : 0.0f;
    at[i] = static_cast<float>(root);
    ++solved;
  }
  roots.at = load(at);
  roots.found = load(found) > set(0.0f);
}

/** The first root of f from 0 to length that counts, lane by lane. A lane walks on where Descartes'
 * rule shows no root that counts in its stretch, by twice as much the next time, and halves it
 * where there may be several; the few that have not come to an end after kMost stretches, where
 * roots all but coincide, are solved in double. */
template <int D>
HWY_NOINLINE FoundRoots firstRootAlong(const RayPolynomials<D>& f, Vec length, bool front_only,
                                       Mask active, std::uint64_t& solved) {
  constexpr int kMost = 12;
  const Vec zero = set(0.0f);
  FoundRoots roots{zero, zero < zero, And(active, length > zero)};
  Vec begin = zero, width = length, root_begin = zero, root_width = zero;
  for (int n = 0; n < kMost && !AllFalse(roots.unclear); ++n) {
    const Vec rest = length - begin;
    width = Min(width, rest);
    const Stretch<D> stretch(f, begin, width);
    const Mask many = stretch.many();
    const Mask one = And(roots.unclear, stretch.one(front_only));
    root_begin = IfThenElse(one, begin, root_begin);
    root_width = IfThenElse(one, width, root_width);
    roots.found = Or(roots.found, one);
    const Mask at_end = AndNot(many, width >= rest);
    roots.unclear = AndNot(Or(one, at_end), roots.unclear);
    begin = IfThenElse(many, begin, begin + width);
    width *= IfThenElse(many, set(0.5f), set(2.0f));
  }
  if (!AllFalse(roots.found)) {
    const Stretch<D> stretch(f, root_begin, root_width);
    roots.at = MulAdd(root_width, stretch.root(roots.found), root_begin);
  }
  if (!AllFalse(roots.unclear)) solveOneByOne<D>(f, length, front_only, solved, roots);
  return roots;
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE::lanes
HWY_AFTER_NAMESPACE();
#endif
