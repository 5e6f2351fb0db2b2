// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/core/cielab.h"

#include <algorithm>
#include <cmath>

#include "cielab_columns.h"
#include "pcl_slim/core/srgb.h"

namespace pcl_slim {

namespace {

using Matrix = std::array<std::array<double, 3>, 3>;

// CIE 15: the cube root meets its tangent through (0, 16/116) at (6/29)^3.
constexpr double kThreshold = 216.0 / 24389.0;
constexpr double kSlope = 841.0 / 108.0;
constexpr double kOffset = 16.0 / 116.0;

constexpr Matrix kSrgbToXyz = {{{0.4124564, 0.3575761, 0.1804375},
                                {0.2126729, 0.7151522, 0.0721750},
                                {0.0193339, 0.1191920, 0.9503041}}};
constexpr Matrix kEbuToXyz = {
    {{0.4303, 0.3416, 0.1784}, {0.2219, 0.7068, 0.0713}, {0.0202, 0.1296, 0.9393}}};

/** RGB -> XYZ with each row over its sum, which is the white point's coordinate. */
Matrix whiteRelative(RgbSpace space) {
  Matrix m = space == RgbSpace::kSrgb ? kSrgbToXyz : kEbuToXyz;
  for (auto& row : m) {
    const double white = row[0] + row[1] + row[2];
    for (double& value : row) value /= white;
  }
  return m;
}

Matrix inverse(const Matrix& m) {
  Matrix adjugate{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      const std::size_t a = (i + 1) % 3, b = (i + 2) % 3, c = (j + 1) % 3, d = (j + 2) % 3;
      adjugate[j][i] = m[a][c] * m[b][d] - m[a][d] * m[b][c];
    }
  }
  double determinant = 0;
  for (std::size_t k = 0; k < 3; ++k) determinant += m[0][k] * adjugate[k][0];
  for (auto& row : adjugate) {
    for (double& value : row) value /= determinant;
  }
  return adjugate;
}

std::array<double, 3> product(const Matrix& m, const std::array<double, 3>& v) {
  std::array<double, 3> out;
  for (std::size_t i = 0; i < 3; ++i) out[i] = m[i][0] * v[0] + m[i][1] * v[1] + m[i][2] * v[2];
  return out;
}

double labRoot(double q) {
  return q > kThreshold ? std::cbrt(q) : kSlope * q + kOffset;
}

double rootInverse(double f) {
  const double cube = f * f * f;
  return cube > kThreshold ? cube : (f - kOffset) * (1.0 / kSlope);
}

double linearOf(double coded, RgbSpace space) {
  if (space == RgbSpace::kEbu) return coded;
  return linearFromSrgb(coded);
}

double codedOf(double linear, RgbSpace space) {
  if (space == RgbSpace::kEbu) return linear;
  return srgbFromLinear(linear);
}

}  // namespace

std::array<double, 3> labFromRgb(const std::array<double, 3>& rgb, RgbSpace space) {
  std::array<double, 3> linear;
  for (std::size_t c = 0; c < 3; ++c) linear[c] = linearOf(rgb[c], space);
  const auto xyz = product(whiteRelative(space), linear);
  const double fx = labRoot(xyz[0]), fy = labRoot(xyz[1]), fz = labRoot(xyz[2]);
  return {116.0 * fy - 16.0, 500.0 * (fx - fy), 200.0 * (fy - fz)};
}

std::array<double, 3> rgbFromLab(const std::array<double, 3>& lab, RgbSpace space) {
  const double fy = (lab[0] + 16.0) / 116.0;
  const std::array<double, 3> xyz = {rootInverse(fy + lab[1] / 500.0), rootInverse(fy),
                                     rootInverse(fy - lab[2] / 200.0)};
  auto rgb = product(inverse(whiteRelative(space)), xyz);
  for (double& c : rgb) c = std::clamp(codedOf(std::clamp(c, 0.0, 1.0), space), 0.0, 1.0);
  return rgb;
}

LabTable::LabTable(RgbSpace space) {
  for (std::size_t i = 0; i < linear_.size(); ++i) {
    linear_[i] = static_cast<float>(linearOf(static_cast<double>(i) / 255.0, space));
  }
  const Matrix to = whiteRelative(space), from = inverse(to);
  for (std::size_t k = 0; k < 3; ++k) {
    to_x_[k] = static_cast<float>(to[0][k]);
    to_y_[k] = static_cast<float>(to[1][k]);
    to_z_[k] = static_cast<float>(to[2][k]);
    for (std::size_t j = 0; j < 3; ++j) from_xyz_[k][j] = static_cast<float>(from[k][j]);
  }
  for (std::size_t i = 0; i <= kPieces; ++i) {
    const double q = static_cast<double>(i) / kPieces;
    root_[i] = static_cast<float>(labRoot(q));
    coded_[i] = static_cast<float>(255.0 * codedOf(q, space));
  }
}

void LabTable::labOfLinear(float* r, float* g, float* b, std::size_t n) const {
  const float to_xyz[9] = {to_x_[0], to_x_[1], to_x_[2], to_y_[0], to_y_[1],
                           to_y_[2], to_z_[0], to_z_[1], to_z_[2]};
  detail::labOfLinear(to_xyz, r, g, b, n);
}

std::array<float, 3> LabTable::rgbUnrounded(const float lab[3]) const {
  const double fy = (lab[0] + 16.0) * (1.0 / 116.0);
  const double xyz[3] = {rootInverse(fy + lab[1] * 0.002), rootInverse(fy),
                         rootInverse(fy - lab[2] * 0.005)};
  std::array<float, 3> out;
  for (std::size_t c = 0; c < 3; ++c) {
    const auto& row = from_xyz_[c];
    const double linear = row[0] * xyz[0] + row[1] * xyz[1] + row[2] * xyz[2];
    const double at = std::clamp(linear, 0.0, 1.0) * kPieces;
    const auto i = static_cast<std::size_t>(std::min(at, kPieces - 1.0));
    out[c] =
        coded_[i] + (coded_[i + 1] - coded_[i]) * static_cast<float>(at - static_cast<double>(i));
  }
  return out;
}

std::array<std::uint8_t, 3> LabTable::rgb(const float lab[3]) const {
  const auto value = rgbUnrounded(lab);
  std::array<std::uint8_t, 3> out;
  for (std::size_t c = 0; c < 3; ++c) out[c] = static_cast<std::uint8_t>(value[c] + 0.5f);
  return out;
}

}  // namespace pcl_slim
