// SPDX-License-Identifier: BSD-3-Clause
#include "tree/box_tree.h"

#include <limits>
#include <numeric>

namespace pcl_slim::detail {

namespace {

constexpr std::size_t kBins = 16;
/** From here on ranges are halved at the median: the depth of a tree stays below 24 nodes, which the
 * stack of a search has room for. */
constexpr int kMostHeuristicDepth = 12;

constexpr float kFloatMax = std::numeric_limits<float>::max();

struct Box {
  std::array<float, 3> low{kFloatMax, kFloatMax, kFloatMax};
  std::array<float, 3> high{-kFloatMax, -kFloatMax, -kFloatMax};

  template <typename B>
  void add(const B& box) {
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], box.low[a]);
      high[a] = std::max(high[a], box.high[a]);
    }
  }
  /** Half of the surface area; 0 of an empty box. */
  double area() const {
    if (low[0] > high[0]) return 0;
    const double x = high[0] - low[0], y = high[1] - low[1], z = high[2] - low[2];
    return x * y + y * z + z * x;
  }
};

float middleOf(const TreeItem& item, std::size_t a) {
  return 0.5f * item.low[a] + 0.5f * item.high[a];
}

/** Where to divide a range: the bin of an axis below which items go to the left. */
struct Split {
  std::size_t axis = 0, bin = 0;  ///< bin 0: nowhere
  float low = 0, per_bin = 0;

  std::size_t binOf(const TreeItem& item) const {
    const float at = (middleOf(item, axis) - low) * per_bin;
    return std::min(static_cast<std::size_t>(std::max(at, 0.0f)), kBins - 1);
  }
};

}  // namespace

void TreeItem::add(const Vector3& p) {
  for (std::size_t a = 0; a < 3; ++a) {
    const auto f = static_cast<float>(p[a]);
    low[a] = std::min(low[a], std::nextafter(f, -kFloatMax));
    high[a] = std::max(high[a], std::nextafter(f, kFloatMax));
  }
}

/** Makes the nodes of a tree, children after their parents. */
struct BoxTree::Build {
  const std::vector<TreeItem>& items;
  std::vector<std::uint32_t>& order;
  AlignedVector<Node>& nodes;
  AlignedVector<Cones>& cones;

  const TreeItem& itemAt(std::uint32_t i) const { return items[order[i]]; }

  Range rangeOf(std::uint32_t begin, std::uint32_t end) const;
  Split splitOf(const Range& range) const;
  std::uint32_t divide(const Range& range, int depth) const;
  std::uint32_t addNode(const Range& range, int depth);
};

/** The box of some items, and the cone about the mean of their axes that contains all of theirs. */
BoxTree::Range BoxTree::Build::rangeOf(std::uint32_t begin, std::uint32_t end) const {
  if (end - begin == 1) return {begin, end, itemAt(begin)};
  Box box;
  Vector3 sum{};
  for (std::uint32_t i = begin; i < end; ++i) {
    const TreeItem& item = itemAt(i);
    box.add(item);
    for (std::size_t a = 0; a < 3; ++a) sum[a] += item.axis[a];
  }
  Range range{begin, end, {}};
  range.hull.low = box.low;
  range.hull.high = box.high;
  const Vector3 axis = normalized(sum);
  double widest = 0;  // angle
  constexpr double kRight = 1.5707963267948966;
  for (std::uint32_t i = begin; i < end && widest < kRight; ++i) {
    const TreeItem& item = itemAt(i);
    const double cosine = dot(axis, {item.axis[0], item.axis[1], item.axis[2]});
    const double own = std::asin(std::min(1.0, static_cast<double>(item.sine)));
    widest = std::max(widest, own + std::acos(std::min(1.0, std::max(-1.0, cosine))) + 1e-6);
  }
  if (widest >= kRight) return range;
  for (std::size_t a = 0; a < 3; ++a) range.hull.axis[a] = static_cast<float>(axis[a]);
  range.hull.sine = static_cast<float>(std::sin(widest));
  return range;
}

/** The cheapest split by the surface area heuristic. */
Split BoxTree::Build::splitOf(const Range& range) const {
  Box middles;
  for (std::uint32_t i = range.begin; i < range.end; ++i) {
    const TreeItem& item = itemAt(i);
    const std::array<float, 3> m = {middleOf(item, 0), middleOf(item, 1), middleOf(item, 2)};
    middles.add(TreeItem{m, m, {}, 0});
  }
  Split split;
  for (std::size_t a = 1; a < 3; ++a) {
    if (middles.high[a] - middles.low[a] > middles.high[split.axis] - middles.low[split.axis])
      split.axis = a;
  }
  const float width = middles.high[split.axis] - middles.low[split.axis];
  split.low = middles.low[split.axis];
  split.per_bin = static_cast<float>(kBins) / width;
  if (!(width > 0) || !std::isfinite(split.per_bin)) return split;
  std::array<Box, kBins> boxes;
  std::array<std::uint32_t, kBins> counts{};
  for (std::uint32_t i = range.begin; i < range.end; ++i) {
    const std::size_t bin = split.binOf(itemAt(i));
    boxes[bin].add(itemAt(i));
    ++counts[bin];
  }
  std::array<double, kBins> right{};  // cost of the items from a bin on
  Box box;
  std::uint32_t count = 0;
  for (std::size_t b = kBins - 1; b > 0; --b) {
    box.add(boxes[b]);
    count += counts[b];
    right[b] = box.area() * count;
  }
  box = Box();
  count = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t b = 1; b < kBins; ++b) {
    box.add(boxes[b - 1]);
    count += counts[b - 1];
    const double cost = box.area() * count + right[b];
    if (count > 0 && count < range.end - range.begin && cost < least) {
      least = cost;
      split.bin = b;
    }
  }
  return split;
}

/** Sorts a range of two items or more into two parts. \return where the second begins. */
std::uint32_t BoxTree::Build::divide(const Range& range, int depth) const {
  const auto begin = order.begin() + range.begin, end = order.begin() + range.end;
  const Split split = splitOf(range);
  if (split.bin > 0 && depth < kMostHeuristicDepth) {
    const auto at = std::partition(
        begin, end, [&](std::uint32_t i) { return split.binOf(items[i]) < split.bin; });
    return static_cast<std::uint32_t>(at - order.begin());
  }
  const auto at = begin + (end - begin) / 2;
  std::nth_element(begin, at, end, [&](std::uint32_t i, std::uint32_t j) {
    const float x = middleOf(items[i], split.axis), y = middleOf(items[j], split.axis);
    return x != y ? x < y : i < j;
  });
  return static_cast<std::uint32_t>(at - order.begin());
}

/** Divides the largest parts of a range until there are eight. \return the node. */
std::uint32_t BoxTree::Build::addNode(const Range& range, int depth) {
  std::vector<Range> parts = {range};
  const auto cost = [](const Range& part) {
    Box box{part.hull.low, part.hull.high};
    const auto count = part.end - part.begin;
    return count > 1 ? box.area() * count + 1e-30 * count : 0.0;
  };
  while (parts.size() < kFan) {
    std::size_t most = 0;
    for (std::size_t k = 1; k < parts.size(); ++k) {
      if (cost(parts[k]) > cost(parts[most])) most = k;
    }
    const Range part = parts[most];
    if (part.end - part.begin < 2) break;
    const std::uint32_t middle = divide(part, depth);
    parts[most] = rangeOf(part.begin, middle);
    parts.insert(parts.begin() + static_cast<std::ptrdiff_t>(most) + 1, rangeOf(middle, part.end));
  }
  const auto node = static_cast<std::uint32_t>(nodes.size());
  nodes.emplace_back();
  cones.emplace_back();
  for (std::size_t k = 0; k < kFan; ++k) {
    TreeItem hull;
    std::uint32_t child = kNothing;
    if (k < parts.size()) {
      hull = parts[k].hull;
      const bool single = parts[k].end - parts[k].begin == 1;
      child = single ? kItem | parts[k].begin : addNode(parts[k], depth + 1);
    }
    for (std::size_t a = 0; a < 3; ++a) {
      nodes[node].low[a][k] = k < parts.size() ? hull.low[a] : kFloatMax;
      nodes[node].high[a][k] = k < parts.size() ? hull.high[a] : kFloatMax;
      cones[node].axis[a][k] = hull.axis[a];
    }
    cones[node].sine[k] = hull.sine;
    nodes[node].child[k] = child;
  }
  return node;
}

BoxTree::BoxTree(const std::vector<TreeItem>& items) : order_(items.size()) {
  std::iota(order_.begin(), order_.end(), 0u);
  if (items.empty()) return;
  nodes_.reserve(items.size() / 4 + 1);
  cones_.reserve(items.size() / 4 + 1);
  Build build{items, order_, nodes_, cones_};
  build.addNode(build.rangeOf(0, static_cast<std::uint32_t>(items.size())), 0);
}

std::size_t BoxTree::memoryBytes() const {
  return nodes_.size() * (sizeof(Node) + sizeof(Cones)) + order_.size() * sizeof(std::uint32_t);
}

}  // namespace pcl_slim::detail
