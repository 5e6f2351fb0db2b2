// SPDX-License-Identifier: BSD-3-Clause
#include "rivals/jets.h"

#include <CGAL/Monge_via_jet_fitting.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/jet_smooth_point_set.h>

namespace pcl_slim::rivals {

namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Points = std::vector<Kernel::Point_3>;

Points cgalPoints(const std::vector<Vector3>& points) {
  Points converted;
  converted.reserve(points.size());
  for (const Vector3& p : points) converted.emplace_back(p[0], p[1], p[2]);
  return converted;
}

}  // namespace

bool hasJets() {
  return true;
}

Error requireJets(const char*) {
  return {};
}

std::vector<Vector3> smoothByJets(const std::vector<Vector3>& points, std::size_t k) {
  Points moved = cgalPoints(points);
  CGAL::jet_smooth_point_set<CGAL::Sequential_tag>(moved, static_cast<unsigned>(k));
  std::vector<Vector3> smoothed;
  smoothed.reserve(points.size());
  for (const Kernel::Point_3& p : moved) smoothed.push_back({p.x(), p.y(), p.z()});
  return smoothed;
}

Monge mongeByJets(const std::vector<Vector3>& points, std::size_t degree) {
  Points near = cgalPoints(points);
  CGAL::Monge_via_jet_fitting<Kernel> fit;
  const auto form = fit(near.begin(), near.end(), degree, 2);
  const Kernel::Vector_3 n = form.normal_direction();
  return {{n.x(), n.y(), n.z()}, form.principal_curvatures(0), form.principal_curvatures(1)};
}

}  // namespace pcl_slim::rivals
