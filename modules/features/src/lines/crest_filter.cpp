// SPDX-License-Identifier: BSD-3-Clause
#include "lines/crest_filter.h"

#include <algorithm>
#include <cstddef>

namespace pcl_slim::detail {

namespace {

constexpr std::ptrdiff_t kAround =
    3;  ///< vertices to both sides of one that smooth its significance

/** Means of the significance over seven vertices; of fewer at an open end. */
std::vector<double>
smoothed(const TracedLine& line)
{
  const auto n = static_cast<std::ptrdiff_t>(line.vertices.size());
  std::vector<double> mean(line.vertices.size());
  for (std::ptrdiff_t i = 0; i < n; ++i) {
    double sum = 0;
    std::ptrdiff_t count = 0;
    for (std::ptrdiff_t j = i - kAround; j <= i + kAround; ++j) {
      if (!line.closed && (j < 0 || j >= n)) continue;
      sum += line.vertices[static_cast<std::size_t>(((j % n) + n) % n)].significance;
      ++count;
    }
    mean[static_cast<std::size_t>(i)] = sum / static_cast<double>(count);
  }
  return mean;
}

/** Opens a closed line at a vertex that does not stand out, if there is one. */
void
openAtLowest(TracedLine& line, std::vector<double>& mean, double least)
{
  const auto lowest = std::min_element(mean.begin(), mean.end());
  if (!line.closed || *lowest >= least) return;
  const std::ptrdiff_t at = lowest - mean.begin();
  std::rotate(mean.begin(), lowest, mean.end());
  std::rotate(line.vertices.begin(), line.vertices.begin() + at, line.vertices.end());
  line.closed = false;
}

}  // namespace

LineSums::LineSums(const TracedLine& line)
{
  const auto& v = line.vertices;
  for (std::size_t i = 0; i < v.size(); ++i) {
    radius += v[i].radius / static_cast<double>(v.size());
    significance += v[i].significance / static_cast<double>(v.size());
    if (i + 1 == v.size() && !line.closed) continue;
    const CrestVertex& next = v[(i + 1) % v.size()];
    const double side = pcl_slim::length(subtract(next.position, v[i].position));
    length += side;
    strength += 0.5 * side * (v[i].k + next.k);
  }
}

std::vector<TracedLine>
keptStretches(const std::vector<TracedLine>& traced, const CrestParams& params,
              CrestStatistics& statistics)
{
  std::vector<TracedLine> kept;
  for (TracedLine line : traced) {
    std::vector<double> mean = smoothed(line);
    openAtLowest(line, mean, params.significance);
    bool any = false;
    for (std::size_t begin = 0, end = 0; begin < mean.size(); begin = end + 1) {
      end = begin;
      double peak = 0;
      for (; end < mean.size() && mean[end] >= params.significance; ++end) {
        peak = std::max(peak, mean[end]);
      }
      if (peak < params.peak_significance || end < begin + 2) continue;
      any = true;
      TracedLine stretch;
      stretch.closed = line.closed;
      stretch.vertices.assign(line.vertices.begin() + static_cast<std::ptrdiff_t>(begin),
                              line.vertices.begin() + static_cast<std::ptrdiff_t>(end));
      const LineSums sums(stretch);
      if (sums.length < params.min_length * sums.radius) {
        ++statistics.short_lines;
      } else if (sums.strength < params.min_strength) {
        ++statistics.weak_lines;
      } else {
        kept.push_back(std::move(stretch));
      }
    }
    if (!any) ++statistics.insignificant;
  }
  return kept;
}

}  // namespace pcl_slim::detail
