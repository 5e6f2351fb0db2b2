// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/cloud/detail/block_kernels.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "pcl_slim/cloud/morton.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "index/block_kernels.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

#include "pcl_slim/core/detail/lane_packing-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = hn::CappedTag<float, 16>;
using Vec = hn::Vec<Tag>;

template <typename Mask>
std::uint32_t maskBits(Tag d, Mask mask) {
  std::uint8_t bits[8] = {};
  StoreMaskBits(d, mask, bits);
  return static_cast<std::uint32_t>(bits[0]) | static_cast<std::uint32_t>(bits[1]) << 8;
}

/** Which lanes' boxes meet one ball. */
class BallTest {
 public:
  BallTest(const float center[3], float radius) : radius_sq_(Set(Tag(), radius * radius)) {
    for (int a = 0; a < 3; ++a) center_[a] = Set(Tag(), center[a]);
  }

  HWY_INLINE hn::Mask<Tag> operator()(const BlockTree::Level& boxes, std::size_t j) const {
    const Tag d;
    const auto outside = [&](const float* low, const float* high, Vec c) HWY_ATTR {
      return Max(Zero(d), Max(Load(d, low + j) - c, c - Load(d, high + j)));
    };
    const Vec ex = outside(boxes.min_x.data(), boxes.max_x.data(), center_[0]);
    const Vec ey = outside(boxes.min_y.data(), boxes.max_y.data(), center_[1]);
    const Vec ez = outside(boxes.min_z.data(), boxes.max_z.data(), center_[2]);
    return MulAdd(ex, ex, MulAdd(ey, ey, ez * ez)) <= radius_sq_;
  }

 private:
  Vec center_[3], radius_sq_;
};

std::uint32_t boxesInBall(const BlockTree::Level& boxes, std::size_t first, const float center[3],
                          float radius) {
  const Tag d;
  const BallTest meets(center, radius);
  std::uint32_t hits = 0;
  for (std::size_t i = 0; i < BlockTree::kFan; i += hn::Lanes(d)) {
    hits |= maskBits(d, meets(boxes, first + i)) << i;
  }
  return hits;
}

std::size_t groupedBoxesInBall(const BlockTree::Level& groups, const std::uint32_t* ids,
                               const BlockTree::Level& boxes, const float center[3], float radius,
                               std::uint32_t* found) {
  const Tag d;
  const hn::RebindToUnsigned<Tag> du;
  const BallTest meets(center, radius);
  std::size_t count = 0;
  for (std::size_t g = 0; g < groups.count; g += hn::Lanes(d)) {
    for (std::uint32_t hits = maskBits(d, meets(groups, g)); hits != 0; hits &= hits - 1) {
      const std::uint32_t id = ids[g + static_cast<std::size_t>(__builtin_ctz(hits))];
      const std::size_t first = id * BlockTree::kFan;
      for (std::size_t i = first; i < first + BlockTree::kFan; i += hn::Lanes(d)) {
        const LanePacking packing(d, meets(boxes, i));
        packing.store(Iota(du, static_cast<std::uint32_t>(i)), found + count);
        count += packing.count();
      }
    }
  }
  return count;
}

std::uint32_t boxesInBox(const BlockTree::Level& boxes, std::size_t first, const float min[3],
                         const float max[3]) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  std::uint32_t hits = 0;
  for (std::size_t i = 0; i < BlockTree::kFan; i += lanes) {
    const std::size_t j = first + i;
    const auto meets = [&](const float* low, const float* high, int axis) {
      return And(Load(d, low + j) <= Set(d, max[axis]), Load(d, high + j) >= Set(d, min[axis]));
    };
    const auto all = And(meets(boxes.min_x.data(), boxes.max_x.data(), 0),
                         And(meets(boxes.min_y.data(), boxes.max_y.data(), 1),
                             meets(boxes.min_z.data(), boxes.max_z.data(), 2)));
    hits |= maskBits(d, all) << i;
  }
  return hits;
}

std::size_t pointsUpTo(const PointStore& store, const std::uint32_t* blocks, std::size_t num_blocks,
                       const double center[3], float limit_sq, float* distances_sq,
                       std::uint32_t* points) {
  const Tag d;
  const hn::RebindToUnsigned<Tag> du;
  const auto limit = Set(d, limit_sq);
  std::size_t count = 0;
  for (std::size_t k = 0; k < num_blocks; ++k) {
    const std::size_t b = blocks[k];
    const auto sx = Set(d, static_cast<float>(store.blockOriginX()[b] - center[0]));
    const auto sy = Set(d, static_cast<float>(store.blockOriginY()[b] - center[1]));
    const auto sz = Set(d, static_cast<float>(store.blockOriginZ()[b] - center[2]));
    const std::size_t end = (b + 1) * PointStore::kBlock;
    for (std::size_t i = b * PointStore::kBlock; i < end; i += hn::Lanes(d)) {
      const auto dx = Load(d, store.x() + i) + sx;
      const auto dy = Load(d, store.y() + i) + sy;
      const auto dz = Load(d, store.z() + i) + sz;
      const auto distance_sq = MulAdd(dx, dx, MulAdd(dy, dy, dz * dz));
      const auto near = distance_sq <= limit;
      if (AllFalse(d, near)) continue;
      const LanePacking packing(d, near);
      packing.store(distance_sq, distances_sq + count);
      packing.store(Iota(du, static_cast<std::uint32_t>(i)), points + count);
      count += packing.count();
    }
  }
  return count;
}

/** How many of n values are at most a limit. */
HWY_INLINE std::size_t countUpTo(const float* values, std::size_t n, float limit) {
  const Tag d;
  std::size_t count = 0, i = 0;
  for (; i + hn::Lanes(d) <= n; i += hn::Lanes(d))
    count += CountTrue(d, LoadU(d, values + i) <= Set(d, limit));
  for (; i < n; ++i) count += values[i] <= limit;
  return count;
}

/** A float's bits, which ascend like floats that are not negative. */
std::uint32_t bitsOf(float value) {
  std::uint32_t bits;
  std::memcpy(&bits, &value, sizeof(bits));
  return bits;
}

float ofBits(std::uint32_t bits) {
  float value;
  std::memcpy(&value, &bits, sizeof(value));
  return value;
}

/** The values above a lower limit and up to an upper one, in a buffer that has room for a vector
 * more. */
HWY_INLINE std::size_t valuesBetween(const float* values, std::size_t n, float low, float high,
                                     float* found) {
  const Tag d;
  std::size_t count = 0, i = 0;
  for (; i + hn::Lanes(d) <= n; i += hn::Lanes(d)) {
    const auto v = LoadU(d, values + i);
    const auto between = And(v > Set(d, low), v <= Set(d, high));
    if (AllFalse(d, between)) continue;
    const LanePacking packing(d, between);
    packing.store(v, found + count);
    count += packing.count();
  }
  for (; i < n; ++i) {
    if (values[i] > low && values[i] <= high) found[count++] = values[i];
  }
  return count;
}

/** The least and the greatest of n values. */
HWY_INLINE std::pair<float, float> rangeOf(const float* values, std::size_t n) {
  const Tag d;
  auto least = Set(d, values[0]), most = least;
  std::size_t i = 0;
  for (; i + hn::Lanes(d) <= n; i += hn::Lanes(d)) {
    const auto v = LoadU(d, values + i);
    least = Min(least, v);
    most = Max(most, v);
  }
  float low = GetLane(MinOfLanes(d, least)), high = GetLane(MaxOfLanes(d, most));
  for (; i < n; ++i) {
    low = std::min(low, values[i]);
    high = std::max(high, values[i]);
  }
  return {low, high};
}

float kthSmallest(const float* values, std::size_t n, std::size_t k) {
  constexpr std::size_t kFew = 32;
  auto [low, high] = rangeOf(values, n);
  std::size_t below = countUpTo(values, n, low), upTo = n;
  if (below >= k) return low;
  // Squared distances from a point of a surface are about evenly spread: their rank predicts where
  // the k-th is. Limits alternate between a little above and below; every third halves the bracket.
  for (int round = 0; upTo - below > kFew; ++round) {
    const auto span = static_cast<double>(upTo - below);
    const double margin = (round % 3 == 0 ? 1 : -1) * (4 + span / 64);
    const double part = (static_cast<double>(k - below) + margin) / span;
    float limit = low + static_cast<float>(part) * (high - low);
    if (round % 3 == 2 || !(limit > low && limit < high)) {
      const std::uint32_t bits = bitsOf(low) + (bitsOf(high) - bitsOf(low)) / 2;
      if (bits == bitsOf(low)) return high;
      limit = ofBits(bits);
    }
    const std::size_t count = countUpTo(values, n, limit);
    (count >= k ? high : low) = limit;
    (count >= k ? upTo : below) = count;
  }
  float few[kFew + 16] = {};
  const std::size_t count = valuesBetween(values, n, low, high, few);
  float* const kth = few + (k - below - 1);
  std::nth_element(few, kth, few + count);
  return *kth;
}

std::size_t valuesUpTo(const float* values, const std::uint32_t* points, std::size_t n, float limit,
                       std::uint32_t* found) {
  const Tag d;
  const hn::RebindToUnsigned<Tag> du;
  std::size_t count = 0, i = 0;
  for (; i + hn::Lanes(d) <= n; i += hn::Lanes(d)) {
    const auto within = LoadU(d, values + i) <= Set(d, limit);
    if (AllFalse(d, within)) continue;
    const LanePacking packing(d, within);
    packing.store(LoadU(du, points + i), found + count);
    count += packing.count();
  }
  for (; i < n; ++i) {
    found[count] = points[i];
    count += values[i] <= limit;
  }
  return count;
}

/** How many points of a block are within a squared distance of a point at these offsets from
 * the block's origin. */
HWY_INLINE std::size_t pointsOfBlockUpTo(const PointStore& store, std::size_t block, float x,
                                         float y, float z, float limit_sq) {
  const Tag d;
  std::size_t count = 0;
  for (std::size_t i = block * PointStore::kBlock; i < (block + 1) * PointStore::kBlock;
       i += hn::Lanes(d)) {
    const auto dx = Load(d, store.x() + i) - Set(d, x);
    const auto dy = Load(d, store.y() + i) - Set(d, y);
    const auto dz = Load(d, store.z() + i) - Set(d, z);
    const auto distance_sq = MulAdd(dx, dx, MulAdd(dy, dy, dz * dz));
    count += CountTrue(d, distance_sq <= Set(d, limit_sq));
  }
  return count;
}

std::uint32_t sparsePoints(const PointStore& store, std::size_t block, float limit_sq,
                           std::size_t others) {
  constexpr std::size_t kSide = 2;  // blocks before and after
  std::uint32_t sparse = 0;
  for (std::size_t k = 0; k < PointStore::kBlock; ++k) {
    const std::size_t i = block * PointStore::kBlock + k;
    const float x = store.x()[i], y = store.y()[i], z = store.z()[i];
    std::size_t count = pointsOfBlockUpTo(store, block, x, y, z, limit_sq);
    const std::size_t first = block - std::min(block, kSide),
                      last = std::min(block + kSide, store.numBlocks() - 1);
    for (std::size_t b = first; b <= last && count <= others; ++b) {
      if (b == block) continue;
      const float sx = store.blockOriginX()[block] - store.blockOriginX()[b],
                  sy = store.blockOriginY()[block] - store.blockOriginY()[b],
                  sz = store.blockOriginZ()[block] - store.blockOriginZ()[b];
      count += pointsOfBlockUpTo(store, b, x + sx, y + sy, z + sz, limit_sq);
    }
    sparse |= static_cast<std::uint32_t>(count <= others) << k;
  }
  return sparse;
}

/** As mortonCell() has it, in the low bits of each lane. */
template <class D, class V>
HWY_INLINE hn::Vec<hn::RebindToUnsigned<D>> mortonCells(D d, V local) {
  const hn::RebindToUnsigned<D> du;
  const V cells = Set(d, static_cast<double>(1 << kMortonBits));
  const V cell = (local + Set(d, 0.5)) * cells;
  const V last = cells - Set(d, 1.0);
  const V whole = Floor(Min(Max(cell, Zero(d)), last));
  // Beyond 2^52 a double's low bits count ones.
  return BitCast(du, whole + Set(d, 0x1p52)) & Set(du, (std::uint64_t{1} << kMortonBits) - 1);
}

/** As the scalar spreadBits() has it. */
template <class DU, class V>
HWY_INLINE V spreadLanes(DU du, V v) {
  v = (v | hn::ShiftLeft<32>(v)) & Set(du, 0x1f00000000ffffULL);
  v = (v | hn::ShiftLeft<16>(v)) & Set(du, 0x1f0000ff0000ffULL);
  v = (v | hn::ShiftLeft<8>(v)) & Set(du, 0x100f00f00f00f00fULL);
  v = (v | hn::ShiftLeft<4>(v)) & Set(du, 0x10c30c30c30c30c3ULL);
  return (v | hn::ShiftLeft<2>(v)) & Set(du, 0x1249249249249249ULL);
}

void mortonCodes(const double (&positions)[3][kMortonBatch], const double origin[3],
                 double inverse_scale, std::uint64_t* codes) {
  const hn::CappedTag<double, 8> d;
  const hn::RebindToUnsigned<decltype(d)> du;
  const auto scale = Set(d, inverse_scale);
  for (std::size_t i = 0; i < kMortonBatch; i += hn::Lanes(d)) {
    const auto spread = [&](int axis) HWY_ATTR {
      const auto offset = Load(d, positions[axis] + i) - Set(d, origin[axis]);
      return spreadLanes(du, mortonCells(d, offset * scale));
    };
    const auto code = hn::ShiftLeft<2>(spread(0)) | hn::ShiftLeft<1>(spread(1)) | spread(2);
    Store(code, du, codes + i);
  }
}

const char* instructionSet() {
  return hwy::TargetName(HWY_TARGET);
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_slim::detail::kernels {

HWY_EXPORT(boxesInBall);
std::uint32_t boxesInBall(const BlockTree::Level& boxes, std::size_t first, const float center[3],
                          float radius) {
  return HWY_DYNAMIC_DISPATCH(boxesInBall)(boxes, first, center, radius);
}

HWY_EXPORT(groupedBoxesInBall);
std::size_t groupedBoxesInBall(const BlockTree::Level& groups, const std::uint32_t* ids,
                               const BlockTree::Level& boxes, const float center[3], float radius,
                               std::uint32_t* found) {
  return HWY_DYNAMIC_DISPATCH(groupedBoxesInBall)(groups, ids, boxes, center, radius, found);
}

HWY_EXPORT(boxesInBox);
std::uint32_t boxesInBox(const BlockTree::Level& boxes, std::size_t first, const float min[3],
                         const float max[3]) {
  return HWY_DYNAMIC_DISPATCH(boxesInBox)(boxes, first, min, max);
}

HWY_EXPORT(pointsUpTo);
std::size_t pointsUpTo(const PointStore& store, const std::uint32_t* blocks, std::size_t num_blocks,
                       const double center[3], float limit_sq, float* distances_sq,
                       std::uint32_t* points) {
  return HWY_DYNAMIC_DISPATCH(pointsUpTo)(store, blocks, num_blocks, center, limit_sq, distances_sq,
                                          points);
}

HWY_EXPORT(kthSmallest);
float kthSmallest(const float* values, std::size_t n, std::size_t k) {
  return HWY_DYNAMIC_DISPATCH(kthSmallest)(values, n, k);
}

HWY_EXPORT(valuesUpTo);
std::size_t valuesUpTo(const float* values, const std::uint32_t* points, std::size_t n, float limit,
                       std::uint32_t* found) {
  return HWY_DYNAMIC_DISPATCH(valuesUpTo)(values, points, n, limit, found);
}

HWY_EXPORT(sparsePoints);
std::uint32_t sparsePoints(const PointStore& store, std::size_t block, float limit_sq,
                           std::size_t others) {
  return HWY_DYNAMIC_DISPATCH(sparsePoints)(store, block, limit_sq, others);
}

HWY_EXPORT(mortonCodes);
void mortonCodes(const double (&positions)[3][kMortonBatch], const double origin[3],
                 double inverse_scale, std::uint64_t* codes) {
  HWY_DYNAMIC_DISPATCH(mortonCodes)(positions, origin, inverse_scale, codes);
}

HWY_EXPORT(instructionSet);
const char* instructionSet() {
  return HWY_DYNAMIC_DISPATCH(instructionSet)();
}

}  // namespace pcl_slim::detail::kernels
#endif
