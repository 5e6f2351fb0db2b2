// SPDX-License-Identifier: BSD-3-Clause
#include "space/space_derivatives.h"

#include <algorithm>
#include <cmath>

#include "pcl_slim/core/parallel.h"
#include "pcl_slim/query/detail/shape_operator.h"

namespace pcl_slim::detail {
namespace {

void
writeCurvatures(const ImplicitJet& jet, double norm, std::size_t pixel, GBuffer& buffer)
{
  const auto [mean, gaussian] = meanAndGaussian(jet.gradient, norm, jet.hessian);
  const float spread = std::sqrt(std::max(0.0f, mean * mean - gaussian));
  buffer.mean_curvature[pixel] = mean;
  buffer.gaussian_curvature[pixel] = gaussian;
  buffer.principal[pixel] = {mean + spread, mean - spread};
}

void
writePixel(ImplicitJet jet, std::size_t pixel, GBuffer& buffer)
{
  const double norm = length(jet.gradient);
  if (!(norm > 0.0)) return;
  if (buffer.back_face[pixel]) {
    // Both sides are shown and this is the inner one: derivatives face the viewer.
    for (double& value : jet.gradient) value = -value;
    for (double& value : jet.hessian) value = -value;
  }
  for (std::size_t k = 0; k < 3; ++k) {
    buffer.normal[pixel][k] = static_cast<float>(jet.gradient[k] / norm);
    if (!buffer.gradient.empty()) buffer.gradient[pixel][k] = static_cast<float>(jet.gradient[k]);
  }
  for (std::size_t k = 0; k < 6 && !buffer.hessian.empty(); ++k) {
    buffer.hessian[pixel][k] = static_cast<float>(jet.hessian[k]);
  }
  if (!buffer.mean_curvature.empty()) writeCurvatures(jet, norm, pixel, buffer);
}

}  // namespace

void
differentiateInSpace(const PartitionOfUnity& unity, int threads, GBuffer& buffer)
{
  parallelFor(buffer.numPixels(), threads, 256, [&](std::size_t pixel, int) {
    if (!buffer.covered(pixel)) return;
    const auto& q = buffer.position[pixel];
    ImplicitJet jet;
    if (unity.evaluate({q[0], q[1], q[2]}, jet)) writePixel(jet, pixel, buffer);
  });
}

}  // namespace pcl_slim::detail
