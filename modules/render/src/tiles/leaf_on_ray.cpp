// SPDX-License-Identifier: BSD-3-Clause
// One leaf on one ray in double, and what a blend of leaves writes into a pixel.
#include "tiles/tiles.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "hwy/highway.h"
#include "pcl_slim/leaf/detail/height-inl.h"
#include "pcl_slim/leaf/detail/level_set-inl.h"

namespace pcl_slim::detail {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/** \brief Interval of s in which a ray is inside the ball of relative radius rho and beyond the
 * near plane; empty when low > high. */
struct Chord {
  double low, high;

  Chord(const RaySurfel& surfel, const Approach& approach, double rho, double near_plane) {
    const double half_sq = rho * rho - approach.distance_sq;
    high = half_sq > 0.0 ? std::sqrt(half_sq) : -1.0;
    low = std::max(-high, (near_plane - approach.depth) * surfel.inverse_radius);
  }
};

/** \brief Whether a leaf's own trim map has data at q, in radii from its centre. */
bool hasData(const RaySurfel& surfel, const Vector3& q) {
  return outsideShare(surfel.trim, dot(q, surfel.frame.u), dot(q, surfel.frame.v)) <= 0.5;
}

/** \brief Adds w grad f and w H of a leaf, turned by sign, in world axes. */
void addDerivatives(const RaySurfel& surfel, const HeightJet& jet, double weight, BlendSum& sum) {
  using namespace kernels::HWY_NAMESPACE;
  const LocalFrame& frame = surfel.frame;
  double gradient[3], hessian[6];
  gradientIn(frame.u.data(), frame.v.data(), frame.w.data(), Slopes<double>{jet.h, jet.hu, jet.hv},
             gradient);
  for (int a = 0; a < 3; ++a) sum.gradient[a] += weight * gradient[a];
  const SecondDerivatives<double> bend{jet.huu, jet.huv, jet.hvv};
  hessianIn(frame.u.data(), frame.v.data(), bend, hessian);
  for (std::size_t k = 0; k < 6; ++k) {
    sum.hessian[k] -= weight * surfel.inverse_radius * hessian[k];
  }
}

/** \brief The root nearest to s_hat, of those on the chord that count. \return false when there is
 * none. */
bool nearestRoot(const RayPolynomial& polynomial, int degree, const Chord& chord, double s_hat,
                 bool front_only, double& root) {
  if (obviousRoot(polynomial.a, s_hat, root) && root >= chord.low && root <= chord.high &&
      (!front_only || polynomial.slope(root) < 0.0)) {
    return true;
  }
  return nearestRootInInterval(degree, polynomial.a, chord.low, chord.high, s_hat, front_only,
                               root);
}

}  // namespace

double firstRoot(const FrameRules& rules, const RaySurfel& surfel, const Ray& ray, double nearest,
                 double limit, std::uint64_t& evaluated) {
  const Approach approach(surfel, ray);
  Chord chord(surfel, approach, rules.shrink, nearest);
  chord.high = std::min(chord.high, (limit - approach.depth) * surfel.inverse_radius);
  if (!(chord.low <= chord.high)) return kInfinity;
  ++evaluated;
  const RayPolynomial polynomial(surfel, approach, ray.direction);
  const auto counts = [&](double s) {
    return !rules.trim || hasData(surfel, along(approach.point, s, ray.direction));
  };
  const double root =
      firstRootInInterval(surfel.degree, polynomial.a, chord.low,
                          rules.front_only ? kInfinity : chord.low, chord.high, counts);
  return approach.depth + root * surfel.radius;
}

void blendLeaf(const FrameRules& rules, WeightKernel kernel, const RaySurfel& surfel,
               std::uint32_t id, const Ray& ray, double depth_hat, BlendSum& sum,
               std::uint64_t& evaluated) {
  const Approach approach(surfel, ray);
  const double s_hat = (depth_hat - approach.depth) * surfel.inverse_radius;
  const double hat_sq = approach.distance_sq + s_hat * s_hat;
  if (!(hat_sq < 1.0)) return;
  ++evaluated;
  const RayPolynomial polynomial(surfel, approach, ray.direction);
  const double at_hat = evaluate<4>(polynomial.a, s_hat);
  if (!(std::abs(at_hat) < kMaxShift)) return;
  const double behind = evaluate<4>(polynomial.a, s_hat + kBehind);
  const Chord chord(surfel, approach, 1.0, rules.near_plane);
  double s = 0.0;
  if (!nearestRoot(polynomial, surfel.degree, chord, s_hat, rules.front_only, s)) {
    if (!(at_hat > 0.0)) return;
    sum.clearance += surfel.variance_weight * evaluateKernel(kernel, hat_sq) * surfel.radius *
                     heightBehind(behind, false);
    return;
  }

  const Vector3 q = along(approach.point, s, ray.direction);
  const double u = dot(q, surfel.frame.u), v = dot(q, surfel.frame.v);
  const HeightJet jet = evaluateJet(surfel.degree, surfel.coefficients, u, v);
  const double slope = polynomial.slope(s);
  // A leaf of another sheet may have its root near its own centre: q^ has to be near as well.
  const double root_sq = approach.distance_sq + s * s;
  const double weight = surfel.variance_weight * evaluateKernel(kernel, std::max(hat_sq, root_sq));
  if (!(weight > 0.0)) return;
  const double side = slope > 0.0 ? -1.0 : 1.0;
  sum.weight += weight;
  sum.shift += weight * (s - s_hat) * surfel.radius;
  sum.coverage += evaluateKernel(kernel, root_sq / (rules.cover_radius * rules.cover_radius));
  sum.clearance += weight * surfel.radius * heightBehind(side * behind, true);
  if (rules.trim) sum.outside += weight * outsideShare(surfel.trim, u, v);
  for (std::size_t k = 0; k < 3; ++k) sum.offset_sum[k] += weight * q[k];
  ++sum.leaves;
  sum.facing += slope > 0.0 ? -1 : 1;
  addDerivatives(surfel, jet, side * weight, sum);
  if (weight > sum.largest_weight) {
    sum.largest_weight = weight;
    sum.surfel = id;
  }
}

bool isOutside(const BlendSum& sum) {
  return sum.outside > 0.5 * sum.weight;
}

bool isSupported(const BlendSum& sum, double min_coverage) {
  if (isOutside(sum)) return false;
  if (sum.coverage >= min_coverage) return true;
  const double offset_sq = sum.offset_sum[0] * sum.offset_sum[0] +
                           sum.offset_sum[1] * sum.offset_sum[1] +
                           sum.offset_sum[2] * sum.offset_sum[2];
  return sum.leaves >= kMinLeaves &&
         offset_sq < kMaxMeanOffset * kMaxMeanOffset * sum.weight * sum.weight;
}

namespace {

/** \brief Writes the requested attributes from the blended derivatives. */
void writeDerivatives(const BlendSum& sum, std::size_t pixel, GBuffer& out) {
  double gradient[3];
  Symmetric3<double> hessian;
  for (int k = 0; k < 3; ++k) gradient[k] = sum.gradient[k] / sum.weight;
  for (std::size_t k = 0; k < 6; ++k) hessian[k] = sum.hessian[k] / sum.weight;
  const Vector3 normal = normalized({gradient[0], gradient[1], gradient[2]});
  for (std::size_t k = 0; k < 3; ++k) {
    out.normal[pixel][k] = static_cast<float>(normal[k]);
    if (!out.gradient.empty()) out.gradient[pixel][k] = static_cast<float>(gradient[k]);
  }
  for (std::size_t k = 0; k < 6 && !out.hessian.empty(); ++k) {
    out.hessian[pixel][k] = static_cast<float>(hessian[k]);
  }
  if (out.mean_curvature.empty()) return;
  using Curvatures = kernels::HWY_NAMESPACE::LevelSetCurvatures<double>;
  const Curvatures curvature(gradient, hessian.data());
  out.mean_curvature[pixel] = static_cast<float>(curvature.mean);
  out.gaussian_curvature[pixel] = static_cast<float>(curvature.gaussian);
  out.principal[pixel] = {static_cast<float>(curvature.k_max), static_cast<float>(curvature.k_min)};
}

}  // namespace

void writeBlend(const SLIMSurface& surface, const Ray& ray, double depth_hat, const BlendSum& sum,
                std::size_t pixel, GBuffer& out) {
  const double depth = depth_hat + sum.shift / sum.weight;
  const Vector3 q = along(ray.origin, depth, ray.direction);
  out.depth[pixel] = static_cast<float>(depth);
  for (std::size_t k = 0; k < 3 && !out.position.empty(); ++k) {
    out.position[pixel][k] = static_cast<float>(q[k]);
  }
  writeDerivatives(sum, pixel, out);
  out.surfel[pixel] = sum.surfel;
  if (!out.level.empty()) {
    out.level[pixel] = surface.level[sum.surfel];
    out.radius[pixel] = surface.radius[sum.surfel];
  }
  if (!out.weight.empty()) {
    out.weight[pixel] = static_cast<float>(sum.weight);
    out.coverage[pixel] = static_cast<float>(sum.coverage);
  }
  out.back_face[pixel] = static_cast<std::uint8_t>(surface.info.hasFront() && sum.facing < 0);
}

}  // namespace pcl_slim::detail
