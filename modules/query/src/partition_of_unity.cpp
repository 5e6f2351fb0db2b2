// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/query/partition_of_unity.h"

#include <algorithm>
#include <cmath>

#include "pcl_slim/surface/detail/center_grid.h"

namespace pcl_slim {

using namespace detail;

namespace {

using Vector = std::array<double, 3>;

/** One leaf's f and its weight w, each with two derivatives, at a point. */
struct WeightedLeaf {
  ImplicitJet f, w;
};

/** Adds k a b^T + k b a^T, or k a a^T for a = b, to a symmetric matrix. */
void
addOuter(double k, const Vector& a, const Vector& b, std::array<double, 6>& h)
{
  for (int i = 0, at = 0; i < 3; ++i) {
    for (int j = i; j < 3; ++j, ++at) {
      h[at] += &a == &b ? k * a[i] * a[j] : k * (a[i] * b[j] + b[i] * a[j]);
    }
  }
}

ImplicitJet
leafFunction(const SLIMSurface& s, std::size_t i, const Vector& d)
{
  const LocalFrame frame({s.nx[i], s.ny[i], s.nz[i]});
  const double r = s.radius[i];
  const auto along = [&](const Vector& axis) {
    return (d[0] * axis[0] + d[1] * axis[1] + d[2] * axis[2]) / r;
  };
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
std::array<double, 3>
kernelBySquare(WeightKernel kernel, double s)
{
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

ImplicitJet
leafWeight(const SLIMSurface& surface, std::size_t i, const Vector& d)
{
  const double r = surface.radius[i];
  const double s = (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) / (r * r);
  auto g = kernelBySquare(surface.info.blend_kernel, s);
  const double trust = surface.info.paper_mode ? 1.0 : surface.trust(i);
  for (double& derivative : g) derivative *= trust;
  ImplicitJet jet;
  jet.value = g[0];
  const double slope = 2 / (r * r);
  for (int a = 0; a < 3; ++a) jet.gradient[a] = g[1] * slope * d[a];
  addOuter(g[2] * slope * slope, d, d, jet.hessian);
  for (const int diagonal : {0, 3, 5}) jet.hessian[diagonal] += g[1] * slope;
  return jet;
}

}  // namespace

/** The leaves by level, as their balls are alike in size there. */
struct PartitionOfUnity::Index {
  std::vector<std::vector<std::uint32_t>> members;
  std::vector<CenterGrid> grids;
};

PartitionOfUnity::PartitionOfUnity(const SLIMSurface& surface)
    : surface_(surface), index_(std::make_unique<Index>())
{
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

bool
PartitionOfUnity::evaluate(const std::array<double, 3>& x, ImplicitJet& jet) const
{
  ImplicitJet weight, sum;  // W = sum w, S = sum w f
  const auto add = [&](std::uint32_t i, float) {
    const Vector d = {x[0] - surface_.cx[i], x[1] - surface_.cy[i], x[2] - surface_.cz[i]};
    const double r = surface_.radius[i];
    if (d[0] * d[0] + d[1] * d[1] + d[2] * d[2] >= r * r) return;
    const ImplicitJet f = leafFunction(surface_, i, d);
    const ImplicitJet w = leafWeight(surface_, i, d);
    weight.value += w.value;
    sum.value += w.value * f.value;
    for (int a = 0; a < 3; ++a) {
      weight.gradient[a] += w.gradient[a];
      sum.gradient[a] += w.gradient[a] * f.value + w.value * f.gradient[a];
    }
    for (int k = 0; k < 6; ++k) {
      weight.hessian[k] += w.hessian[k];
      sum.hessian[k] += w.hessian[k] * f.value + w.value * f.hessian[k];
    }
    addOuter(1.0, w.gradient, f.gradient, sum.hessian);
  };
  for (const CenterGrid& grid : index_->grids) {
    grid.forEachNear(static_cast<float>(x[0]), static_cast<float>(x[1]), static_cast<float>(x[2]),
                     add);
  }
  if (!(weight.value > 0)) return false;
  // F = S / W, so S = F W and its derivatives give those of F in turn.
  jet.value = sum.value / weight.value;
  for (int a = 0; a < 3; ++a) {
    jet.gradient[a] = (sum.gradient[a] - jet.value * weight.gradient[a]) / weight.value;
  }
  jet.hessian = sum.hessian;
  for (int k = 0; k < 6; ++k) jet.hessian[k] -= jet.value * weight.hessian[k];
  addOuter(-1.0, jet.gradient, weight.gradient, jet.hessian);
  for (double& entry : jet.hessian) entry /= weight.value;
  return true;
}

}  // namespace pcl_slim
