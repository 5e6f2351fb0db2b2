// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/render/g_buffer.h"

#include <algorithm>
#include <limits>

namespace pcl_slim {

void
GBuffer::reserve(int new_width, int new_height, unsigned columns)
{
  width = new_width;
  height = new_height;
  const std::size_t n = static_cast<std::size_t>(new_width) * static_cast<std::size_t>(new_height);
  const auto wanted = [&](unsigned column) { return (columns & column) != 0 ? n : 0; };
  depth.resize(n);
  normal.resize(n);
  surfel.resize(n);
  back_face.resize(n);
  position.resize(wanted(kPositionColumn));
  gradient.resize(wanted(kGradientColumn));
  hessian.resize(wanted(kHessianColumn));
  mean_curvature.resize(wanted(kCurvatureColumn));
  gaussian_curvature.resize(wanted(kCurvatureColumn));
  principal.resize(wanted(kCurvatureColumn));
  level.resize(wanted(kLeafColumns));
  radius.resize(wanted(kLeafColumns));
  weight.resize(wanted(kWeightColumns));
  coverage.resize(wanted(kWeightColumns));
  color.clear();
}

void
GBuffer::resize(int new_width, int new_height, unsigned columns)
{
  reserve(new_width, new_height, columns);
  const auto clear = [](auto& column, auto value) {
    std::fill(column.begin(), column.end(), value);
  };
  clear(depth, std::numeric_limits<float>::infinity());
  for (auto* column : {&position, &normal, &gradient}) clear(*column, std::array<float, 3>{});
  clear(hessian, std::array<float, 6>{});
  for (auto* column : {&mean_curvature, &gaussian_curvature, &radius, &weight, &coverage}) {
    clear(*column, 0.0f);
  }
  clear(principal, std::array<float, 2>{});
  clear(surfel, kNothing);
  for (auto* column : {&level, &back_face}) clear(*column, std::uint8_t{0});
}

std::size_t
GBuffer::numCovered() const
{
  return numPixels() - static_cast<std::size_t>(std::count(surfel.begin(), surfel.end(), kNothing));
}

}  // namespace pcl_slim
