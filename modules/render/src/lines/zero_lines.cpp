// SPDX-License-Identifier: BSD-3-Clause
#include "lines/zero_lines.h"

#include <algorithm>
#include <cmath>

#include "lines/chains.h"
#include "pcl_slim/core/parallel.h"

namespace pcl_slim::detail {

namespace {

constexpr float kReach = 2.0f;  ///< strength that a line has somewhere

/** Edges of the grid of pixel centres: 2 i from pixel i to the right, 2 i + 1 down. */
struct Grid {
  const ZeroField& field;
  int width;

  std::size_t other(std::uint32_t edge) const { return edge / 2 + (edge % 2 == 0 ? 1 : width); }

  /** Where the field crosses zero on an edge, as a share of it; negative: nowhere. */
  float crossing(std::uint32_t edge) const
  {
    const std::size_t a = edge / 2, b = other(edge);
    if (!field.valid(a) || !field.valid(b)) return -1.0f;
    const float at_a = field.value(a, a), at_b = field.value(b, a);
    if ((at_a < 0) == (at_b < 0)) return -1.0f;
    return at_a / (at_a - at_b);
  }

  LineVertex vertexOn(std::uint32_t edge) const
  {
    const std::size_t a = edge / 2;
    const float share = crossing(edge);
    const auto x = static_cast<float>(a % width), y = static_cast<float>(a / width);
    const bool right = edge % 2 == 0;
    return {right ? x + share : x, right ? y : y + share, field.strength(a, other(edge), share)};
  }

  /** The piece of a line through the cell below and right of a pixel, if there is one. */
  bool linkIn(std::size_t pixel, Link& link) const
  {
    const auto valid = [&](std::size_t i) { return field.valid(i); };
    if (valid(pixel) + valid(pixel + 1) + valid(pixel + width) + valid(pixel + width + 1) < 3)
      return false;
    const auto top = static_cast<std::uint32_t>(2 * pixel), left = top + 1;
    const auto right = static_cast<std::uint32_t>(2 * (pixel + 1) + 1);
    const auto bottom = static_cast<std::uint32_t>(2 * (pixel + width));
    std::size_t count = 0;
    for (const std::uint32_t edge : {top, left, right, bottom}) {
      if (crossing(edge) < 0) continue;
      if (count == 2) return false;
      link.joint[count++] = edge;
    }
    return count == 2;
  }
};

}  // namespace

std::vector<ZeroLine>
traceZeros(const ZeroField& field, int width, int height, int threads)
{
  const Grid grid{field, width};
  std::vector<std::vector<Link>> rows(static_cast<std::size_t>(std::max(0, height - 1)));
  parallelFor(rows.size(), threads, 8, [&](std::size_t y, int) {
    Link link;
    for (int x = 0; x + 1 < width; ++x) {
      if (grid.linkIn(y * width + x, link)) rows[y].push_back(link);
    }
  });
  std::vector<Link> links;
  for (const auto& row : rows) links.insert(links.end(), row.begin(), row.end());

  const std::vector<Chain> chains = joinLinks(links, 2 * static_cast<std::size_t>(width) * height);
  std::vector<ZeroLine> lines(chains.size());
  parallelFor(chains.size(), threads, 8, [&](std::size_t i, int) {
    lines[i].closed = chains[i].closed;
    for (const std::uint32_t edge : chains[i].joints)
      lines[i].vertices.push_back(grid.vertexOn(edge));
  });
  return lines;
}

namespace {

/** Appends vertices [begin, end) of a line as a line of its own, if it is long and strong enough. */
void
keepStretch(const std::vector<LineVertex>& vertices, std::size_t begin, std::size_t end,
            PictureLine line, double least_length, std::vector<PictureLine>& lines)
{
  double length = 0;
  float strongest = 0;
  for (std::size_t i = begin; i < end; ++i) {
    const LineVertex& v = vertices[i];
    if (i > begin) length += std::hypot(v.x - vertices[i - 1].x, v.y - vertices[i - 1].y);
    strongest = std::max(strongest, v.strength);
    line.points.push_back({v.x, v.y});
    line.strength.push_back(v.strength);
  }
  if (strongest >= kReach && length >= least_length) lines.push_back(std::move(line));
}

/** A closed line, opened at a vertex that is not kept, if there is one. */
ZeroLine
opened(ZeroLine line)
{
  for (std::size_t i = 0; line.closed && i < line.vertices.size(); ++i) {
    if (line.vertices[i].strength >= 1.0f) continue;
    std::rotate(line.vertices.begin(), line.vertices.begin() + static_cast<std::ptrdiff_t>(i),
                line.vertices.end());
    line.closed = false;
  }
  return line;
}

}  // namespace

void
keepStrong(const std::vector<ZeroLine>& zeros, PictureLineKind kind, double least_length,
           std::vector<PictureLine>& lines)
{
  for (const ZeroLine& zero : zeros) {
    const ZeroLine line = opened(zero);
    PictureLine kept;
    kept.kind = kind;
    kept.closed = line.closed;
    const std::size_t count = line.vertices.size();
    for (std::size_t begin = 0; begin < count;) {
      std::size_t end = begin;
      while (end < count && line.vertices[end].strength >= 1.0f) ++end;
      if (end > begin) keepStretch(line.vertices, begin, end, kept, least_length, lines);
      begin = end + 1;
    }
  }
}

}  // namespace pcl_slim::detail
