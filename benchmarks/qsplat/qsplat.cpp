// SPDX-License-Identifier: BSD-3-Clause
#include "qsplat/qsplat.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace pcl_slim::bench {
namespace {

/** Cuts a range in two along the longest side of its box. \return where. */
std::size_t cut(std::vector<Splat>& splats, std::size_t begin, std::size_t end) {
  Vector3 low = splats[begin].center, high = low;
  for (std::size_t i = begin; i < end; ++i) {
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], splats[i].center[a]);
      high[a] = std::max(high[a], splats[i].center[a]);
    }
  }
  const Vector3 size = subtract(high, low);
  const auto axis =
      static_cast<std::size_t>(std::max_element(size.begin(), size.end()) - size.begin());
  const std::size_t middle = (begin + end) / 2;
  const auto at = [&](std::size_t i) { return splats.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(at(begin), at(middle), at(end), [axis](const Splat& a, const Splat& b) {
    return a.center[axis] < b.center[axis];
  });
  return middle;
}

}  // namespace

QSplat::QSplat(std::vector<Splat> splats) {
  if (!splats.empty()) root_ = build(splats, 0, splats.size());
}

std::uint32_t QSplat::build(std::vector<Splat>& splats, std::size_t begin, std::size_t end) {
  Node node{splats[begin], 1.0, 0, 0};
  if (end - begin > 1) {
    // Four children a node, as the paper's average.
    const std::size_t middle = cut(splats, begin, end);
    std::vector<std::size_t> bounds{begin};
    if (middle - begin > 1) bounds.push_back(cut(splats, begin, middle));
    bounds.push_back(middle);
    if (end - middle > 1) bounds.push_back(cut(splats, middle, end));
    bounds.push_back(end);
    std::vector<std::uint32_t> children;
    for (std::size_t i = 0; i + 1 < bounds.size(); ++i) {
      children.push_back(build(splats, bounds[i], bounds[i + 1]));
    }
    Vector3 center{}, normal{};
    for (const std::uint32_t child : children) {
      center =
          along(center, 1.0 / static_cast<double>(children.size()), nodes_[child].sphere.center);
      normal = along(normal, 1.0, nodes_[child].sphere.normal);
    }
    node.sphere = {center, normalized(normal), 0.0};
    double widest = 0.0;
    for (const std::uint32_t child : children) {
      const Node& below = nodes_[child];
      const double distance = length(subtract(below.sphere.center, center));
      node.sphere.radius = std::max(node.sphere.radius, distance + below.sphere.radius);
      const double turn =
          std::acos(std::clamp(dot(below.sphere.normal, node.sphere.normal), -1.0, 1.0));
      widest = std::max(widest, turn + std::acos(below.cosine));
    }
    node.cosine = widest < 1.5 ? std::cos(widest) : -1.0;
    node.first_child = static_cast<std::uint32_t>(links_.size());
    node.children = static_cast<std::uint32_t>(children.size());
    links_.insert(links_.end(), children.begin(), children.end());
  }
  nodes_.push_back(node);
  return static_cast<std::uint32_t>(nodes_.size() - 1);
}

bool QSplat::isHidden(const detail::CameraRays& rays, const Node& node) const {
  if (rays.pixelsOfBall(node.sphere.center, node.sphere.radius).empty()) return true;
  if (node.cosine < 0.0) return false;
  const double open =
      std::acos(node.cosine) + rays.halfAngle(node.sphere.center, node.sphere.radius);
  return open < 1.57 &&
         dot(node.sphere.normal, rays.directionTo(node.sphere.center)) > std::sin(open);
}

void QSplat::drawDisc(const detail::CameraRays& rays, const Splat& disc, std::uint32_t id,
                      GBuffer& buffer) {
  const detail::PixelRect rect = rays.pixelsOfBall(disc.center, disc.radius);
  for (int y = rect.y0; y <= rect.y1; ++y) {
    for (int x = rect.x0; x <= rect.x1; ++x) {
      const detail::Ray ray = rays.ray(x, y);
      const double facing = dot(disc.normal, ray.direction);
      if (!(facing < 0.0)) continue;
      const double depth = dot(disc.normal, subtract(disc.center, ray.origin)) / facing;
      const std::size_t pixel = buffer.index(x, y);
      if (!(depth > 0.0 && depth < buffer.depth[pixel])) continue;
      const Vector3 point = along(ray.origin, depth, ray.direction);
      if (length(subtract(point, disc.center)) > disc.radius) continue;
      buffer.depth[pixel] = static_cast<float>(depth);
      buffer.surfel[pixel] = id;
      for (std::size_t a = 0; a < 3; ++a) {
        buffer.normal[pixel][a] = static_cast<float>(disc.normal[a]);
        buffer.position[pixel][a] = static_cast<float>(point[a]);
      }
    }
  }
}

std::size_t QSplat::draw(const detail::CameraRays& rays, GBuffer& buffer) const {
  std::size_t drawn = 0;
  std::vector<std::uint32_t> stack;
  if (!nodes_.empty()) stack.push_back(root_);
  while (!stack.empty()) {
    const std::uint32_t at = stack.back();
    stack.pop_back();
    const Node& node = nodes_[at];
    if (isHidden(rays, node)) continue;
    const bool small = 2.0 * node.sphere.radius < rays.pixelLength(node.sphere.center);
    if (node.children == 0 || small) {
      drawDisc(rays, node.sphere, at, buffer);
      ++drawn;
      continue;
    }
    for (std::uint32_t k = 0; k < node.children; ++k) stack.push_back(links_[node.first_child + k]);
  }
  return drawn;
}

}  // namespace pcl_slim::bench
