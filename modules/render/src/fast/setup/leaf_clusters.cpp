// SPDX-License-Identifier: BSD-3-Clause
#include "fast/setup/leaf_setup.h"

#include <algorithm>
#include <cmath>

#include "pcl_slim/cloud/morton.h"
#include "pcl_slim/cloud/morton_sort.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/surface/detail/detail_sizes.h"
#include "tiles/tiles.h"

namespace pcl_slim::detail {
namespace {

/** \brief Length and inner products of a point seen from the camera. */
struct Seen {
  double x, y, z, distance_sq;

  Seen(const FrameView& view, const float point[3]) {
    double p[3];
    for (int a = 0; a < 3; ++a) p[a] = double{point[a]} - view.eye[a] - view.eye_rest[a];
    x = p[0] * view.right[0] + p[1] * view.right[1] + p[2] * view.right[2];
    y = p[0] * view.up[0] + p[1] * view.up[1] + p[2] * view.up[2];
    z = p[0] * view.forward[0] + p[1] * view.forward[1] + p[2] * view.forward[2];
    distance_sq = p[0] * p[0] + p[1] * p[1] + p[2] * p[2];
  }
};

/** \brief True if a ball at coordinate x, depth z is beyond the side of the picture at slope t. */
bool beyond(bool perspective, double x, double z, double t, double radius) {
  return perspective ? x - t * z > radius * std::sqrt(1.0 + t * t) : x - t > radius;
}

bool outsideFrustum(const FrameView& view, const Seen& p, double radius) {
  if (p.z + radius <= 0.0) return true;
  // Half a pixel on top of the outermost rays keeps rounding out of it.
  const double right = (view.width - 0.5 - view.center_x) * view.pixel;
  const double left = (view.center_x + 0.5) * view.pixel;
  const double top = (view.center_y + 0.5) * view.pixel;
  const double bottom = (view.height - 0.5 - view.center_y) * view.pixel;
  return beyond(view.perspective, p.x, p.z, right, radius) ||
         beyond(view.perspective, -p.x, p.z, left, radius) ||
         beyond(view.perspective, p.y, p.z, top, radius) ||
         beyond(view.perspective, -p.y, p.z, bottom, radius);
}

/** \brief Angle between a unit vector and a vector of a length. */
double angleTo(const float axis[3], const Vector3& direction) {
  const double cosine = axis[0] * direction[0] + axis[1] * direction[1] + axis[2] * direction[2];
  return std::acos(std::clamp(cosine, -1.0, 1.0));
}

bool turnedAway(const FrameView& view, const Seen& p, const LeafCluster& cluster) {
  constexpr double kMargin = 1e-3;  // radians, above any rounding here
  const double distance = std::sqrt(p.distance_sq);
  Vector3 direction{view.forward[0], view.forward[1], view.forward[2]};
  double spread = cluster.cone;
  if (view.perspective) {
    if (!(distance > cluster.radius)) return false;
    spread += std::asin(cluster.radius / distance);
    for (std::size_t a = 0; a < 3; ++a) {
      direction[a] = (double{cluster.center[a]} - view.eye[a] - view.eye_rest[a]) / distance;
    }
  }
  return angleTo(cluster.axis, direction) + spread < 0.5 * M_PI - kMargin;
}

/** \brief Whether balls whose gradients are in a cone may be seen. Errs on the visible side. */
Visibility visibilityOf(const FrameView& view, const LeafCluster& cluster,
                        const VisibilityRules& rules) {
  const Seen p(view, cluster.center);
  if (outsideFrustum(view, p, cluster.radius)) return Visibility::kOutside;
  if (isCutAway(rules.cuts, {cluster.center[0], cluster.center[1], cluster.center[2]},
                cluster.radius)) {
    return Visibility::kCutAway;
  }
  if (rules.detail.active()) {
    const double lod = 0.5 * rules.detail.lod * view.pixel;  // radii on the plane z = 1
    const double near = view.perspective ? p.z - cluster.radius : 1.0;
    const double far = view.perspective ? p.z + cluster.radius : 1.0;
    if (near > 0.0 && cluster.largest < lod * near) return Visibility::kTooSmall;
    if (cluster.smallest > DetailRule::kFade * lod * far) return Visibility::kTooLarge;
  }
  if (rules.front_only && turnedAway(view, p, cluster)) return Visibility::kBackFacing;
  return Visibility::kVisible;
}

}  // namespace

LeafClusters::LeafClusters(const SLIMSurface& surface, int threads, ClusteredSurfels which) {
  std::vector<std::uint32_t> leaves;
  std::vector<std::vector<std::uint32_t>> levels(256);
  for (std::uint32_t i = 0; i < surface.size(); ++i) {
    if (surface.isLeaf(i))
      leaves.push_back(i);
    else
      levels[surface.level[i]].push_back(i);
  }
  if (which == ClusteredSurfels::kLeaves) {
    sortSurfels(surface, std::move(leaves), threads);
  } else {
    for (auto& level : levels) sortSurfels(surface, std::move(level), threads);
  }
  fillColumns(surface);
  fillSizes(surface);
  for (std::uint32_t begin = 0; begin < size(); begin += kClusterSize) {
    clusters_.push_back(
        enclose(begin, std::min(begin + kClusterSize, static_cast<std::uint32_t>(size()))));
  }
}

void LeafClusters::sortSurfels(const SLIMSurface& surface, std::vector<std::uint32_t> surfels,
                               int threads) {
  AlignedVector<std::uint64_t> keys;
  keys.reserve(surfels.size());
  for (const std::uint32_t i : surfels) {
    keys.push_back(mortonCode(surface.cx[i], surface.cy[i], surface.cz[i]));
  }
  AlignedVector<std::uint32_t> order;
  sortByKey(keys, order, threads);
  for (const std::uint32_t i : order) surfel.push_back(surfels[i]);
}

void LeafClusters::fillSizes(const SLIMSurface& surface) {
  const DetailSizes sizes(surface);
  own_size.assign(x.size(), 0.0f);
  parent_size.assign(x.size(), DetailSizes::kNoParent);
  for (std::size_t i = 0; i < size(); ++i) {
    own_size[i] = sizes.own[surfel[i]];
    parent_size[i] = sizes.parent[surfel[i]];
  }
}

void LeafClusters::fillColumns(const SLIMSurface& surface) {
  const std::size_t padded = (size() + kClusterSize - 1) / kClusterSize * kClusterSize;
  for (auto* column : {&x, &y, &z, &radius, &nx, &ny, &nz, &sine, &variance_weight}) {
    column->assign(padded, 0.0f);
  }
  for (std::size_t i = 0; i < size(); ++i) {
    const std::size_t s = surfel[i];
    x[i] = surface.cx[s];
    y[i] = surface.cy[s];
    z[i] = surface.cz[s];
    radius[i] = surface.radius[s];
    nx[i] = surface.nx[s];
    ny[i] = surface.ny[s];
    nz[i] = surface.nz[s];
    sine[i] = static_cast<float>(std::sin(std::atan(slopeBound(surface, s))));
    variance_weight[i] = surface.info.paper_mode ? 1.0f : surface.varianceWeight(s);
  }
}

LeafCluster LeafClusters::enclose(std::uint32_t begin, std::uint32_t end) const {
  LeafCluster cluster{};
  cluster.begin = begin;
  cluster.end = end;
  float low[3], high[3];
  const AlignedVector<float>* columns[3] = {&x, &y, &z};
  Vector3 sum{0.0, 0.0, 0.0};
  for (int a = 0; a < 3; ++a) {
    const auto first = columns[a]->begin() + begin, last = columns[a]->begin() + end;
    low[a] = *std::min_element(first, last);
    high[a] = *std::max_element(first, last);
    cluster.center[a] = 0.5f * (low[a] + high[a]);
  }
  for (std::uint32_t i = begin; i < end; ++i) sum = along(sum, 1.0, {nx[i], ny[i], nz[i]});
  const Vector3 axis = normalized(sum);
  for (std::size_t a = 0; a < 3; ++a) cluster.axis[a] = static_cast<float>(axis[a]);
  double reach = 0.0, cone = length(axis) > 0.5 ? 0.0 : 2.0 * M_PI;
  for (std::uint32_t i = begin; i < end; ++i) {
    const Vector3 d{x[i] - cluster.center[0], y[i] - cluster.center[1], z[i] - cluster.center[2]};
    reach = std::max(reach, length(d) + radius[i]);
    cone = std::max(cone, angleTo(cluster.axis, {nx[i], ny[i], nz[i]}) + std::asin(sine[i]));
  }
  cluster.smallest = *std::min_element(own_size.begin() + begin, own_size.begin() + end);
  cluster.largest = *std::max_element(parent_size.begin() + begin, parent_size.begin() + end);
  cluster.radius = static_cast<float>(reach * (1.0 + 1e-6));
  cluster.cone = static_cast<float>(cone + 1e-5);
  return cluster;
}

void LeafClusters::findVisible(const FrameView& view, const VisibilityRules& rules,
                               std::vector<std::uint32_t>& visible, std::uint64_t* hidden) const {
  for (std::uint32_t c = 0; c < clusters_.size(); ++c) {
    const Visibility visibility = visibilityOf(view, clusters_[c], rules);
    if (visibility == Visibility::kVisible)
      visible.push_back(c);
    else
      hidden[static_cast<std::size_t>(visibility)] += clusters_[c].end - clusters_[c].begin;
  }
}

}  // namespace pcl_slim::detail
