// SPDX-License-Identifier: BSD-3-Clause
#include "rays/wide_tree.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "pcl_slim/core/parallel.h"

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
double
blocksOf(std::uint32_t count)
{
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
  Builder(const std::vector<Box>& hit, const std::vector<Box>& reach) : hit_(hit), reach_(reach)
  {
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
  float middle(std::uint32_t id, int axis) const
  {
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

Range
Builder::boxed(std::uint32_t begin, std::uint32_t end) const
{
  Range range{begin, end, Box()};
  for (std::uint32_t i = begin; i < end; ++i) range.box.add(hit_[ids_[i]]);
  return range;
}

Split
Builder::bestAlong(const Range& range, int axis) const
{
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

/** \brief Cuts a range in two where that is cheapest; it keeps the first half. \return the second. */
Range
Builder::cut(Range& range, bool evenly)
{
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
std::vector<Range>
Builder::children(const Range& range, int level)
{
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

void
Builder::setBox(WideBoxes& boxes, std::size_t k, const Box& box) const
{
  for (std::size_t a = 0; a < 3; ++a) {
    boxes.bound[2 * a][k] = box.low[a] - margin_;
    boxes.bound[2 * a + 1][k] = box.high[a] + margin_;
  }
}

Box
Builder::reachOf(const Range& range) const
{
  Box box;
  for (std::uint32_t i = range.begin; i < range.end; ++i) box.add(reach_[ids_[i]]);
  return box;
}

/** \brief Appends a node with the boxes of its children, which are yet to come. */
std::uint32_t
Builder::addNode(const std::vector<Range>& ranges, Part& part)
{
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

std::uint32_t
Builder::addBlock(const Range& range, Part& part) const
{
  const std::size_t block = part.order.size() / kWide;
  for (std::uint32_t k = 0; k < kWide; ++k) {
    part.order.push_back(k < range.size() ? ids_[range.begin + k] : WideTree::kNothing);
  }
  return static_cast<std::uint32_t>(block) | WideNode::kBlock;
}

std::uint32_t
Builder::addSubtree(const Range& range, int level, Part& part)
{
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
std::uint32_t
append(Part& part, std::uint32_t root, WideTree& tree)
{
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

WideTree
Builder::build(int threads)
{
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

void
Box::add(const Box& other)
{
  for (int a = 0; a < 3; ++a) {
    low[a] = std::min(low[a], other.low[a]);
    high[a] = std::max(high[a], other.high[a]);
  }
}

double
Box::area() const
{
  const double x = double{high[0]} - low[0], y = double{high[1]} - low[1],
               z = double{high[2]} - low[2];
  return x >= 0.0 ? x * y + y * z + z * x : 0.0;
}

WideTree
buildWideTree(const std::vector<Box>& hit, const std::vector<Box>& reach, int threads)
{
  if (hit.empty()) return {};
  return Builder(hit, reach).build(threads);
}

}  // namespace pcl_slim::detail
