// SPDX-License-Identifier: BSD-3-Clause
// Principal and radial curvatures of a picture's pixels, a vector of neighbours at a time.
#include "lines/lines.h"

#include <cstdint>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lines/frame_rows.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

#include "pcl_slim/surface/detail/kernel_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

constexpr float kLeastFacing = 0.15f;    ///< crest lines seen flatter are lost in noise
constexpr float kLeastRadial = 0.342f;   ///< sin 20 degrees: DeCarlo et al. 2003
constexpr float kContourFacing = 0.05f;  ///< flatter than that belongs to the contour itself
constexpr float kLeastLength = 1e-6f;
constexpr float kFar = 1e30f;  ///< depths beyond it are those of pixels that show nothing

/** A vector per lane. */
struct Lanes3 {
  Vec x, y, z;
};

HWY_INLINE Lanes3 set(const std::array<float, 3>& v) {
  return {set(v[0]), set(v[1]), set(v[2])};
}

HWY_INLINE Vec dot(const Lanes3& a, const Lanes3& b) {
  return dot3(a.x, a.y, a.z, b.x, b.y, b.z);
}

/** a + s b. */
HWY_INLINE Lanes3 along(const Lanes3& a, Vec s, const Lanes3& b) {
  return {MulAdd(s, b.x, a.x), MulAdd(s, b.y, a.y), MulAdd(s, b.z, a.z)};
}

HWY_INLINE Lanes3 scaled(const Lanes3& a, Vec s) {
  return {a.x * s, a.y * s, a.z * s};
}

/** Neighbouring pixels' columns and where their rays go. */
class Pixels {
 public:
  HWY_INLINE Pixels(const PictureRow& row, int first) : row_(row) {
    const hn::RebindToSigned<Tag> integers;
    // Past the row's end its last pixel is read again.
    place_ = Min(Iota(integers, first), Set(integers, row.width - 1));
    depth_ = GatherIndex(Tag(), row.depth, place_);
    covered = depth_ < set(kFar);
  }

  HWY_INLINE void load() {
    normal = load3(row_.normal);
    gradient = load3(row_.gradient);
    length = Sqrt(dot(gradient, gradient));
    const Vec steps = ConvertTo(Tag(), place_);
    x_ = MulAdd(steps, set(row_.pixel), set(row_.left));
    y_ = set(row_.height);
    if (!row_.perspective) x_ = y_ = set(0.0f);
    const Lanes3 towards = along(along(set(row_.forward), x_, set(row_.right)), y_, set(row_.up));
    const Vec inverse = set(1.0f) / Sqrt(dot(towards, towards));
    ray = scaled(towards, inverse);
    const Vec ahead = row_.perspective ? depth_ * inverse : set(1.0f);
    per_pixel_ = set(1.0f) / (set(row_.pixel) * ahead);
    facing = Neg(dot(normal, ray));
    for (int k = 0; k < 6; ++k) hessian_[k] = load(row_.hessian, 6, k);
  }

  /** The Hessian times a vector. */
  HWY_INLINE Lanes3 bent(const Lanes3& v) const {
    const Vec* const h = hessian_;
    return {dot3(h[0], h[1], h[2], v.x, v.y, v.z), dot3(h[1], h[3], h[4], v.x, v.y, v.z),
            dot3(h[2], h[4], h[5], v.x, v.y, v.z)};
  }

  /** Writes a curvature, its tangent and the tangent's image, the latter two in some lanes. */
  HWY_INLINE void put(Vec k, const Lanes3& tangent, Mask shown, int first, FrameRow& frames) const {
    const Tag d;
    const Vec ahead = dot(tangent, set(row_.forward));
    const Vec across = NegMulAdd(ahead, x_, dot(tangent, set(row_.right)));
    const Vec down = MulSub(ahead, y_, dot(tangent, set(row_.up)));
    Store(k, d, frames.k.data() + first);
    const Vec columns[] = {tangent.x, tangent.y, tangent.z};
    for (int a = 0; a < 3; ++a) {
      Store(IfThenElseZero(shown, columns[a]), d, frames.direction[a].data() + first);
    }
    const Vec screen[] = {across * per_pixel_, down * per_pixel_};
    for (int a = 0; a < 2; ++a) {
      Store(IfThenElseZero(shown, screen[a]), d, frames.screen[a].data() + first);
    }
  }

  Mask covered;
  Lanes3 normal, gradient, ray;
  Vec length, facing;  ///< of the gradient; cosine of the way to the viewer and the normal

 private:
  HWY_INLINE Vec load(const float* column, int stride, int entry) const {
    const hn::RebindToSigned<Tag> integers;
    return GatherIndex(Tag(), column + entry, place_ * Set(integers, stride));
  }
  HWY_INLINE Lanes3 load3(const float* column) const {
    return {load(column, 3, 0), load(column, 3, 1), load(column, 3, 2)};
  }

  const PictureRow& row_;
  hn::Vec<hn::RebindToSigned<Tag>> place_;
  Vec depth_, x_, y_, per_pixel_, hessian_[6];
};

/** Two unit tangents that make a frame with a unit normal. */
HWY_INLINE void tangents(const Lanes3& n, Lanes3& a, Lanes3& b) {
  const Vec one = set(1.0f), sign = IfThenElse(n.z >= set(0.0f), one, set(-1.0f));
  const Vec q = set(-1.0f) / (sign + n.z), p = n.x * n.y * q;
  const Vec xx = n.x * n.x * q, yy = n.y * n.y * q;
  a = {MulAdd(sign, xx, one), sign * p, Neg(sign * n.x)};
  b = {p, sign + yy, Neg(n.y)};
}

/** Principal curvatures k1 >= k2 of symmetric 2x2 matrices and the angle of the first. */
struct Principal {
  Vec k1, k2, cosine, sine;

  HWY_INLINE Principal(Vec aa, Vec ab, Vec bb) {
    const Vec half = set(0.5f) * (aa - bb);
    const Vec mean = set(0.5f) * (aa + bb);
    const Vec root = Sqrt(MulAdd(half, half, ab * ab));
    k1 = mean + root;
    k2 = mean - root;
    // The half angle of (half, ab), without trigonometry.
    const Mask left = half < set(0.0f);
    const Vec x = IfThenElse(left, ab, half + root);
    const Vec y = IfThenElse(left, root - half, ab);
    const Vec length = Sqrt(MulAdd(x, x, y * y));
    const Mask bent = length > set(0.0f);
    const Vec inverse = set(1.0f) / IfThenElse(bent, length, set(1.0f));
    cosine = IfThenElse(bent, x * inverse, set(1.0f));
    sine = IfThenElse(bent, y * inverse, set(0.0f));
  }
};

HWY_INLINE void putNothing(int first, FrameRow& frames) {
  const Tag d;
  Store(Zero(d), d, frames.k.data() + first);
  for (auto& column : frames.direction) Store(Zero(d), d, column.data() + first);
  for (auto& column : frames.screen) Store(Zero(d), d, column.data() + first);
}

/** Runs body(pixels, first) for the vectors of a row that show anything. */
template <typename Body>
HWY_INLINE void forShown(const PictureRow& row, FrameRow& frames, const Body& body) {
  const Tag d;
  for (int first = 0; first < row.width; first += static_cast<int>(hn::Lanes(d))) {
    Pixels pixels(row, first);
    if (AllFalse(d, pixels.covered)) {
      putNothing(first, frames);
      continue;
    }
    pixels.load();
    body(pixels, first);
  }
}

void crestFrames(const PictureRow& row, FrameRow& frames) {
  forShown(row, frames, [&](const Pixels& pixels, int first) HWY_ATTR {
    const Mask usable = And(pixels.covered, pixels.length > set(0.0f));
    const Mask shown = And(usable, pixels.facing >= set(kLeastFacing));
    Lanes3 a, b;
    tangents(pixels.normal, a, b);
    const Lanes3 ha = pixels.bent(a), hb = pixels.bent(b);
    const Vec inverse = set(1.0f) / IfThenElse(usable, pixels.length, set(1.0f));
    const Principal found(dot(a, ha) * inverse, dot(a, hb) * inverse, dot(b, hb) * inverse);
    const Mask bulges = found.k1 > Neg(found.k2);
    const Vec k = IfThenElse(bulges, found.k1, found.k2);
    const Vec c = IfThenElse(bulges, found.cosine, Neg(found.sine));
    const Vec s = IfThenElse(bulges, found.sine, found.cosine);
    pixels.put(IfThenElseZero(usable, k), along(scaled(a, c), s, b), shown, first, frames);
  });
}

void radialFrames(const PictureRow& row, FrameRow& frames) {
  forShown(row, frames, [&](const Pixels& pixels, int first) HWY_ATTR {
    const Lanes3 back = scaled(pixels.ray, set(-1.0f));
    const Lanes3 w = along(back, Neg(pixels.facing), pixels.normal);
    const Vec w_length = Sqrt(dot(w, w));
    const Mask usable =
        And(pixels.covered, And(pixels.length > set(0.0f), w_length >= set(kLeastLength)));
    const Lanes3 unit = scaled(w, set(1.0f) / IfThenElse(usable, w_length, set(1.0f)));
    const Vec k = dot(unit, pixels.bent(unit)) / IfThenElse(usable, pixels.length, set(1.0f));
    const Mask shown =
        And(usable, And(pixels.facing >= set(kContourFacing), w_length >= set(kLeastRadial)));
    pixels.put(IfThenElseZero(usable, k), unit, shown, first, frames);
  });
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_slim::detail {

FrameRow::FrameRow(int width) {
  const std::size_t padded = (static_cast<std::size_t>(width) + 15) / 16 * 16;
  k.resize(padded);
  for (auto& column : direction) column.resize(padded);
  for (auto& column : screen) column.resize(padded);
}

namespace kernels {

HWY_EXPORT(crestFrames);
void crestFrames(const PictureRow& row, FrameRow& frames) {
  HWY_DYNAMIC_DISPATCH(crestFrames)(row, frames);
}

HWY_EXPORT(radialFrames);
void radialFrames(const PictureRow& row, FrameRow& frames) {
  HWY_DYNAMIC_DISPATCH(radialFrames)(row, frames);
}

}  // namespace kernels
}  // namespace pcl_slim::detail
#endif
