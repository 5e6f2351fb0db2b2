// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/render/g_buffer.h"

#include <algorithm>
#include <limits>

#include "tiles/clear_pixels.h"

namespace pcl_slim {

void
detail::clearPixels(GBuffer& buffer, std::size_t begin, std::size_t count)
{
  const auto clear = [&](auto& column, auto value) {
    if (!column.empty()) std::fill_n(column.data() + begin, count, value);
  };
  clear(buffer.depth, std::numeric_limits<float>::infinity());
  for (auto* column : {&buffer.position, &buffer.normal, &buffer.gradient}) {
    clear(*column, std::array<float, 3>{});
  }
  clear(buffer.hessian, std::array<float, 6>{});
  for (auto* column : {&buffer.mean_curvature, &buffer.gaussian_curvature, &buffer.radius,
                       &buffer.residual, &buffer.weight, &buffer.coverage}) {
    clear(*column, 0.0f);
  }
  clear(buffer.principal, std::array<float, 2>{});
  clear(buffer.surfel, GBuffer::kNothing);
  for (auto* column : {&buffer.level, &buffer.back_face}) clear(*column, std::uint8_t{0});
}

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
  residual.resize(wanted(kResidualColumn));
  weight.resize(wanted(kWeightColumns));
  coverage.resize(wanted(kWeightColumns));
  color.clear();
}

void
GBuffer::resize(int new_width, int new_height, unsigned columns)
{
  reserve(new_width, new_height, columns);
  detail::clearPixels(*this, 0, numPixels());
}

std::size_t
GBuffer::numCovered() const
{
  return numPixels() - static_cast<std::size_t>(std::count(surfel.begin(), surfel.end(), kNothing));
}

}  // namespace pcl_slim
