// SPDX-License-Identifier: BSD-3-Clause
#include "contour/polygons.h"

#include <algorithm>
#include <limits>

#include "pcl_slim/cloud/morton_sort.h"

namespace pcl_slim::detail {

namespace {

constexpr double kFacesWell =
    0.7;  ///< cosine to the vertices' normals from which on length decides

/** A face without repeated vertices. */
struct Polygon {
  std::uint32_t at[4];
  std::size_t count = 0;

  explicit Polygon(const std::array<std::uint32_t, 4>& around)
  {
    for (std::size_t k = 0; k < 4; ++k) {
      if (around[k] != around[(k + 3) % 4]) at[count++] = around[k];
    }
  }
};

/** How well a triangle faces the normals of its vertices: the least cosine. */
double
facing(const Triangle& t, const std::vector<Vector3>& positions,
       const std::vector<Vector3>& normals)
{
  const Vector3 area =
      cross(subtract(positions[t[1]], positions[t[0]]), subtract(positions[t[2]], positions[t[0]]));
  const double size = length(area);
  if (!(size > 0)) return -1;
  double least = 1;
  for (const std::uint32_t v : t) least = std::min(least, dot(area, normals[v]) / size);
  return least;
}

}  // namespace

std::vector<std::uint32_t>
crowdedCells(const SheetVertices& vertices, int threads)
{
  AlignedVector<std::uint64_t> keys;
  keys.reserve(4 * vertices.of_crossing.size());
  for (const auto& around : vertices.of_crossing) {
    const Polygon polygon(around);
    if (polygon.count < 3) continue;
    for (std::size_t k = 0; k < polygon.count; ++k) {
      const std::uint32_t a = polygon.at[k], b = polygon.at[(k + 1) % polygon.count];
      keys.push_back(static_cast<std::uint64_t>(std::min(a, b)) << 32 | std::max(a, b));
    }
  }
  AlignedVector<std::uint32_t> order;
  sortByKey(keys, order, threads);
  std::vector<std::uint32_t> cells;
  for (std::size_t i = 0; i + 2 < keys.size(); ++i) {
    if (keys[i] != keys[i + 2]) continue;
    cells.push_back(vertices.cell[keys[i] >> 32]);
    cells.push_back(vertices.cell[keys[i] & 0xffffffffu]);
  }
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  return cells;
}

std::vector<Triangle>
cutIntoTriangles(const std::vector<std::array<std::uint32_t, 4>>& faces,
                 const std::vector<Vector3>& positions, const std::vector<Vector3>& normals)
{
  std::vector<Triangle> triangles;
  triangles.reserve(2 * faces.size());
  for (const auto& around : faces) {
    const Polygon p(around);
    if (p.count < 3) continue;
    if (p.count == 3) {
      triangles.push_back({p.at[0], p.at[1], p.at[2]});
      continue;
    }
    const Triangle first[2] = {{p.at[0], p.at[1], p.at[2]}, {p.at[0], p.at[2], p.at[3]}};
    const Triangle second[2] = {{p.at[1], p.at[2], p.at[3]}, {p.at[1], p.at[3], p.at[0]}};
    double well[2];
    well[0] = std::min(facing(first[0], positions, normals), facing(first[1], positions, normals));
    well[1] =
        std::min(facing(second[0], positions, normals), facing(second[1], positions, normals));
    bool take_second = well[1] > well[0];
    if (std::min(well[0], well[1]) > kFacesWell) {
      take_second = length(subtract(positions[p.at[1]], positions[p.at[3]])) <
                    length(subtract(positions[p.at[0]], positions[p.at[2]]));
    }
    for (const Triangle& t : take_second ? second : first) triangles.push_back(t);
  }
  return triangles;
}

}  // namespace pcl_slim::detail
