// SPDX-License-Identifier: BSD-3-Clause
// The recursion over cells, faces and edges of Ju, Losasso, Schaefer, Warren: Dual contouring of
// Hermite data, SIGGRAPH 2002.
#include "octree/cell_edges.h"

#include <algorithm>
#include <cstddef>

namespace pcl_slim::detail {

namespace {

/** A node with its place. */
struct Placed {
  std::uint32_t node = 0;
  CellPlace place;
};

/** The bit of an octant's number that says on which side along an axis it is. */
constexpr unsigned int
axisBit(unsigned int axis)
{
  return 4u >> axis;
}

class EdgeWalk {
 public:
  EdgeWalk(const CellTree& tree, bool fresh_only, std::vector<CellEdge>& edges)
      : tree_(tree), fresh_only_(fresh_only), edges_(edges)
  {
  }

  void cell(const Placed& parent)
  {
    if (isLeaf(parent) || isDone(parent)) return;
    Placed children[8];
    for (unsigned int k = 0; k < 8; ++k) children[k] = child(parent, k);
    for (const Placed& one : children) cell(one);
    for (unsigned int axis = 0; axis < 3; ++axis) {
      for (unsigned int k = 0; k < 8; ++k) {
        if ((k & axisBit(axis)) == 0) face(axis, children[k], children[k | axisBit(axis)]);
      }
    }
    for (unsigned int axis = 0; axis < 3; ++axis) {
      const unsigned int b = axisBit((axis + 1) % 3), c = axisBit((axis + 2) % 3);
      for (const unsigned int at : {0u, axisBit(axis)}) {
        edge(axis, {children[at], children[at | b], children[at | b | c], children[at | c]});
      }
    }
  }

 private:
  /** Four nodes around an edge, counter-clockwise: low low, high low, high high, low high. */
  struct Ring {
    Placed at[4];
  };

  bool isLeaf(const Placed& p) const { return tree_.nodes()[p.node].first_child == 0; }

  bool isDone(const Placed& p) const { return fresh_only_ && !tree_.nodes()[p.node].fresh; }

  Placed child(const Placed& parent, unsigned int octant) const
  {
    return {tree_.nodes()[parent.node].first_child + octant, CellTree::child(parent.place, octant)};
  }
  Placed childOrSelf(const Placed& p, unsigned int octant) const
  {
    return isLeaf(p) ? p : child(p, octant);
  }

  /** The face between two nodes, the first one lower along axis. */
  void face(unsigned int axis, const Placed& low, const Placed& high)
  {
    if ((isLeaf(low) && isLeaf(high)) || (isDone(low) && isDone(high))) return;
    const unsigned int a = axisBit(axis);
    for (unsigned int k = 0; k < 8; ++k) {
      if ((k & a) == 0) face(axis, childOrSelf(low, k | a), childOrSelf(high, k));
    }
    // Edges in the face along the two other axes: the face's axis is across them.
    for (const unsigned int along : {(axis + 1) % 3, (axis + 2) % 3}) {
      const unsigned int b = axisBit((along + 1) % 3), c = axisBit((along + 2) % 3);
      for (const unsigned int at : {0u, axisBit(along)}) {
        const auto pick = [&](unsigned int octant) {
          const unsigned int inside = at | octant;
          return (inside & a) != 0 ? childOrSelf(high, inside & ~a) : childOrSelf(low, inside | a);
        };
        edge(along, {pick(0), pick(b), pick(b | c), pick(c)});
      }
    }
  }

  void edge(unsigned int axis, const Ring& ring)
  {
    if (isDone(ring.at[0]) && isDone(ring.at[1]) && isDone(ring.at[2]) && isDone(ring.at[3]))
      return;
    if (isLeaf(ring.at[0]) && isLeaf(ring.at[1]) && isLeaf(ring.at[2]) && isLeaf(ring.at[3])) {
      emit(axis, ring);
      return;
    }
    const unsigned int b = axisBit((axis + 1) % 3), c = axisBit((axis + 2) % 3);
    for (const unsigned int at : {0u, axisBit(axis)}) {
      edge(axis, {childOrSelf(ring.at[0], at | b | c), childOrSelf(ring.at[1], at | c),
                  childOrSelf(ring.at[2], at), childOrSelf(ring.at[3], at | b)});
    }
  }

  void emit(unsigned int axis, const Ring& ring)
  {
    bool near = false;
    std::size_t finest = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      near = near || tree_.nodes()[ring.at[k].node].near;
      if (ring.at[k].place.depth > ring.at[finest].place.depth) finest = k;
    }
    if (!near) return;
    CellEdge made{};
    for (std::size_t k = 0; k < 4; ++k) made.cell[k] = tree_.nodes()[ring.at[k].node].cell;
    const CellPlace& own = ring.at[finest].place;
    std::copy(own.low, own.low + 3, made.low);
    // A node on the low side has the edge at its high face.
    if (finest == 0 || finest == 3) made.low[(axis + 1) % 3] += CellTree::width(own.depth);
    if (finest == 0 || finest == 1) made.low[(axis + 2) % 3] += CellTree::width(own.depth);
    made.axis = static_cast<std::uint8_t>(axis);
    made.depth = static_cast<std::uint8_t>(own.depth);
    edges_.push_back(made);
  }

  const CellTree& tree_;
  bool fresh_only_;
  std::vector<CellEdge>& edges_;
};

}  // namespace

std::vector<CellEdge>
cellEdges(const CellTree& tree, bool fresh_only)
{
  std::vector<CellEdge> edges;
  EdgeWalk(tree, fresh_only, edges).cell({});
  return edges;
}

}  // namespace pcl_slim::detail
