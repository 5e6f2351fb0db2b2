// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/surface/detail/detail_sizes.h"

#include <algorithm>

namespace pcl_slim::detail {
namespace {

/** \brief Surfels, the finest levels' first. */
std::vector<std::uint32_t>
fromFinest(const SLIMSurface& surface)
{
  std::vector<std::uint32_t> begin(257, 0), order(surface.size());
  for (std::size_t i = 0; i < surface.size(); ++i) ++begin[256u - surface.level[i]];
  for (std::size_t k = 1; k < begin.size(); ++k) begin[k] += begin[k - 1];
  for (std::size_t i = 0; i < surface.size(); ++i) {
    order[begin[255u - surface.level[i]]++] = static_cast<std::uint32_t>(i);
  }
  return order;
}

/** \brief Whether a parent's ball holds all that a child alone may cover: as neighbours overlap, the inner part
 * of its ball. */
bool
holds(const SLIMSurface& surface, std::uint32_t parent, std::uint32_t child)
{
  // Rays meet leaves and internal surfels elsewhere too, but never further from the nearest of their kind.
  const float inner = surface.isLeaf(child) ? 0.5f : 0.7f;
  const float x = surface.cx[child] - surface.cx[parent],
              y = surface.cy[child] - surface.cy[parent];
  const float z = surface.cz[child] - surface.cz[parent];
  const float rest = DetailSizes::kCovers * surface.radius[parent] - inner * surface.radius[child];
  return rest > 0.0f && x * x + y * y + z * z <= rest * rest;
}

}  // namespace

DetailSizes::DetailSizes(const SLIMSurface& surface)
    : own(surface.size(), 0.0f), parent(surface.size(), kNoParent)
{
  const bool linked = surface.child_begin.size() == surface.size() + 1;
  const bool trimmed = !surface.trim_begin.empty();
  std::vector<bool> open(surface.size(), false);  // it or a descendant has a border
  for (const std::uint32_t i : fromFinest(surface)) {
    open[i] = trimmed && surface.trim_begin[i] < surface.trim_begin[i + 1];
    if (surface.isLeaf(i)) continue;
    const std::uint32_t begin = linked ? surface.child_begin[i] : 0;
    const std::uint32_t end = linked ? surface.child_begin[i + 1] : 0;
    float largest = 0.0f;
    for (std::uint32_t k = begin; k < end; ++k) {
      const std::uint32_t child = surface.children[k];
      largest = std::max(largest, own[child]);
      open[i] = open[i] || open[child];
    }
    const float by_error = open[i] ? surface.radius[i] : 0.5f * kErrors * surface.error[i];
    own[i] = std::max(largest, std::min(surface.radius[i], by_error));
    for (std::uint32_t k = begin; k < end; ++k) {
      const std::uint32_t child = surface.children[k];
      if (holds(surface, i, child)) parent[child] = std::min(parent[child], own[i]);
    }
  }
}

}  // namespace pcl_slim::detail
