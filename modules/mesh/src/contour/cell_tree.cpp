// SPDX-License-Identifier: BSD-3-Clause
#include "contour/contour.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "pcl_slim/core/parallel.h"

namespace pcl_slim::detail {

namespace {

/** A node with its place. */
struct Placed {
  std::uint32_t node = 0;
  CellPlace place;
};

/** The bit of an octant's number for its side along an axis. */
constexpr unsigned int axisBit(unsigned int axis) {
  return 4u >> axis;
}

class EdgeWalk {
 public:
  EdgeWalk(const CellTree& tree, bool fresh_only, std::vector<CellEdge>& edges)
      : tree_(tree), fresh_only_(fresh_only), edges_(edges) {}

  void cell(const Placed& parent) {
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

  Placed child(const Placed& parent, unsigned int octant) const {
    return {tree_.nodes()[parent.node].first_child + octant, CellTree::child(parent.place, octant)};
  }
  Placed childOrSelf(const Placed& p, unsigned int octant) const {
    return isLeaf(p) ? p : child(p, octant);
  }

  /** The face between two nodes, the first one lower along axis. */
  void face(unsigned int axis, const Placed& low, const Placed& high) {
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

  void edge(unsigned int axis, const Ring& ring) {
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

  void emit(unsigned int axis, const Ring& ring) {
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

constexpr float kBall = 0.8f;  ///< of r: leaves cover their points within two thirds
constexpr float kSheetReach =
    0.95f;                        ///< of a cell's width: its middle is that near to a sheet in it
constexpr float kCoarse = 1.0f;   ///< radii: polynomials do not describe wider cells
constexpr float kSlack = 1.001f;  ///< a cell as wide as it may be is not divided for rounding
constexpr std::uint32_t kSerialDepth = 5;  ///< levels divided before threads take over
constexpr std::size_t kMostNodes = std::size_t{1} << 30;
/// Where the cube begins, in cells: no plane of a scan and no body's middle falls on corners.
constexpr double kShift[3] = {0.37, 0.23, 0.41};

using Members = std::vector<std::uint32_t>;

/** A node whose subtree is still to be made. */
struct Pending {
  std::uint32_t node;
  CellPlace place;
  Members members;
};

/** How far a place is from the leaf's sheet: signed, local units, to first order. */
float sheetDistance(const LeafShape& leaf, const Vector3& place) {
  float local[3] = {0, 0, 0};
  for (std::size_t a = 0; a < 3; ++a) {
    const auto d = static_cast<float>((place[a] - leaf.center[a]) / leaf.radius);
    local[0] += d * leaf.u[a];
    local[1] += d * leaf.v[a];
    local[2] += d * leaf.w[a];
  }
  const float reach = std::sqrt(local[0] * local[0] + local[1] * local[1]);
  const float shrink = reach > 1 ? 1 / reach : 1;
  const HeightJet jet = evaluateJet(leaf.degree, leaf.c, shrink * local[0], shrink * local[1]);
  const double slope = std::sqrt(1 + jet.hu * jet.hu + jet.hv * jet.hv);
  return static_cast<float>((local[2] - jet.h) / slope * leaf.radius);
}

/** Divides cells downwards from one. */
class Grower {
 public:
  Grower(const CellTree& tree, const std::vector<LeafShape>& shapes)
      : tree_(tree), shapes_(shapes) {}

  /** Makes what is below nodes[i], but for nodes at depth limit: they are left pending. */
  void grow(std::vector<CellNode>& nodes, std::uint32_t i, const CellPlace& place,
            const Members& candidates, std::uint32_t limit, std::vector<Pending>& pending) const {
    Members members;
    const bool divide = examine(place, candidates, members);
    nodes[i].near = !members.empty();
    if (!divide || nodes.size() > kMostNodes) return;
    if (place.depth == limit) {
      pending.push_back({i, place, members});
      return;
    }
    const auto first = static_cast<std::uint32_t>(nodes.size());
    nodes[i].first_child = first;
    nodes.resize(nodes.size() + 8);
    for (unsigned int k = 0; k < 8; ++k) {
      grow(nodes, first + k, CellTree::child(place, k), members, limit, pending);
    }
  }

 private:
  /** \param[out] members leaves whose sheet passes the cell; one is enough where none can divide
   * it.
   * \return whether the cell is wider than one of them allows. */
  bool examine(const CellPlace& place, const Members& candidates, Members& members) const {
    const auto size = static_cast<float>(tree_.size(place.depth));
    const bool finest = place.depth >= CellTree::kMostDepth;
    Vector3 middle = tree_.corner(place.low);
    for (double& x : middle) x += 0.5 * size;
    const bool may =
        !finest && std::any_of(candidates.begin(), candidates.end(),
                               [&](std::uint32_t j) { return divides(shapes_[j], middle, size); });
    bool divide = false;
    for (const std::uint32_t j : candidates) {
      if (!passes(shapes_[j], middle, size)) continue;
      members.push_back(j);
      if (!may) break;
      divide = divide || divides(shapes_[j], middle, size);
    }
    return divide;
  }

  /** Whether a cell is too wide for a leaf's sheet, if that passes it. */
  static bool divides(const LeafShape& leaf, const Vector3& middle, float size) {
    if (size > kSlack * leaf.cell_size && kSlack * size >= 2 * leaf.least) return true;
    return !leaf.borders.empty() && size > kSlack * leaf.border_size &&
           isNearBorder(leaf, middle, size);
  }

  static bool passes(const LeafShape& leaf, const Vector3& middle, float size) {
    float off_sq = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      const float off = std::abs(static_cast<float>(middle[a]) - leaf.center[a]) - 0.5f * size;
      if (off > 0) off_sq += off * off;
    }
    const float ball = kBall * leaf.radius;
    if (off_sq > ball * ball) return false;
    if (size > kCoarse * leaf.radius) return true;
    return std::abs(sheetDistance(leaf, middle)) <= kSheetReach * size;
  }

  const CellTree& tree_;
  const std::vector<LeafShape>& shapes_;
};

}  // namespace

std::vector<CellEdge> cellEdges(const CellTree& tree, bool fresh_only) {
  std::vector<CellEdge> edges;
  EdgeWalk(tree, fresh_only, edges).cell({});
  return edges;
}

CellPlace CellTree::child(const CellPlace& parent, unsigned int octant) {
  CellPlace made = parent;
  ++made.depth;
  const std::uint32_t half = width(made.depth);
  for (unsigned int a = 0; a < 3; ++a) {
    if ((octant >> (2 - a) & 1u) != 0) made.low[a] += half;
  }
  return made;
}

/** Places the root: a cube about the leaves. */
void CellTree::place(const std::vector<LeafShape>& shapes) {
  Vector3 low = {1e30, 1e30, 1e30}, high = {-1e30, -1e30, -1e30};
  for (const LeafShape& shape : shapes) {
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], static_cast<double>(shape.center[a] - shape.radius));
      high[a] = std::max(high[a], static_cast<double>(shape.center[a] + shape.radius));
    }
  }
  const double cell = thriftyCellSize(shapes);
  const double span = std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2]}) + 2 * cell;
  double root = cell;
  while (root < span) root *= 2;
  unit_ = root / width(0);
  for (std::size_t a = 0; a < 3; ++a) low_[a] = low[a] - (1 + kShift[a]) * cell;
}

Error CellTree::build(const std::vector<LeafShape>& shapes, int threads) {
  place(shapes);
  const Grower grower(*this, shapes);
  nodes_.assign(1, {});
  Members all(shapes.size());
  for (std::size_t j = 0; j < all.size(); ++j) all[j] = static_cast<std::uint32_t>(j);
  std::vector<Pending> pending, none;
  grower.grow(nodes_, 0, {}, all, kSerialDepth, pending);
  std::vector<std::vector<CellNode>> made(pending.size());
  parallelFor(pending.size(), threads, 1, [&](std::size_t p, int) {
    std::vector<Pending> nothing;
    made[p].assign(1, {});
    grower.grow(made[p], 0, pending[p].place, pending[p].members, kMostDepth + 1, nothing);
  });
  for (std::size_t p = 0; p < pending.size(); ++p) {
    // A subtree's node k goes to offset + k; its root is here already.
    const auto offset = static_cast<std::uint32_t>(nodes_.size()) - 1;
    for (CellNode& node : made[p]) {
      if (node.first_child != 0) node.first_child += offset;
    }
    nodes_[pending[p].node] = made[p][0];
    nodes_.insert(nodes_.end(), made[p].begin() + 1, made[p].end());
    if (nodes_.size() > kMostNodes) {
      return {ErrorCode::kBadArgument,
              "the tolerance asks for more than 2^30 cells; raise the tolerance"};
    }
    std::vector<CellNode>().swap(made[p]);
  }
  number();
  return {};
}

std::vector<std::uint32_t> CellTree::split(const std::vector<std::uint32_t>& cells) {
  std::vector<std::uint32_t> numbers(cells_.size(), 0);
  for (const std::uint32_t cell : cells) {
    if (cells_[cell].depth < kMostDepth) numbers[cell] = kDivided;
  }
  const std::size_t before = nodes_.size();
  std::vector<std::uint32_t> kept(cells_.size());
  for (std::uint32_t i = 0; i < before; ++i) {
    nodes_[i].fresh = false;
    if (nodes_[i].first_child != 0) continue;
    kept[nodes_[i].cell] = i;
    if (numbers[nodes_[i].cell] != kDivided) continue;
    nodes_[i].first_child = static_cast<std::uint32_t>(nodes_.size());
    CellNode added;
    added.near = added.fresh = true;
    nodes_.insert(nodes_.end(), 8, added);
  }
  // Children come after their parents.
  for (std::size_t i = before; i-- > 0;) {
    const std::uint32_t first = nodes_[i].first_child;
    for (std::uint32_t k = 0; first != 0 && k < 8; ++k) {
      nodes_[i].fresh = nodes_[i].fresh || nodes_[first + k].fresh;
    }
  }
  number();
  for (std::size_t cell = 0; cell < numbers.size(); ++cell) {
    if (numbers[cell] != kDivided) numbers[cell] = nodes_[kept[cell]].cell;
  }
  return numbers;
}

/** Lists the cells not divided, depth first. */
void CellTree::number() {
  cells_.clear();
  std::vector<std::pair<std::uint32_t, CellPlace>> stack = {{0, {}}};
  while (!stack.empty()) {
    const auto [node, at] = stack.back();
    stack.pop_back();
    const std::uint32_t first = nodes_[node].first_child;
    if (first == 0) {
      nodes_[node].cell = static_cast<std::uint32_t>(cells_.size());
      cells_.push_back(at);
      continue;
    }
    for (unsigned int k = 8; k-- > 0;) stack.emplace_back(first + k, child(at, k));
  }
}

std::uint64_t CellTree::numNear() const {
  return static_cast<std::uint64_t>(
      std::count_if(nodes_.begin(), nodes_.end(),
                    [](const CellNode& node) { return node.first_child == 0 && node.near; }));
}

}  // namespace pcl_slim::detail
