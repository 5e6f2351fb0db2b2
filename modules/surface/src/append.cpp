// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/surface/surface.h"
#include "pcl_slim/surface/surfel_color.h"

namespace pcl_slim {

namespace {

template <typename T>
void
appendTo(std::vector<T>& column, const std::vector<T>& more)
{
  column.insert(column.end(), more.begin(), more.end());
}

/** Appends trim maps; surfels without any have empty ones. */
void
appendTrimMaps(const SLIMSurface& more, std::size_t surfels, SLIMSurface& surface)
{
  if (!surface.hasTrimMaps() && !more.hasTrimMaps()) return;
  const auto bytes = static_cast<std::uint32_t>(surface.trim_maps.size());
  surface.trim_begin.resize(surfels + 1, bytes);
  surface.trim_begin.pop_back();
  for (std::size_t i = 0; i <= more.size(); ++i)
    surface.trim_begin.push_back(bytes + (more.hasTrimMaps() ? more.trim_begin[i] : 0));
  appendTo(surface.trim_maps, more.trim_maps);
}

template <typename T>
std::vector<T>
part(const std::vector<T>& column, std::size_t begin, std::size_t end)
{
  return {column.begin() + static_cast<std::ptrdiff_t>(begin),
          column.begin() + static_cast<std::ptrdiff_t>(end)};
}

/** The trim maps of some surfels; none where all of these are closed. */
void
takeTrimMaps(const SLIMSurface& all, std::size_t begin, std::size_t end, SLIMSurface& some)
{
  if (!all.hasTrimMaps() || all.trim_begin[begin] == all.trim_begin[end]) return;
  some.trim_begin = part(all.trim_begin, begin, end + 1);
  some.trim_maps = part(all.trim_maps, all.trim_begin[begin], all.trim_begin[end]);
  for (std::uint32_t& at : some.trim_begin) at -= all.trim_begin[begin];
}

}  // namespace

SLIMSurface
SLIMSurface::slice(std::size_t begin, std::size_t end) const
{
  const auto width = static_cast<std::size_t>(stride());
  SLIMSurface some;
  some.info = info;
  some.cx = part(cx, begin, end);
  some.cy = part(cy, begin, end);
  some.cz = part(cz, begin, end);
  some.radius = part(radius, begin, end);
  some.nx = part(nx, begin, end);
  some.ny = part(ny, begin, end);
  some.nz = part(nz, begin, end);
  some.coefficients = part(coefficients, begin * width, end * width);
  some.error = part(error, begin, end);
  some.effective_count = part(effective_count, begin, end);
  some.degree = part(degree, begin, end);
  some.level = part(level, begin, end);
  some.flags = part(flags, begin, end);
  takeTrimMaps(*this, begin, end, some);
  if (hasColors()) some.colors = part(colors, begin * kColorBytes, end * kColorBytes);
  return some;
}

void
SLIMSurface::append(const SLIMSurface& more)
{
  if (empty()) info = more.info;
  const std::size_t before = size();
  appendTrimMaps(more, before, *this);
  const bool colored = more.hasColors() && (before == 0 || hasColors());
  if (!colored) colors.clear();
  if (colored) appendTo(colors, more.colors);
  appendTo(cx, more.cx);
  appendTo(cy, more.cy);
  appendTo(cz, more.cz);
  appendTo(radius, more.radius);
  appendTo(nx, more.nx);
  appendTo(ny, more.ny);
  appendTo(nz, more.nz);
  appendTo(coefficients, more.coefficients);
  appendTo(error, more.error);
  appendTo(effective_count, more.effective_count);
  appendTo(degree, more.degree);
  appendTo(level, more.level);
  appendTo(flags, more.flags);
  child_begin.clear();
  children.clear();
  roots.clear();
}

}  // namespace pcl_slim
