// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "rays/ray_scene.h"

namespace pcl_slim::bench {

/** \brief Leaves under Embree's tree, as user geometry: the same boxes and rules as RayScene's, a
 * leaf at a time. */
class EmbreeTree {
 public:
  virtual ~EmbreeTree() = default;

  /** \brief Depth of q^ of each ray: the first root inside a shrunk ball; infinity without one. */
  virtual void first(const std::vector<detail::BoundedRay>& rays, bool front_only, int threads,
                     std::vector<double>& depth) const = 0;
  /** \brief Whether any such root is there at all. */
  virtual void any(const std::vector<detail::BoundedRay>& rays, int threads,
                   std::vector<std::uint8_t>& met) const = 0;
};

/** \brief Null in a build without Embree. */
std::unique_ptr<EmbreeTree> embreeTree(const SLIMSurface& surface, int threads);

}  // namespace pcl_slim::bench
