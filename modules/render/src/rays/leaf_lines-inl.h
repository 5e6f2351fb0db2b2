// SPDX-License-Identifier: BSD-3-Clause
// The polynomials of a block's leaves along one ray, a leaf a lane, and one ray's or one point's
// way down a tree of eight children a node. The guard toggles: Highway compiles a kernel file once
// per instruction set.
#if defined(PCL_SLIM_LEAF_LINES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PCL_SLIM_LEAF_LINES_INL
#undef PCL_SLIM_LEAF_LINES_INL
#else
#define PCL_SLIM_LEAF_LINES_INL
#endif

#include <algorithm>
#include <cmath>

#include "hwy/highway.h"
#include "pcl_slim/leaf/detail/line-inl.h"
#include "pcl_slim/query/detail/ray_surfel.h"
#include "pcl_slim/surface/detail/kernel_math-inl.h"
#include "rays/ray_scene.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE::rays {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = hn::CappedTag<float, kWide>;
using Vec = hn::Vec<Tag>;
using Mask = hn::Mask<Tag>;

HWY_INLINE Vec set(float value) {
  return Set(Tag(), value);
}

/** One bit a lane. */
HWY_INLINE unsigned bitsOf(Mask mask) {
  std::uint8_t bits[8] = {};
  StoreMaskBits(Tag(), mask, bits);
  return bits[0];
}

using Triad = Triple<Vec>;

/** Vec k, k + 1, ... of a block. */
struct BlockLanes {
  const float* columns;
  std::size_t k;

  HWY_INLINE Vec column(std::size_t c) const { return Load(Tag(), columns + c * kWide + k); }
  /** Coefficient i of the leaves' polynomials. */
  HWY_INLINE Vec operator()(int i) const {
    return column(kBlockCoefficients + static_cast<std::size_t>(i));
  }

  /** The leaves' frames. */
  HWY_INLINE FrameLanes<Vec> frames() const {
    return FrameLanes<Vec>({column(kBlockNX), column(kBlockNY), column(kBlockNZ)});
  }

  /** A point relative to the block, relative to the centres and in radii. */
  HWY_INLINE Triad place(const float point[3]) const {
    const Vec inverse = column(kBlockInverseRadius);
    return {(set(point[0]) - column(kBlockX)) * inverse,
            (set(point[1]) - column(kBlockY)) * inverse,
            (set(point[2]) - column(kBlockZ)) * inverse};
  }
};

/** f / r of a block's leaves along one line; D: 2, 3 or 4. */
template <int D>
using LeafLines = LinePolynomial<D, Vec>;

constexpr std::size_t kStack = 7 * 64 + 8;  ///< seven siblings are left at each of 64 levels

/** A ray in single precision, from a point next to the tree on. */
struct Line {
  double shift = 0.0;  ///< depth of that point
  float origin[3], inverse[3];
  std::size_t near_row[3];

  Line(const Ray& ray, const Box& bounds) {
    Vector3 middle{};
    double reach = 0.0;
    for (std::size_t a = 0; a < 3; ++a) {
      middle[a] = 0.5 * (double{bounds.low[a]} + bounds.high[a]);
      const double half = 0.5 * (double{bounds.high[a]} - bounds.low[a]);
      reach += half * half;
    }
    shift = std::max(0.0, dot(subtract(middle, ray.origin), ray.direction) - std::sqrt(reach));
    const Vector3 start = along(ray.origin, shift, ray.direction);
    for (std::size_t a = 0; a < 3; ++a) {
      constexpr double kLeast = 1e-18;  // keeps 0 times infinity out of the boxes' distances
      const double slope = std::abs(ray.direction[a]) > kLeast
                               ? ray.direction[a]
                               : std::copysign(kLeast, ray.direction[a]);
      origin[a] = static_cast<float>(start[a]);
      inverse[a] = static_cast<float>(1.0 / slope);
      near_row[a] = 2 * a + (slope < 0.0 ? 1 : 0);
    }
  }
};

/** Children whose boxes a line meets between two depths, and where it enters them. */
HWY_INLINE unsigned meetChildren(const WideBoxes& boxes, const Line& line, float from, float to,
                                 float* entry) {
  const Tag d;
  unsigned bits = 0;
  for (std::size_t k = 0; k < kWide; k += hn::Lanes(d)) {
    Vec near = set(from), far = set(to);
    for (std::size_t a = 0; a < 3; ++a) {
      const Vec origin = set(line.origin[a]), inverse = set(line.inverse[a]);
      const Vec first = Load(d, boxes.bound[line.near_row[a]] + k);
      const Vec last = Load(d, boxes.bound[line.near_row[a] ^ 1u] + k);
      near = Max(near, (first - origin) * inverse);
      far = Min(far, (last - origin) * inverse);
    }
    Store(near, d, entry + k);
    bits |= bitsOf(near <= far) << k;
  }
  return bits;
}

/** The same of boxes widened by base, and by slope times how far their farthest corner may be from
 * the ray's own origin: a pixel's length there. */
HWY_INLINE unsigned meetWidened(const WideBoxes& boxes, const Line& line, const RayWidth& width,
                                float from, float to, float* entry) {
  const Tag d;
  unsigned bits = 0;
  for (std::size_t k = 0; k < kWide; k += hn::Lanes(d)) {
    Vec low[3], high[3], away = set(static_cast<float>(line.shift));
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = Load(d, boxes.bound[2 * a] + k) - set(line.origin[a]);
      high[a] = Load(d, boxes.bound[2 * a + 1] + k) - set(line.origin[a]);
      away += Max(Abs(low[a]), Abs(high[a]));
    }
    const Vec wider = MulAdd(set(width.slope), away, set(width.base));
    Vec near = set(from), far = set(to);
    for (std::size_t a = 0; a < 3; ++a) {
      const Vec one = (low[a] - wider) * set(line.inverse[a]);
      const Vec two = (high[a] + wider) * set(line.inverse[a]);
      near = Max(near, Min(one, two));
      far = Min(far, Max(one, two));
    }
    Store(near, d, entry + k);
    bits |= bitsOf(near <= far) << k;
  }
  return bits;
}

/** Children whose wider box contains a point. */
HWY_INLINE unsigned childrenAround(const WideBoxes& boxes, const float point[3]) {
  const Tag d;
  unsigned bits = 0;
  for (std::size_t k = 0; k < kWide; k += hn::Lanes(d)) {
    const auto within = [&](std::size_t a) HWY_ATTR {
      const Vec p = set(point[a]);
      return And(Load(d, boxes.bound[2 * a] + k) <= p, Load(d, boxes.bound[2 * a + 1] + k) >= p);
    };
    bits |= bitsOf(And(within(0), And(within(1), within(2)))) << k;
  }
  return bits;
}

/** A child to be visited, and where the ray enters it. */
struct Visit {
  std::uint32_t child;
  float entry;
};

/** Visits the blocks that a line meets, roughly from near to far, until body returns false.
 * \param[in] until a depth less the line's shift, read anew at every step
 * \param[in] meet unsigned(node's number, float* entry): children that the line meets
 * \param[in] body bool(block) */
template <typename Meet, typename Body>
HWY_INLINE void walkAlong(const WideTree& tree, float from, const float& until,
                          std::uint64_t& nodes, const Meet& meet, const Body& body) {
  Visit stack[kStack];
  std::size_t top = 0;
  stack[top++] = {0, from};
  while (top > 0) {
    const Visit at = stack[--top];
    if (!(at.entry <= until)) continue;
    if ((at.child & WideNode::kBlock) != 0) {
      if (!body(at.child & ~WideNode::kBlock)) return;
      continue;
    }
    ++nodes;
    const WideNode& node = tree.nodes[at.child];
    HWY_ALIGN float entry[kWide];
    const std::size_t first = top;
    for (unsigned bits = meet(at.child, entry); bits != 0; bits &= bits - 1) {
      const auto k = static_cast<std::size_t>(__builtin_ctz(bits));
      std::size_t place = top++;
      for (; place > first && stack[place - 1].entry < entry[k]; --place) {
        stack[place] = stack[place - 1];
      }
      stack[place] = {node.child[k], entry[k]};
    }
  }
}

/** Visits the blocks whose wider box contains a point. */
template <typename Body>
HWY_INLINE void walkAround(const WideTree& tree, const float point[3], std::uint64_t& nodes,
                           const Body& body) {
  std::uint32_t stack[kStack];
  std::size_t top = 0;
  stack[top++] = 0;
  while (top > 0) {
    const std::uint32_t at = stack[--top];
    if ((at & WideNode::kBlock) != 0) {
      body(at & ~WideNode::kBlock);
      continue;
    }
    ++nodes;
    for (unsigned bits = childrenAround(tree.reach[at], point); bits != 0; bits &= bits - 1) {
      stack[top++] = tree.nodes[at].child[__builtin_ctz(bits)];
    }
  }
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE::rays
HWY_AFTER_NAMESPACE();
#endif
