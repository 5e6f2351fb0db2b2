// SPDX-License-Identifier: BSD-3-Clause
#include "rivals/jets.h"

#include <string>

namespace pcl_slim::rivals {

bool hasJets() {
  return false;
}

Error requireJets(const char* option) {
  return {ErrorCode::kBadArgument,
          std::string(
              "CGAL's jets are not built in: install libcgal-dev and configure anew, or give ") +
              option};
}

std::vector<Vector3> smoothByJets(const std::vector<Vector3>& points, std::size_t) {
  return points;
}

Monge mongeByJets(const std::vector<Vector3>&, std::size_t) {
  return {};
}

}  // namespace pcl_slim::rivals
