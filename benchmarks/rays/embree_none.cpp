// SPDX-License-Identifier: BSD-3-Clause
#include "embree_tree.h"

namespace pcl_slim::bench {

std::unique_ptr<EmbreeTree> embreeTree(const SLIMSurface&, int) {
  return nullptr;
}

}  // namespace pcl_slim::bench
