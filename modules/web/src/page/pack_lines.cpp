// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>

#include "columns/gzip.h"
#include "columns/web_columns.h"
#include "columns/web_header.h"
#include "page/page_text.h"

namespace pcl_slim::detail {

Result<std::vector<unsigned char>>
packLines(const std::vector<SpaceLine>& lines, const std::array<double, 3>& origin, double scale)
{
  std::array<std::vector<double>, 3> axes;
  std::vector<std::uint32_t> kinds, counts;
  for (const SpaceLine& line : lines) {
    kinds.push_back(line.kind == PictureLineKind::kRidge ? 0 : 1);
    counts.push_back(static_cast<std::uint32_t>(line.points.size()));
    for (const auto& point : line.points) {
      for (std::size_t k = 0; k < 3; ++k) axes[k].push_back((point[k] - origin[k]) / scale);
    }
  }
  double extent = std::numeric_limits<double>::min();
  std::array<double, 3> corner{};
  for (std::size_t k = 0; k < 3 && !axes[k].empty(); ++k) {
    const auto [least, most] = std::minmax_element(axes[k].begin(), axes[k].end());
    corner[k] = *least;
    extent = std::max(extent, *most - *least);
  }
  const double step = extent / kCenterSteps;
  PlaneWriter out;
  out.putNumber(static_cast<std::uint32_t>(lines.size()));
  out.put(kinds, 1);
  out.put(counts, 4);
  out.putDouble(step);
  for (std::size_t k = 0; k < 3; ++k) {
    std::uint32_t last = 0;
    std::vector<std::uint32_t> steps;
    for (const double x : axes[k]) {
      const auto cell = static_cast<std::uint32_t>(std::lround((x - corner[k]) / step));
      steps.push_back((cell - last) & 0xffffu);
      last = cell;
    }
    out.putDouble(corner[k]);
    out.put(steps, 2);
  }
  return gzip(out.data);
}

}  // namespace pcl_slim::detail
