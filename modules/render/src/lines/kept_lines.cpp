// SPDX-License-Identifier: BSD-3-Clause
// Which stretches of lines stand out of the noise, and are long and strong enough to be drawn.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "lines/lines.h"

namespace pcl_slim::detail {

namespace {

constexpr LineSignificance kSignificance;
constexpr double kLeastRadii = 0.3;  ///< length of a line [radii of its leaves]

/** A stretch of a line whose vertices are all of size 1 or more, and how far along it each is. */
struct Stretch {
  const LineVertex* vertices;
  std::size_t count;
  std::vector<double> at;  ///< local units

  Stretch(const LineVertex* first, std::size_t number)
      : vertices(first), count(number), at(number) {
    for (std::size_t i = 1; i < count; ++i) {
      const Vector3 step = subtract(vertices[i].position, vertices[i - 1].position);
      at[i] = at[i - 1] + pcl_slim::length(step);
    }
  }
};

/** Means of the significance over .45 radii to both sides; of less at an end. */
std::vector<float> meanSignificance(const Stretch& stretch) {
  std::vector<double> sum(stretch.count + 1, 0.0);
  for (std::size_t i = 0; i < stretch.count; ++i)
    sum[i + 1] = sum[i] + stretch.vertices[i].significance;
  std::vector<float> mean(stretch.count);
  std::size_t begin = 0, end = 0;
  for (std::size_t i = 0; i < stretch.count; ++i) {
    const double reach = LineSignificance::kMeanReach * stretch.vertices[i].radius;
    while (stretch.at[begin] < stretch.at[i] - reach) ++begin;
    while (begin > 0 && stretch.at[begin - 1] >= stretch.at[i] - reach) --begin;
    end = std::max(end, i + 1);
    while (end < stretch.count && stretch.at[end] <= stretch.at[i] + reach) ++end;
    while (end > i + 1 && stretch.at[end - 1] > stretch.at[i] + reach) --end;
    mean[i] = static_cast<float>((sum[end] - sum[begin]) / static_cast<double>(end - begin));
  }
  return mean;
}

/** Appends vertices [begin, end) of a stretch, if they are a line that is kept. */
void keepPart(const Stretch& stretch, const std::vector<float>& significance, std::size_t begin,
              std::size_t end, const LineRule& rule, PictureLine line,
              std::vector<PictureLine>& lines) {
  double pixels = 0, strength = 0, radius = 0;
  float size = 0, peak = 0;
  for (std::size_t i = begin; i < end; ++i) {
    const LineVertex& v = stretch.vertices[i];
    if (i > begin) {
      const LineVertex& last = stretch.vertices[i - 1];
      const float dx = v.x - last.x, dy = v.y - last.y;
      pixels += std::sqrt(dx * dx + dy * dy);
      strength += 0.5 * (v.sharpness + last.sharpness) * (stretch.at[i] - stretch.at[i - 1]);
    }
    size = std::max(size, v.size);
    peak = std::max(peak, significance[i]);
    radius += v.radius / static_cast<double>(end - begin);
  }
  const double length = stretch.at[end - 1] - stretch.at[begin];
  if (!(size >= kReachedSize && peak >= kSignificance.somewhere)) return;
  if (!(pixels >= rule.least_length && strength >= rule.least_strength)) return;
  if (!(length >= kLeastRadii * radius)) return;
  constexpr auto kLeast = static_cast<float>(kSignificance.everywhere);
  // A line just above a threshold is drawn finely: its neighbour, or it in the next view, may be
  // just below. Twice the least significance makes the full width.
  double whole = 1.0 + 3.0 * (peak / kSignificance.somewhere - 1.0);
  if (rule.least_strength > 0) whole = std::min(whole, strength / rule.least_strength);
  for (std::size_t i = begin; i < end; ++i) {
    const LineVertex& v = stretch.vertices[i];
    line.points.push_back({v.x, v.y});
    line.strength.push_back(
        std::min({v.size, significance[i] / kLeast, static_cast<float>(whole)}));
  }
  lines.push_back(std::move(line));
}

void keepParts(const Stretch& stretch, const LineRule& rule, const PictureLine& line,
               std::vector<PictureLine>& lines) {
  const std::vector<float> significance = meanSignificance(stretch);
  for (std::size_t begin = 0; begin < stretch.count;) {
    std::size_t end = begin;
    while (end < stretch.count && significance[end] >= kSignificance.everywhere) ++end;
    if (end > begin) {
      PictureLine part = line;
      part.closed = line.closed && end - begin == stretch.count;
      keepPart(stretch, significance, begin, end, rule, std::move(part), lines);
    }
    begin = end + 1;
  }
}

/** A closed line, opened at a vertex that is not kept, if there is one. */
ZeroLine opened(ZeroLine line) {
  if (!line.closed) return line;
  const auto small = std::find_if(line.vertices.begin(), line.vertices.end(),
                                  [](const LineVertex& v) { return v.size < 1.0f; });
  if (small == line.vertices.end()) return line;
  std::rotate(line.vertices.begin(), small, line.vertices.end());
  line.closed = false;
  return line;
}

}  // namespace

void keepStrong(const std::vector<ZeroLine>& zeros, PictureLineKind kind, const LineRule& rule,
                std::vector<PictureLine>& lines) {
  for (const ZeroLine& zero : zeros) {
    const ZeroLine line = opened(zero);
    PictureLine kept;
    kept.kind = kind;
    kept.closed = line.closed;
    const std::size_t count = line.vertices.size();
    for (std::size_t begin = 0; begin < count;) {
      std::size_t end = begin;
      while (end < count && line.vertices[end].size >= 1.0f) ++end;
      if (end > begin)
        keepParts(Stretch(line.vertices.data() + begin, end - begin), rule, kept, lines);
      begin = end + 1;
    }
  }
}

}  // namespace pcl_slim::detail
