// SPDX-License-Identifier: BSD-3-Clause
#include "columns/new_frame.h"

namespace pcl_slim::detail {
namespace {

/** \brief A polynomial in (u, v), by powers of u and v. */
using Grid = std::array<std::array<double, kMaxDegree + 1>, kMaxDegree + 1>;

/** \brief p times an affine form a u + b v + c; terms above the highest degree do not arise. */
Grid
timesAffine(const Grid& p, const Vector3& form)
{
  Grid product{};
  for (std::size_t i = 0; i <= kMaxDegree; ++i) {
    for (std::size_t j = 0; i + j <= kMaxDegree; ++j) {
      product[i][j] += form[2] * p[i][j];
      if (i + j == kMaxDegree) continue;
      product[i + 1][j] += form[0] * p[i][j];
      product[i][j + 1] += form[1] * p[i][j];
    }
  }
  return product;
}

/** \brief h(U, V) with affine forms U and V in place of u and v. */
Grid
substitute(int degree, const float* c, const Vector3& form_u, const Vector3& form_v)
{
  Grid sum{};
  std::size_t k = 0;
  for (int n = 0; n <= degree; ++n) {
    for (int power_of_v = 0; power_of_v <= n; ++power_of_v, ++k) {
      Grid term{};
      term[0][0] = static_cast<double>(c[k]);
      for (int p = power_of_v; p < n; ++p) term = timesAffine(term, form_u);
      for (int p = 0; p < power_of_v; ++p) term = timesAffine(term, form_v);
      for (std::size_t i = 0; i <= kMaxDegree; ++i) {
        for (std::size_t j = 0; j <= kMaxDegree; ++j) sum[i][j] += term[i][j];
      }
    }
  }
  return sum;
}

}  // namespace

std::array<double, kMaxCoefficients>
inNewFrame(int degree, const float* c, const FramedBall& from, const FramedBall& to)
{
  const LocalFrame old(normalized(from.normal)), frame(normalized(to.normal));
  const Vector3 shift = scaled(subtract(to.center, from.center), 1.0 / from.radius);
  const double grow = to.radius / from.radius;
  // Where the new plane's points are in the old frame; the height above it tilts along.
  const Vector3 form_u{grow * dot(old.u, frame.u), grow * dot(old.u, frame.v), dot(old.u, shift)};
  const Vector3 form_v{grow * dot(old.v, frame.u), grow * dot(old.v, frame.v), dot(old.v, shift)};
  Grid h = substitute(degree, c, form_u, form_v);
  h[0][0] -= dot(old.w, shift);
  h[1][0] -= grow * dot(old.w, frame.u);
  h[0][1] -= grow * dot(old.w, frame.v);
  const double upright = 1.0 / (grow * dot(old.w, frame.w));
  std::array<double, kMaxCoefficients> result{};
  std::size_t k = 0;
  for (std::size_t n = 0; n <= static_cast<std::size_t>(degree); ++n) {
    for (std::size_t j = 0; j <= n; ++j) result[k++] = upright * h[n - j][j];
  }
  return result;
}

}  // namespace pcl_slim::detail
