// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "pcl_slim/cloud/morton.h"
#include "pcl_slim/cloud/morton_sort.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/splat/octree_cloud.h"

#if defined(__GNUC__)
#define PCL_SLIM_PREFETCH(address) __builtin_prefetch(address)
#else
#define PCL_SLIM_PREFETCH(address) static_cast<void>(address)
#endif

namespace pcl_slim {

namespace octree_cloud {

constexpr std::size_t kSlice = 1 << 15;  ///< points a thread takes at a time
constexpr std::uint32_t kTooMany = 0xffffffffu;
constexpr int kProbeBits = 6;                  ///< the grid that guesses a cloud's area: 64 an axis
constexpr std::size_t kProbePoints = 1 << 18;  ///< points that suffice for it
constexpr double kLargest = 1e150;             ///< squares of such coordinates are still finite
constexpr std::size_t kAhead = 24;             ///< points between asking for one and using it
constexpr float kUnitSlack = 1e-3f;            ///< normals this near to unit length are left alone

using Vector = std::array<double, 3>;

struct Box {
  Vector min, max;
  std::size_t finite = 0;
};

inline Box
emptyBox()
{
  const double inf = std::numeric_limits<double>::infinity();
  return {{inf, inf, inf}, {-inf, -inf, -inf}, 0};
}

inline bool
isFinite(const Vector& p)
{
  return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
}

/** Reads coordinates stored as T. */
template <typename T>
struct Reader {
  const unsigned char* base;
  std::size_t stride;
  const std::int32_t* indices;

  Vector operator()(std::size_t i) const
  {
    const std::size_t input = indices ? static_cast<std::size_t>(indices[i]) : i;
    T q[3];
    std::memcpy(q, base + input * stride, sizeof(q));
    return {static_cast<double>(q[0]), static_cast<double>(q[1]), static_cast<double>(q[2])};
  }
};

inline std::size_t
spread(const Vector& p, const Vector& low, double scale)
{
  std::size_t cell = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const double at = (p[a] - low[a]) * scale;
    const auto last = static_cast<double>((1 << kProbeBits) - 1);
    cell = cell << kProbeBits | static_cast<std::size_t>(std::min(at, last));
  }
  return cell;
}

}  // namespace octree_cloud

/** The steps of OctreeCloud::build. */
class OctreeCloudBuilder {
  using Vector = octree_cloud::Vector;
  using Box = octree_cloud::Box;
  static constexpr std::size_t kSlice = octree_cloud::kSlice;

 public:
  OctreeCloudBuilder(const CloudView& cloud, const ColorView& colors, const LabTable& table,
                     int threads)
      : view_(cloud), colors_(colors), table_(table), threads_(threads)
  {
  }

  Result<OctreeCloud> run(const RootGrid& grid)
  {
    if (Error error = checkInput()) return error;
    const auto* base = static_cast<const unsigned char*>(view_.xyz);
    if (view_.scalar == CloudView::Scalar::kDouble) {
      return runAs(octree_cloud::Reader<double>{base, view_.xyz_stride, view_.indices}, grid);
    }
    return runAs(octree_cloud::Reader<float>{base, view_.xyz_stride, view_.indices}, grid);
  }

 private:
  Error checkInput() const
  {
    const std::size_t n = view_.count();
    if (n == 0 || view_.xyz == nullptr) {
      return {ErrorCode::kBadInput, "the cloud has no points: give one that has"};
    }
    if (n >= octree_cloud::kTooMany) {
      return {ErrorCode::kBadInput, "the cloud has more than 2^32 - 2 points: split it"};
    }
    for (std::size_t i = 0; view_.indices != nullptr && i < n; ++i) {
      if (view_.indices[i] < 0 || static_cast<std::size_t>(view_.indices[i]) >= view_.size) {
        return {ErrorCode::kBadArgument, "index " + std::to_string(view_.indices[i]) +
                                             " lies outside the cloud of " +
                                             std::to_string(view_.size) + " points"};
      }
    }
    return {};
  }

  template <typename Read>
  Result<OctreeCloud> runAs(const Read& read, const RootGrid& grid)
  {
    const Box box = measure(read);
    if (box.finite == 0) {
      return Error{ErrorCode::kBadInput,
                   "every point of the cloud is NaN or infinite: nothing to work on"};
    }
    double longest = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      if (std::max(std::abs(box.min[a]), std::abs(box.max[a])) > octree_cloud::kLargest) {
        return Error{ErrorCode::kBadInput,
                     "some coordinates are beyond 1e150: remove those points"};
      }
      longest = std::max(longest, box.max[a] - box.min[a]);
    }
    out_.num_non_finite_ = view_.count() - box.finite;
    out_.has_colors_ = colors_.bgr != nullptr;
    out_.origin_ = box.min;
    chooseGrid(read, box, longest, grid);
    sortPoints(read, box.finite);
    gather(read);
    return std::move(out_);
  }

  template <typename Read>
  Box measure(const Read& read) const
  {
    const std::size_t n = view_.count(), slices = (n + kSlice - 1) / kSlice;
    std::vector<Box> parts(slices, octree_cloud::emptyBox());
    parallelFor(slices, threads_, 1, [&](std::size_t s, int) {
      Box box = octree_cloud::emptyBox();
      for (std::size_t i = s * kSlice; i < std::min(n, (s + 1) * kSlice); ++i) {
        const Vector p = read(i);
        if (!octree_cloud::isFinite(p)) continue;
        ++box.finite;
        for (std::size_t a = 0; a < 3; ++a) {
          box.min[a] = std::min(box.min[a], p[a]);
          box.max[a] = std::max(box.max[a], p[a]);
        }
      }
      parts[s] = box;
    });
    Box all = octree_cloud::emptyBox();
    for (const Box& part : parts) {
      all.finite += part.finite;
      for (std::size_t a = 0; a < 3; ++a) {
        all.min[a] = std::min(all.min[a], part.min[a]);
        all.max[a] = std::max(all.max[a], part.max[a]);
      }
    }
    return all;
  }

  /** Resolution that gives about as many occupied cells as wanted: a surface's count grows with
   * the square of the resolution, and a coarse grid tells the factor. */
  template <typename Read>
  int guessResolution(const Read& read, const Box& box, double longest, double wanted) const
  {
    const std::size_t stride = std::max<std::size_t>(1, view_.count() / octree_cloud::kProbePoints);
    const std::size_t n = view_.count() / stride,
                      words = (std::size_t{1} << 3 * octree_cloud::kProbeBits) / 64;
    std::vector<std::vector<std::uint64_t>> seen(static_cast<std::size_t>(threads_));
    const double scale = (1 << octree_cloud::kProbeBits) / longest;
    parallelFor((n + kSlice - 1) / kSlice, threads_, 1, [&](std::size_t s, int thread) {
      auto& bits = seen[static_cast<std::size_t>(thread)];
      bits.resize(words);
      for (std::size_t i = s * kSlice; i < std::min(n, (s + 1) * kSlice); ++i) {
        const Vector p = read(i * stride);
        if (!octree_cloud::isFinite(p)) continue;
        const std::size_t cell = octree_cloud::spread(p, box.min, scale);
        bits[cell / 64] |= std::uint64_t{1} << cell % 64;
      }
    });
    std::size_t count = 0;
    for (std::size_t w = 0; w < words; ++w) {
      std::uint64_t word = 0;
      for (const auto& bits : seen) word |= bits.empty() ? 0 : bits[w];
      for (; word != 0; word &= word - 1) ++count;
    }
    const double ratio =
        std::max(wanted, 1.0) / static_cast<double>(std::max<std::size_t>(count, 1));
    return static_cast<int>(
        std::clamp(std::round((1 << octree_cloud::kProbeBits) * std::sqrt(ratio)), 1.0, 65536.0));
  }

  template <typename Read>
  void chooseGrid(const Read& read, const Box& box, double longest, const RootGrid& grid)
  {
    out_.resolution_ = std::clamp(grid.resolution, 1, RootGrid::kMaxResolution);
    if (!(longest > 0.0)) {
      out_.resolution_ = 1;
    } else if (grid.resolution <= 0) {
      out_.resolution_ = guessResolution(read, box, longest, grid.occupied);
    }
    out_.cell_ = longest / out_.resolution_;
    out_.depth_ = OctreeCloud::kBits;
    while ((out_.resolution_ - 1) >> (OctreeCloud::kBits - out_.depth_) != 0) --out_.depth_;
  }

  template <typename Read>
  void sortPoints(const Read& read, std::size_t finite)
  {
    const std::size_t n = view_.count(), slices = (n + kSlice - 1) / kSlice;
    const bool all = finite == n;
    std::vector<std::size_t> first(slices + 1, 0);
    const auto sliceEnd = [&](std::size_t s) { return std::min(n, (s + 1) * kSlice); };
    parallelFor(slices, threads_, 1, [&](std::size_t s, int) {
      std::size_t count = sliceEnd(s) - s * kSlice;
      for (std::size_t i = s * kSlice; !all && i < sliceEnd(s); ++i)
        count -= !octree_cloud::isFinite(read(i));
      first[s + 1] = count;
    });
    for (std::size_t s = 0; s < slices; ++s) first[s + 1] += first[s];
    out_.keys_.resize(finite);
    order_.resize(finite);
    const double scale = out_.cell_ > 0 ? std::ldexp(1.0 / out_.cell_, out_.depth_) : 0.0;
    const std::int64_t last =
        (static_cast<std::int64_t>(out_.resolution_) << out_.depth_) - 1;  // the box's far side
    parallelFor(slices, threads_, 1, [&](std::size_t s, int) {
      std::size_t at = first[s];
      for (std::size_t i = s * kSlice; i < sliceEnd(s); ++i) {
        const Vector p = read(i);
        if (!all && !octree_cloud::isFinite(p)) continue;
        std::uint64_t c[3];
        for (std::size_t a = 0; a < 3; ++a) {
          const auto cell = static_cast<std::int64_t>((p[a] - out_.origin_[a]) * scale);
          c[a] = static_cast<std::uint64_t>(std::min(cell, last));
        }
        out_.keys_[at] = spreadBits(c[0]) << 2 | spreadBits(c[1]) << 1 | spreadBits(c[2]);
        order_[at++] = static_cast<std::uint32_t>(i);
      }
    });
    sortByKey(out_.keys_, order_, threads_);
  }

  void readNormal(std::size_t input, float normal[3]) const
  {
    std::memcpy(normal,
                static_cast<const unsigned char*>(view_.normal) + input * view_.normal_stride,
                3 * sizeof(float));
    const float sq = normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2];
    if (std::abs(sq - 1.0f) < octree_cloud::kUnitSlack) return;
    const bool usable = sq > 1e-24f && std::isfinite(sq);
    const float scale = usable ? 1.0f / std::sqrt(sq) : 0.0f;
    for (int a = 0; a < 3; ++a) normal[a] = usable ? normal[a] * scale : 0.0f;
  }

  template <typename Read>
  void gather(const Read& read)
  {
    out_.points_.resize(order_.size());
    const double scale = out_.cell_ > 0 ? 1.0 / out_.cell_ : 0.0;
    const auto* bgr = static_cast<const unsigned char*>(colors_.bgr);
    const auto* normals = static_cast<const unsigned char*>(view_.normal);
    parallelFor(order_.size(), threads_, kSlice / 4, [&](std::size_t at, int) {
      // Points lie in any order: each is asked for from memory some points ahead. Not in a function
      // of its own, which GCC takes for one without effect.
      if (at + octree_cloud::kAhead < order_.size()) {
        const std::size_t ahead = view_.inputIndex(order_[at + octree_cloud::kAhead]);
        PCL_SLIM_PREFETCH(read.base + ahead * view_.xyz_stride);
        if (normals) PCL_SLIM_PREFETCH(normals + ahead * view_.normal_stride);
        if (bgr) PCL_SLIM_PREFETCH(bgr + ahead * colors_.stride);
      }
      OctreePoint q{};
      q.order = order_[at];
      const Vector p = read(q.order);
      for (std::size_t a = 0; a < 3; ++a) {
        q.position[a] = static_cast<float>((p[a] - out_.origin_[a]) * scale);
      }
      const std::size_t input = view_.inputIndex(q.order);
      if (view_.normal) readNormal(input, q.normal);
      if (bgr) {
        const unsigned char* c = bgr + input * colors_.stride;
        table_.convert(c[2], c[1], c[0], q.lab);
      }
      out_.points_[at] = q;
    });
  }

  const CloudView& view_;
  const ColorView& colors_;
  const LabTable& table_;
  int threads_;
  OctreeCloud out_;
  AlignedVector<std::uint32_t> order_;
};

}  // namespace pcl_slim

#undef PCL_SLIM_PREFETCH
