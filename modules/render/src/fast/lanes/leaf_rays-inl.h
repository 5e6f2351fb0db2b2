// SPDX-License-Identifier: BSD-3-Clause
// One leaf's polynomial along the rays of a block of pixels, a ray a lane. The guard toggles:
// Highway compiles a kernel file once per instruction set.
#if defined(PCL_SLIM_LEAF_RAYS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PCL_SLIM_LEAF_RAYS_INL
#undef PCL_SLIM_LEAF_RAYS_INL
#else
#define PCL_SLIM_LEAF_RAYS_INL
#endif

#include "fast/lanes/lanes-inl.h"
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
    Vec f = set(static_cast<float>(D)) * a[D];
    unrolled<D - 1>([&](auto i) HWY_ATTR {
      constexpr int kPower = D - 1 - i();
      f = MulAdd(f, t, set(static_cast<float>(kPower)) * a[kPower]);
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
  /** Lanes whose point at sigma is in the ball of a share of the radius. */
  HWY_INLINE Mask inBall(Vec sigma, float share_sq) const
  {
    const Vec m = scaleAt(sigma);
    return distanceSq(sigma) < set(share_sq) * (m * m);
  }
  /** Where rays enter and leave that ball. \return lanes that do. */
  HWY_INLINE Mask chord(float share_sq, Vec& low, Vec& high) const
  {
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
  HWY_INLINE explicit QuadraticRoots(const RayPolynomials<2>& f, bool front_only)
  {
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

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE::lanes
HWY_AFTER_NAMESPACE();
#endif
