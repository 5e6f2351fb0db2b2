// SPDX-License-Identifier: BSD-3-Clause
// Principal and radial curvatures of a picture's pixels, a vector of neighbours at a time.
#include "lines/frame_rows.h"

#include <cstdint>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lines/frame_rows.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

#include "pcl_slim/surface/detail/kernel_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

constexpr float kLeastFacing = 0.15f;    ///< crest lines seen flatter are not told from noise
constexpr float kLeastRadial = 0.342f;   ///< sin 20 degrees: DeCarlo et al. 2003
constexpr float kContourFacing = 0.05f;  ///< flatter than that belongs to the contour itself
constexpr float kLeastLength = 1e-6f;
constexpr float kFar = 1e30f;  ///< depths beyond it are those of pixels that show nothing

/** A vector per lane. */
struct Lanes3 {
  Vec x, y, z;
};

HWY_INLINE Vec
set(float value)
{
  return hn::Set(Tag(), value);
}

HWY_INLINE Lanes3
set(const std::array<float, 3>& v)
{
  return {set(v[0]), set(v[1]), set(v[2])};
}

HWY_INLINE Vec
dot(const Lanes3& a, const Lanes3& b)
{
  return dot3(a.x, a.y, a.z, b.x, b.y, b.z);
}

/** a + s b. */
HWY_INLINE Lanes3
along(const Lanes3& a, Vec s, const Lanes3& b)
{
  return {hn::MulAdd(s, b.x, a.x), hn::MulAdd(s, b.y, a.y), hn::MulAdd(s, b.z, a.z)};
}

HWY_INLINE Lanes3
scaled(const Lanes3& a, Vec s)
{
  return {hn::Mul(a.x, s), hn::Mul(a.y, s), hn::Mul(a.z, s)};
}

/** Neighbouring pixels' columns and where their rays go. */
class Pixels {
 public:
  HWY_INLINE Pixels(const PictureRow& row, int first) : row_(row)
  {
    const hn::RebindToSigned<Tag> integers;
    // Past the row's end its last pixel is read again.
    place_ = hn::Min(hn::Iota(integers, first), hn::Set(integers, row.width - 1));
    depth_ = hn::GatherIndex(Tag(), row.depth, place_);
    covered = hn::Lt(depth_, set(kFar));
  }

  HWY_INLINE void load()
  {
    normal = load3(row_.normal);
    gradient = load3(row_.gradient);
    length = hn::Sqrt(dot(gradient, gradient));
    const Vec steps = hn::ConvertTo(Tag(), place_);
    x_ = hn::MulAdd(steps, set(row_.pixel), set(row_.left));
    y_ = set(row_.height);
    if (!row_.perspective) x_ = y_ = set(0.0f);
    const Lanes3 towards = along(along(set(row_.forward), x_, set(row_.right)), y_, set(row_.up));
    const Vec inverse = hn::Div(set(1.0f), hn::Sqrt(dot(towards, towards)));
    ray = scaled(towards, inverse);
    const Vec ahead = row_.perspective ? hn::Mul(depth_, inverse) : set(1.0f);
    per_pixel_ = hn::Div(set(1.0f), hn::Mul(set(row_.pixel), ahead));
    facing = hn::Neg(dot(normal, ray));
    for (int k = 0; k < 6; ++k) hessian_[k] = load(row_.hessian, 6, k);
  }

  /** The Hessian times a vector. */
  HWY_INLINE Lanes3 bent(const Lanes3& v) const
  {
    const Vec* const h = hessian_;
    return {dot3(h[0], h[1], h[2], v.x, v.y, v.z), dot3(h[1], h[3], h[4], v.x, v.y, v.z),
            dot3(h[2], h[4], h[5], v.x, v.y, v.z)};
  }

  /** Writes a curvature, its tangent and the tangent's image, the latter two in some lanes. */
  HWY_INLINE void put(Vec k, const Lanes3& tangent, Mask shown, int first, FrameRow& frames) const
  {
    const Tag d;
    const Vec ahead = dot(tangent, set(row_.forward));
    const Vec across = hn::NegMulAdd(ahead, x_, dot(tangent, set(row_.right)));
    const Vec down = hn::MulSub(ahead, y_, dot(tangent, set(row_.up)));
    hn::Store(k, d, frames.k.data() + first);
    const Vec columns[] = {tangent.x, tangent.y, tangent.z};
    for (int a = 0; a < 3; ++a) {
      hn::Store(hn::IfThenElseZero(shown, columns[a]), d, frames.direction[a].data() + first);
    }
    const Vec screen[] = {hn::Mul(across, per_pixel_), hn::Mul(down, per_pixel_)};
    for (int a = 0; a < 2; ++a) {
      hn::Store(hn::IfThenElseZero(shown, screen[a]), d, frames.screen[a].data() + first);
    }
  }

  Mask covered;
  Lanes3 normal, gradient, ray;
  Vec length, facing;  ///< of the gradient; cosine of the way to the viewer and the normal

 private:
  HWY_INLINE Vec load(const float* column, int stride, int entry) const
  {
    const hn::RebindToSigned<Tag> integers;
    return hn::GatherIndex(Tag(), column + entry, hn::Mul(place_, hn::Set(integers, stride)));
  }
  HWY_INLINE Lanes3 load3(const float* column) const
  {
    return {load(column, 3, 0), load(column, 3, 1), load(column, 3, 2)};
  }

  const PictureRow& row_;
  hn::Vec<hn::RebindToSigned<Tag>> place_;
  Vec depth_, x_, y_, per_pixel_, hessian_[6];
};

/** Two unit tangents that make a frame with a unit normal. */
HWY_INLINE void
tangents(const Lanes3& n, Lanes3& a, Lanes3& b)
{
  const Vec one = set(1.0f), sign = hn::IfThenElse(hn::Ge(n.z, set(0.0f)), one, set(-1.0f));
  const Vec q = hn::Div(set(-1.0f), hn::Add(sign, n.z)), p = hn::Mul(hn::Mul(n.x, n.y), q);
  const Vec xx = hn::Mul(hn::Mul(n.x, n.x), q), yy = hn::Mul(hn::Mul(n.y, n.y), q);
  a = {hn::MulAdd(sign, xx, one), hn::Mul(sign, p), hn::Neg(hn::Mul(sign, n.x))};
  b = {p, hn::Add(sign, yy), hn::Neg(n.y)};
}

/** Principal curvatures k1 >= k2 of symmetric 2x2 matrices and the angle of the first. */
struct Principal {
  Vec k1, k2, cosine, sine;

  HWY_INLINE Principal(Vec aa, Vec ab, Vec bb)
  {
    const Vec half = hn::Mul(set(0.5f), hn::Sub(aa, bb));
    const Vec mean = hn::Mul(set(0.5f), hn::Add(aa, bb));
    const Vec root = hn::Sqrt(hn::MulAdd(half, half, hn::Mul(ab, ab)));
    k1 = hn::Add(mean, root);
    k2 = hn::Sub(mean, root);
    // The half angle of (half, ab), without trigonometry.
    const Mask left = hn::Lt(half, set(0.0f));
    const Vec x = hn::IfThenElse(left, ab, hn::Add(half, root));
    const Vec y = hn::IfThenElse(left, hn::Sub(root, half), ab);
    const Vec length = hn::Sqrt(hn::MulAdd(x, x, hn::Mul(y, y)));
    const Mask bent = hn::Gt(length, set(0.0f));
    const Vec inverse = hn::Div(set(1.0f), hn::IfThenElse(bent, length, set(1.0f)));
    cosine = hn::IfThenElse(bent, hn::Mul(x, inverse), set(1.0f));
    sine = hn::IfThenElse(bent, hn::Mul(y, inverse), set(0.0f));
  }
};

HWY_INLINE void
putNothing(int first, FrameRow& frames)
{
  const Tag d;
  hn::Store(hn::Zero(d), d, frames.k.data() + first);
  for (auto& column : frames.direction) hn::Store(hn::Zero(d), d, column.data() + first);
  for (auto& column : frames.screen) hn::Store(hn::Zero(d), d, column.data() + first);
}

/** Runs body(pixels, first) for the vectors of a row that show anything. */
template <typename Body>
HWY_INLINE void
forShown(const PictureRow& row, FrameRow& frames, const Body& body)
{
  const Tag d;
  for (int first = 0; first < row.width; first += static_cast<int>(hn::Lanes(d))) {
    Pixels pixels(row, first);
    if (hn::AllFalse(d, pixels.covered)) {
      putNothing(first, frames);
      continue;
    }
    pixels.load();
    body(pixels, first);
  }
}

void
crestFrames(const PictureRow& row, FrameRow& frames)
{
  forShown(row, frames, [&](const Pixels& pixels, int first) HWY_ATTR {
    const Mask usable = hn::And(pixels.covered, hn::And(hn::Gt(pixels.length, set(0.0f)),
                                                        hn::Ge(pixels.facing, set(kLeastFacing))));
    Lanes3 a, b;
    tangents(pixels.normal, a, b);
    const Lanes3 ha = pixels.bent(a), hb = pixels.bent(b);
    const Vec inverse = hn::Div(set(1.0f), hn::IfThenElse(usable, pixels.length, set(1.0f)));
    const Principal found(hn::Mul(dot(a, ha), inverse), hn::Mul(dot(a, hb), inverse),
                          hn::Mul(dot(b, hb), inverse));
    const Mask bulges = hn::Gt(found.k1, hn::Neg(found.k2));
    const Vec k = hn::IfThenElse(bulges, found.k1, found.k2);
    const Vec c = hn::IfThenElse(bulges, found.cosine, hn::Neg(found.sine));
    const Vec s = hn::IfThenElse(bulges, found.sine, found.cosine);
    pixels.put(hn::IfThenElseZero(usable, k), along(scaled(a, c), s, b), usable, first, frames);
  });
}

void
radialFrames(const PictureRow& row, FrameRow& frames)
{
  forShown(row, frames, [&](const Pixels& pixels, int first) HWY_ATTR {
    const Lanes3 back = scaled(pixels.ray, set(-1.0f));
    const Lanes3 w = along(back, hn::Neg(pixels.facing), pixels.normal);
    const Vec w_length = hn::Sqrt(dot(w, w));
    const Mask usable = hn::And(pixels.covered, hn::And(hn::Gt(pixels.length, set(0.0f)),
                                                        hn::Ge(w_length, set(kLeastLength))));
    const Lanes3 unit = scaled(w, hn::Div(set(1.0f), hn::IfThenElse(usable, w_length, set(1.0f))));
    const Vec k =
        hn::Div(dot(unit, pixels.bent(unit)), hn::IfThenElse(usable, pixels.length, set(1.0f)));
    const Mask shown = hn::And(usable, hn::And(hn::Ge(pixels.facing, set(kContourFacing)),
                                               hn::Ge(w_length, set(kLeastRadial))));
    pixels.put(hn::IfThenElseZero(usable, k), unit, shown, first, frames);
  });
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_slim::detail {

FrameRow::FrameRow(int width)
{
  const std::size_t padded = (static_cast<std::size_t>(width) + 15) / 16 * 16;
  k.resize(padded);
  for (auto& column : direction) column.resize(padded);
  for (auto& column : screen) column.resize(padded);
}

namespace kernels {

HWY_EXPORT(crestFrames);
void
crestFrames(const PictureRow& row, FrameRow& frames)
{
  HWY_DYNAMIC_DISPATCH(crestFrames)(row, frames);
}

HWY_EXPORT(radialFrames);
void
radialFrames(const PictureRow& row, FrameRow& frames)
{
  HWY_DYNAMIC_DISPATCH(radialFrames)(row, frames);
}

}  // namespace kernels
}  // namespace pcl_slim::detail
#endif
