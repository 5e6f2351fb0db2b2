// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/render/g_buffer.h"

#include <algorithm>
#include <limits>

namespace pcl_slim {

void
GBuffer::resize(int new_width, int new_height)
{
  width = new_width;
  height = new_height;
  const std::size_t n = static_cast<std::size_t>(new_width) * static_cast<std::size_t>(new_height);
  depth.assign(n, std::numeric_limits<float>::infinity());
  for (auto* column : {&position, &normal, &gradient}) column->assign(n, {});
  hessian.assign(n, {});
  for (auto* column : {&mean_curvature, &gaussian_curvature, &radius, &weight, &coverage}) {
    column->assign(n, 0.0f);
  }
  principal.assign(n, {});
  surfel.assign(n, kNothing);
  level.assign(n, 0);
  back_face.assign(n, 0);
  color.clear();
}

std::size_t
GBuffer::numCovered() const
{
  return numPixels() - static_cast<std::size_t>(std::count(surfel.begin(), surfel.end(), kNothing));
}

}  // namespace pcl_slim
