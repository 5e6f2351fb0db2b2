// SPDX-License-Identifier: BSD-3-Clause
// A surface's leaves in blocks under a tree with eight children a node.
#include "rays/ray_scene.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "pcl_slim/core/parallel.h"
#include "pcl_slim/core/vector3.h"
#include "tiles/tiles.h"

namespace pcl_slim::detail {
namespace {

constexpr int kBins = 16;
constexpr int kMaxLevel = 24;  ///< from here on ranges are halved, so that walks need little memory

/** \brief Things [begin, end) of the order, and their box. */
struct Range {
  std::uint32_t begin = 0, end = 0;
  Box box;

  std::uint32_t size() const { return end - begin; }
};

/** \brief A plane between bins, and what it costs to split there. */
struct Split {
  double cost = HUGE_VAL;
  int axis = 0;
  float below = 0.0f;  ///< middles less than this go to the first half
};

/** \brief Blocks that a number of things fill: half empty ones cost as much as full ones. */
double blocksOf(std::uint32_t count) {
  return static_cast<double>((count + kWide - 1) / kWide);
}

/** \brief Nodes of one part of the tree; children that are nodes count from its own first one. */
struct Part {
  std::vector<WideNode> nodes;
  std::vector<WideBoxes> reach;
  std::vector<std::uint32_t> order;
};

class Builder {
 public:
  Builder(const std::vector<Box>& hit, const std::vector<Box>& reach) : hit_(hit), reach_(reach) {
    ids_.resize(hit.size());
    for (std::size_t i = 0; i < hit.size(); ++i) ids_[i] = static_cast<std::uint32_t>(i);
    all_ = boxed(0, static_cast<std::uint32_t>(hit.size()));
    for (int a = 0; a < 3; ++a) {
      const double size = double{all_.box.high[a]} - all_.box.low[a];
      const double far = std::max(std::abs(all_.box.low[a]), std::abs(all_.box.high[a]));
      margin_ = std::max(margin_, static_cast<float>(2e-6 * std::max(size, far)));
    }
  }

  WideTree build(int threads);

 private:
  float middle(std::uint32_t id, int axis) const {
    return 0.5f * (hit_[id].low[axis] + hit_[id].high[axis]);
  }
  Range boxed(std::uint32_t begin, std::uint32_t end) const;
  Split bestAlong(const Range& range, int axis) const;
  Range cut(Range& range, bool evenly);
  std::vector<Range> children(const Range& range, int level);
  std::uint32_t addNode(const std::vector<Range>& ranges, Part& part);
  std::uint32_t addBlock(const Range& range, Part& part) const;
  std::uint32_t addSubtree(const Range& range, int level, Part& part);
  void setBox(WideBoxes& boxes, std::size_t k, const Box& box) const;
  Box reachOf(const Range& range) const;

  const std::vector<Box>&hit_, &reach_;
  std::vector<std::uint32_t> ids_;
  Range all_;
  float margin_ = 0.0f;
};

Range Builder::boxed(std::uint32_t begin, std::uint32_t end) const {
  Range range{begin, end, Box()};
  for (std::uint32_t i = begin; i < end; ++i) range.box.add(hit_[ids_[i]]);
  return range;
}

Split Builder::bestAlong(const Range& range, int axis) const {
  float low = Box::kFar, high = -Box::kFar;
  for (std::uint32_t i = range.begin; i < range.end; ++i) {
    low = std::min(low, middle(ids_[i], axis));
    high = std::max(high, middle(ids_[i], axis));
  }
  Split best;
  if (!(low < high)) return best;
  std::array<Box, kBins> boxes;
  std::array<std::uint32_t, kBins> counts{};
  const float scale = kBins / (high - low);
  for (std::uint32_t i = range.begin; i < range.end; ++i) {
    const int bin = static_cast<int>((middle(ids_[i], axis) - low) * scale);
    const auto b = static_cast<std::size_t>(std::clamp(bin, 0, kBins - 1));
    boxes[b].add(hit_[ids_[i]]);
    ++counts[b];
  }
  std::array<double, kBins> behind{};
  Box box;
  std::uint32_t count = 0;
  for (std::size_t b = kBins - 1; b > 0; --b) {
    box.add(boxes[b]);
    behind[b] = box.area() * blocksOf(count += counts[b]);
  }
  box = Box();
  count = 0;
  for (std::size_t b = 1; b < kBins; ++b) {
    box.add(boxes[b - 1]);
    count += counts[b - 1];
    const double cost = box.area() * blocksOf(count) + behind[b];
    if (count == 0 || count == range.size() || !(cost < best.cost)) continue;
    best = {cost, axis, low + static_cast<float>(b) / scale};
  }
  return best;
}

/** \brief Cuts a range in two where that is cheapest; it keeps the first half. \return the second.
 */
Range Builder::cut(Range& range, bool evenly) {
  Split best;
  for (int axis = 0; axis < 3 && !evenly; ++axis) {
    const Split split = bestAlong(range, axis);
    if (split.cost < best.cost) best = split;
  }
  const auto first = ids_.begin() + range.begin, last = ids_.begin() + range.end;
  auto middle_of = std::stable_partition(first, last, [&](std::uint32_t id) {
    return best.cost < HUGE_VAL && middle(id, best.axis) < best.below;
  });
  // Rounding may put all of them on one side, and things in one place have no plane between them.
  if (middle_of == first || middle_of == last) middle_of = first + (last - first) / 2;
  const auto at = static_cast<std::uint32_t>(middle_of - ids_.begin());
  const Range second = boxed(at, range.end);
  range = boxed(range.begin, at);
  return second;
}

/** \brief Cuts the largest of a node's ranges until there are eight or all fit into blocks. */
std::vector<Range> Builder::children(const Range& range, int level) {
  std::vector<Range> ranges{range};
  while (ranges.size() < kWide) {
    std::size_t largest = ranges.size();
    double area = -1.0;
    for (std::size_t i = 0; i < ranges.size(); ++i) {
      if (ranges[i].size() <= kWide || !(ranges[i].box.area() > area)) continue;
      area = ranges[i].box.area();
      largest = i;
    }
    if (largest == ranges.size()) break;
    const Range second = cut(ranges[largest], level > kMaxLevel);
    ranges.push_back(second);
  }
  return ranges;
}

void Builder::setBox(WideBoxes& boxes, std::size_t k, const Box& box) const {
  for (std::size_t a = 0; a < 3; ++a) {
    boxes.bound[2 * a][k] = box.low[a] - margin_;
    boxes.bound[2 * a + 1][k] = box.high[a] + margin_;
  }
}

Box Builder::reachOf(const Range& range) const {
  Box box;
  for (std::uint32_t i = range.begin; i < range.end; ++i) box.add(reach_[ids_[i]]);
  return box;
}

/** \brief Appends a node with the boxes of its children, which are yet to come. */
std::uint32_t Builder::addNode(const std::vector<Range>& ranges, Part& part) {
  WideNode node;
  WideBoxes reach;
  for (std::size_t k = 0; k < kWide; ++k) {
    const bool is = k < ranges.size();
    setBox(node.hit, k, is ? ranges[k].box : Box());
    setBox(reach, k, is ? reachOf(ranges[k]) : Box());
    node.child[k] = WideNode::kNoChild;
  }
  part.nodes.push_back(node);
  part.reach.push_back(reach);
  return static_cast<std::uint32_t>(part.nodes.size() - 1);
}

std::uint32_t Builder::addBlock(const Range& range, Part& part) const {
  const std::size_t block = part.order.size() / kWide;
  for (std::uint32_t k = 0; k < kWide; ++k) {
    part.order.push_back(k < range.size() ? ids_[range.begin + k] : WideTree::kNothing);
  }
  return static_cast<std::uint32_t>(block) | WideNode::kBlock;
}

std::uint32_t Builder::addSubtree(const Range& range, int level, Part& part) {
  if (range.size() <= kWide) return addBlock(range, part);
  const std::vector<Range> ranges = children(range, level);
  const std::uint32_t node = addNode(ranges, part);
  for (std::size_t k = 0; k < ranges.size(); ++k) {
    const std::uint32_t child = addSubtree(ranges[k], level + 1, part);
    part.nodes[node].child[k] = child;
  }
  return node;
}

/** \brief Appends a part to the tree. \return its root there. */
std::uint32_t append(Part& part, std::uint32_t root, WideTree& tree) {
  const auto first_node = static_cast<std::uint32_t>(tree.nodes.size());
  const auto first_block = static_cast<std::uint32_t>(tree.numBlocks());
  const auto moved = [&](std::uint32_t child) {
    if (child == WideNode::kNoChild) return child;
    return child + ((child & WideNode::kBlock) != 0 ? first_block : first_node);
  };
  for (WideNode& node : part.nodes) {
    for (std::uint32_t& child : node.child) child = moved(child);
    tree.nodes.push_back(node);
  }
  tree.reach.insert(tree.reach.end(), part.reach.begin(), part.reach.end());
  tree.order.insert(tree.order.end(), part.order.begin(), part.order.end());
  return moved(root);
}

WideTree Builder::build(int threads) {
  WideTree tree;
  tree.bounds = all_.box;
  const std::vector<Range> ranges = children(all_, 0);
  std::vector<Part> parts(ranges.size());
  std::vector<std::uint32_t> roots(ranges.size());
  parallelFor(ranges.size(), threads, 1,
              [&](std::size_t k, int) { roots[k] = addSubtree(ranges[k], 1, parts[k]); });

  Part top;
  addNode(ranges, top);
  tree.nodes.assign(top.nodes.begin(), top.nodes.end());
  tree.reach.assign(top.reach.begin(), top.reach.end());
  for (std::size_t k = 0; k < parts.size(); ++k) {
    tree.nodes[0].child[k] = append(parts[k], roots[k], tree);
  }
  return tree;
}

}  // namespace

void Box::add(const Box& other) {
  for (int a = 0; a < 3; ++a) {
    low[a] = std::min(low[a], other.low[a]);
    high[a] = std::max(high[a], other.high[a]);
  }
}

double Box::area() const {
  const double x = double{high[0]} - low[0], y = double{high[1]} - low[1],
               z = double{high[2]} - low[2];
  return x >= 0.0 ? x * y + y * z + z * x : 0.0;
}

WideTree buildWideTree(const std::vector<Box>& hit, const std::vector<Box>& reach, int threads) {
  if (hit.empty()) return {};
  return Builder(hit, reach).build(threads);
}

namespace {

/** \brief An interval of heights over the disc u^2 + v^2 <= a^2, in radii. */
struct HeightRange {
  double low, high;

  HeightRange(const SLIMSurface& surface, std::size_t i, double a) {
    const float* c = surface.coefficientsOf(i);
    const double slope = a * std::hypot(c[1], c[2]);
    low = c[0] - slope;
    high = c[0] + slope;
    if (surface.degree[i] < 2) return;
    const double mean = 0.5 * (double{c[3]} + c[5]);
    const double spread = std::hypot(0.5 * (double{c[3]} - c[5]), 0.5 * double{c[4]});
    low += a * a * std::min(0.0, mean - spread);
    high += a * a * std::max(0.0, mean + spread);
    double power = a * a;
    for (int degree = 3, k = 6; degree <= surface.degree[i]; ++degree) {
      double sum = 0.0;
      for (int j = 0; j <= degree; ++j, ++k) sum += std::abs(double{c[k]});
      power *= a;
      low -= power * sum;
      high += power * sum;
    }
  }
};

}  // namespace

Box boxOfLeaf(const SLIMSurface& surface, std::size_t i, double share, double slack) {
  const HeightRange heights(surface, i, share);
  const double low = std::clamp(heights.low - slack, -share, share);
  const double high = std::clamp(heights.high + slack, -share, share);
  const float center[3] = {surface.cx[i], surface.cy[i], surface.cz[i]};
  const float normal[3] = {surface.nx[i], surface.ny[i], surface.nz[i]};
  Box box;
  for (int a = 0; a < 3; ++a) {
    const double n = normal[a], r = surface.radius[i];
    const double flat = share * std::sqrt(std::max(0.0, 1.0 - n * n));
    const double from = std::max(-share, std::min(low * n, high * n) - flat);
    const double to = std::min(share, std::max(low * n, high * n) + flat);
    box.low[a] = static_cast<float>(center[a] + r * from);
    box.high[a] = static_cast<float>(center[a] + r * to);
  }
  return box;
}

LeafBlocks::LeafBlocks(const SLIMSurface& surface, const std::vector<std::uint32_t>& leaves,
                       const std::vector<std::uint32_t>& order) {
  const auto coefficients = static_cast<std::size_t>(std::max(6, surface.stride()));
  stride_ = kWide * (kBlockCoefficients + coefficients);
  const std::size_t blocks = order.size() / kWide;
  heads_.resize(blocks);
  columns_.assign(blocks * stride_, 0.0f);
  for (std::size_t block = 0; block < blocks; ++block) {
    std::uint32_t surfels[kWide];
    for (std::size_t k = 0; k < kWide; ++k) {
      const std::uint32_t place = order[block * kWide + k];
      surfels[k] = place == WideTree::kNothing ? WideTree::kNothing : leaves[place];
    }
    fill(surface, surfels, block);
  }
}

void LeafBlocks::fill(const SLIMSurface& surface, const std::uint32_t* surfels, std::size_t block) {
  constexpr float kFarAway = 1e15f;  // its square is still finite
  Head& head = heads_[block];
  float* lanes = columns_.data() + block * stride_;
  const std::uint32_t first = surfels[0];
  const std::array<float, 3> center{surface.cx[first], surface.cy[first], surface.cz[first]};
  std::copy(center.begin(), center.end(), head.center);
  std::copy(surfels, surfels + kWide, head.surfel);
  head.degree = 1;
  const auto at = [&](std::size_t column, std::size_t k) -> float& {
    return lanes[column * kWide + k];
  };
  for (std::size_t k = 0; k < kWide; ++k) {
    const std::uint32_t s = surfels[k];
    const bool is = s != WideTree::kNothing;
    at(kBlockX, k) = is ? surface.cx[s] - center[0] : kFarAway;
    at(kBlockY, k) = is ? surface.cy[s] - center[1] : 0.0f;
    at(kBlockZ, k) = is ? surface.cz[s] - center[2] : 0.0f;
    at(kBlockRadius, k) = is ? surface.radius[s] : 1.0f;
    at(kBlockInverseRadius, k) = is ? 1.0f / surface.radius[s] : 1.0f;
    at(kBlockNX, k) = is ? surface.nx[s] : 0.0f;
    at(kBlockNY, k) = is ? surface.ny[s] : 0.0f;
    at(kBlockNZ, k) = is ? surface.nz[s] : 1.0f;
    if (!is) continue;
    at(kBlockVariance, k) = surface.info.paper_mode ? 1.0f : surface.varianceWeight(s);
    head.degree = std::max(head.degree, static_cast<int>(surface.degree[s]));
    const float* c = surface.coefficientsOf(s);
    for (int j = 0; j < numCoefficients(surface.degree[s]); ++j) {
      at(kBlockCoefficients + static_cast<std::size_t>(j), k) = c[j];
    }
  }
}

RayScene::RayScene(const SLIMSurface& s, int threads)
    : surface(s),
      shrink(std::clamp(s.info.cover_radius, 0.05, kMaxShrink)),
      cover_radius(std::clamp(s.info.cover_radius, 0.05, 1.0)) {
  const std::vector<std::uint32_t> leaves = surface.leaves();
  std::vector<Box> hit(leaves.size()), reach(leaves.size());
  parallelFor(leaves.size(), threads, 1024, [&](std::size_t i, int) {
    hit[i] = boxOfLeaf(surface, leaves[i], shrink, 0.0);
    reach[i] = boxOfLeaf(surface, leaves[i], 1.0, kMaxShift);
  });
  tree = buildWideTree(hit, reach, threads);
  blocks = LeafBlocks(surface, leaves, tree.order);
}

bool closesGap(const BlendSum& sum, const Vector3& direction) {
  // In the rim of balls weights fall steeply, so that the nearest leaf outweighs all others: leaves
  // count alike here. At the rim of a sheet they are on one side, .5 radii away and more in the
  // mean.
  constexpr double kMaxSpread = 0.3, kAgreement = 0.8, kLeastCosine = 0.4;
  constexpr int kLeastLeaves = 3;
  if (isOutside(sum)) return false;
  const Vector3 gradient{sum.gradient[0], sum.gradient[1], sum.gradient[2]};
  const Vector3 spread{sum.spread[0], sum.spread[1], sum.spread[2]};
  const double size = length(gradient);
  return sum.leaves >= kLeastLeaves && length(spread) < kMaxSpread * sum.leaves &&
         size > kAgreement * sum.weight && std::abs(dot(gradient, direction)) > kLeastCosine * size;
}

RayCounts& RayCounts::operator+=(const RayCounts& other) {
  nodes += other.nodes;
  leaves_first += other.leaves_first;
  leaves_blend += other.leaves_blend;
  bracketed += other.bracketed;
  closed += other.closed;
  peeled += other.peeled;
  return *this;
}

}  // namespace pcl_slim::detail
