// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "hwy/highway.h"
#include "pcl_slim/leaf/detail/height-inl.h"
#include "pcl_slim/surface/detail/kernel_math-inl.h"
#include "pcl_slim/surface/detail/new_frame.h"
#include "pcl_slim/surface/oct_normal.h"
#include "pcl_slim/surface/polynomial.h"
#include "pcl_slim/surface/surfel_color.h"

namespace pcl_slim {

LocalFrame::LocalFrame(const std::array<double, 3>& normal) : w(normal) {
  const double sign = std::copysign(1.0, w[2]);
  const double a = -1.0 / (sign + w[2]);
  const double b = w[0] * w[1] * a;
  u = {1.0 + sign * w[0] * w[0] * a, sign * b, -sign * w[0]};
  v = {b, sign + w[1] * w[1] * a, -w[1]};
}

double evaluateHeight(int degree, const float* c, double u, double v) {
  double h = c[0] + c[1] * u + c[2] * v;
  if (degree >= 2) h += c[3] * u * u + c[4] * u * v + c[5] * v * v;
  if (degree >= 3) h += u * u * (c[6] * u + c[7] * v) + v * v * (c[8] * u + c[9] * v);
  if (degree >= 4) {
    h +=
        u * u * (u * (c[10] * u + c[11] * v) + c[12] * v * v) + v * v * v * (c[13] * u + c[14] * v);
  }
  return h;
}

HeightJet evaluateJet(int degree, const float* coefficients, double u, double v) {
  using namespace detail::kernels::HWY_NAMESPACE;
  const auto c = [coefficients](int k) HWY_ATTR { return static_cast<double>(coefficients[k]); };
  return forDegree(degree, [&](auto d) HWY_ATTR {
    const auto first = slopesOf<d()>(c, u, v);
    const auto second = secondDerivatives<d()>(c, u, v);
    const auto third = thirdDerivatives<d()>(c, u, v);
    return HeightJet{first.h,   first.u,   first.v,   second.uu, second.uv,
                     second.vv, third.uuu, third.uuv, third.uvv, third.vvv};
  });
}

void flipCoefficients(int degree, float* c) {
  // The frame of -n is (u, -v, -w): h'(u, v) = -h(u, -v).
  int k = 0;
  for (int d = 0; d <= degree; ++d) {
    for (int power_of_v = 0; power_of_v <= d; ++power_of_v, ++k) {
      if (power_of_v % 2 == 0) c[k] = -c[k];
    }
  }
}

namespace {

double signOf(double value) {
  return value < 0.0 ? -1.0 : 1.0;
}

}  // namespace

OctNormal encodeNormal(const std::array<double, 3>& normal, double grid) {
  const double sum = std::abs(normal[0]) + std::abs(normal[1]) + std::abs(normal[2]);
  if (!(sum > 0.0) || !std::isfinite(sum)) return {};
  double x = std::nearbyint(normal[0] / sum * grid);
  double y = std::nearbyint(normal[1] / sum * grid);
  // Keep |z| at one step or more.
  const double excess = std::abs(x) + std::abs(y) - (grid - 1.0);
  if (excess > 0.0) {
    double& larger = std::abs(x) >= std::abs(y) ? x : y;
    larger -= signOf(larger) * excess;
  }
  double a = x, b = y;
  if (std::signbit(normal[2])) {
    a = (grid - std::abs(y)) * signOf(x);
    b = (grid - std::abs(x)) * signOf(y);
  }
  return {static_cast<float>(a / grid), static_cast<float>(b / grid)};
}

std::array<float, 3> decodeNormal(OctNormal code) {
  double x = code.a, y = code.b;
  const double z = 1.0 - std::abs(x) - std::abs(y);
  if (z < 0.0) {
    x = (1.0 - std::abs(static_cast<double>(code.b))) * signOf(code.a);
    y = (1.0 - std::abs(static_cast<double>(code.a))) * signOf(code.b);
  }
  const double length = std::sqrt(x * x + y * y + z * z);
  return {static_cast<float>(x / length), static_cast<float>(y / length),
          static_cast<float>(z / length)};
}

std::array<float, 3> snapNormal(const std::array<double, 3>& normal) {
  return decodeNormal(encodeNormal(normal));
}

void encodeColor(const ColorPolynomial& color, std::uint8_t* bytes) {
  for (std::size_t k = 0; k < color.size(); ++k) {
    for (std::size_t c = 0; c < 3; ++c) {
      const float value = color[k][c];
      const long code = k == 0 ? std::lround(std::clamp(value, 0.0f, 255.0f))
                               : std::lround(std::clamp(value / kColorStep, -127.0f, 127.0f));
      bytes[3 * k + c] = static_cast<std::uint8_t>(code);
    }
  }
}

ColorPolynomial decodeColor(const std::uint8_t* bytes) {
  ColorPolynomial color;
  for (std::size_t k = 0; k < color.size(); ++k) {
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint8_t code = bytes[3 * k + c];
      color[k][c] = k == 0 ? static_cast<float>(code)
                           : kColorStep * static_cast<float>(static_cast<std::int8_t>(code));
    }
  }
  return color;
}

void flipColor(std::uint8_t* bytes) {
  for (int n = 1, k = 1; n <= kColorDegree; ++n) {
    for (int power_of_v = 0; power_of_v <= n; ++power_of_v, ++k) {
      for (int c = 0; power_of_v % 2 != 0 && c < 3; ++c) {
        std::uint8_t& code = bytes[3 * k + c];
        code = static_cast<std::uint8_t>(-static_cast<std::int8_t>(code));
      }
    }
  }
}

}  // namespace pcl_slim

namespace pcl_slim::detail {
namespace {

/** \brief A polynomial in (u, v), by powers of u and v. */
using Grid = std::array<std::array<double, kMaxDegree + 1>, kMaxDegree + 1>;

/** \brief p times an affine form a u + b v + c; terms above the highest degree do not arise. */
Grid timesAffine(const Grid& p, const Vector3& form) {
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
Grid substitute(int degree, const float* c, const Vector3& form_u, const Vector3& form_v) {
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
        grow(to.radius / from.radius) {}

  /** \brief A polynomial where the new plane's points are in the old frame; the height above it
   * tilts along. */
  Grid substitutedInto(int degree, const float* c) const {
    const auto form = [this](const Vector3& axis) {
      return Vector3{grow * dot(axis, frame.u), grow * dot(axis, frame.v), dot(axis, shift)};
    };
    return substitute(degree, c, form(old.u), form(old.v));
  }

  LocalFrame old, frame;
  Vector3 shift;
  double grow;
};

std::array<double, kMaxCoefficients> termsOf(int degree, const Grid& p, double factor) {
  std::array<double, kMaxCoefficients> terms{};
  std::size_t k = 0;
  for (std::size_t n = 0; n <= static_cast<std::size_t>(degree); ++n) {
    for (std::size_t j = 0; j <= n; ++j) terms[k++] = factor * p[n - j][j];
  }
  return terms;
}

}  // namespace

std::array<double, kMaxCoefficients> inNewFrame(int degree, const float* c, const SurfelFrame& from,
                                                const SurfelFrame& to) {
  const Change change(from, to);
  Grid h = change.substitutedInto(degree, c);
  const LocalFrame &old = change.old, &frame = change.frame;
  h[0][0] -= dot(old.w, change.shift);
  h[1][0] -= change.grow * dot(old.w, frame.u);
  h[0][1] -= change.grow * dot(old.w, frame.v);
  return termsOf(degree, h, 1.0 / (change.grow * dot(old.w, frame.w)));
}

void recolorInNewFrame(const SurfelFrame& from, const SurfelFrame& to, std::uint8_t* bytes) {
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
