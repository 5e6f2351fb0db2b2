// SPDX-License-Identifier: BSD-3-Clause
#include "contour/polygons.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "pcl_slim/cloud/morton_sort.h"

namespace pcl_slim::detail {

namespace {

/** Sets of slots: place k around crossing i is slot 4 i + k. */
class SlotSets {
 public:
  explicit SlotSets(std::size_t count) : parent_(count)
  {
    std::iota(parent_.begin(), parent_.end(), 0u);
  }

  /** The least slot of a set. */
  std::uint32_t find(std::uint32_t i)
  {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b)
  {
    a = find(a);
    b = find(b);
    if (a != b) parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

/** Crossings on one face's border: the slots in the face's first cell and in its second. */
struct FaceEnd {
  std::uint32_t crossing, first, second;
};

class FaceLinker {
 public:
  FaceLinker(const std::vector<EdgeCrossing>& crossings, bool oriented, SlotSets& sets)
      : crossings_(crossings), oriented_(oriented), sets_(sets)
  {
  }

  /** Links what is on one face's border. */
  void link(std::vector<FaceEnd>& ends)
  {
    if (ends.size() == 4) return linkFour(ends);
    while (ends.size() >= 2) {
      std::size_t best_i = 0, best_j = 1;
      double best = std::numeric_limits<double>::infinity();
      for (std::size_t i = 0; ends.size() > 2 && i < ends.size(); ++i) {
        for (std::size_t j = i + 1; j < ends.size(); ++j) {
          const double own = cost(ends[i], ends[j]);
          if (own < best) {
            best = own;
            best_i = i;
            best_j = j;
          }
        }
      }
      join(ends[best_i], ends[best_j]);
      ends.erase(ends.begin() + static_cast<std::ptrdiff_t>(best_j));
      ends.erase(ends.begin() + static_cast<std::ptrdiff_t>(best_i));
    }
  }

 private:
  /** Of the three ways to pair four the one of least cost. */
  void linkFour(const std::vector<FaceEnd>& ends)
  {
    std::size_t best = 1;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t partner = 1; partner < 4; ++partner) {
      const std::size_t p = partner == 1 ? 2 : 1, q = partner == 3 ? 2 : 3;
      const double own = cost(ends[0], ends[partner]) + cost(ends[p], ends[q]);
      if (own < least) {
        least = own;
        best = partner;
      }
    }
    join(ends[0], ends[best]);
    join(ends[best == 1 ? 2 : 1], ends[best == 3 ? 2 : 3]);
  }

  void join(const FaceEnd& a, const FaceEnd& b)
  {
    sets_.join(a.first, b.first);
    sets_.join(a.second, b.second);
  }

  /** How little two crossings look like ends of one curve: they are off each other's tangent planes, or
   * their normals differ. */
  double cost(const FaceEnd& a, const FaceEnd& b) const
  {
    const EdgeCrossing &p = crossings_[a.crossing], &q = crossings_[b.crossing];
    const Vector3 d = subtract(q.position, p.position);
    const double cosine = dot(p.normal, q.normal);
    const double off =
        (std::abs(dot(d, p.normal)) + std::abs(dot(d, q.normal))) / std::max(p.size, q.size);
    return off + 2 * (1 - (oriented_ ? cosine : std::abs(cosine)));
  }

  const std::vector<EdgeCrossing>& crossings_;
  bool oriented_;
  SlotSets& sets_;
};

/** Joins the slots of each crossing's cells that are linked across faces. */
void
linkFaces(const std::vector<EdgeCrossing>& crossings, bool oriented, int threads, SlotSets& sets)
{
  AlignedVector<std::uint64_t> keys;
  std::vector<std::uint32_t> slots;
  keys.reserve(4 * crossings.size());
  slots.reserve(4 * crossings.size());
  for (std::uint32_t i = 0; i < crossings.size(); ++i) {
    for (std::uint32_t k = 0; k < 4; ++k) {
      const std::uint32_t a = crossings[i].cell[k], b = crossings[i].cell[(k + 1) % 4];
      if (a == b) {
        sets.join(4 * i + k, 4 * i + (k + 1) % 4);
        continue;
      }
      keys.push_back(static_cast<std::uint64_t>(std::min(a, b)) << 32 | std::max(a, b));
      slots.push_back(4 * i + k);
    }
  }
  AlignedVector<std::uint32_t> order;
  sortByKey(keys, order, threads);
  FaceLinker linker(crossings, oriented, sets);
  std::vector<FaceEnd> ends;
  for (std::size_t begin = 0; begin < keys.size();) {
    ends.clear();
    std::size_t at = begin;
    for (; at < keys.size() && keys[at] == keys[begin]; ++at) {
      const std::uint32_t slot = slots[order[at]], i = slot / 4, k = slot % 4;
      const std::uint32_t next = 4 * i + (k + 1) % 4;
      const bool ascending = crossings[i].cell[k] < crossings[i].cell[(k + 1) % 4];
      ends.push_back({i, ascending ? slot : next, ascending ? next : slot});
    }
    linker.link(ends);
    begin = at;
  }
}

/** Numbers the sets by cell, then by their least slot. */
std::vector<std::uint32_t>
numberSets(const std::vector<EdgeCrossing>& crossings, int threads, SlotSets& sets,
           std::vector<std::uint32_t>& cells)
{
  AlignedVector<std::uint64_t> keys;
  std::vector<std::uint32_t> roots;
  for (std::uint32_t slot = 0; slot < 4 * crossings.size(); ++slot) {
    if (sets.find(slot) != slot) continue;
    keys.push_back(crossings[slot / 4].cell[slot % 4]);
    roots.push_back(slot);
  }
  AlignedVector<std::uint32_t> order;
  sortByKey(keys, order, threads);
  std::vector<std::uint32_t> number(4 * crossings.size());
  for (std::uint32_t v = 0; v < order.size(); ++v) {
    number[roots[order[v]]] = v;
    cells.push_back(static_cast<std::uint32_t>(keys[v]));
  }
  for (std::uint32_t slot = 0; slot < number.size(); ++slot) number[slot] = number[sets.find(slot)];
  return number;
}

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

SheetVertices
findSheetVertices(const std::vector<EdgeCrossing>& crossings, bool oriented, int threads)
{
  SlotSets sets(4 * crossings.size());
  linkFaces(crossings, oriented, threads, sets);
  SheetVertices made;
  const std::vector<std::uint32_t> number = numberSets(crossings, threads, sets, made.cell);
  const std::size_t count = made.cell.size();
  made.position.assign(count, {});
  made.normal.assign(count, {});
  made.size.assign(count, std::numeric_limits<float>::max());
  made.of_crossing.resize(crossings.size());
  std::vector<std::uint32_t> members(count, 0);
  for (std::size_t i = 0; i < crossings.size(); ++i) {
    const EdgeCrossing& own = crossings[i];
    for (std::size_t k = 0; k < 4; ++k) {
      const std::uint32_t v = number[4 * i + k];
      made.of_crossing[i][k] = v;
      if (k > 0 && own.cell[k] == own.cell[k - 1]) continue;
      if (k == 3 && own.cell[3] == own.cell[0]) continue;
      const bool turned = !oriented && dot(made.normal[v], own.normal) < 0;
      made.position[v] = along(made.position[v], 1, own.position);
      made.normal[v] = along(made.normal[v], turned ? -1 : 1, own.normal);
      made.size[v] = std::min(made.size[v], own.size);
      ++members[v];
    }
  }
  for (std::size_t v = 0; v < count; ++v) {
    made.position[v] = scaled(made.position[v], 1.0 / members[v]);
    made.normal[v] = normalized(made.normal[v]);
  }
  return made;
}

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
