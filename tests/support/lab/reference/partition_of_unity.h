// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <memory>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/symmetric.h"
#include "pcl_slim/render/g_buffer.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim::lab {

/** \brief Value, gradient and Hessian of a function at a point. */
struct ImplicitJet {
  double value = 0;
  std::array<double, 3> gradient{};
  Symmetric3<double> hessian{};
};

/** \brief The same leaves blended in space: F = sum w_i f_i / sum w_i, with F's own derivatives.
 *
 * The right side of equation (8) of Ohtake, Belyaev, Alexa 2005, kept to compare with: its
 * derivatives contain those of the weights, which is where partition-of-unity surfaces show
 * wiggles that blending derivatives along a ray (projectPoints) does not. Plain double code, a
 * reference and not meant for speed. Leaves must agree in orientation.
 */
class PartitionOfUnity {
 public:
  /** \brief The surface must outlive this object. O(M log M). */
  explicit PartitionOfUnity(const SLIMSurface& surface);
  ~PartitionOfUnity();
  PartitionOfUnity(const PartitionOfUnity&) = delete;
  PartitionOfUnity& operator=(const PartitionOfUnity&) = delete;

  /** \brief F and its derivatives at a point in the surface's local units.
   * \return false where no leaf's ball contains the point. O(leaves near it). */
  bool evaluate(const std::array<double, 3>& x, ImplicitJet& jet) const;

 private:
  struct Index;
  const SLIMSurface& surface_;
  std::unique_ptr<Index> index_;
};

/** \brief Puts the derivatives of a surface's partition of unity (eq. 8, right) at a frame's
 * positions in place of the blended ones: normals, and gradients, Hessians and curvatures where the
 * buffer has them. Refused for leaves that differ in orientation. \param[in,out] buffer with
 * positions. O(covered pixels * leaves near each). */
Error differentiateInSpace(const SLIMSurface& surface, int threads, GBuffer& buffer);

}  // namespace pcl_slim::lab
