// SPDX-License-Identifier: BSD-3-Clause
// Stands in for advancing_front.cpp where CGAL is not installed.
#include "borders/reconstructions.h"

namespace pcl_slim::borders {

Error advancingFront(const OpenScene&, TriangleMesh&) {
  return badInput("this build has no CGAL; install libcgal-dev");
}

}  // namespace pcl_slim::borders
