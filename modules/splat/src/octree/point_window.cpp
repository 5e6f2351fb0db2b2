// SPDX-License-Identifier: BSD-3-Clause
#include "octree/octree.h"

#include <algorithm>
#include <cstring>
#include <functional>

#include "kernels/splat_kernels.h"

// Prefetches the cache line of an address. A macro, as GCC takes a function for one without effect.
#if defined(__GNUC__)
#define PCL_SLIM_PREFETCH(address) __builtin_prefetch(address)
#else
#define PCL_SLIM_PREFETCH(address) static_cast<void>(address)
#endif

namespace pcl_slim::detail {
namespace {

/** Reads points' records, in any order, into columns. */
class PointFetcher {
 public:
  static constexpr std::size_t kBlock = 64;  ///< points converted at a time
  static constexpr std::size_t kAhead = 24;  ///< points between prefetch and use of one

  PointFetcher(const OctreeFrame& frame, const OctreeSource& source);

  /** Fetches n points. points: their places in the caller's arrays, and kBlock + kAhead places more
   * that may be read; columns: aligned, with room for kBlock more. */
  void run(const std::uint32_t* points, std::size_t n,
           const std::array<float*, PointWindow::kNumColumns>& columns) const;

 private:
  /** One attribute: an address, and bytes from one point to the next. */
  struct Attribute {
    const unsigned char* first = nullptr;
    std::size_t stride = 0;

    const unsigned char* of(std::size_t point) const { return first + point * stride; }
  };

  template <typename T>
  void positions(const std::uint32_t* points, std::size_t n, float* const out[3]) const;
  void vectors(const Attribute& attribute, const std::uint32_t* points, std::size_t n,
               float* const out[3]) const;
  void colors(const std::uint32_t* points, std::size_t n, float* const out[3]) const;

  const OctreeFrame& frame_;
  const LabTable& table_;
  bool doubles_;
  std::uint32_t last_;  ///< place behind which there may be no fourth float
  Attribute xyz_, normal_, bgr_;
  /** Attributes together in memory, and bytes from its begin to its last one. */
  struct Stretch {
    Attribute begin;
    std::size_t span = 0;
  };

  std::array<Stretch, 3> stretches_;
  std::size_t num_stretches_ = 0;
};

constexpr std::size_t kLine = 64;  ///< bytes that come into the cache together
constexpr std::size_t kVector = 4 * sizeof(float);
constexpr std::size_t kStep = 16;  ///< points prefetched and read in turn

/** Stretches of memory with a point's attributes; those of one record, as in PCL's clouds, are
 * one stretch. */
class Stretches {
 public:
  struct Stretch {
    const unsigned char *begin, *last;
    std::size_t stride;
  };

  void add(const void* first, std::size_t stride, std::size_t bytes) {
    if (!first) return;
    const auto* begin = static_cast<const unsigned char*>(first);
    const Stretch one = {begin, begin + bytes - 1, stride};
    Stretch& whole = all_[0];
    const bool together =
        size_ > 0 && whole.stride == stride && stride <= kLine &&
        std::less<>()(std::max(whole.last, one.last), std::min(whole.begin, one.begin) + kLine);
    if (!together) {
      all_[size_++] = one;
    } else {
      whole.begin = std::min(whole.begin, one.begin);
      whole.last = std::max(whole.last, one.last);
    }
  }

  const Stretch* begin() const { return all_; }
  const Stretch* end() const { return all_ + size_; }

 private:
  Stretch all_[3] = {};
  int size_ = 0;
};

PointFetcher::PointFetcher(const OctreeFrame& frame, const OctreeSource& source)
    : frame_(frame),
      table_(source.table),
      doubles_(source.cloud.scalar == CloudView::Scalar::kDouble),
      last_(static_cast<std::uint32_t>(source.cloud.size - 1)),
      xyz_{static_cast<const unsigned char*>(source.cloud.xyz), source.cloud.xyz_stride},
      normal_{static_cast<const unsigned char*>(source.cloud.normal), source.cloud.normal_stride},
      bgr_{static_cast<const unsigned char*>(source.colors.bgr), source.colors.stride} {
  Stretches stretches;
  stretches.add(xyz_.first, xyz_.stride, 3 * (doubles_ ? sizeof(double) : sizeof(float)));
  stretches.add(normal_.first, normal_.stride, 3 * sizeof(float));
  stretches.add(bgr_.first, bgr_.stride, 3);
  for (const auto& stretch : stretches) {
    stretches_[num_stretches_++] = {{stretch.begin, stretch.stride},
                                    static_cast<std::size_t>(stretch.last - stretch.begin)};
  }
}

template <typename T>
void PointFetcher::positions(const std::uint32_t* points, std::size_t n,
                             float* const out[3]) const {
  for (std::size_t k = 0; k < n; ++k) {
    T world[3];
    float cells[3];
    std::memcpy(world, xyz_.of(points[k]), sizeof(world));
    frame_.position(world, cells);
    for (int a = 0; a < 3; ++a) out[a][k] = cells[a];
  }
}

void PointFetcher::vectors(const Attribute& attribute, const std::uint32_t* points, std::size_t n,
                           float* const out[3]) const {
  std::uint32_t at_end = 0;
  for (std::size_t k = 0; k < n; ++k) at_end |= static_cast<std::uint32_t>(points[k] == last_);
  if (!at_end && attribute.stride >= kVector && n % 4 == 0) {
    splat_kernels::gatherVectors(attribute.first, attribute.stride, points, n, out[0], out[1],
                                 out[2]);
    return;
  }
  for (std::size_t k = 0; k < n; ++k) {
    float v[3];
    std::memcpy(v, attribute.of(points[k]), sizeof(v));
    for (int a = 0; a < 3; ++a) out[a][k] = v[a];
  }
}

void PointFetcher::colors(const std::uint32_t* points, std::size_t n, float* const out[3]) const {
  for (std::size_t k = 0; k < n; ++k) {
    const unsigned char* bgr = bgr_.of(points[k]);
    const float blue = table_.linear(bgr[0]), green = table_.linear(bgr[1]),
                red = table_.linear(bgr[2]);
    out[0][k] = red, out[1][k] = green, out[2][k] = blue;
  }
}

void PointFetcher::run(const std::uint32_t* points, std::size_t n,
                       const std::array<float*, PointWindow::kNumColumns>& columns) const {
  const auto at = [&](PointWindow::Column first, std::size_t k) {
    return std::array<float*, 3>{columns[first] + k, columns[first + 1] + k,
                                 columns[first + 2] + k};
  };
  const Stretch stretch = stretches_[0];
  for (std::size_t begin = 0; begin < n; begin += kBlock) {
    for (std::size_t k = begin; k < std::min(n, begin + kBlock); k += kStep) {
      const std::size_t count = std::min(kStep, n - k);
      // Points are in any order: each is prefetched before its turn, at both ends.
      for (std::size_t i = k + kAhead; i < k + kAhead + count; ++i) {
        PCL_SLIM_PREFETCH(stretch.begin.of(points[i]));
        PCL_SLIM_PREFETCH(stretch.begin.of(points[i]) + stretch.span);
        for (std::size_t s = 1; s < num_stretches_; ++s) {
          PCL_SLIM_PREFETCH(stretches_[s].begin.of(points[i]));
          PCL_SLIM_PREFETCH(stretches_[s].begin.of(points[i]) + stretches_[s].span);
        }
      }
      const auto xyz = at(PointWindow::kX, k);
      if (doubles_) {
        positions<double>(points + k, count, xyz.data());
      } else {
        vectors(xyz_, points + k, count, xyz.data());
      }
      if (normal_.first) vectors(normal_, points + k, count, at(PointWindow::kNormalX, k).data());
      if (bgr_.first) colors(points + k, count, at(PointWindow::kL, k).data());
    }
    const auto xyz = at(PointWindow::kX, begin), normal = at(PointWindow::kNormalX, begin),
               lab = at(PointWindow::kL, begin);
    if (!doubles_) splat_kernels::toCells(frame_, xyz[0], xyz[1], xyz[2], kBlock);
    if (normal_.first) splat_kernels::normalize(normal[0], normal[1], normal[2], kBlock);
    if (bgr_.first) table_.labOfLinear(lab[0], lab[1], lab[2], kBlock);
  }
}

}  // namespace

const std::uint32_t* PointWindow::fetchOrder(const OctreeCloud& cloud, const OctreeSource& source) {
  constexpr std::size_t kMore = PointFetcher::kBlock + PointFetcher::kAhead;
  const std::size_t n = end_ - begin_;
  order_.resize(n + kMore);
  for (std::size_t i = 0; i < n; ++i) order_[i] = cloud.order(begin_ + i);
  std::fill_n(order_.data() + n, kMore, order_[n - 1]);
  if (!source.cloud.indices) return order_.data();
  inputs_.resize(n + kMore);
  for (std::size_t i = 0; i < n + kMore; ++i) {
    inputs_[i] = static_cast<std::uint32_t>(source.cloud.inputIndex(order_[i]));
  }
  return inputs_.data();
}

void PointWindow::load(const OctreeCloud& cloud, const OctreeSource& source, std::size_t begin,
                       std::size_t end) {
  begin_ = begin;
  end_ = end;
  const std::size_t n = end - begin;
  std::array<float*, kNumColumns> columns;
  for (std::size_t c = 0; c < kNumColumns; ++c) {
    columns_[c].resize(n + PointFetcher::kBlock);
    columns[c] = columns_[c].data();
    std::fill_n(columns[c] + n, PointFetcher::kBlock, 0.0f);
    // What no point has stays zero.
    const bool missing = c >= kL ? !source.colors.bgr : c >= kNormalX && !source.cloud.normal;
    if (missing) std::fill_n(columns[c], n, 0.0f);
  }
  PointFetcher(cloud.frame(), source).run(fetchOrder(cloud, source), n, columns);
}

void PointWindow::loadAround(const OctreeCloud& cloud, const OctreeSource& source,
                             std::size_t begin, std::size_t end, std::size_t reach) {
  load(cloud, source, begin - std::min(begin, reach), std::min(cloud.size(), end + reach));
}

}  // namespace pcl_slim::detail
