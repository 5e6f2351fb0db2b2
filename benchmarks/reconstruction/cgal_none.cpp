// SPDX-License-Identifier: BSD-3-Clause
// Stands in for cgal_poisson.cpp where CGAL is not installed.
#include "reconstruction/rivals.h"

namespace pcl_slim::reconstruction_bench {

bool hasCgal() {
  return false;
}

Error cgalPoisson(const measure::Scene&, double, TriangleMesh&) {
  return badInput("this build has no CGAL; install libcgal-dev");
}

}  // namespace pcl_slim::reconstruction_bench
