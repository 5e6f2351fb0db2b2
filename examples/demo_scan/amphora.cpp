// SPDX-License-Identifier: BSD-3-Clause
#include "amphora.h"

#include <algorithm>
#include <cmath>

namespace pcl_slim::demo {
namespace {

constexpr int kProfileSteps = 1024;
constexpr double kWall = 0.014;
constexpr double kRounding = 0.016;  ///< of lip and foot
constexpr double kFloor = 0.04;      ///< the hollow ends here

/** Outer radius at some heights; a monotone-free cubic runs through them. */
constexpr double kShape[][2] = {{0.000, 0.067}, {0.010, 0.069}, {0.020, 0.062}, {0.032, 0.042},
                                {0.048, 0.044}, {0.080, 0.072}, {0.130, 0.110}, {0.185, 0.136},
                                {0.235, 0.143}, {0.280, 0.132}, {0.312, 0.104}, {0.332, 0.072},
                                {0.346, 0.056}, {0.372, 0.048}, {0.405, 0.048}, {0.428, 0.056},
                                {0.442, 0.069}, {0.452, 0.073}, {0.460, 0.072}};
constexpr int kShapePoints = static_cast<int>(sizeof(kShape) / sizeof(kShape[0]));

/** Catmull-Rom value through kShape with its derivative by z. */
std::array<double, 2> interpolateShape(double z) {
  int i = 0;
  while (i + 2 < kShapePoints && z > kShape[i + 1][0]) ++i;
  const auto slope = [](int k) {
    const int a = std::max(0, k - 1), b = std::min(kShapePoints - 1, k + 1);
    return (kShape[b][1] - kShape[a][1]) / (kShape[b][0] - kShape[a][0]);
  };
  const double h = kShape[i + 1][0] - kShape[i][0], t = (z - kShape[i][0]) / h;
  const double y0 = kShape[i][1], y1 = kShape[i + 1][1], m0 = slope(i) * h, m1 = slope(i + 1) * h;
  const double c2 = 3.0 * (y1 - y0) - 2.0 * m0 - m1, c3 = 2.0 * (y0 - y1) + m0 + m1;
  return {y0 + t * (m0 + t * (c2 + t * c3)), (m0 + t * (2.0 * c2 + 3.0 * t * c3)) / h};
}

/** A bump of height 1 about x = 0, with smooth shoulders at |x| = width. */
double bump(double x, double width) {
  const double s = 1.0 - (x / width) * (x / width);
  return s > 0.0 ? s * s : 0.0;
}

/** 1 between low and high, falling to 0 within edge on either side. */
double window(double x, double low, double high, double edge) {
  const auto step = [](double t) {
    t = std::clamp(t, 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
  };
  return step((x - low) / edge + 0.5) * step((high - x) / edge + 0.5);
}

double smoothMin(double a, double b, double k) {
  const double h = std::max(0.0, k - std::abs(a - b)) / k;
  return std::min(a, b) - 0.25 * h * h * k;
}

/** Heights over the belly's middle of the two strands of the braid. */
double strandOffset(double angle) {
  return 0.017 * std::sin(9.0 * angle);
}

/** Relief ornament: height of the surface above the profile [m], 0 ... 0.0045. */
double relief(double angle, double z) {
  double height = 0.0;
  if (z > 0.05 && z < 0.18) {  // gadroons that swell out of the foot
    height += 0.0040 * (0.5 + 0.5 * std::cos(20.0 * angle)) * window(z, 0.075, 0.155, 0.03);
  }
  if (z > 0.18 && z < 0.29) {  // beads above and below a braid
    height += 0.0030 * (bump(z - 0.192, 0.0055) + bump(z - 0.278, 0.0055));
    const double offset = strandOffset(angle), x = z - 0.235;
    height += 0.0045 * std::max(bump(x - offset, 0.0095), bump(x + offset, 0.0095));
  }
  if (z > 0.28 && z < 0.345) {  // tongues on the shoulder, a row of pearls round the neck
    height += 0.0022 * (0.5 + 0.5 * std::cos(36.0 * angle)) * window(z, 0.293, 0.326, 0.01);
    height += 0.0030 * (0.6 + 0.4 * std::cos(40.0 * angle)) * bump(z - 0.340, 0.005);
  }
  return height;
}

}  // namespace

double Amphora::dentAt(double angle, double z) const {
  constexpr double kAngle = -1.05, kHeightOfDent = 0.235, kBelly = 0.143, kRadius = 0.03;
  return dent_ * bump(std::hypot(kBelly * (angle - kAngle), z - kHeightOfDent), kRadius);
}

Amphora::Amphora(double dent) : dent_(dent) {
  profile_.reserve(kProfileSteps + 1);
  for (int i = 0; i <= kProfileSteps; ++i) {
    const auto [radius, slope] = interpolateShape(kHeight * i / kProfileSteps);
    profile_.push_back({radius, slope});
  }
  // A Bezier arc from the neck outwards and down to the shoulder.
  constexpr double kArc[4][2] = {{0.044, 0.402}, {0.090, 0.452}, {0.165, 0.425}, {0.112, 0.296}};
  constexpr int kSegments = 20;
  for (int i = 0; i <= kSegments; ++i) {
    const double t = static_cast<double>(i) / kSegments, s = 1.0 - t;
    const double w[4] = {s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t};
    std::array<double, 2> p{0.0, 0.0};
    for (int k = 0; k < 4; ++k) {
      for (std::size_t a = 0; a < 2; ++a) p[a] += w[k] * kArc[k][a];
    }
    handle_.push_back(p);
  }
}

Amphora::Profile Amphora::profileAt(double z) const {
  const double x = std::clamp(z / kHeight, 0.0, 1.0) * kProfileSteps;
  const auto i = std::min(static_cast<std::size_t>(x), profile_.size() - 2);
  const double t = x - static_cast<double>(i);
  const Profile &a = profile_[i], &b = profile_[i + 1];
  return {a.radius + t * (b.radius - a.radius), a.slope + t * (b.slope - a.slope)};
}

double Amphora::bodyDistance(double rho, double angle, double z) const {
  const Profile profile = profileAt(z);
  const double flatness = 1.0 / std::sqrt(1.0 + profile.slope * profile.slope);
  double outer = (rho - profile.radius) * flatness;
  // Ornament matters near the surface only; further away a margin keeps the bound.
  outer -=
      outer < 0.03 && outer > -0.01 ? (relief(angle, z) - dentAt(angle, z)) * flatness : 0.0045;
  const double inner = std::max((rho - profile.radius) * flatness + kWall, kFloor - z);
  const double shell = -smoothMin(-outer, inner, kRounding);
  return -smoothMin(-shell, -std::max(z - kHeight, -z), kRounding);
}

double Amphora::handleDistance(const Point& p) const {
  const double x = std::abs(p[0]), z = p[2];
  double nearest_sq = 1.0;
  for (std::size_t i = 0; i + 1 < handle_.size(); ++i) {
    const auto &a = handle_[i], &b = handle_[i + 1];
    const double ex = b[0] - a[0], ez = b[1] - a[1], px = x - a[0], pz = z - a[1];
    const double t = std::clamp((px * ex + pz * ez) / (ex * ex + ez * ez), 0.0, 1.0);
    const double dx = px - t * ex, dz = pz - t * ez;
    nearest_sq = std::min(nearest_sq, dx * dx + dz * dz);
  }
  // A strap rather than a rod: wider across than thick.
  return std::sqrt(nearest_sq + 0.36 * p[1] * p[1]) - 0.0085;
}

double Amphora::distance(const Point& p) const {
  const double rho = std::hypot(p[0], p[1]);
  const double body = bodyDistance(rho, std::atan2(p[1], p[0]), p[2]);
  const double box = std::max({std::abs(p[1]) - 0.02, 0.27 - p[2], p[2] - 0.47});
  if (box > 0.03) return std::min(body, box);
  return smoothMin(body, handleDistance(p), 0.012);
}

Point Amphora::normal(const Point& p) const {
  constexpr double kStep = 2e-4;
  Point n{};
  for (std::size_t a = 0; a < 3; ++a) {
    Point low = p, high = p;
    low[a] -= kStep;
    high[a] += kStep;
    n[a] = distance(high) - distance(low);
  }
  const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  for (double& v : n) v /= length > 0.0 ? length : 1.0;
  return n;
}

std::array<double, 3> Amphora::color(const Point& p) const {
  constexpr std::array<double, 3> kClay{0.82, 0.47, 0.27}, kGlaze{0.13, 0.11, 0.11},
      kCream{0.93, 0.86, 0.71};
  const double z = p[2], angle = std::atan2(p[1], p[0]);
  if (handleDistance(p) < 0.003) return kGlaze;
  if (z < 0.05) return kGlaze;
  if (z < 0.165) {  // rays that taper upwards out of the foot
    const double width = 0.9 - 2.1 * (z - 0.05) / 0.115;
    return std::cos(20.0 * angle) > -width ? kGlaze : kClay;
  }
  if (z < 0.187 || (z > 0.198 && z < 0.204)) return kClay;
  if (z < 0.204 || (z > 0.272 && z < 0.285)) return kCream;
  if (z < 0.272) {
    const double offset = strandOffset(angle), x = z - 0.235;
    if (std::abs(x - offset) < 0.008) return kCream;
    return std::abs(x + offset) < 0.008 ? kClay : kGlaze;
  }
  if (z < 0.331) return std::cos(36.0 * angle) > 0.0 ? kGlaze : kClay;
  if (z < 0.346) return kCream;
  if (z > 0.425) return kGlaze;
  const double zigzag = std::abs(std::fmod(angle * 12.0 / M_PI + 48.0, 2.0) - 1.0);
  return std::abs(z - 0.375 - 0.028 * zigzag) < 0.006 ? kGlaze : kClay;
}

}  // namespace pcl_slim::demo
