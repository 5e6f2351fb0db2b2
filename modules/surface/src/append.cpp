// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/surface/surface.h"

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

}  // namespace

void
SLIMSurface::append(const SLIMSurface& more)
{
  if (empty()) info = more.info;
  const std::size_t before = size();
  appendTrimMaps(more, before, *this);
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
