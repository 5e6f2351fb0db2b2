// SPDX-License-Identifier: BSD-3-Clause
// Leaves side by side: their records in the camera's coordinates.
#include "fast/setup/leaf_setup.h"

#include <array>

#include "pcl_slim/core/symmetric.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fast/setup/leaf_setup.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

#include "fast/setup/camera_axes-inl.h"
#include "pcl_slim/surface/detail/kernel_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/** Norms of the forms of degree 2 to 4 of height polynomials: |form| <= norm |(u, v)|^n (Bombieri's
 * norm). */
struct FormNorms {
  Vec n[3];

  template <typename Coefficient>
  HWY_INLINE FormNorms(int degree, const Coefficient& c) {
    constexpr float kShares[3][5] = {{1.0f, 1.0f / 2.0f, 1.0f},
                                     {1.0f, 1.0f / 3.0f, 1.0f / 3.0f, 1.0f},
                                     {1.0f, 1.0f / 4.0f, 1.0f / 6.0f, 1.0f / 4.0f, 1.0f}};
    const Tag d;
    const auto square = [&](int k) HWY_ATTR { return c(k) * c(k); };
    for (int form = 2, k = 3; form <= 4; ++form) {
      Vec sum = Zero(d);
      for (int j = 0; j <= form && form <= degree; ++j, ++k) {
        sum = MulAdd(set(kShares[form - 2][j]), square(k), sum);
      }
      n[form - 2] = Sqrt(sum);
    }
  }

  /** Bound on |grad h - its value at the centre| over a disc. */
  HWY_INLINE Vec turn(float rho) const {
    const Vec high = MulAdd(set(4.0f * rho), n[2], set(3.0f) * n[1]);
    return set(rho) * MulAdd(set(rho), high, set(2.0f) * n[0]);
  }

  /** Bound on |h - its tangent plane at the centre| over a disc. */
  HWY_INLINE Vec bend(float rho) const {
    const Vec high = MulAdd(set(rho), n[2], n[1]);
    return set(rho * rho) * MulAdd(set(rho), high, n[0]);
  }
};

/** The tangent plane of a leaf at its centre, seen along the ray through the centre. */
struct CentreRay {
  Vec c0, c1, c2;
  Vec uc, vc, wc;  ///< the frame's axes times (x_c, y_c, 1)
  Vec eps;
};

/** Lanes in which f falls, and those in which it rises, along every ray in the ball of a share of the
 * radius: the slope along the ray through the centre exceeds what the bends of h and the directions
 * of the other rays change. */
struct Turns {
  Mask falls, rises;

  HWY_INLINE Turns(const CentreRay& ray, const Triple<Vec>& center, const FormNorms& norms,
                   float rho) {
    const Vec one = set(1.0f), length = Sqrt(dot3(center, center)), reach = set(rho) * ray.eps;
    // Between the rays through the centre and at the ball's rim, on the plane z = 1.
    const Vec aside = length * reach / Max(one - reach, set(1e-3f));
    const Vec along_plane = Sqrt(MulAdd(ray.uc, ray.uc, ray.vc * ray.vc)) + aside;
    const Vec gradient = Sqrt(MulAdd(ray.c1, ray.c1, MulAdd(ray.c2, ray.c2, one)));
    const Vec change = MulAdd(norms.turn(rho), along_plane, aside * gradient);
    const Vec slope = NegMulAdd(ray.c1, ray.uc, NegMulAdd(ray.c2, ray.vc, ray.wc));
    const Vec least = MulAdd(set(1e-3f), length, change);
    falls = Neg(slope) > least;
    rises = slope > least;
  }
};

/** A strip of the picture, in pixels from the centre's. */
struct Strip {
  Vec x, y;  ///< its direction
  Vec low, high;
};

/** The strip that contains the picture of a leaf's own surface inside the ball of a share of the
 * radius: across the surface's normal in the picture a slanting leaf is narrow.
 * \param[in] u,v,w the frame's axes as they move in the picture: (a_x - x_c a_z, a_y - y_c a_z) */
HWY_INLINE Strip stripOf(const Vec u[2], const Vec v[2], const Vec w[2], const CentreRay& ray,
                         const FormNorms& norms, Vec per_pixel, float rho) {
  const Vec one = set(1.0f), share = set(rho);
  const Vec length = Sqrt(MulAdd(w[0], w[0], w[1] * w[1]));
  const Vec inverse = one / Max(length, set(1e-6f));
  const Vec nx = w[0] * inverse, ny = w[1] * inverse;
  const Vec by_u = MulAdd(ray.c1, length, MulAdd(u[0], nx, u[1] * ny));
  const Vec by_v = MulAdd(ray.c2, length, MulAdd(v[0], nx, v[1] * ny));
  const Vec tilt = Sqrt(MulAdd(by_u, by_u, by_v * by_v));
  const Vec half = MulAdd(share, tilt, norms.bend(rho) * length);
  const Vec middle = ray.c0 * length;
  // The near side of the ball looks larger, the far side smaller.
  const Vec reach = Min(ray.eps, set(0.7f)) * share;
  const Vec pixel = set(1.001f) / per_pixel;
  const Vec near = pixel / (one - reach), far = pixel / (one + reach);
  const Vec low = middle - half, high = middle + half;
  const Vec margin = set(0.02f);
  return {nx, Neg(ny), Min(low * near, low * far) - margin, Max(high * near, high * far) + margin};
}

/** F = m^D f / r as sum_i sigma^i A_i(X, Y). */
template <int D>
class RayForm {
 public:
  using Axis = std::array<Vec, 3>;

  RayForm(const Axis& u, const Axis& v, const Axis& w, Vec xc, Vec yc, Vec eps)
      : u_(u), v_(v), w_(w), eps_(eps) {
    uc_ = slope(u, xc, yc);
    vc_ = slope(v, xc, yc);
    wc_ = slope(w, xc, yc);
  }

  /** \param[in] c coefficient k of the height polynomial. */
  template <typename Coefficient>
  HWY_INLINE void build(const Coefficient& c) {
    // f = w - c0 - c1 u - c2 v - ..., times m: every point of the ball divides by m once.
    const Vec c0 = c(0), c1 = c(1), c2 = c(2);
    a_[0][0] = Neg(c0);
    a_[0][1] = NegMulAdd(c1, u_[0], NegMulAdd(c2, v_[0], w_[0]));
    a_[0][2] = NegMulAdd(c1, u_[1], NegMulAdd(c2, v_[1], w_[1]));
    a_[1][0] = MulAdd(c0, eps_, NegMulAdd(c1, uc_, NegMulAdd(c2, vc_, wc_)));
    unrolled<D - 1>([&](auto step) HWY_ATTR {
      multiplyByM<2 + step()>();
      subtractForm<2 + step()>(c);
    });
  }

  /** The k-th coefficient, A_0's first. */
  HWY_INLINE Vec coefficient(int k) const {
    int i = 0;
    for (int n = numCoefficients(D); k >= n; n = numCoefficients(D - i)) {
      k -= n;
      ++i;
    }
    return a_[i][k];
  }

 private:
  HWY_INLINE Vec slope(const Axis& a, Vec xc, Vec yc) const {
    return MulAdd(a[0], xc, MulAdd(a[1], yc, a[2]));
  }

  /** Raises the degree to N: F <- (1 - eps sigma) F. */
  template <int N>
  HWY_INLINE void multiplyByM() {
    // From the highest power down, so that each step reads what is still unchanged.
    for (int i = N; i >= 0; --i) {
      const int old = i <= N - 1 ? numCoefficients(N - 1 - i) : 0;
      const int size = numCoefficients(N - i);
      for (int k = 0; k < size; ++k) {
        const Vec kept = k < old ? a_[i][k] : Zero(Tag());
        a_[i][k] = i > 0 ? NegMulAdd(eps_, a_[i - 1][k], kept) : kept;
      }
    }
  }

  /** F <- F - h_N(U, V), the form of degree N, by its polar forms. */
  template <int N, typename Coefficient>
  HWY_INLINE void subtractForm(const Coefficient& c) {
    Vec g[N + 1];
    for (int j = 0; j <= N; ++j) g[j] = c(numCoefficients(N - 1) + j);
    unrolled<N + 1>([&](auto step) HWY_ATTR {
      constexpr int kDegree = N - step();
      subtractTurned<kDegree>(g, a_[step()]);
      if constexpr (kDegree > 0) {
        const Vec share = set(1.0f / static_cast<float>(step() + 1));
        for (int j = 0; j < kDegree; ++j) {
          const Vec by_u = set(static_cast<float>(kDegree - j)) * g[j];
          const Vec by_v = set(static_cast<float>(j + 1)) * g[j + 1];
          g[j] = share * MulAdd(uc_, by_u, vc_ * by_v);
        }
      }
    });
  }

  /** Subtracts the form g of degree E in (u_x X + u_y Y, v_x X + v_y Y) from target. */
  template <int E>
  HWY_INLINE void subtractTurned(const Vec* g, Vec* target) const {
    constexpr int kFirst = E * (E + 1) / 2;
    Vec sum[E + 1], power[E + 1];
    sum[0] = g[0];
    power[0] = set(1.0f);
    for (int s = 1; s <= E; ++s) {
      timesLine(u_, s, sum);
      timesLine(v_, s, power);
      for (int j = 0; j <= s; ++j) sum[j] = MulAdd(g[s], power[j], sum[j]);
    }
    for (int j = 0; j <= E; ++j) target[kFirst + j] -= sum[j];
  }

  /** p <- (a_x X + a_y Y) p for a form p of degree s - 1. */
  HWY_INLINE void timesLine(const Axis& a, int s, Vec* p) const {
    p[s] = a[1] * p[s - 1];
    for (int j = s - 1; j > 0; --j) p[j] = MulAdd(a[0], p[j], a[1] * p[j - 1]);
    p[0] = a[0] * p[0];
  }

  Axis u_, v_, w_;
  Vec eps_, uc_, vc_, wc_;
  Vec a_[D + 1][numCoefficients(D)];
};

constexpr float kNearest = 0.7f;  ///< largest r / z_c of a leaf that is drawn by its polynomial

/** A circle in the picture, in pixels. */
struct Circle {
  Vec x, y, reach;
};

/** Encloses the picture of balls of a share of the radius. The picture of a ball is an ellipse; its
 * centre is at tan of the mean of the angles at which the ball begins and ends. */
HWY_INLINE Circle circleAround(const FrameView& view, const Triple<Vec>& p, Vec radius,
                               float share) {
  const Vec rho = radius * set(share);
  const Vec to_pixel = set(1.0f / view.pixel);
  Vec x = p.x, y = p.y, reach = rho;
  if (view.perspective) {
    const Vec rho_sq = rho * rho;
    const Vec inverse = set(1.0f) / NegMulAdd(rho, rho, p.z * p.z);
    const Vec along = p.z * inverse;
    x = p.x * along;
    y = p.y * along;
    reach = rho * inverse * Sqrt(dot3(p, p) - rho_sq);
  }
  const Vec wider = set(1.0f + 1e-4f);
  return {MulAdd(x, to_pixel, set(view.center_x)), NegMulAdd(y, to_pixel, set(view.center_y)),
          MulAdd(reach * to_pixel, wider, set(0.01f))};
}

/** Columns of a batch's records on their way out. */
class Outlet {
 public:
  HWY_INLINE void put(std::size_t column, Vec value) { Store(value, Tag(), rows_[column]); }
  float at(std::size_t column, std::size_t lane) const { return rows_[column][lane]; }

 private:
  HWY_ALIGN float rows_[FrameLeaf::formSize(kMaxDegree) + FrameLeaf::derivativeSize(kMaxDegree)]
                       [16];
};

/** The frame of leaves in the camera's axes. */
struct LeafAxes {
  Triple<Vec> u, v, w;

  LeafAxes(const Axes& axes, const FrameLanes<Vec>& frame)
      : u(axes.turn(frame.u)), v(axes.turn(frame.v)), w(axes.turn(frame.w)) {}
};

/** Everything but polynomials, as vectors. */
struct Heads {
  Vec pixel_x, pixel_y, per_pixel, eps, xc, yc, depth, inverse_depth;
  Vec radius, inverse_radius, beta, inverse_beta, nearest;

  Heads(const FrameView& view, const Triple<Vec>& p, Vec r, float share) {
    const Tag d;
    const Vec one = set(1.0f), zero = Zero(d), pixel = set(view.pixel);
    radius = r;
    inverse_radius = one / r;
    depth = p.z;
    const Vec reach = r * set(share * 1.0001f);
    const Vec begin = p.z - reach;
    Vec x = p.x, y = p.y;
    if (view.perspective) {
      inverse_depth = one / p.z;
      eps = r * inverse_depth;
      xc = x = p.x * inverse_depth;
      yc = y = p.y * inverse_depth;
      per_pixel = pixel * p.z * inverse_radius;
      beta = p.z * p.z * inverse_radius;
      // The rounding of depth values near the camera's own scale stays below this share.
      nearest = Neg(one) / begin * set(1.0f + 1e-6f);
    } else {
      inverse_depth = one;
      eps = xc = yc = zero;
      per_pixel = pixel * inverse_radius;
      beta = inverse_radius;
      nearest = begin - Abs(begin) * set(1e-6f);
    }
    inverse_beta = one / beta;
    const Vec to_pixel = set(1.0f / view.pixel);
    pixel_x = MulAdd(x, to_pixel, set(view.center_x));
    pixel_y = NegMulAdd(y, to_pixel, set(view.center_y));
  }
};

/** The strip of a batch's surfaces in the ball of pass 1. */
HWY_INLINE Strip stripOf(const Heads& h, const LeafAxes& frame, const CentreRay& ray,
                         const FormNorms& norms, const BallShares& shares) {
  const auto moves = [&](const Triple<Vec>& axis, Vec moved[2]) HWY_ATTR {
    moved[0] = NegMulAdd(h.xc, axis.z, axis.x);
    moved[1] = NegMulAdd(h.yc, axis.z, axis.y);
  };
  Vec u[2], v[2], w[2];
  moves(frame.u, u);
  moves(frame.v, v);
  moves(frame.w, w);
  return stripOf(u, v, w, ray, norms, h.per_pixel, shares.first);
}

/** Writes the members from x to strip_high of up to 16 records. */
HWY_INLINE void writeHeads(const LeafBatch& batch, std::size_t lane, const FrameView& view,
                           const Triple<Vec>& p, const Heads& h, const LeafAxes& frame,
                           const CentreRay& ray, const Strip& strip, const BallShares& shares) {
  constexpr std::size_t kCount = 35;
  static_assert(offsetof(FrameLeaf, inverse_cover_sq) == kCount * sizeof(float), "floats before");
  const Tag d;
  const Circle blend = circleAround(view, p, h.radius, shares.blend);
  const Circle first = circleAround(view, p, h.radius, shares.first);
  const Vec columns[kCount] = {h.pixel_x,   h.pixel_y,
                               h.per_pixel, h.eps,
                               h.xc,        h.yc,
                               h.depth,     h.inverse_depth,
                               h.radius,    h.inverse_radius,
                               h.beta,      h.inverse_beta,
                               h.nearest,   Load(d, batch.variance_weight + lane),
                               frame.u.x,   frame.u.y,
                               frame.u.z,   frame.v.x,
                               frame.v.y,   frame.v.z,
                               frame.w.x,   frame.w.y,
                               frame.w.z,   ray.uc,
                               ray.vc,      blend.x,
                               blend.y,     blend.reach,
                               first.x,     first.y,
                               first.reach, strip.x,
                               strip.y,     strip.low,
                               strip.high};
  Outlet out;
  for (std::size_t k = 0; k < kCount; ++k) out.put(k, columns[k]);
  for (std::size_t i = 0; i < hn::Lanes(d) && lane + i < batch.count; ++i) {
    float* target = reinterpret_cast<float*>(batch.target[lane + i]);
    for (std::size_t k = 0; k < kCount; ++k) target[k] = out.at(k, i);
  }
}

/** The derivatives that follow a record's form. */
template <int D, typename Coefficient>
HWY_INLINE void putDerivatives(const Heads& h, const LeafAxes& frame, const Coefficient& c,
                               std::size_t k, Outlet& out) {
  const auto times = [&](int factor, Vec v)
                         HWY_ATTR { return set(static_cast<float>(factor)) * v; };
  if constexpr (D == 2) {
    const Vec scale = Neg(h.inverse_radius);
    const Vec huu = times(2, scale * c(3)), huv = scale * c(4);
    const Vec hvv = times(2, scale * c(5));
    const Vec u[3] = {frame.u.x, frame.u.y, frame.u.z}, v[3] = {frame.v.x, frame.v.y, frame.v.z};
    for (int i = 0; i < 3; ++i) {
      const Vec by_u = MulAdd(huu, u[i], huv * v[i]);
      const Vec by_v = MulAdd(huv, u[i], hvv * v[i]);
      for (int j = i; j < 3; ++j) {
        out.put(k + static_cast<std::size_t>(kSymmetricEntry[i][j]),
                MulAdd(by_u, u[j], by_v * v[j]));
      }
    }
  } else {
    // d/du^a dv^b of u^i v^j, by the order of derivatives and of their coefficients.
    constexpr int kOrders[5][2] = {{1, 0}, {0, 1}, {2, 0}, {1, 1}, {0, 2}};
    for (const auto& [a, b] : kOrders) {
      for (int degree = 0; degree <= D - a - b; ++degree) {
        for (int j = 0; j <= degree; ++j) {
          int factor = 1;
          for (int n = 0; n < a; ++n) factor *= degree - j + a - n;
          for (int n = 0; n < b; ++n) factor *= j + b - n;
          const int whole = degree + a + b;
          out.put(k++, times(factor, c(whole * (whole + 1) / 2 + j + b)));
        }
      }
    }
  }
}

template <int D>
void setUpOfDegree(const LeafBatch& batch, const FrameView& view, const BallShares& shares) {
  constexpr int kFloats = FrameLeaf::formSize(D) + FrameLeaf::derivativeSize(D);
  const Tag d;
  const Axes axes(view);
  for (std::size_t lane = 0; lane < batch.count; lane += hn::Lanes(d)) {
    const auto load = [&](const float* column) HWY_ATTR { return Load(d, column + lane); };
    const auto c = [&](int k) HWY_ATTR { return load(batch.c[k]); };
    const Triple<Vec> p = axes.turn(fromEye(view, load(batch.x), load(batch.y), load(batch.z)));
    const Heads heads(view, p, load(batch.radius), 1.0f);
    const Triple<Vec> normal{load(batch.nx), load(batch.ny), load(batch.nz)};
    const LeafAxes frame(axes, FrameLanes<Vec>(normal));
    const Triple<Vec> center{heads.xc, heads.yc, set(1.0f)};
    const CentreRay ray{
        c(0),     c(1), c(2), dot3(frame.u, center), dot3(frame.v, center), dot3(frame.w, center),
        heads.eps};
    const FormNorms norms(D, c);
    writeHeads(batch, lane, view, p, heads, frame, ray, stripOf(heads, frame, ray, norms, shares),
               shares);
    RayForm<D> form({frame.u.x, frame.u.y, frame.u.z}, {frame.v.x, frame.v.y, frame.v.z},
                    {frame.w.x, frame.w.y, frame.w.z}, heads.xc, heads.yc, heads.eps);
    form.build(c);
    const Turns turns(ray, center, norms, shares.first);
    HWY_ALIGN float turned[16];
    Store(IfThenElse(turns.falls, set(-1.0f), IfThenElseZero(turns.rises, set(1.0f))), d, turned);
    Outlet out;
    constexpr auto kForm = static_cast<std::size_t>(FrameLeaf::formSize(D));
    for (std::size_t k = 0; k < kForm; ++k) out.put(k, form.coefficient(static_cast<int>(k)));
    putDerivatives<D>(heads, frame, c, kForm, out);
    for (std::size_t i = 0; i < hn::Lanes(d) && lane + i < batch.count; ++i) {
      FrameLeaf& leaf = *batch.target[lane + i];
      const bool drawable = leaf.depth > 0.0f && leaf.eps < kNearest;
      leaf.inverse_cover_sq = batch.inverse_cover_sq[lane + i];
      leaf.surfel = batch.surfel[lane + i];
      leaf.degree = view.perspective && !drawable ? kNearLeaf : static_cast<std::uint16_t>(D);
      leaf.turn = turned[i] < 0.0f   ? LeafTurn::kFalls
                  : turned[i] > 0.0f ? LeafTurn::kRises
                                     : LeafTurn::kEither;
      float* target = leaf.form();
      for (std::size_t k = 0; k < kFloats; ++k) target[k] = out.at(k, i);
    }
  }
}

void setUpLeaves(const LeafBatch& batch, int degree, const FrameView& view,
                 const BallShares& shares) {
  switch (degree) {
    case 2: return setUpOfDegree<2>(batch, view, shares);
    case 3: return setUpOfDegree<3>(batch, view, shares);
    default: return setUpOfDegree<4>(batch, view, shares);
  }
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_slim::detail::kernels {

HWY_EXPORT(setUpLeaves);

void setUpLeaves(const LeafBatch& batch, int degree, const FrameView& view,
                 const BallShares& shares) {
  HWY_DYNAMIC_DISPATCH(setUpLeaves)(batch, degree, view, shares);
}

}  // namespace pcl_slim::detail::kernels
#endif
