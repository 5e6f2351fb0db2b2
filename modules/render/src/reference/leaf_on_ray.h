// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "pcl_slim/core/symmetric.h"
#include "pcl_slim/query/detail/ray_surfel.h"
#include "pcl_slim/render/g_buffer.h"
#include "tiles/frame_rules.h"

namespace pcl_slim::detail {

/** \brief Sums of one pixel's blend (eqs. 6, 7, 8 left), before division by the weight. */
struct BlendSum {
  double weight = 0.0;
  double shift = 0.0;  ///< of w (t - t^): q is on the ray
  double coverage = 0.0;
  double outside = 0.0;              ///< of w outsideShare(): of the trim maps
  double lean[3] = {0.0, 0.0, 0.0};  ///< of w (q - c) / r: points away from the leaves' middle
  double spread[3] = {0.0, 0.0,
                      0.0};  ///< of (q - c) / r, all leaves alike; by the ray tracer alone
  int leaves = 0;
  double gradient[3] = {0.0, 0.0, 0.0};
  Symmetric3<double> hessian{};
  double largest_weight = 0.0;
  std::uint32_t surfel = GBuffer::kNothing;
  std::int32_t facing = 0;  ///< leaves seen from the front minus those seen from behind
};

/** \brief Depth of the first root of a leaf between two depths at which its own trim map has data, or
 * infinity. */
double
firstRoot(const FrameRules& rules, const RaySurfel& surfel, const Ray& ray, double nearest,
          double limit, std::uint64_t& evaluated);

/** \brief Adds one leaf to one pixel's blend. */
void
blendLeaf(const FrameRules& rules, WeightKernel kernel, const RaySurfel& surfel, std::uint32_t id,
          const Ray& ray, double depth_hat, BlendSum& sum, std::uint64_t& evaluated);

/** \brief Whether a blend is beyond the border that trim maps draw. */
bool
isOutside(const BlendSum& sum);

/** \brief Whether a blend belongs to the surface: its leaves cover it, or it is in a gap between
 * leaves all around it; and it is inside the border that trim maps draw. Beyond the rim of what
 * was measured all leaves are on one side. */
bool
isSupported(const BlendSum& sum, double min_coverage);

}  // namespace pcl_slim::detail
