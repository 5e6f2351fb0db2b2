// SPDX-License-Identifier: BSD-3-Clause
#include "carrier/split_edges.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "pcl_slim/core/vector3.h"

namespace pcl_slim::detail {
namespace {

using Corners = std::array<std::uint32_t, 3>;
constexpr std::uint32_t kNone = 0xffffffffu;

/** \brief One round: every edge that is too long now is divided once. */
class Round {
 public:
  Round(double longest, TriangleMesh& mesh) : longest_sq_(longest * longest), mesh_(mesh) {}

  /** \return whether an edge was divided */
  bool run() {
    std::vector<Corners> made;
    made.reserve(mesh_.triangles.size());
    for (const Corners& t : mesh_.triangles) {
      Corners middle;
      std::size_t count = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        middle[k] = middleOf(t[k], t[(k + 1) % 3]);
        count += middle[k] != kNone;
      }
      divide(t, middle, count, made);
    }
    mesh_.triangles = std::move(made);
    return !middles_.empty();
  }

 private:
  std::uint32_t middleOf(std::uint32_t a, std::uint32_t b) {
    const Vector3 edge = subtract(mesh_.vertices[b], mesh_.vertices[a]);
    if (!(dot(edge, edge) > longest_sq_)) return kNone;
    const std::uint64_t key = a < b ? std::uint64_t{a} << 32 | b : std::uint64_t{b} << 32 | a;
    const auto [found, is_new] =
        middles_.emplace(key, static_cast<std::uint32_t>(mesh_.vertices.size()));
    if (is_new) addMiddle(a, b);
    return found->second;
  }

  void addMiddle(std::uint32_t a, std::uint32_t b) {
    const Vector3 first = mesh_.vertices[a], second = mesh_.vertices[b];
    mesh_.vertices.push_back(along(first, 0.5, subtract(second, first)));
    if (!mesh_.sigma.empty()) mesh_.sigma.push_back(0.5f * (mesh_.sigma[a] + mesh_.sigma[b]));
    if (mesh_.normals.empty()) return;
    const auto &m = mesh_.normals[a], &n = mesh_.normals[b];
    const Vector3 sum = normalized({double{m[0]} + n[0], double{m[1]} + n[1], double{m[2]} + n[2]});
    mesh_.normals.push_back(
        {static_cast<float>(sum[0]), static_cast<float>(sum[1]), static_cast<float>(sum[2])});
  }

  void divide(const Corners& t, const Corners& middle, std::size_t count,
              std::vector<Corners>& made) const {
    if (count == 0) {
      made.push_back(t);
    } else if (count == 3) {
      made.push_back({t[0], middle[0], middle[2]});
      made.push_back({middle[0], t[1], middle[1]});
      made.push_back({middle[2], middle[1], t[2]});
      made.push_back({middle[0], middle[1], middle[2]});
    } else {
      // Begins at the one divided edge, or at the first of two.
      std::size_t k = 0;
      while (middle[k] == kNone || (count == 2 && middle[(k + 1) % 3] == kNone)) ++k;
      const std::uint32_t a = t[k], b = t[(k + 1) % 3], c = t[(k + 2) % 3];
      const std::uint32_t ab = middle[k], bc = middle[(k + 1) % 3];
      if (count == 1) {
        made.push_back({a, ab, c});
        made.push_back({ab, b, c});
        return;
      }
      made.push_back({ab, b, bc});
      if (distanceSq(a, bc) < distanceSq(ab, c)) {
        made.push_back({a, ab, bc});
        made.push_back({a, bc, c});
      } else {
        made.push_back({a, ab, c});
        made.push_back({ab, bc, c});
      }
    }
  }

  double distanceSq(std::uint32_t a, std::uint32_t b) const {
    const Vector3 d = subtract(mesh_.vertices[b], mesh_.vertices[a]);
    return dot(d, d);
  }

  double longest_sq_;
  TriangleMesh& mesh_;
  std::unordered_map<std::uint64_t, std::uint32_t> middles_;  ///< vertex that divides an edge
};

}  // namespace

void splitLongEdges(double longest, TriangleMesh& mesh) {
  mesh.k1.clear();
  mesh.k2.clear();
  mesh.colors.clear();
  while (Round(longest, mesh).run()) {
  }
}

double areaOf(const TriangleMesh& mesh) {
  double twice = 0.0;
  for (const Corners& t : mesh.triangles) {
    const Vector3& a = mesh.vertices[t[0]];
    twice += length(cross(subtract(mesh.vertices[t[1]], a), subtract(mesh.vertices[t[2]], a)));
  }
  return 0.5 * twice;
}

}  // namespace pcl_slim::detail
