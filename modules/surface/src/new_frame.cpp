// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/surface/detail/new_frame.h"

#include "pcl_slim/surface/surfel_color.h"

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

/** \brief From a ball and its frame to others, which are near. */
struct Change {
  Change(const SurfelFrame& from, const SurfelFrame& to)
      : old(normalized(from.normal)),
        frame(normalized(to.normal)),
        shift(scaled(subtract(to.center, from.center), 1.0 / from.radius)),
        grow(to.radius / from.radius)
  {
  }

  /** \brief A polynomial where the new plane's points are in the old frame; the height above it tilts along. */
  Grid substitutedInto(int degree, const float* c) const
  {
    const auto form = [this](const Vector3& axis) {
      return Vector3{grow * dot(axis, frame.u), grow * dot(axis, frame.v), dot(axis, shift)};
    };
    return substitute(degree, c, form(old.u), form(old.v));
  }

  LocalFrame old, frame;
  Vector3 shift;
  double grow;
};

std::array<double, kMaxCoefficients>
termsOf(int degree, const Grid& p, double factor)
{
  std::array<double, kMaxCoefficients> terms{};
  std::size_t k = 0;
  for (std::size_t n = 0; n <= static_cast<std::size_t>(degree); ++n) {
    for (std::size_t j = 0; j <= n; ++j) terms[k++] = factor * p[n - j][j];
  }
  return terms;
}

}  // namespace

std::array<double, kMaxCoefficients>
inNewFrame(int degree, const float* c, const SurfelFrame& from, const SurfelFrame& to)
{
  const Change change(from, to);
  Grid h = change.substitutedInto(degree, c);
  const LocalFrame &old = change.old, &frame = change.frame;
  h[0][0] -= dot(old.w, change.shift);
  h[1][0] -= change.grow * dot(old.w, frame.u);
  h[0][1] -= change.grow * dot(old.w, frame.v);
  return termsOf(degree, h, 1.0 / (change.grow * dot(old.w, frame.w)));
}

void
recolorInNewFrame(const SurfelFrame& from, const SurfelFrame& to, std::uint8_t* bytes)
{
  const Change change(from, to);
  ColorPolynomial color = decodeColor(bytes);
  for (std::size_t channel = 0; channel < 3; ++channel) {
    std::array<float, kColorTerms> terms;
    for (std::size_t k = 0; k < kColorTerms; ++k) terms[k] = color[k][channel];
    const auto moved =
        termsOf(kColorDegree, change.substitutedInto(kColorDegree, terms.data()), 1.0);
    for (std::size_t k = 0; k < kColorTerms; ++k) color[k][channel] = static_cast<float>(moved[k]);
  }
  encodeColor(color, bytes);
}

}  // namespace pcl_slim::detail
