// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>

#include "pcl_slim/cloud/detail/block_kernels.h"
#include "trim/border_test.h"

namespace pcl_slim::detail {

namespace {

constexpr std::size_t kNeighbors = 16;
constexpr double kInNoise = 3.6;      ///< [RMS noise] nearer points are less than a surface's
constexpr std::size_t kAround = 4;    ///< blocks before and after
constexpr std::size_t kQuantile = 4;  ///< tenths

}  // namespace

LocalSpacing::LocalSpacing(const PointStore& store, const BorderConstants& constants, double noise)
    : store_(store),
      constants_(constants),
      noise_(noise),
      raw_(store.numBlocks()),
      smooth_(store.numBlocks()) {}

float LocalSpacing::raw(std::size_t block) {
  float spacing = raw_[block].load(std::memory_order_relaxed);
  if (spacing == 0.0f) {
    spacing = at(middleOf(block));
    raw_[block].store(spacing, std::memory_order_relaxed);
  }
  return spacing;
}

float LocalSpacing::of(std::size_t block) {
  float spacing = smooth_[block].load(std::memory_order_relaxed);
  if (spacing == 0.0f) {
    std::array<float, 2 * kAround + 1> values{};
    std::size_t count = 0;
    const std::size_t end = std::min(store_.numBlocks(), block + kAround + 1);
    for (std::size_t b = block > kAround ? block - kAround : 0; b < end; ++b)
      values[count++] = raw(b);
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(count * kQuantile / 10);
    std::nth_element(values.begin(), at, values.begin() + static_cast<std::ptrdiff_t>(count));
    spacing = *at;
    smooth_[block].store(spacing, std::memory_order_relaxed);
  }
  return spacing;
}

/** The point of a block next to the mean of its points. */
std::size_t LocalSpacing::middleOf(std::size_t block) const {
  const std::size_t begin = block * PointStore::kBlock;
  const std::size_t end = std::min(begin + PointStore::kBlock, store_.size());
  Vector3 mean{};
  for (std::size_t i = begin; i < end; ++i)
    mean = along(mean, 1.0 / static_cast<double>(end - begin), store_.position(i));
  std::size_t middle = begin;
  double nearest_sq = std::numeric_limits<double>::max();
  for (std::size_t i = begin; i < end; ++i) {
    const Vector3 offset = subtract(store_.position(i), mean);
    if (dot(offset, offset) >= nearest_sq) continue;
    nearest_sq = dot(offset, offset);
    middle = i;
  }
  return middle;
}

/** About the distance of the 16th neighbour, from a few points of the same block. */
double LocalSpacing::guessAt(std::size_t point) const {
  constexpr std::size_t kFew = 4;
  constexpr double kFarther = 2.2, kLeast = 1e-7;
  const Vector3 place = store_.position(point);
  const std::size_t begin = point / PointStore::kBlock * PointStore::kBlock;
  const std::size_t end = std::min(begin + PointStore::kBlock, store_.size());
  std::array<double, PointStore::kBlock> squares{};
  for (std::size_t i = begin; i < end; ++i) {
    const Vector3 offset = subtract(store_.position(i), place);
    squares[i - begin] = dot(offset, offset);
  }
  const auto last = squares.begin() + static_cast<std::ptrdiff_t>(end - begin);
  const auto few = squares.begin() + static_cast<std::ptrdiff_t>(std::min(kFew, end - begin - 1));
  std::nth_element(squares.begin(), few, last);
  return kFarther * std::sqrt(*few) + kLeast;
}

float LocalSpacing::at(std::size_t point) const {
  const Vector3 place = store_.position(point);
  thread_local std::vector<std::uint32_t> blocks, found;
  thread_local std::vector<float> distances_sq;
  const float center[3] = {static_cast<float>(place[0]), static_cast<float>(place[1]),
                           static_cast<float>(place[2])};
  std::size_t every = 1;  // of the blocks is counted
  const auto countWithin = [&](double reach, std::size_t enough_blocks) {
    blocks.clear();
    store_.tree().blocksInBall(center, static_cast<float>(reach), blocks);
    every = keepEnough(enough_blocks, blocks);
    const std::size_t most = (blocks.size() + 1) * PointStore::kBlock;
    if (found.size() < most) {
      found.resize(most);
      distances_sq.resize(most);
    }
    return kernels::pointsUpTo(store_, blocks.data(), blocks.size(), place.data(),
                               static_cast<float>(reach * reach), distances_sq.data(),
                               found.data());
  };
  const double in_noise = kInNoise * noise_;
  const std::size_t enough = std::min(kNeighbors + 1, store_.size());
  const double guess = guessAt(point);
  double reach = std::max(guess, in_noise);
  std::size_t count =
      countWithin(reach, guess > in_noise ? store_.numBlocks() : constants_.enough_blocks);
  while (count < enough) {
    if (every == 1) reach *= 1.4;
    count = countWithin(reach, store_.numBlocks());
  }
  if (count < 2) return 1.0f;
  const auto limit = static_cast<float>(in_noise * in_noise);
  const auto within = static_cast<std::size_t>(
      std::count_if(distances_sq.begin(), distances_sq.begin() + static_cast<std::ptrdiff_t>(count),
                    [&](float q) { return q <= limit; }));
  if (within < enough) {
    const double farthest_sq = kernels::kthSmallest(distances_sq.data(), count, enough);
    return static_cast<float>(std::sqrt(M_PI * farthest_sq / static_cast<double>(enough - 1)));
  }
  const double area = M_PI * (in_noise * in_noise - 2 * noise_ * noise_);
  return static_cast<float>(std::sqrt(area / static_cast<double>(within * every - 1)));
}

}  // namespace pcl_slim::detail
