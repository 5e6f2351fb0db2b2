// SPDX-License-Identifier: BSD-3-Clause
#include "rivals/jets.h"

namespace pcl_slim::rivals {

bool
hasJets()
{
  return false;
}

std::vector<Vector3>
smoothByJets(const std::vector<Vector3>& points, std::size_t)
{
  return points;
}

Monge
mongeByJets(const std::vector<Vector3>&, std::size_t)
{
  return {};
}

}  // namespace pcl_slim::rivals
