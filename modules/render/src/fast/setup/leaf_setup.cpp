// SPDX-License-Identifier: BSD-3-Clause
// Leaves side by side: their records in the camera's coordinates.
#include "fast/setup/leaf_setup.h"

#include "pcl_slim/core/symmetric.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fast/setup/leaf_setup.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

#include "fast/setup/camera_axes-inl.h"
#include "fast/setup/ray_forms-inl.h"
#include "fast/setup/surface_bounds-inl.h"
#include "pcl_slim/surface/detail/kernel_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr float kNearest = 0.7f;  ///< largest r / z_c of a leaf that is drawn by its polynomial

/** A circle in the picture, in pixels. */
struct Circle {
  Vec x, y, reach;
};

/** Encloses the picture of balls of a share of the radius. The picture of a ball is an ellipse; its
 * centre lies at tan of the mean of the angles at which the ball begins and ends. */
HWY_INLINE Circle
circleAround(const FrameView& view, const Triple& p, Vec radius, float share)
{
  const Tag d;
  const Vec rho = hn::Mul(radius, hn::Set(d, share));
  const Vec to_pixel = hn::Set(d, 1.0f / view.pixel);
  Vec x = p.x, y = p.y, reach = rho;
  if (view.perspective) {
    const Vec rho_sq = hn::Mul(rho, rho);
    const Vec inverse = hn::Div(hn::Set(d, 1.0f), hn::NegMulAdd(rho, rho, hn::Mul(p.z, p.z)));
    const Vec along = hn::Mul(p.z, inverse);
    x = hn::Mul(p.x, along);
    y = hn::Mul(p.y, along);
    reach = hn::Mul(hn::Mul(rho, inverse), hn::Sqrt(hn::Sub(dot3(p, p), rho_sq)));
  }
  const Vec wider = hn::Set(d, 1.0f + 1e-4f);
  return {hn::MulAdd(x, to_pixel, hn::Set(d, view.center_x)),
          hn::NegMulAdd(y, to_pixel, hn::Set(d, view.center_y)),
          hn::MulAdd(hn::Mul(reach, to_pixel), wider, hn::Set(d, 0.01f))};
}

/** Columns of a batch's records on their way out. */
class Outlet {
 public:
  HWY_INLINE void put(std::size_t column, Vec value) { hn::Store(value, Tag(), rows_[column]); }
  float at(std::size_t column, std::size_t lane) const { return rows_[column][lane]; }

 private:
  HWY_ALIGN float rows_[FrameLeaf::formSize(kMaxDegree) + FrameLeaf::derivativeSize(kMaxDegree)]
                       [16];
};

/** The frame of leaves in the camera's axes (Duff et al. 2017, as LocalFrame). */
struct LeafAxes {
  Triple u, v, w;

  LeafAxes(const Axes& axes, Vec nx, Vec ny, Vec nz)
  {
    const Tag d;
    const Vec one = hn::Set(d, 1.0f);
    const Vec sign = hn::CopySign(one, nz);
    const Vec a = hn::Div(hn::Neg(one), hn::Add(sign, nz));
    const Vec b = hn::Mul(hn::Mul(nx, ny), a);
    const Vec sx = hn::Mul(sign, nx);
    u = axes.turn({hn::MulAdd(hn::Mul(sx, nx), a, one), hn::Mul(sign, b), hn::Neg(sx)});
    v = axes.turn({b, hn::MulAdd(hn::Mul(ny, ny), a, sign), hn::Neg(ny)});
    w = axes.turn({nx, ny, nz});
  }
};

/** Everything but polynomials, as vectors. */
struct Heads {
  Vec pixel_x, pixel_y, per_pixel, eps, xc, yc, depth, inverse_depth;
  Vec radius, inverse_radius, beta, inverse_beta, nearest;

  Heads(const FrameView& view, const Triple& p, Vec r, float share)
  {
    const Tag d;
    const Vec one = hn::Set(d, 1.0f), zero = hn::Zero(d), pixel = hn::Set(d, view.pixel);
    radius = r;
    inverse_radius = hn::Div(one, r);
    depth = p.z;
    const Vec reach = hn::Mul(r, hn::Set(d, share * 1.0001f));
    const Vec begin = hn::Sub(p.z, reach);
    Vec x = p.x, y = p.y;
    if (view.perspective) {
      inverse_depth = hn::Div(one, p.z);
      eps = hn::Mul(r, inverse_depth);
      xc = x = hn::Mul(p.x, inverse_depth);
      yc = y = hn::Mul(p.y, inverse_depth);
      per_pixel = hn::Mul(hn::Mul(pixel, p.z), inverse_radius);
      beta = hn::Mul(hn::Mul(p.z, p.z), inverse_radius);
      // The rounding of depth values near the camera's own scale stays below this share.
      nearest = hn::Mul(hn::Div(hn::Neg(one), begin), hn::Set(d, 1.0f + 1e-6f));
    } else {
      inverse_depth = one;
      eps = xc = yc = zero;
      per_pixel = hn::Mul(pixel, inverse_radius);
      beta = inverse_radius;
      nearest = hn::Sub(begin, hn::Mul(hn::Abs(begin), hn::Set(d, 1e-6f)));
    }
    inverse_beta = hn::Div(one, beta);
    const Vec to_pixel = hn::Set(d, 1.0f / view.pixel);
    pixel_x = hn::MulAdd(x, to_pixel, hn::Set(d, view.center_x));
    pixel_y = hn::NegMulAdd(y, to_pixel, hn::Set(d, view.center_y));
  }
};

/** The strip of a batch's surfaces in the ball of pass 1. */
HWY_INLINE Strip
stripOf(const Heads& h, const LeafAxes& frame, const CentreRay& ray, const FormNorms& norms,
        const BallShares& shares)
{
  const auto moves = [&](const Triple& axis, Vec moved[2]) HWY_ATTR {
    moved[0] = hn::NegMulAdd(h.xc, axis.z, axis.x);
    moved[1] = hn::NegMulAdd(h.yc, axis.z, axis.y);
  };
  Vec u[2], v[2], w[2];
  moves(frame.u, u);
  moves(frame.v, v);
  moves(frame.w, w);
  return stripOf(u, v, w, ray, norms, h.per_pixel, shares.first);
}

/** Writes the members from x to strip_high of up to 16 records. */
HWY_INLINE void
writeHeads(const LeafBatch& batch, std::size_t lane, const FrameView& view, const Triple& p,
           const Heads& h, const LeafAxes& frame, const CentreRay& ray, const Strip& strip,
           const BallShares& shares)
{
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
                               h.nearest,   hn::Load(d, batch.variance_weight + lane),
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
HWY_INLINE void
putDerivatives(const Heads& h, const LeafAxes& frame, const Coefficient& c, std::size_t k,
               Outlet& out)
{
  const Tag d;
  const auto times = [&](int factor, Vec v)
                         HWY_ATTR { return hn::Mul(hn::Set(d, static_cast<float>(factor)), v); };
  if constexpr (D == 2) {
    const Vec scale = hn::Neg(h.inverse_radius);
    const Vec huu = times(2, hn::Mul(scale, c(3))), huv = hn::Mul(scale, c(4));
    const Vec hvv = times(2, hn::Mul(scale, c(5)));
    const Vec u[3] = {frame.u.x, frame.u.y, frame.u.z}, v[3] = {frame.v.x, frame.v.y, frame.v.z};
    for (int i = 0; i < 3; ++i) {
      const Vec by_u = hn::MulAdd(huu, u[i], hn::Mul(huv, v[i]));
      const Vec by_v = hn::MulAdd(huv, u[i], hn::Mul(hvv, v[i]));
      for (int j = i; j < 3; ++j) {
        out.put(k + static_cast<std::size_t>(kSymmetricEntry[i][j]),
                hn::MulAdd(by_u, u[j], hn::Mul(by_v, v[j])));
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
void
setUpOfDegree(const LeafBatch& batch, const FrameView& view, const BallShares& shares)
{
  constexpr int kFloats = FrameLeaf::formSize(D) + FrameLeaf::derivativeSize(D);
  const Tag d;
  const Axes axes(view);
  for (std::size_t lane = 0; lane < batch.count; lane += hn::Lanes(d)) {
    const auto load = [&](const float* column) HWY_ATTR { return hn::Load(d, column + lane); };
    const auto c = [&](int k) HWY_ATTR { return load(batch.c[k]); };
    const Triple p = axes.turn(fromEye(view, load(batch.x), load(batch.y), load(batch.z)));
    const Heads heads(view, p, load(batch.radius), 1.0f);
    const LeafAxes frame(axes, load(batch.nx), load(batch.ny), load(batch.nz));
    const Triple center{heads.xc, heads.yc, hn::Set(d, 1.0f)};
    const CentreRay ray{
        c(0),     c(1), c(2), dot3(frame.u, center), dot3(frame.v, center), dot3(frame.w, center),
        heads.eps};
    const FormNorms norms(D, c);
    writeHeads(batch, lane, view, p, heads, frame, ray, stripOf(heads, frame, ray, norms, shares),
               shares);
    RayForm<D> form({frame.u.x, frame.u.y, frame.u.z}, {frame.v.x, frame.v.y, frame.v.z},
                    {frame.w.x, frame.w.y, frame.w.z}, heads.xc, heads.yc, heads.eps);
    form.build(c);
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
      float* target = leaf.form();
      for (std::size_t k = 0; k < kFloats; ++k) target[k] = out.at(k, i);
    }
  }
}

void
setUpLeaves(const LeafBatch& batch, int degree, const FrameView& view, const BallShares& shares)
{
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

void
setUpLeaves(const LeafBatch& batch, int degree, const FrameView& view, const BallShares& shares)
{
  HWY_DYNAMIC_DISPATCH(setUpLeaves)(batch, degree, view, shares);
}

}  // namespace pcl_slim::detail::kernels
#endif
