// SPDX-License-Identifier: BSD-3-Clause
#include "contour/contour.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <utility>

#include "pcl_slim/cloud/morton.h"
#include "pcl_slim/cloud/morton_sort.h"

namespace pcl_slim::detail {

namespace {

std::uint64_t keyOf(const std::uint32_t (&place)[3]) {
  return spreadBits(place[0]) << 2 | spreadBits(place[1]) << 1 | spreadBits(place[2]);
}

Vector3 placeOf(const CellTree& tree, std::uint64_t key) {
  const std::uint32_t place[3] = {gatherBits(key >> 2), gatherBits(key >> 1), gatherBits(key)};
  return tree.corner(place);
}

/// Ends whose normals agree are of one sheet unless the distances, in edges, are out of all
/// proportion; polynomials err at corners that far off.
constexpr double kMostOfSheet = 2.5, kMostSumOfSheet = 3;
/// Others may be of two sheets: then the distances' sum is larger than the normals predict.
constexpr double kMostDistance = 1.5, kSlope = 1.3, kSlack = 0.6;

/** The crossing of an edge between a and b, which has the length given. \return false: there is
 * none. */
bool crossingOf(const SheetDistance& a, const SheetDistance& b, bool oriented, unsigned int axis,
                double edge, double& share, Vector3& normal) {
  if (!a.known || !b.known) return false;
  const double cosine = static_cast<double>(a.normal[0]) * b.normal[0] +
                        static_cast<double>(a.normal[1]) * b.normal[1] +
                        static_cast<double>(a.normal[2]) * b.normal[2];
  const double turn = !oriented && cosine < 0 ? -1 : 1;
  const double fa = a.distance, fb = turn * b.distance;
  if ((fa < 0) == (fb < 0)) return false;
  const double sum = std::abs(fa) + std::abs(fb);
  const double slope = std::max(std::abs(a.normal[axis]), std::abs(b.normal[axis]));
  const bool agree = turn * cosine > 0;
  const double most_sum = agree ? kMostSumOfSheet : kSlope * slope + kSlack;
  const double most = agree ? kMostOfSheet : kMostDistance;
  if (std::max(std::abs(fa), std::abs(fb)) > most * edge || sum > most_sum * edge) return false;
  share = sum > 0 ? std::abs(fa) / sum : 0.5;
  for (std::size_t k = 0; k < 3; ++k) {
    normal[k] = (1 - share) * a.normal[k] + share * turn * b.normal[k];
  }
  normal = normalized(normal);
  // The normal points from the inner end to the outer one.
  if ((fa < 0) != (normal[axis] > 0)) return std::abs(normal[axis]) < 0.5;
  return true;
}

}  // namespace

std::vector<std::array<std::uint32_t, 2>> CornerValues::evaluate(
    const CellTree& tree, const std::vector<CellEdge>& edges) {
  AlignedVector<std::uint64_t> ends(2 * edges.size());
  parallelFor(edges.size(), field_.threads, 4096, [&](std::size_t e, int) {
    std::uint32_t place[3] = {edges[e].low[0], edges[e].low[1], edges[e].low[2]};
    ends[2 * e] = keyOf(place);
    place[edges[e].axis] += CellTree::width(edges[e].depth);
    ends[2 * e + 1] = keyOf(place);
  });
  AlignedVector<std::uint32_t> order;
  sortByKey(ends, order, field_.threads);
  std::vector<std::uint64_t> keys(ends.begin(), ends.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  merge(tree, keys);
  std::vector<std::array<std::uint32_t, 2>> corners(edges.size());
  std::size_t at = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    while (keys_[at] != ends[i]) ++at;
    corners[order[i] / 2][order[i] % 2] = static_cast<std::uint32_t>(at);
  }
  return corners;
}

/** Adds corners to those known, and evaluates the new ones. */
void CornerValues::merge(const CellTree& tree, const std::vector<std::uint64_t>& keys) {
  std::vector<std::uint64_t> all;
  all.reserve(keys_.size() + keys.size());
  std::set_union(keys_.begin(), keys_.end(), keys.begin(), keys.end(), std::back_inserter(all));
  std::vector<SheetDistance> values(all.size());
  std::vector<std::uint32_t> missing;
  std::size_t old = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (old < keys_.size() && keys_[old] == all[i]) {
      values[i] = values_[old++];
    } else {
      missing.push_back(static_cast<std::uint32_t>(i));
    }
  }
  forProbeBlocks(field_, missing.size(),
                 [&](SurfaceProbe& probe, std::size_t first, std::size_t n) {
                   Vector3 places[SurfaceProbe::kMost] = {};
                   SheetDistance found[SurfaceProbe::kMost];
                   for (std::size_t i = 0; i < n; ++i) {
                     places[i] = placeOf(tree, all[missing[first + i]]);
                   }
                   probe.distances(places, n, found);
                   for (std::size_t i = 0; i < n; ++i) values[missing[first + i]] = found[i];
                 });
  keys_ = std::move(all);
  values_ = std::move(values);
}

void findCrossings(const CellTree& tree, const std::vector<CellEdge>& edges,
                   const std::vector<std::array<std::uint32_t, 2>>& ends,
                   const std::vector<SheetDistance>& values, bool oriented,
                   std::vector<EdgeCrossing>& crossings) {
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const SheetDistance &a = values[ends[e][0]], &b = values[ends[e][1]];
    const CellEdge& edge = edges[e];
    double share = 0;
    EdgeCrossing made{};
    const double size = tree.size(edge.depth);
    if (!crossingOf(a, b, oriented, edge.axis, size, share, made.normal)) continue;
    made.position = tree.corner(edge.low);
    made.position[edge.axis] += share * size;
    made.size = static_cast<float>(size);
    std::copy(edge.cell, edge.cell + 4, made.cell);
    // Seen from the upper end the ring is counter-clockwise: right where that is outside.
    if (!(a.distance < 0)) std::swap(made.cell[1], made.cell[3]);
    crossings.push_back(made);
  }
}

namespace {

/** Sets of slots: place k around crossing i is slot 4 i + k. */
class SlotSets {
 public:
  explicit SlotSets(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), 0u);
  }

  /** The least slot of a set. */
  std::uint32_t find(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) {
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
      : crossings_(crossings), oriented_(oriented), sets_(sets) {}

  /** Links what is on one face's border. */
  void link(std::vector<FaceEnd>& ends) {
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
  void linkFour(const std::vector<FaceEnd>& ends) {
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

  void join(const FaceEnd& a, const FaceEnd& b) {
    sets_.join(a.first, b.first);
    sets_.join(a.second, b.second);
  }

  /** How little two crossings look like ends of one curve: they are off each other's tangent
   * planes, or their normals differ. */
  double cost(const FaceEnd& a, const FaceEnd& b) const {
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
void linkFaces(const std::vector<EdgeCrossing>& crossings, bool oriented, int threads,
               SlotSets& sets) {
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
std::vector<std::uint32_t> numberSets(const std::vector<EdgeCrossing>& crossings, int threads,
                                      SlotSets& sets, std::vector<std::uint32_t>& cells) {
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

  explicit Polygon(const std::array<std::uint32_t, 4>& around) {
    for (std::size_t k = 0; k < 4; ++k) {
      if (around[k] != around[(k + 3) % 4]) at[count++] = around[k];
    }
  }
};

/** How well a triangle faces the normals of its vertices: the least cosine. */
double facing(const Triangle& t, const std::vector<Vector3>& positions,
              const std::vector<Vector3>& normals) {
  const Vector3 area =
      cross(subtract(positions[t[1]], positions[t[0]]), subtract(positions[t[2]], positions[t[0]]));
  const double size = length(area);
  if (!(size > 0)) return -1;
  double least = 1;
  for (const std::uint32_t v : t) least = std::min(least, dot(area, normals[v]) / size);
  return least;
}

}  // namespace

SheetVertices findSheetVertices(const std::vector<EdgeCrossing>& crossings, bool oriented,
                                int threads) {
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

std::vector<std::uint32_t> crowdedCells(const SheetVertices& vertices, int threads) {
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

std::vector<Triangle> cutIntoTriangles(const std::vector<std::array<std::uint32_t, 4>>& faces,
                                       const std::vector<Vector3>& positions,
                                       const std::vector<Vector3>& normals) {
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
