// SPDX-License-Identifier: BSD-3-Clause
#include "disc/disc_tree.h"

#include <cmath>
#include <utility>

namespace pcl_slim::detail {

using Eigen::Vector3d;

DiscTree::DiscTree(const PointStore& store, const SplatSet& splats, double depth,
                   double least_cosine)
    : center_(splats.size()), normal_(splats.size()), radius_(splats.size()), depth_(depth)
{
  Vector3d shift;
  for (std::size_t a = 0; a < 3; ++a) {
    shift[static_cast<Eigen::Index>(a)] = splats.origin[a] - store.origin()[a];
  }
  BlockTree::Level boxes;
  boxes.allocate(splats.size());
  for (std::size_t i = 0; i < splats.size(); ++i) {
    center_[i] = (Vector3d(splats.x[i], splats.y[i], splats.z[i]) + shift) / store.scale();
    normal_[i] = Vector3d(splats.nx[i], splats.ny[i], splats.nz[i]);
    radius_[i] = splats.radius[i] / store.scale();
    setBox(i, least_cosine, boxes);
  }
  tree_ = BlockTree(std::move(boxes));
}

void
DiscTree::setBox(std::size_t i, double least_cosine, BlockTree::Level& boxes) const
{
  // A place whose ray, leaning with least_cosine, pierces the disc at most radius + depth above or
  // below lies in this box.
  const double reach = radius_[i] + (radius_[i] + depth_) / least_cosine;
  float* const low[3] = {&boxes.min_x[i], &boxes.min_y[i], &boxes.min_z[i]};
  float* const high[3] = {&boxes.max_x[i], &boxes.max_y[i], &boxes.max_z[i]};
  for (int a = 0; a < 3; ++a) {
    *low[a] = static_cast<float>(center_[i][a] - reach);
    *high[a] = static_cast<float>(center_[i][a] + reach);
  }
}

std::uint32_t
DiscTree::count(const Vector3d& place, const Vector3d& direction, double cosine,
                std::vector<std::uint32_t>& near) const
{
  const float at[3] = {static_cast<float>(place[0]), static_cast<float>(place[1]),
                       static_cast<float>(place[2])};
  near.clear();
  tree_.blocksInBall(at, 1e-6f, near);
  std::uint32_t met = 0;
  for (const std::uint32_t i : near) {
    const double slope = direction.dot(normal_[i]);
    if (std::abs(slope) < 1e-6) continue;
    const Vector3d to_center = center_[i] - place;
    const double along = to_center.dot(normal_[i]) / slope;
    if (std::abs(along) * cosine > radius_[i] + depth_) continue;
    met += (along * direction - to_center).squaredNorm() <= radius_[i] * radius_[i];
  }
  return met;
}

}  // namespace pcl_slim::detail
