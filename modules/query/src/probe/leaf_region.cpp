// SPDX-License-Identifier: BSD-3-Clause
#include "probe/leaf_region.h"

#include <algorithm>
#include <cmath>

namespace pcl_slim::detail {

namespace {

/** Squared distance from a place to a box. */
double
distanceSq(const Vector3& p, const Vector3& low, const Vector3& high)
{
  double sum = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const double off = std::max({low[a] - p[a], p[a] - high[a], 0.0});
    sum += off * off;
  }
  return sum;
}

}  // namespace

bool
LeafRegion::covers(const Vector3& low, const Vector3& high) const
{
  bool inside = valid_;
  for (std::size_t a = 0; a < 3; ++a) inside = inside && low_[a] <= low[a] && high[a] <= high_[a];
  return inside;
}

void
LeafRegion::resize(std::size_t count)
{
  if (leaves_.size() >= count) return;
  for (auto* column : {&x_, &y_, &z_, &reach_sq_, &effective_count_, &measure_}) {
    column->resize(count);
  }
  leaves_.resize(count);
}

void
LeafRegion::build(const std::vector<ProbeLeaf>& leaves, const BlockTree& tree, double reach,
                  const Vector3& low, const Vector3& high, double margin)
{
  float min[3], max[3];
  for (std::size_t a = 0; a < 3; ++a) {
    low_[a] = low[a] - margin;
    high_[a] = high[a] + margin;
    origin_[a] = 0.5 * (low[a] + high[a]);
    min[a] = static_cast<float>(low_[a]);
    max[a] = static_cast<float>(high_[a]);
  }
  valid_ = true;
  share_ = static_cast<float>(1 / (reach * reach));
  places_.clear();
  tree.blocksInBox(min, max, places_);
  resize(places_.size());
  count_ = 0;
  for (const std::uint32_t place : places_) {
    const ProbeLeaf& own = leaves[place];
    const double r = reach * own.leaf.radius;
    if (distanceSq(own.center, low_, high_) > r * r) continue;
    const auto center = offset(own.center);
    x_[count_] = center[0];
    y_[count_] = center[1];
    z_[count_] = center[2];
    reach_sq_[count_] = static_cast<float>(r * r);
    effective_count_[count_] = own.effective_count;
    leaves_[count_] = own.leaf;
    for (std::size_t a = 0; a < 3; ++a) leaves_[count_].shift[a] = -center[a];
    ++count_;
  }
}

void
LeafRegion::choose(const Vector3& low, const Vector3& high, std::vector<const BlockLeaf*>& chosen)
{
  float middle[3], half[3];
  for (std::size_t a = 0; a < 3; ++a) {
    middle[a] = static_cast<float>(0.5 * (low[a] + high[a]) - origin_[a]);
    half[a] = static_cast<float>(0.5 * (high[a] - low[a]));
  }
  for (std::size_t j = 0; j < count_; ++j) {
    const float dx = std::max(std::abs(x_[j] - middle[0]) - half[0], 0.0f);
    const float dy = std::max(std::abs(y_[j] - middle[1]) - half[1], 0.0f);
    const float dz = std::max(std::abs(z_[j] - middle[2]) - half[2], 0.0f);
    measure_[j] = dx * dx + dy * dy + dz * dz - reach_sq_[j];
  }
  chosen.clear();
  for (std::size_t j = 0; j < count_; ++j) {
    if (measure_[j] < 0) chosen.push_back(&leaves_[j]);
  }
}

}  // namespace pcl_slim::detail
