// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/surface/detail/detail_sizes.h"

#include <algorithm>
#include <cmath>

#include "pcl_slim/core/vector3.h"

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

/** \brief Whether a parent's ball contains all that a child alone may cover: as neighbours overlap, the inner part
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

/** \brief Places all over the part of a surfel that rays meet, on its polynomial. */
template <typename Visit>
void
visitPlaces(const SLIMSurface& surface, std::uint32_t surfel, const Visit& visit)
{
  constexpr int kDirections = 8;
  const LocalFrame frame({surface.nx[surfel], surface.ny[surfel], surface.nz[surfel]});
  const Vector3 center{surface.cx[surfel], surface.cy[surfel], surface.cz[surfel]};
  const double radius = surface.radius[surfel];
  for (const double ring : {0.4, 0.8}) {
    for (int k = 0; k < kDirections; ++k) {
      const double angle = 2.0 * std::acos(-1.0) * k / kDirections;
      const double u = ring * std::cos(angle), v = ring * std::sin(angle);
      const double h = evaluateHeight(surface.degree[surfel], surface.coefficientsOf(surfel), u, v);
      if (u * u + v * v + h * h > DetailSizes::kCovers * DetailSizes::kCovers) continue;
      visit(along(along(along(center, radius * u, frame.u), radius * v, frame.v), radius * h,
                  frame.w));
    }
  }
}

/** \brief How far a surfel's surface reaches beyond its children's balls. */
float
overhang(const SLIMSurface& surface, std::uint32_t surfel, std::uint32_t begin, std::uint32_t end)
{
  double farthest = 0.0;
  visitPlaces(surface, surfel, [&](const Vector3& place) {
    double nearest = surface.radius[surfel];
    for (std::uint32_t k = begin; k < end; ++k) {
      const std::uint32_t child = surface.children[k];
      const Vector3 center{surface.cx[child], surface.cy[child], surface.cz[child]};
      nearest = std::min(nearest, length(subtract(place, center)) - surface.radius[child]);
    }
    farthest = std::max(farthest, nearest);
  });
  return static_cast<float>(farthest);
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
    const float beyond = begin < end ? overhang(surface, i, begin, end) : 0.0f;
    const float wrong = 0.5f * std::max(kErrors * surface.error[i], kOverhangs * beyond);
    const float by_error = open[i] ? surface.radius[i] : wrong;
    own[i] = std::max(largest, std::min(surface.radius[i], by_error));
    for (std::uint32_t k = begin; k < end; ++k) {
      const std::uint32_t child = surface.children[k];
      if (holds(surface, i, child)) parent[child] = std::min(parent[child], own[i]);
    }
  }
}

}  // namespace pcl_slim::detail
