// SPDX-License-Identifier: BSD-3-Clause
#include "tiles/noise_sample.h"

#include <algorithm>

#include "pcl_slim/cloud/detail/cloud_reader.h"
#include "ranks/rank_messages.h"

namespace pcl_slim::detail {

namespace {

constexpr std::uint64_t kWindows = 32;
constexpr std::uint64_t kWindowPoints = 32768;
constexpr double kSlack = 1.25;  ///< windows of so many times their points are cut
constexpr std::uint64_t kThinningStep = 4;

/** Cells [first, end) of one window. */
struct Window {
  std::size_t first, end;
};

/** Windows of so many points each about evenly spread places; neighbours that meet do not overlap. */
std::vector<Window>
windowsOf(const TilePlan& plan, std::uint64_t points_of_window)
{
  std::vector<Window> windows;
  std::size_t cell = 0;
  std::uint64_t before = 0;  // points of the cells before it
  for (std::uint64_t w = 0; w < kWindows; ++w) {
    const std::uint64_t middle = (2 * w + 1) * (plan.points / (2 * kWindows));
    const std::uint64_t begin = middle - std::min(middle, points_of_window / 2);
    for (; cell < plan.cells.size() && before + plan.cells[cell].points <= begin; ++cell)
      before += plan.cells[cell].points;
    const Window window{cell, cell};
    windows.push_back(window);
    const std::uint64_t first = before;
    for (; cell < plan.cells.size() && before - first < points_of_window; ++cell)
      before += plan.cells[cell].points;
    windows.back().end = cell;
    if (window.first == cell) windows.pop_back();
  }
  return windows;
}

/** Keeps the points of least Morton codes, ties by place, where a window has too many. */
void
cutWindow(const StoreFrame& frame, const PointRecord& record, int threads,
          std::vector<unsigned char>& records)
{
  const std::size_t step = record.bytes(), count = records.size() / step;
  if (static_cast<double>(count) <= kSlack * static_cast<double>(kWindowPoints)) return;
  const CloudView view = record.view(records);
  const CloudReader reader(view);
  PointKeys keys(frame, threads);
  const AlignedVector<std::uint64_t>& codes = keys.of(view);
  std::vector<std::uint32_t> order(count);
  for (std::uint32_t i = 0; i < count; ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return codes[a] != codes[b] ? codes[a] < codes[b] : reader.position(a) < reader.position(b);
  });
  std::vector<unsigned char> kept;
  for (std::size_t i = 0; i < kWindowPoints; ++i) {
    const auto from = records.begin() + static_cast<std::ptrdiff_t>(order[i] * step);
    kept.insert(kept.end(), from, from + static_cast<std::ptrdiff_t>(step));
  }
  records.swap(kept);
}

/** The windows' points at rank 0, none at the others. */
Error
takeSample(const TileLoader& loader, const StoreFrame& frame, const std::vector<Window>& windows,
           std::uint64_t thinning, int threads, Ranks& ranks, std::vector<unsigned char>& all)
{
  std::vector<unsigned char> records;
  for (const Window& window : windows) {
    records.clear();
    if (Error error = loader.loadCells(window.first, window.end, thinning, records)) return error;
    gather(ranks, records);
    if (windows.size() > 1) cutWindow(frame, loader.record(), threads, records);
    all.insert(all.end(), records.begin(), records.end());
  }
  return {};
}

Result<MeasuredTraits>
measureSample(const TileLoader& loader, const StoreFrame& frame, const FitParams& params,
              const TraitsSample& how, const std::vector<unsigned char>& sample)
{
  Result<PointStore> store = PointStore::build(loader.record().view(sample), frame, params.threads);
  if (!store) return store.error();
  return measureTraits(*store, params, how);
}

/** What all ranks need of what rank 0 has measured. */
struct Verdict {
  CloudTraits traits;
  bool noise_fills;
};

}  // namespace

Result<MeasuredTraits>
measureSampledTraits(const TileLoader& loader, const StoreFrame& frame, const FitParams& params,
                     Ranks& ranks, std::uint64_t& thinning)
{
  const TilePlan& plan = loader.plan();
  const std::uint64_t sample = kWindows * kWindowPoints;
  double spacing = 0;  // of the cloud as it is
  for (thinning = 1;; thinning *= kThinningStep) {
    const bool whole = static_cast<double>(plan.points) <=
                       kSlack * static_cast<double>(sample) * static_cast<double>(thinning);
    if (whole) thinning = std::max<std::uint64_t>(1, plan.points / sample);
    const std::vector<Window> windows = whole ? std::vector<Window>{{0, plan.cells.size()}}
                                              : windowsOf(plan, kWindowPoints * thinning);
    std::vector<unsigned char> points;
    if (Error error = takeSample(loader, frame, windows, thinning, params.threads, ranks, points))
      return error;
    TraitsSample how;
    how.windows = windows.size();
    how.thinning = static_cast<std::size_t>(thinning);
    Result<MeasuredTraits> measured = MeasuredTraits();
    if (ranks.rank() == 0) measured = measureSample(loader, frame, params, how, points);
    if (!measured) return measured;
    const Verdict verdict = ofFirst(ranks, Verdict{measured->traits, measured->noise_fills});
    measured->traits = verdict.traits;
    measured->noise_fills = verdict.noise_fills;
    if (thinning == 1) spacing = measured->traits.spacing;
    measured->traits.spacing = spacing;
    if (!measured->noise_fills || whole) return measured;
  }
}

}  // namespace pcl_slim::detail
