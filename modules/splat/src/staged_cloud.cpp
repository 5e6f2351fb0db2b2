// SPDX-License-Identifier: BSD-3-Clause
#include "staged_cloud.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <vector>

#include "octree_grid.h"
#include "octree_key.h"

namespace pcl_slim {

namespace {

constexpr std::size_t kFewest = std::size_t{1} << 21;  ///< points from which a copy pays
constexpr int kCellBits = 4;                           ///< 16 cells along the longest side
constexpr std::size_t kCells = std::size_t{1} << 3 * kCellBits;
constexpr std::size_t kPairs = 4096;  ///< neighbours in memory that tell whether they are in space
constexpr double kNear = 1.0 / 32.0;  ///< of the longest side: near enough
constexpr std::size_t kBlock =
    2048;  ///< points that stay in a cache while they are looked at twice

/** Some pairs of points next to each other in memory. */
template <typename T>
class PairSample {
 public:
  PairSample(const octree_grid::Reader<T>& read, std::size_t n)
  {
    for (std::size_t k = 0; k < kPairs; ++k) {
      T p[3], q[3];
      const std::size_t i = 1 + k * ((n - 1) / kPairs);
      read(i - 1, p);
      read(i, q);
      if (!octree_grid::isFinite(p) || !octree_grid::isFinite(q)) continue;
      const auto x = static_cast<double>(q[0]), y = static_cast<double>(q[1]),
                 z = static_cast<double>(q[2]);
      octree_grid::extend(box_, x, y, z);
      ++box_.finite;
      apart_.push_back(std::max({std::abs(x - static_cast<double>(p[0])),
                                 std::abs(y - static_cast<double>(p[1])),
                                 std::abs(z - static_cast<double>(p[2]))}));
    }
  }

  const octree_grid::Box& box() const { return box_; }

  /** Whether most points lie near those before them. */
  bool isCoherent() const
  {
    std::size_t near = 0;
    for (const double distance : apart_) near += distance < kNear * box_.longest();
    return 2 * near > apart_.size();
  }

 private:
  octree_grid::Box box_ = octree_grid::noBox();
  std::vector<double> apart_;
};

}  // namespace

/** One point, as PCL's types have it, without gaps. */
template <typename T>
struct StagedCloud::Record {
  T xyz[3];
  float normal[3];
  unsigned char bgr[4];
  std::uint32_t index;
};

/** Counts cells, then writes each point behind those of its cell. */
template <typename T>
class StagedCloud::Writer {
 public:
  Writer(const CloudView& cloud, const ColorView& colors, const OctreeFrame& frame, int threads)
      : cloud_(cloud),
        colors_(colors),
        frame_(frame),
        threads_(threads),
        read_(octree_grid::readerOf<T>(cloud)),
        cells_(cloud.size),
        boxes_(cloud.size / octree_grid::kSlice + 1, octree_grid::noBox()),
        next_((cloud.size / octree_grid::kSlice + 1) * kCells, 0)
  {
  }

  void run(Record<T>* records)
  {
    octree_grid::forEachSlice(
        cloud_.size, threads_,
        [&](std::size_t s, std::size_t begin, std::size_t end) { count(s, begin, end); });
    std::uint32_t total = 0;
    for (std::size_t cell = 0; cell < kCells; ++cell) {
      for (std::size_t at = cell; at < next_.size(); at += kCells) {
        const std::uint32_t number = next_[at];
        next_[at] = total;
        total += number;
      }
    }
    octree_grid::forEachSlice(
        cloud_.size, threads_,
        [&](std::size_t s, std::size_t begin, std::size_t end) { write(s, begin, end, records); });
  }

  /** Box of all points. */
  octree_grid::Box box() const { return octree_grid::unionOf(boxes_); }

 private:
  void count(std::size_t slice, std::size_t begin, std::size_t end)
  {
    std::vector<octree_grid::Box> blocks;
    for (; begin < end; begin += kBlock) {
      const std::size_t last = std::min(end, begin + kBlock);
      blocks.push_back(octree_grid::boxOf(read_, begin, last));
      countBlock(next_.data() + slice * kCells, begin, last);
    }
    boxes_[slice] = octree_grid::unionOf(blocks);
  }

  void countBlock(std::uint32_t* counts, std::size_t begin, std::size_t end)
  {
    for (std::size_t i = begin; i < end; ++i) {
      T p[3];
      read_(i, p);
      std::array<float, 3> position{};
      if (octree_grid::isFinite(p)) frame_.position(p, position.data());
      for (float& x : position) x = std::max(x, 0.0f);  // the frame is that of a sample
      cells_[i] = static_cast<std::uint16_t>(mortonKey(position, 0));
      ++counts[cells_[i]];
    }
  }

  void write(std::size_t slice, std::size_t begin, std::size_t end, Record<T>* records)
  {
    std::uint32_t* next = next_.data() + slice * kCells;
    const auto* normals = static_cast<const unsigned char*>(cloud_.normal);
    const auto* bgr = static_cast<const unsigned char*>(colors_.bgr);
    for (std::size_t i = begin; i < end; ++i) {
      Record<T> record{};
      read_(i, record.xyz);
      if (normals) {
        std::memcpy(record.normal, normals + i * cloud_.normal_stride, sizeof(record.normal));
      }
      if (bgr) std::memcpy(record.bgr, bgr + i * colors_.stride, 3);
      record.index = static_cast<std::uint32_t>(i);
      records[next[cells_[i]]++] = record;
    }
  }

  const CloudView& cloud_;
  const ColorView& colors_;
  const OctreeFrame& frame_;
  int threads_;
  octree_grid::Reader<T> read_;
  AlignedVector<std::uint16_t> cells_;
  std::vector<octree_grid::Box> boxes_;
  std::vector<std::uint32_t> next_;  ///< of each slice and cell
};

template <typename T>
std::optional<StagedCloud>
StagedCloud::copyOf(const CloudView& cloud, const ColorView& colors, int threads)
{
  const auto read = octree_grid::readerOf<T>(cloud);
  const PairSample<T> sample(read, cloud.size);
  const octree_grid::Box& box = sample.box();
  const double longest = box.longest();
  if (box.finite == 0 || !(longest > 0.0) || !std::isfinite(longest)) return {};
  if (sample.isCoherent()) return {};
  OctreeFrame frame;
  frame.origin = box.min;
  frame.scale = (1 << kCellBits) / longest;
  frame.last = std::nextafter(static_cast<float>(1 << kCellBits), 0.0f);
  std::optional<StagedCloud> staged(std::in_place);
  staged->records_.resize(cloud.size * sizeof(Record<T>));
  auto* records = reinterpret_cast<Record<T>*>(staged->records_.data());
  Writer<T> writer(cloud, colors, frame, threads);
  writer.run(records);
  staged->box_ = writer.box();
  staged->index_offset_ = offsetof(Record<T>, index);
  staged->view_ = cloud;
  staged->view_.xyz = records->xyz;
  staged->view_.xyz_stride = sizeof(Record<T>);
  if (cloud.normal) {
    staged->view_.normal = records->normal;
    staged->view_.normal_stride = sizeof(Record<T>);
  }
  if (colors.bgr) staged->colors_ = {records->bgr, sizeof(Record<T>)};
  return staged;
}

std::optional<StagedCloud>
StagedCloud::of(const CloudView& cloud, const ColorView& colors, int threads)
{
  const bool many = cloud.size >= kFewest && cloud.size < 0xffffffffu;
  if (!many || !cloud.xyz || cloud.indices) return {};
  return cloud.scalar == CloudView::Scalar::kDouble ? copyOf<double>(cloud, colors, threads)
                                                    : copyOf<float>(cloud, colors, threads);
}

std::uint32_t
StagedCloud::input(std::size_t i) const
{
  std::uint32_t index;
  std::memcpy(&index, records_.data() + i * view_.xyz_stride + index_offset_, sizeof(index));
  return index;
}

}  // namespace pcl_slim
