// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "hwy/highway.h"
#include "pcl_slim/leaf/detail/line-inl.h"
#include "pcl_slim/query/detail/ray_surfel.h"
#include "pcl_slim/surface/detail/kernel_math-inl.h"

namespace pcl_slim::detail {

RayPolynomial::RayPolynomial(const RaySurfel& surfel, const Approach& approach,
                             const Vector3& direction) {
  using namespace kernels::HWY_NAMESPACE;
  const auto c = [&](int k) HWY_ATTR { return static_cast<double>(surfel.coefficients[k]); };
  const auto turn = [&frame = surfel.frame](const Vector3& p) {
    return Triple<double>{dot(p, frame.u), dot(p, frame.v), dot(p, frame.w)};
  };
  const Triple<double> p = turn(approach.point), d = turn(direction);
  forDegree(surfel.degree, [&](auto degree) HWY_ATTR {
    const LinePolynomial<degree(), double> line(c, p, d);
    std::copy(line.a, line.a + 5, a);
  });
}

}  // namespace pcl_slim::detail
