// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/fit/fit_colors.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "pcl_slim/core/parallel.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/surface/surfel_color.h"

namespace pcl_slim {

namespace {

constexpr std::size_t kMostPoints = 4096;  ///< of a ball: more would not change six coefficients
constexpr double kLeastGate =
    0.1;  ///< of the radius: points farther from the surfel's polynomial ...
constexpr double kGateErrors = 5.0;  ///< ... and than this many residuals are of other sheets
constexpr std::uint8_t kGrey = 128;  ///< of surfels without any point

using Terms = Eigen::Matrix<double, kColorTerms, 1>;
using Matrix = Eigen::Matrix<double, kColorTerms, kColorTerms>;
using Channels = Eigen::Matrix<double, kColorTerms, 3>;

/** The colours of stored points. */
struct StoreColors {
  const PointStore& store;
  const CloudView& cloud;
  const ColorView& colors;

  const std::uint8_t* bgr(std::size_t i) const
  {
    const std::size_t input = cloud.inputIndex(store.orderOfStore()[i]);
    return static_cast<const std::uint8_t*>(colors.bgr) + input * colors.stride;
  }
};

Terms
termsAt(double u, double v)
{
  static_assert(kColorDegree == 2, "the terms below are those of degree 2");
  Terms terms;
  terms << 1.0, u, v, u * u, u * v, v * v;
  return terms;
}

/** Sums of the normal equations over weighted points. */
class ColorSums {
 public:
  void add(double weight, const Terms& terms, const std::uint8_t* bgr)
  {
    matrix_.noalias() += weight * terms * terms.transpose();
    for (int c = 0; c < 3; ++c) right_.col(c) += weight * bgr[2 - c] * terms;
    weight_ += weight;
    weight_sq_ += weight * weight;
  }

  bool empty() const { return !(weight_ > 0.0); }

  /** The polynomial; one more point's weight says that the colour is the same everywhere, so that few
   * points, or points on one side, give no steep slopes. */
  ColorPolynomial solve() const
  {
    Matrix matrix = matrix_;
    for (int k = 1; k < kColorTerms; ++k) matrix(k, k) += weight_sq_ / weight_;
    const Channels solution = matrix.ldlt().solve(right_);
    ColorPolynomial color;
    for (int k = 0; k < kColorTerms; ++k) {
      for (int c = 0; c < 3; ++c)
        color[static_cast<std::size_t>(k)][static_cast<std::size_t>(c)] =
            static_cast<float>(solution(k, c));
    }
    return color;
  }

 private:
  Matrix matrix_ = Matrix::Zero();
  Channels right_ = Channels::Zero();
  double weight_ = 0.0, weight_sq_ = 0.0;
};

/** Fits the colours of one surface's surfels, one after another. One per thread: it keeps its memory. */
class ColorFitter {
 public:
  ColorFitter(const StoreColors& points, const SLIMSurface& surface)
      : points_(points), surface_(surface)
  {
  }

  void fit(std::size_t i, std::uint8_t* bytes)
  {
    blocks_.clear();
    const float center[3] = {surface_.cx[i], surface_.cy[i], surface_.cz[i]};
    points_.store.tree().blocksInBall(center, surface_.radius[i], blocks_);
    ColorSums near = sumsOf(i, true);
    if (near.empty()) near = sumsOf(i, false);
    if (near.empty()) {
      std::fill_n(bytes, kColorBytes, std::uint8_t{0});
      std::fill_n(bytes, 3, kGrey);
    } else {
      encodeColor(near.solve(), bytes);
    }
  }

 private:
  /** \param[in] gated only points of the surfel's own sheet */
  ColorSums sumsOf(std::size_t i, bool gated) const
  {
    const SLIMSurface& s = surface_;
    const PointStore& store = points_.store;
    const LocalFrame frame({s.nx[i], s.ny[i], s.nz[i]});
    const Vector3 center = {s.cx[i], s.cy[i], s.cz[i]};
    const double scale = 1.0 / s.radius[i],
                 gate = std::max(kLeastGate, kGateErrors * s.error[i] * scale);
    const std::size_t all = blocks_.size() * PointStore::kBlock, step = 1 + all / kMostPoints;
    ColorSums sums;
    for (std::size_t j = 0; j < all; j += step) {
      const std::size_t p =
          blocks_[j / PointStore::kBlock] * PointStore::kBlock + j % PointStore::kBlock;
      if (p >= store.size()) continue;
      const Vector3 offset = scaled(subtract(store.position(p), center), scale);
      const double s_sq = dot(offset, offset);
      if (!(s_sq < 1.0)) continue;
      const double u = dot(offset, frame.u), v = dot(offset, frame.v);
      const double height = evaluateHeight(s.degree[i], s.coefficientsOf(i), u, v);
      if (gated && (std::abs(dot(offset, frame.w) - height) > gate || facesAway(p, frame.w)))
        continue;
      sums.add(evaluateKernel(s.info.blend_kernel, s_sq), termsAt(u, v), points_.bgr(p));
    }
    return sums;
  }

  bool facesAway(std::size_t p, const Vector3& normal) const
  {
    if (!points_.store.hasSides()) return false;
    const auto n = points_.store.normal(p);
    return n[0] * normal[0] + n[1] * normal[1] + n[2] * normal[2] < 0.0;
  }

  const StoreColors& points_;
  const SLIMSurface& surface_;
  std::vector<std::uint32_t> blocks_;
};

}  // namespace

Error
fitColors(const PointStore& store, const CloudView& cloud, const ColorView& colors, int threads,
          SLIMSurface& surface)
{
  surface.colors.clear();
  if (colors.bgr == nullptr || surface.empty()) return {};
  if (store.origin() != surface.info.origin || store.scale() != surface.info.scale)
    return badInput("the surface was not fitted to these points: fit it before its colours");
  threads = resolveThreads(threads);
  const StoreColors points{store, cloud, colors};
  std::vector<ColorFitter> fitters(static_cast<std::size_t>(threads), ColorFitter(points, surface));
  std::vector<std::uint8_t> bytes(surface.size() * kColorBytes);
  parallelFor(surface.size(), threads, 16, [&](std::size_t i, int thread) {
    fitters[static_cast<std::size_t>(thread)].fit(i, bytes.data() + i * kColorBytes);
  });
  surface.colors = std::move(bytes);
  return {};
}

}  // namespace pcl_slim
