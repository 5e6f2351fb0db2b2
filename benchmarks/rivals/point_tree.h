// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nanoflann.hpp>
#include <vector>

#include "pcl_slim/core/vector3.h"

namespace pcl_slim::rivals {

/** \brief nanoflann's tree over points that outlive it. */
class PointTree {
 public:
  explicit PointTree(const std::vector<Vector3>& points)
      : points_{points}, tree_(3, points_, nanoflann::KDTreeSingleIndexAdaptorParams(10)) {
    tree_.buildIndex();
  }

  /** \brief The k nearest points, nearest first. */
  std::vector<std::size_t> nearest(const Vector3& p, std::size_t k) const {
    std::vector<std::size_t> found(k);
    std::vector<double> distances_sq(k);
    found.resize(tree_.knnSearch(p.data(), k, found.data(), distances_sq.data()));
    return found;
  }

  /** \brief Points within a radius, nearest first. */
  std::vector<std::size_t> within(const Vector3& p, double radius) const {
    std::vector<std::pair<std::size_t, double>> found;
    tree_.radiusSearch(p.data(), radius * radius, found, nanoflann::SearchParams());
    std::vector<std::size_t> points;
    for (const auto& one : found) points.push_back(one.first);
    return points;
  }

 private:
  struct Cloud {
    const std::vector<Vector3>& points;
    std::size_t kdtree_get_point_count() const { return points.size(); }
    double kdtree_get_pt(std::size_t i, std::size_t a) const { return points[i][a]; }
    template <class Box>
    bool kdtree_get_bbox(Box&) const {
      return false;
    }
  };
  using Distance = nanoflann::L2_Simple_Adaptor<double, Cloud>;

  Cloud points_;
  nanoflann::KDTreeSingleIndexAdaptor<Distance, Cloud, 3, std::size_t> tree_;
};

}  // namespace pcl_slim::rivals
