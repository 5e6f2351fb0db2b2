// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/splat/octree_cloud.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <numeric>
#include <optional>
#include <type_traits>
#include <vector>

#include "kernels/splat_kernels.h"
#include "pcl_slim/cloud/cloud_view.h"
#include "pcl_slim/cloud/morton_sort.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/core/vector3.h"

namespace pcl_slim {

using namespace detail;

namespace {

constexpr std::size_t kSlice = 1 << 15;  ///< points a thread takes at a time

/** Coordinates stored as T. */
template <typename T>
struct Reader {
  using Scalar = T;
  const unsigned char* base;
  std::size_t stride;
  const std::int32_t* indices;

  const unsigned char* address(std::size_t i) const {
    return base + (indices ? static_cast<std::size_t>(indices[i]) : i) * stride;
  }
  void operator()(std::size_t i, T p[3]) const { std::memcpy(p, address(i), 3 * sizeof(T)); }
};

template <typename T>
Reader<T> readerOf(const CloudView& view) {
  return {static_cast<const unsigned char*>(view.xyz), view.xyz_stride, view.indices};
}

/** Runs body(slice, begin, end) over [0, n). */
template <typename Body>
void forEachSlice(std::size_t n, int threads, const Body& body) {
  parallelFor((n + kSlice - 1) / kSlice, threads, 1,
              [&](std::size_t s, int) { body(s, s * kSlice, std::min(n, (s + 1) * kSlice)); });
}

struct Box {
  std::array<double, 3> min, max;
  std::size_t finite = 0;  ///< points inside; the others are NaN or infinite

  double longest() const { return std::max({max[0] - min[0], max[1] - min[1], max[2] - min[2]}); }
};

Box noBox() {
  const double inf = std::numeric_limits<double>::infinity();
  return {{inf, inf, inf}, {-inf, -inf, -inf}, 0};
}

Box unionOf(const std::vector<Box>& parts) {
  Box all = noBox();
  for (const Box& part : parts) {
    all.finite += part.finite;
    for (std::size_t a = 0; a < 3; ++a) {
      all.min[a] = std::min(all.min[a], part.min[a]);
      all.max[a] = std::max(all.max[a], part.max[a]);
    }
  }
  return all;
}

void extend(Box& box, double a0, double a1, double a2) {
  const double p[3] = {a0, a1, a2};
  for (std::size_t a = 0; a < 3; ++a) {
    box.min[a] = std::min(box.min[a], p[a]);
    box.max[a] = std::max(box.max[a], p[a]);
  }
}

/** Box of the finite points in [begin, end). */
template <typename T>
Box boxOf(const Reader<T>& read, std::size_t begin, std::size_t end) {
  Box box = noBox();
  std::size_t i = begin;
  // The last point may end its memory, so that no fourth float follows it.
  if (std::is_same_v<T, float> && !read.indices && read.stride >= 4 * sizeof(float)) {
    float low[3], high[3];
    const std::size_t n = end - begin - 1;
    if (n > 0 &&
        splat_kernels::boxOfPoints(read.base + begin * read.stride, read.stride, n, low, high)) {
      extend(box, low[0], low[1], low[2]);
      extend(box, high[0], high[1], high[2]);
      box.finite = n;
      i = begin + n;
    }
  }
  for (; i < end; ++i) {
    T p[3];
    read(i, p);
    if (!isFinite(p)) continue;
    ++box.finite;
    extend(box, p[0], p[1], p[2]);
  }
  return box;
}

template <typename T>
Box measure(const Reader<T>& read, std::size_t n, int threads, std::vector<std::size_t>& finite) {
  std::vector<Box> parts((n + kSlice - 1) / kSlice);
  forEachSlice(n, threads, [&](std::size_t s, std::size_t begin, std::size_t end) {
    parts[s] = boxOf(read, begin, end);
  });
  finite.assign(1, 0);
  for (const Box& part : parts) finite.push_back(finite.back() + part.finite);
  return unionOf(parts);
}

/** Positions of some finite points in root cells, and their indices. */
struct PointBlock {
  static constexpr std::size_t kSize = 256;

  alignas(64) float x[kSize] = {}, y[kSize] = {}, z[kSize] = {};
  alignas(64) std::uint32_t index[kSize] = {};
  std::size_t count = 0;
};

/** A cloud's finite points in blocks. */
template <typename T>
class PointBlocks {
 public:
  /** first: finite points before each slice of kSlice points, and behind the last. */
  PointBlocks(const Reader<T>& read, std::size_t points, const OctreeFrame& frame,
              const std::vector<std::size_t>& first, int threads)
      : read_(read), points_(points), frame_(frame), first_(first), threads_(threads) {}

  /** How many points are finite. */
  std::size_t count() const { return first_.back(); }
  bool allFinite() const { return count() == points_; }

  /** Runs body(place, block) for all blocks; place: finite points before them. */
  template <typename Body>
  void forEach(const Body& body) const {
    forEachSlice(points_, threads_, [&](std::size_t s, std::size_t begin, std::size_t end) {
      std::size_t place = first_[s];
      PointBlock block;
      for (; begin < end; begin += PointBlock::kSize) {
        fill(begin, std::min(end, begin + PointBlock::kSize), block);
        body(place, block);
        place += block.count;
      }
    });
  }

  /** Some points of a list, at most as many as fit a block. */
  void fillListed(const std::uint32_t* points, std::size_t count, PointBlock& block) const {
    for (std::size_t k = 0; k < count; ++k) {
      T p[3];
      read_(points[k], p);
      put(p, points[k], k, block);
    }
    finish(count, block);
  }

 private:
  void fill(std::size_t begin, std::size_t end, PointBlock& block) const {
    const bool all_finite = allFinite();
    const bool whole = end - begin == PointBlock::kSize && end < points_;
    if (all_finite && whole && fillWhole(begin, block)) return;
    if (all_finite) {
      fillEach<true>(begin, end, block);
    } else {
      fillEach<false>(begin, end, block);
    }
  }

  /** For a whole block of finite points with others behind it: four floats at a time. \return false
   * where their layout does not allow that. */
  bool fillWhole(std::size_t begin, PointBlock& block) const {
    if (!std::is_same_v<T, float> || read_.indices || read_.stride < 4 * sizeof(float)) {
      return false;
    }
    std::iota(block.index, block.index + PointBlock::kSize, static_cast<std::uint32_t>(begin));
    splat_kernels::gatherVectors(read_.base, read_.stride, block.index, PointBlock::kSize, block.x,
                                 block.y, block.z);
    splat_kernels::toCells(frame_, block.x, block.y, block.z, PointBlock::kSize);
    block.count = PointBlock::kSize;
    return true;
  }

  template <bool kAllFinite>
  void fillEach(std::size_t begin, std::size_t end, PointBlock& block) const {
    std::size_t k = 0;
    for (std::size_t i = begin; i < end; ++i) {
      T p[3];
      read_(i, p);
      if (!kAllFinite && !isFinite(p)) continue;
      put(p, static_cast<std::uint32_t>(i), k++, block);
    }
    finish(k, block);
  }

  void put(const T p[3], std::uint32_t index, std::size_t k, PointBlock& block) const {
    float q[3] = {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])};
    if constexpr (std::is_same_v<T, double>) frame_.position(p, q);
    block.x[k] = q[0], block.y[k] = q[1], block.z[k] = q[2];
    block.index[k] = index;
  }

  void finish(std::size_t count, PointBlock& block) const {
    constexpr std::size_t kWhole = 16;  // points of the widest vectors
    block.count = count;
    if constexpr (std::is_same_v<T, float>) {
      const std::size_t n = (count + kWhole - 1) / kWhole * kWhole;
      splat_kernels::toCells(frame_, block.x, block.y, block.z, n);
    }
  }

  const Reader<T>& read_;
  std::size_t points_;
  const OctreeFrame& frame_;
  const std::vector<std::size_t>& first_;
  int threads_;
};

/** Orders points with equal leading bits of keys by their whole keys and then by their attributes,
 * and keeps one of those that are equal in place, normal and colour, so that nothing depends on the
 * order in which their owner has them. One per thread: it keeps its scratch memory. */
template <typename T>
class CanonicalOrder {
 public:
  CanonicalOrder(const CloudView& cloud, const ColorView& colors, const Reader<T>& read,
                 const PointBlocks<T>& blocks, int depth)
      : cloud_(cloud), colors_(colors), read_(read), blocks_(blocks), depth_(depth) {}

  /** Brings n points and their keys into that order, those kept to the front. \return how many */
  std::size_t arrange(std::uint64_t* keys, std::uint32_t* points, std::size_t n) {
    entries_.clear();
    for (std::size_t first = 0; first < n; first += PointBlock::kSize) {
      addEntries(points + first, std::min(PointBlock::kSize, n - first));
    }
    std::sort(entries_.begin(), entries_.end());
    entries_.erase(std::unique(entries_.begin(), entries_.end()), entries_.end());
    for (std::size_t i = 0; i < entries_.size(); ++i) {
      keys[i] = entries_[i].key;
      points[i] = entries_[i].point;
    }
    return entries_.size();
  }

 private:
  /** What distinguishes points, in the order of comparison; the point comes last. */
  struct Entry {
    std::uint64_t key;
    std::array<T, 3> place;
    std::array<unsigned char, 3 * sizeof(float) + 3> look;  ///< normal and colour
    std::uint32_t point;

    bool operator==(const Entry& other) const { return place == other.place && look == other.look; }
    bool operator<(const Entry& other) const {
      if (key != other.key) return key < other.key;
      if (place != other.place) return place < other.place;
      return look != other.look ? look < other.look : point < other.point;
    }
  };

  void addEntries(const std::uint32_t* points, std::size_t n) {
    std::uint64_t keys[PointBlock::kSize];
    blocks_.fillListed(points, n, block_);
    splat_kernels::mortonKeys(block_.x, block_.y, block_.z, n, depth_, keys);
    for (std::size_t k = 0; k < n; ++k) entries_.push_back(entryOf(keys[k], points[k]));
  }

  Entry entryOf(std::uint64_t key, std::uint32_t point) const {
    Entry entry{key, {}, {}, point};
    read_(point, entry.place.data());
    const std::size_t input = cloud_.inputIndex(point);
    if (cloud_.normal != nullptr) {
      std::memcpy(entry.look.data(),
                  static_cast<const unsigned char*>(cloud_.normal) + input * cloud_.normal_stride,
                  3 * sizeof(float));
    }
    if (colors_.bgr != nullptr) {
      std::memcpy(entry.look.data() + 3 * sizeof(float),
                  static_cast<const unsigned char*>(colors_.bgr) + input * colors_.stride, 3);
    }
    return entry;
  }

  const CloudView& cloud_;
  const ColorView& colors_;
  const Reader<T>& read_;
  const PointBlocks<T>& blocks_;
  int depth_;
  PointBlock block_;
  std::vector<Entry> entries_;
};

/** Resolutions that give about as many occupied cells as wanted: a surface's count grows with the
 * square of the resolution, and a coarse grid gives the factor. Neither the order of the points nor
 * how often one is given changes it. */
class AreaProbe {
 public:
  static OctreeFrame frameOver(const Box& box) {
    return {box.min, kCells / box.longest(), std::nextafter(static_cast<float>(kCells), 0.0f)};
  }

  /** blocks: in the cells of frameOver(). */
  template <typename T>
  explicit AreaProbe(const PointBlocks<T>& blocks) {
    std::vector<std::atomic<std::uint64_t>> seen((std::size_t{1} << 3 * kBits) / 64);
    blocks.forEach([&](std::size_t, const PointBlock& block) {
      for (std::size_t k = 0; k < block.count; ++k) {
        const auto at = [](float c) { return static_cast<std::uint32_t>(c); };
        const std::uint32_t cell =
            (at(block.x[k]) << kBits | at(block.y[k])) << kBits | at(block.z[k]);
        const std::uint64_t bit = std::uint64_t{1} << cell % 64;
        std::atomic<std::uint64_t>& word = seen[cell / 64];
        // Most cells are known already: threads seldom write.
        if ((word.load(std::memory_order_relaxed) & bit) == 0) {
          word.fetch_or(bit, std::memory_order_relaxed);
        }
      }
    });
    for (const auto& word : seen) {
      for (std::uint64_t bits = word; bits != 0; bits &= bits - 1) ++occupied_;
    }
  }

  int resolutionFor(double wanted) const {
    const double ratio = std::max(wanted, 1.0) / std::max(occupied_, 1.0);
    return static_cast<int>(std::clamp(std::round(kCells * std::sqrt(ratio)), 1.0, 65536.0));
  }

 private:
  static constexpr int kBits = 6;  ///< the grid has 64 cells an axis
  static constexpr double kCells = 1 << kBits;
  double occupied_ = 0;
};

/** Orders a cloud's points by the Morton codes of their cells, equal points once.
 *
 * Leading bits separate nearly all points of a scan: whole keys are made again for the others. */
template <typename T>
class KeyOrder {
 public:
  /** depth: of keys below root cells. */
  KeyOrder(const PointBlocks<T>& blocks, int depth, int threads)
      : blocks_(blocks), depth_(depth), threads_(threads) {}

  /** \param[out] keys ascending; below the leading bits they are 0 where those separate a point
   * from all others. \param[out] order the points they are of. */
  void run(CanonicalOrder<T> ties, AlignedVector<std::uint64_t>& keys,
           AlignedVector<std::uint32_t>& order) const {
    AlignedVector<std::uint32_t> finite;
    makeKeys(keys, finite);
    sortByLeadingBits(keys, order, threads_);
    if (!finite.empty()) {
      for (std::uint32_t& point : order) point = finite[point];
    }
    arrange(ties, tiedRuns(keys), keys, order);
  }

 private:
  /** Points that share their leading bits, and how many of them are kept. */
  struct Run {
    std::size_t begin, end, kept;
  };

  /** \param[out] finite the points the keys are of; empty where that is all. */
  void makeKeys(AlignedVector<std::uint64_t>& keys, AlignedVector<std::uint32_t>& finite) const {
    keys.resize(blocks_.count());
    if (!blocks_.allFinite()) finite.resize(keys.size());
    blocks_.forEach([&](std::size_t place, const PointBlock& block) {
      std::uint64_t part[PointBlock::kSize];
      splat_kernels::mortonKeys(block.x, block.y, block.z, PointBlock::kSize, depth_, part);
      std::copy_n(part, block.count, keys.data() + place);
      if (!finite.empty()) std::copy_n(block.index, block.count, finite.data() + place);
    });
  }

  std::vector<Run> tiedRuns(const AlignedVector<std::uint64_t>& keys) const {
    const std::size_t n = keys.size();
    std::vector<std::vector<Run>> parts((n + kSlice - 1) / kSlice);
    // A run belongs to the slice it begins in.
    forEachSlice(n, threads_, [&](std::size_t s, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end && i + 1 < n; ++i) {
        if (keys[i] != keys[i + 1] || (i > 0 && keys[i] == keys[i - 1])) continue;
        std::size_t last = i + 1;
        while (last < n && keys[last] == keys[i]) ++last;
        parts[s].push_back({i, last, last - i});
      }
    });
    std::vector<Run> runs;
    for (const auto& part : parts) runs.insert(runs.end(), part.begin(), part.end());
    return runs;
  }

  void arrange(const CanonicalOrder<T>& ties, std::vector<Run> runs,
               AlignedVector<std::uint64_t>& keys, AlignedVector<std::uint32_t>& order) const {
    if (runs.empty()) return;
    std::vector<CanonicalOrder<T>> of_thread(static_cast<std::size_t>(threads_), ties);
    parallelFor(runs.size(), threads_, 64, [&](std::size_t r, int thread) {
      Run& run = runs[r];
      run.kept = of_thread[static_cast<std::size_t>(thread)].arrange(
          keys.data() + run.begin, order.data() + run.begin, run.end - run.begin);
    });
    // Those behind close the gaps of points that were not kept.
    runs.push_back({keys.size(), keys.size(), 0});
    std::size_t to = runs.front().begin;
    for (std::size_t r = 0; r + 1 < runs.size(); ++r) {
      const auto move = [&](std::size_t begin, std::size_t end) {
        if (to != begin) {
          std::copy(keys.data() + begin, keys.data() + end, keys.data() + to);
          std::copy(order.data() + begin, order.data() + end, order.data() + to);
        }
        to += end - begin;
      };
      move(runs[r].begin, runs[r].begin + runs[r].kept);
      move(runs[r].end, runs[r + 1].begin);
    }
    keys.resize(to);
    order.resize(to);
  }

  const PointBlocks<T>& blocks_;
  int depth_, threads_;
};

}  // namespace

namespace detail {

/** The steps of OctreeCloud::build. */
class OctreeCloudBuilder {
  static constexpr double kLargest = 1e150;  ///< squares of such coordinates are still finite
  static constexpr double kWidest = 1e38;    ///< positions are floats relative to the box's corner
  static constexpr double kNarrowest = 1e-32;  ///< a millionth of it is a normal float

 public:
  OctreeCloudBuilder(const CloudView& cloud, const ColorView& colors, int threads)
      : view_(cloud), colors_(colors), threads_(threads) {}

  Result<OctreeCloud> run(const RootGrid& grid) {
    if (Error error = view_.validate()) return error;
    Error error = view_.scalar == CloudView::Scalar::kDouble ? runAs(readerOf<double>(view_), grid)
                                                             : runAs(readerOf<float>(view_), grid);
    if (error) return error;
    return std::move(out_);
  }

 private:
  template <typename T>
  Error runAs(const Reader<T>& read, const RootGrid& grid) {
    const Box box = measure(read, view_.count(), threads_, first_);
    if (Error error = checkBox(box)) return error;
    out_.num_non_finite_ = view_.count() - box.finite;
    const bool one_place = !(box.longest() > 0.0);
    std::optional<AreaProbe> area;
    if (!one_place && grid.resolution == 0) {
      area.emplace(blocksIn(AreaProbe::frameOver(box), read));
    }
    const int first = resolutionOf(grid, area, box.finite);
    chooseGrid(box, first);
    sort(read);
    // Repeated points are known by now: the grid is that of the others.
    const int resolution = resolutionOf(grid, area, out_.order_.size());
    if (resolution != first) {
      chooseGrid(box, resolution);
      sort(read);
    }
    out_.num_duplicates_ = box.finite - out_.order_.size();
    findRoots();
    return {};
  }

  template <typename T>
  PointBlocks<T> blocksIn(const OctreeFrame& frame, const Reader<T>& read) const {
    return {read, view_.count(), frame, first_, threads_};
  }

  static Error checkBox(const Box& box) {
    if (box.finite == 0) return CloudView::nothingFinite();
    for (std::size_t a = 0; a < 3; ++a) {
      if (std::max(std::abs(box.min[a]), std::abs(box.max[a])) > kLargest) {
        return badInput("some coordinates are beyond 1e150: remove those points");
      }
    }
    if (box.longest() > kWidest) {
      return badInput(
          "the points span more than 1e38, which splats, being floats, cannot tell: "
          "scale the cloud, or remove the farthest points");
    }
    if (box.longest() > 0.0 && box.longest() < kNarrowest) {
      return badInput(
          "the points span less than 1e-32, which splats, being floats, cannot tell: scale the "
          "cloud");
    }
    return {};
  }

  static int bitsOf(std::uint64_t value) {
    int bits = 0;
    for (; value != 0; value >>= 1) ++bits;
    return bits;
  }

  /** For a number of different points; without an area for a grid that is given or has one cell. */
  static int resolutionOf(const RootGrid& grid, const std::optional<AreaProbe>& area,
                          std::size_t points) {
    if (!area) return std::clamp(grid.resolution, 1, RootGrid::kMaxResolution);
    if (!(grid.points_per_root > 0)) return area->resolutionFor(grid.occupied);
    return area->resolutionFor(static_cast<double>(points) / grid.points_per_root);
  }

  void chooseGrid(const Box& box, int resolution) {
    const double longest = box.longest();
    out_.resolution_ = longest > 0.0 ? resolution : 1;
    out_.cell_ = longest / out_.resolution_;
    out_.depth_ = OctreeCloud::kBits - bitsOf(static_cast<std::uint64_t>(out_.resolution_ - 1));
    out_.frame_.origin = box.min;
    out_.frame_.scale = longest > 0.0 ? out_.resolution_ / longest : 0.0;
    out_.frame_.last = std::nextafter(static_cast<float>(out_.resolution_), 0.0f);
  }

  template <typename T>
  void sort(const Reader<T>& read) {
    const PointBlocks<T> blocks = blocksIn(out_.frame_, read);
    KeyOrder<T>(blocks, out_.depth_, threads_)
        .run(CanonicalOrder<T>(view_, colors_, read, blocks, out_.depth_), out_.keys_, out_.order_);
  }

  void findRoots() {
    const std::size_t n = out_.keys_.size();
    const int below = 3 * out_.depth_;
    out_.roots_.clear();
    for (std::size_t i = 0; i < n; ++i) {
      const std::uint64_t root = out_.keys_[i] >> below;
      if (i > 0 && root == out_.roots_.back().key) continue;
      out_.roots_.push_back({root, static_cast<std::uint32_t>(i)});
    }
    out_.roots_.push_back({~std::uint64_t{0}, static_cast<std::uint32_t>(n)});
  }

  const CloudView& view_;
  ColorView colors_;
  int threads_;
  std::vector<std::size_t> first_;  ///< finite points before each slice
  OctreeCloud out_;
};

}  // namespace detail

Result<OctreeCloud> OctreeCloud::build(const CloudView& cloud, const RootGrid& grid, int threads,
                                       const ColorView& colors) {
  return OctreeCloudBuilder(cloud, colors, resolveThreads(threads)).run(grid);
}

double OctreeCloud::edge(int shift) const {
  return std::ldexp(1.0, shift - depth_);
}

std::array<double, 3> OctreeCloud::center(const std::array<float, 3>& position, int shift) const {
  const double width = edge(shift);
  std::array<double, 3> c;
  for (std::size_t a = 0; a < 3; ++a) c[a] = (std::floor(position[a] / width) + 0.5) * width;
  return c;
}

std::size_t OctreeCloud::rootOf(std::size_t point) const {
  const auto after = std::upper_bound(roots_.begin(), roots_.end() - 1, point,
                                      [](std::size_t p, const Root& r) { return p < r.begin; });
  return static_cast<std::size_t>(after - roots_.begin()) - 1;
}

std::size_t OctreeCloud::countCells(int growth) const {
  std::size_t count = 1;
  for (std::size_t r = 1; r < numRoots(); ++r) {
    count += (roots_[r].key ^ roots_[r - 1].key) >> 3 * growth != 0;
  }
  return count;
}

}  // namespace pcl_slim
