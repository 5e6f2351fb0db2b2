// SPDX-License-Identifier: BSD-3-Clause
#include "sides/facing.h"

#include <cmath>
#include <numeric>

namespace pcl_slim::sides {

namespace {

/** Normals more than 60 degrees off the true line are at edges, of another sheet, or noise. */
constexpr double kLeastCosine = 0.5;

Vector3 toDouble(const std::array<float, 3>& v) {
  return {v[0], v[1], v[2]};
}

}  // namespace

Truth::Truth(const std::vector<Vector3>& points, const std::vector<Vector3>& normals,
             const std::vector<Vector3>& sensors)
    : normals_(normals), sensors_(sensors) {
  if (!normals_.empty() || sensors_.size() > 1) tree_.emplace(points);
}

double Truth::cosine(const Vector3& place, const Vector3& normal) const {
  if (!known() || !isFinite(normal)) return 0;
  return cosineOf(tree_ ? tree_->nearest(place, 1)[0] : 0, place, normal);
}

double Truth::cosineOf(std::size_t point, const Vector3& place, const Vector3& normal) const {
  if (!known() || !isFinite(normal)) return 0;
  const Vector3 unit = normalized(normal);
  const double cosine = normals_.empty() ? 1 : dot(unit, normals_[point]);
  if (std::abs(cosine) < kLeastCosine) return 0;
  if (sensors_.empty()) return cosine;
  const Vector3& sensor = sensors_[sensors_.size() == 1 ? 0 : point];
  return dot(unit, normalized(subtract(sensor, place)));
}

Share facingLeaves(const SLIMSurface& surface, const Truth& truth) {
  Share share;
  for (const std::uint32_t i : surface.leaves()) {
    const Vector3 center = along(surface.info.origin, surface.info.scale,
                                 {surface.cx[i], surface.cy[i], surface.cz[i]});
    const double radius = surface.radius[i];
    share.add(truth.cosine(center, {surface.nx[i], surface.ny[i], surface.nz[i]}), radius * radius);
  }
  return share;
}

Share facingPoints(const CloudProjection& projection, const std::vector<std::size_t>& kept,
                   const Truth& truth) {
  Share share;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    if (!projection.isSupported(kept[i])) continue;
    const ProjectedPoint point = projection.point(kept[i]);
    share.add(truth.cosineOf(i, point.position, toDouble(point.normal)), 1);
  }
  return share;
}

Share facingSplats(const SplatSet& splats, const Truth& truth) {
  Share share;
  for (std::size_t i = 0; i < splats.size(); ++i) {
    const Vector3 center = along(splats.origin, 1, {splats.x[i], splats.y[i], splats.z[i]});
    share.add(truth.cosine(center, {splats.nx[i], splats.ny[i], splats.nz[i]}),
              splats.confidence[i]);
  }
  return share;
}

namespace {

/** Sets of vertices that triangles connect. */
class Components {
 public:
  explicit Components(const TriangleMesh& mesh) : parent_(mesh.vertices.size()) {
    std::iota(parent_.begin(), parent_.end(), 0);
    for (const auto& t : mesh.triangles) {
      parent_[root(t[1])] = root(t[0]);
      parent_[root(t[2])] = root(t[0]);
    }
  }

  std::uint32_t root(std::uint32_t v) {
    while (parent_[v] != v) v = parent_[v] = parent_[parent_[v]];
    return v;
  }

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace

MeshSides facingMesh(const TriangleMesh& mesh, const Truth& truth) {
  MeshSides sides;
  Components components(mesh);
  std::vector<Share> shares(mesh.vertices.size());
  std::vector<double> areas(mesh.vertices.size(), 0);
  double total = 0;
  for (const auto& t : mesh.triangles) {
    const Vector3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    const Vector3 normal = cross(subtract(b, a), subtract(c, a));
    const double area = 0.5 * length(normal);
    const Vector3 middle = scaled(along(along(a, 1, b), 1, c), 1.0 / 3);
    const double cosine = area > 0 ? truth.cosine(middle, normal) : 0;
    const std::uint32_t component = components.root(t[0]);
    sides.all.add(cosine, area);
    shares[component].add(cosine, area);
    areas[component] += area;
    total += area;
  }
  for (std::size_t v = 0; v < shares.size(); ++v) {
    if (2 * shares[v].right < shares[v].judged) sides.wrong_components += 100 * areas[v] / total;
  }
  return sides;
}

}  // namespace pcl_slim::sides
