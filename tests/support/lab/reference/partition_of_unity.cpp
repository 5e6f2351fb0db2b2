// SPDX-License-Identifier: BSD-3-Clause
// The right side of the paper's equation (8): theory.md, "Curvature".
#include "support/lab/reference/partition_of_unity.h"

#include <algorithm>
#include <cmath>

#include "pcl_slim/core/parallel.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/surface/detail/center_grid.h"
#include "projection/projection.h"

namespace pcl_slim::lab {

using namespace detail;

namespace {

/** One leaf's f and its weight w, each with two derivatives, at a point. */
struct WeightedLeaf {
  ImplicitJet f, w;
};

/** Adds k a b^T + k b a^T, or k a a^T for a = b, to a symmetric matrix. */
void addOuter(double k, const Vector3& a, const Vector3& b, Symmetric3<double>& h) {
  for (int i = 0; i < 3; ++i) {
    for (int j = i; j < 3; ++j) {
      h[kSymmetricEntry[i][j]] += &a == &b ? k * a[i] * a[j] : k * (a[i] * b[j] + b[i] * a[j]);
    }
  }
}

ImplicitJet leafFunction(const SLIMSurface& s, std::size_t i, const Vector3& d) {
  const LocalFrame frame({s.nx[i], s.ny[i], s.nz[i]});
  const double r = s.radius[i];
  const auto along = [&](const Vector3& axis) { return dot(d, axis) / r; };
  const HeightJet h = evaluateJet(s.degree[i], s.coefficientsOf(i), along(frame.u), along(frame.v));
  ImplicitJet jet;
  jet.value = r * (along(frame.w) - h.h);
  for (int a = 0; a < 3; ++a) jet.gradient[a] = frame.w[a] - h.hu * frame.u[a] - h.hv * frame.v[a];
  addOuter(-h.huu / r, frame.u, frame.u, jet.hessian);
  addOuter(-h.huv / r, frame.u, frame.v, jet.hessian);
  addOuter(-h.hvv / r, frame.v, frame.v, jet.hessian);
  return jet;
}

/** (1 - s)^m over s = (d / r)^2, and for the Gaussian its inner part's derivatives by s. */
std::array<double, 3> kernelBySquare(WeightKernel kernel, double s) {
  if (kernel == WeightKernel::kGaussian) {
    if (s < 0.25) return {std::exp(-8 * s), -8 * std::exp(-8 * s), 64 * std::exp(-8 * s)};
    const double root = std::sqrt(s), q = 1 - root, k = 16 * std::exp(-2.0);
    return {k * q * q * q * q, -2 * k * q * q * q / root,
            k * (3 * q * q / s + q * q * q / (s * root))};
  }
  const double m = static_cast<double>(static_cast<unsigned char>(kernel));
  const double q = 1 - s;
  return {std::pow(q, m), -m * std::pow(q, m - 1), m * (m - 1) * std::pow(q, m - 2)};
}

ImplicitJet leafWeight(const SLIMSurface& surface, std::size_t i, const Vector3& d) {
  const double r = surface.radius[i];
  const double s = dot(d, d) / (r * r);
  auto g = kernelBySquare(surface.info.blend_kernel, s);
  const double variance_weight = surface.info.paper_mode ? 1.0 : surface.varianceWeight(i);
  for (double& derivative : g) derivative *= variance_weight;
  ImplicitJet jet;
  jet.value = g[0];
  const double slope = 2 / (r * r);
  for (int a = 0; a < 3; ++a) jet.gradient[a] = g[1] * slope * d[a];
  addOuter(g[2] * slope * slope, d, d, jet.hessian);
  for (const SymmetricEntry diagonal : {kXX, kYY, kZZ}) jet.hessian[diagonal] += g[1] * slope;
  return jet;
}

/** W = sum w and S = sum w f over leaves. */
struct Sums {
  ImplicitJet weight, product;

  void add(const ImplicitJet& f, const ImplicitJet& w) {
    weight.value += w.value;
    product.value += w.value * f.value;
    for (int a = 0; a < 3; ++a) {
      weight.gradient[a] += w.gradient[a];
      product.gradient[a] += w.gradient[a] * f.value + w.value * f.gradient[a];
    }
    for (std::size_t k = 0; k < 6; ++k) {
      weight.hessian[k] += w.hessian[k];
      product.hessian[k] += w.hessian[k] * f.value + w.value * f.hessian[k];
    }
    addOuter(1.0, w.gradient, f.gradient, product.hessian);
  }

  /** F = S / W: as S = F W, its derivatives give those of F in turn. */
  ImplicitJet quotient() const {
    ImplicitJet jet;
    jet.value = product.value / weight.value;
    for (int a = 0; a < 3; ++a) {
      jet.gradient[a] = (product.gradient[a] - jet.value * weight.gradient[a]) / weight.value;
    }
    jet.hessian = product.hessian;
    for (std::size_t k = 0; k < 6; ++k) jet.hessian[k] -= jet.value * weight.hessian[k];
    addOuter(-1.0, jet.gradient, weight.gradient, jet.hessian);
    for (double& entry : jet.hessian) entry /= weight.value;
    return jet;
  }
};

}  // namespace

/** The leaves by level, as their balls are alike in size there. */
struct PartitionOfUnity::Index {
  std::vector<std::vector<std::uint32_t>> members;
  std::vector<CenterGrid> grids;
};

PartitionOfUnity::PartitionOfUnity(const SLIMSurface& surface)
    : surface_(surface), index_(std::make_unique<Index>()) {
  index_->members.resize(256);
  for (std::uint32_t i = 0; i < surface.size(); ++i) {
    if (surface.isLeaf(i)) index_->members[surface.level[i]].push_back(i);
  }
  for (const auto& level : index_->members) {
    float widest = 0;
    for (const std::uint32_t i : level) widest = std::max(widest, surface.radius[i]);
    if (!level.empty()) index_->grids.emplace_back(surface, level, widest);
  }
}

PartitionOfUnity::~PartitionOfUnity() = default;

bool PartitionOfUnity::evaluate(const std::array<double, 3>& x, ImplicitJet& jet) const {
  Sums sums;
  const auto add = [&](std::uint32_t i, float) {
    const Vector3 d = {x[0] - surface_.cx[i], x[1] - surface_.cy[i], x[2] - surface_.cz[i]};
    const double r = surface_.radius[i];
    if (dot(d, d) >= r * r) return;
    sums.add(leafFunction(surface_, i, d), leafWeight(surface_, i, d));
  };
  for (const CenterGrid& grid : index_->grids) {
    grid.forEachNear(static_cast<float>(x[0]), static_cast<float>(x[1]), static_cast<float>(x[2]),
                     add);
  }
  if (!(sums.weight.value > 0)) return false;
  jet = sums.quotient();
  return true;
}

namespace {

void writeCurvatures(const ImplicitJet& jet, std::size_t pixel, GBuffer& buffer) {
  const auto [mean, gaussian] = meanAndGaussian(jet.gradient, jet.hessian);
  const float spread = std::sqrt(std::max(0.0f, mean * mean - gaussian));
  buffer.mean_curvature[pixel] = mean;
  buffer.gaussian_curvature[pixel] = gaussian;
  buffer.principal[pixel] = {mean + spread, mean - spread};
}

void writePixel(ImplicitJet jet, std::size_t pixel, GBuffer& buffer) {
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
  if (!buffer.mean_curvature.empty()) writeCurvatures(jet, pixel, buffer);
}

}  // namespace

Error differentiateInSpace(const SLIMSurface& surface, int threads, GBuffer& buffer) {
  if (!surface.info.oriented) {
    return {ErrorCode::kBadArgument,
            "leaves that differ in orientation have no partition of unity; fit the surface with "
            "normals or take blended derivatives"};
  }
  const PartitionOfUnity unity(surface);
  parallelFor(buffer.numPixels(), resolveThreads(threads), 256, [&](std::size_t pixel, int) {
    if (!buffer.covered(pixel)) return;
    const auto& q = buffer.position[pixel];
    ImplicitJet jet;
    if (unity.evaluate({q[0], q[1], q[2]}, jet)) writePixel(jet, pixel, buffer);
  });
  return {};
}

}  // namespace pcl_slim::lab
