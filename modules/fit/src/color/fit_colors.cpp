// SPDX-License-Identifier: BSD-3-Clause
// Weighted sums of points' colours over the plane of a surfel, compiled for each instruction set,
// and the polynomials that they give.
#include "pcl_slim/fit/fit_colors.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

#include "color/color_fit.h"
#include "color/surfel_sheet.h"
#include "color/texture_fit.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/leaf/detail/gates.h"
#include "pcl_slim/surface/surfel_color.h"
#include "scan/ball_kernels.h"

#ifndef PCL_SLIM_COLOR_SUMS  // once: Highway includes this file anew for each instruction set
#define PCL_SLIM_COLOR_SUMS

namespace pcl_slim::detail {

/** A surfel as its colours see it: points of the ball within its normal bound, and near its
 * polynomial. */
struct ColorBall {
  BallQuery ball;
  LocalFrame frame;
  int degree;
  const float* c;      ///< coefficients in units of the radius
  float max_residual;  ///< [radii]; infinite: no point is too far
};

/** Sums of the normal equations of a polynomial in (u, v) for each channel. */
struct ColorSums {
  static constexpr int kMoments = numCoefficients(2 * kColorDegree);
  std::array<double, kMoments> moments{};  ///< sum w u^i v^j, in the order of evaluateHeight()
  std::array<std::array<double, kColorTerms>, 3> channels{};  ///< sum w colour u^i v^j
  double weight_sq = 0;
};

}  // namespace pcl_slim::detail

#endif

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "color/fit_colors.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

#include "scan/ball_scan-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/** One channel of a group of points. */
HWY_INLINE Vec loadChannel(const std::uint8_t* channel) {
  const Tag d;
  const hn::Rebind<std::uint8_t, Tag> bytes;
  const hn::Rebind<std::int32_t, Tag> integers;
  return ConvertTo(d, PromoteTo(integers, LoadU(bytes, channel)));
}

template <int D, WeightKernel K>
ColorSums sumColorsOf(const PointStore& store, const BlockList& blocks, const ColorBall& surfel,
                      const ColorColumns& colors) {
  const Tag d;
  const float scale = 1.0f / surfel.ball.radius;
  Vec axes[3][3];
  for (int a = 0; a < 3; ++a) {
    axes[0][a] = set(static_cast<float>(surfel.frame.u[a]) * scale);
    axes[1][a] = set(static_cast<float>(surfel.frame.v[a]) * scale);
    axes[2][a] = set(static_cast<float>(surfel.frame.w[a]) * scale);
  }
  const Height<D> height(surfel.c);
  const auto limit = set(surfel.max_residual), scale_sq = set(scale * scale);
  Vec moments[ColorSums::kMoments], channels[3][kColorTerms], weight_sq = Zero(d);
  for (auto& sum : moments) sum = Zero(d);
  for (auto& channel : channels)
    for (auto& sum : channel) sum = Zero(d);
  BallScan(store, surfel.ball).forEach(blocks, [&](std::size_t i, const Lanes& l) HWY_ATTR {
    const auto u = dot3(l.dx, l.dy, l.dz, axes[0][0], axes[0][1], axes[0][2]);
    const auto v = dot3(l.dx, l.dy, l.dz, axes[1][0], axes[1][1], axes[1][2]);
    const auto w = dot3(l.dx, l.dy, l.dz, axes[2][0], axes[2][1], axes[2][2]);
    const auto near = And(l.kept, Abs(w - height(u, v)) <= limit);
    if (AllFalse(d, near)) return;
    const auto weight = IfThenElseZero(near, kernelWeight<K>(l.d_sq * scale_sq));
    // Padding is far away; its products may be infinite, and count as 0.
    const auto u_near = IfThenElseZero(near, u), v_near = IfThenElseZero(near, v);
    weight_sq = MulAdd(weight, weight, weight_sq);
    addGradedTerms<2 * kColorDegree>(weight, u_near, v_near, moments);
    for (int c = 0; c < 3; ++c) {
      const auto color = loadChannel(colors[static_cast<std::size_t>(c)].data() + i);
      addGradedTerms<kColorDegree>(weight * color, u_near, v_near, channels[c]);
    }
  });
  ColorSums sums;
  sums.weight_sq = sumLanes(weight_sq);
  for (std::size_t k = 0; k < sums.moments.size(); ++k) sums.moments[k] = sumLanes(moments[k]);
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t k = 0; k < kColorTerms; ++k) sums.channels[c][k] = sumLanes(channels[c][k]);
  }
  return sums;
}

/** Sums over the points of some blocks inside a surfel's ball, weighted by a kernel. */
ColorSums sumColors(const PointStore& store, const BlockList& blocks, const ColorBall& surfel,
                    WeightKernel kernel, const ColorColumns& colors) {
  ColorSums sums;
  forDegree(surfel.degree, [&](auto degree) HWY_ATTR {
    sums = kernel == WeightKernel::kGaussian
               ? sumColorsOf<degree(), WeightKernel::kGaussian>(store, blocks, surfel, colors)
               : sumColorsOf<degree(), WeightKernel::kPower7>(store, blocks, surfel, colors);
  });
  return sums;
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_slim::detail::kernels {

HWY_EXPORT(sumColors);

ColorSums sumColors(const PointStore& store, const BlockList& blocks, const ColorBall& surfel,
                    WeightKernel kernel, const ColorColumns& colors) {
  return HWY_DYNAMIC_DISPATCH(sumColors)(store, blocks, surfel, kernel, colors);
}

}  // namespace pcl_slim::detail::kernels

namespace pcl_slim {

namespace {

using detail::ColorColumns;
using detail::ColorSums;

constexpr std::size_t kMostPoints = 4096;  ///< of a ball: more would not change six coefficients
/// Points farther from the surfel's polynomial are of other sheets.
constexpr auto kLeastGate = static_cast<float>(detail::kLeastErrorGate);  ///< of the radius
constexpr auto kGateErrors = static_cast<float>(detail::kErrorGate);      ///< residuals
constexpr std::uint8_t kGrey = 128;      ///< of surfels without any point
constexpr std::size_t kSlice = 1 << 14;  ///< points that a thread takes at a time

/** Powers of u and v of the polynomial's terms. */
constexpr std::array<std::array<int, 2>, kColorTerms> kPowers = {
    {{0, 0}, {1, 0}, {0, 1}, {2, 0}, {1, 1}, {0, 2}}};

/** The polynomials; the weight of one more point pulls them towards a constant colour, so that few
 * points, or points on one side, give no steep slopes. */
ColorPolynomial solve(const ColorSums& sums) {
  Eigen::Matrix<double, kColorTerms, kColorTerms> matrix;
  Eigen::Matrix<double, kColorTerms, 3> right;
  for (int k = 0; k < kColorTerms; ++k) {
    for (int l = 0; l < kColorTerms; ++l) {
      const auto &a = kPowers[static_cast<std::size_t>(k)],
                 &b = kPowers[static_cast<std::size_t>(l)];
      const int i = a[0] + b[0], j = a[1] + b[1];
      matrix(k, l) = sums.moments[static_cast<std::size_t>((i + j) * (i + j + 1) / 2 + j)];
    }
    for (int c = 0; c < 3; ++c)
      right(k, c) = sums.channels[static_cast<std::size_t>(c)][static_cast<std::size_t>(k)];
    if (k > 0) matrix(k, k) += sums.weight_sq / sums.moments[0];
  }
  const Eigen::Matrix<double, kColorTerms, 3> solution = matrix.ldlt().solve(right);
  ColorPolynomial color;
  for (int k = 0; k < kColorTerms; ++k) {
    for (int c = 0; c < 3; ++c)
      color[static_cast<std::size_t>(k)][static_cast<std::size_t>(c)] =
          static_cast<float>(solution(k, c));
  }
  return color;
}

/** Fits the colours of one surface's surfels, one after another. One per thread: it keeps its
 * memory. */
class ColorFitter {
 public:
  ColorFitter(const PointStore& store, const ColorColumns& colors, const SLIMSurface& surface,
              const LabTable& lab, double noise, const detail::LeadingWeights& weights)
      : store_(store), colors_(colors), surface_(surface), textures_(colors, lab, noise, weights) {}

  /** Appends the texels of a surfel that has its polynomial. \return the texture's side, 0: none */
  std::uint8_t fitTexture(std::size_t i, const std::uint8_t* color,
                          std::vector<std::uint8_t>& texels) {
    const float variance_weight = surface_.isLeaf(i) ? surface_.varianceWeight(i) : 0.0f;
    return static_cast<std::uint8_t>(textures_.fit(gather(i), color, variance_weight, texels));
  }

  /** Raises the weights at a leaf's points to its own. */
  void raise(std::size_t i, detail::LeadingWeights& weights) {
    detail::raiseWeights(gather(i), surface_.varianceWeight(i), weights);
  }

  /** Encodes the polynomial of a surfel; without points the bytes stay as they are. */
  void fit(std::size_t i, std::uint8_t* bytes) {
    const float center[3] = {surface_.cx[i], surface_.cy[i], surface_.cz[i]};
    detail::listBlocks(store_, center, surface_.radius[i], kMostPoints, found_, blocks_);
    ColorSums sums = sumsOf(i, true);
    if (!(sums.moments[0] > 0)) sums = sumsOf(i, false);
    if (sums.moments[0] > 0) encodeColor(solve(sums), bytes);
  }

 private:
  /** The points of surfel i's sheet, as far as textures reach; a part of those of wide internal
   * ones. */
  const detail::SheetPoints& gather(std::size_t i) {
    detail::SheetBounds bounds;
    bounds.reach = SurfelTexture::kReach;
    bounds.facing = store_.hasSides();
    bounds.max_residual = gateOf(i);
    if (!surface_.isLeaf(i)) bounds.most = kMostPoints;
    return sheet_.gather(store_, surface_, i, bounds);
  }

  /** Points farther from a surfel's polynomial are of other sheets [radii]. */
  float gateOf(std::size_t i) const {
    return std::max(kLeastGate, kGateErrors * surface_.error[i] / surface_.radius[i]);
  }

  /** \param[in] own_sheet only points of the surfel's own sheet */
  ColorSums sumsOf(std::size_t i, bool own_sheet) const {
    const SLIMSurface& s = surface_;
    const float normal[3] = {s.nx[i], s.ny[i], s.nz[i]};
    detail::ColorBall surfel;
    surfel.ball = {{s.cx[i], s.cy[i], s.cz[i]}, s.radius[i]};
    if (own_sheet && store_.hasSides()) surfel.ball.bound_normal = normal;
    surfel.frame = LocalFrame({s.nx[i], s.ny[i], s.nz[i]});
    surfel.degree = s.degree[i];
    surfel.c = s.coefficientsOf(i);
    surfel.max_residual = own_sheet ? gateOf(i) : std::numeric_limits<float>::infinity();
    return detail::kernels::sumColors(store_, blocks_, surfel, s.info.blend_kernel, colors_);
  }

  const PointStore& store_;
  const ColorColumns& colors_;
  const SLIMSurface& surface_;
  std::vector<std::uint32_t> found_;  ///< blocks that meet the ball ...
  BlockList blocks_;                  ///< ... and those of them that are looked at
  detail::SurfelSheet sheet_;
  detail::TextureFitter textures_;
};

/** Appends a texture as it is. \return its side */
std::uint8_t keepTexture(const SurfelTexture& texture, std::vector<std::uint8_t>& texels) {
  texels.insert(texels.end(), texture.rgb, texture.rgb + SurfelTexture::numBytes(texture.side));
  return static_cast<std::uint8_t>(texture.side);
}

/** Gives surfels textures where their polynomials do not follow the points' colours. \param[in]
 * keeps whether a surfel has the texture that it has in the surface already; empty: none has */
void fitTextures(const std::vector<char>& keeps, int threads, std::vector<ColorFitter>& fitters,
                 detail::LeadingWeights& weights, SLIMSurface& surface) {
  constexpr std::size_t kRun = 4;  ///< surfels a thread takes at a time; no result depends on it
  const std::size_t count = surface.size(), runs = (count + kRun - 1) / kRun;
  const auto forRuns = [&](const auto& body) {
    parallelFor(runs, threads, 1, [&](std::size_t run, int thread) {
      for (std::size_t i = run * kRun; i < std::min(count, (run + 1) * kRun); ++i)
        body(i, run, fitters[static_cast<std::size_t>(thread)]);
    });
  };
  forRuns([&](std::size_t i, std::size_t, ColorFitter& fitter) {
    if (surface.isLeaf(i)) fitter.raise(i, weights);
  });
  std::vector<std::uint8_t> sides(count);
  std::vector<std::vector<std::uint8_t>> parts(runs);
  forRuns([&](std::size_t i, std::size_t run, ColorFitter& fitter) {
    sides[i] = keeps.empty() || keeps[i] == 0
                   ? fitter.fitTexture(i, surface.colors.data() + i * kColorBytes, parts[run])
                   : keepTexture(surface.texture(i), parts[run]);
  });
  std::vector<std::uint8_t> texels;
  for (const auto& part : parts) texels.insert(texels.end(), part.begin(), part.end());
  surface.setTextures(sides, texels);
}

}  // namespace

namespace detail {

ColorColumns colorsInStoreOrder(const PointStore& store, const CloudView& cloud,
                                const ColorView& colors, int threads) {
  ColorColumns columns;
  for (auto& column : columns) column.resize(store.numBlocks() * PointStore::kBlock);
  parallelFor((store.size() + kSlice - 1) / kSlice, threads, 1, [&](std::size_t s, int) {
    const std::size_t end = std::min(store.size(), (s + 1) * kSlice);
    for (std::size_t i = s * kSlice; i < end; ++i) {
      const std::size_t input = cloud.inputIndex(store.orderOfStore()[i]);
      const auto* bgr = static_cast<const std::uint8_t*>(colors.bgr) + input * colors.stride;
      for (std::size_t c = 0; c < 3; ++c) columns[c][i] = bgr[2 - c];
    }
  });
  for (auto& column : columns) std::fill(column.begin() + store.size(), column.end(), kGrey);
  return columns;
}

std::vector<std::uint8_t> greyColors(std::size_t surfels) {
  std::vector<std::uint8_t> bytes(surfels * kColorBytes, 0);
  for (std::size_t i = 0; i < surfels; ++i) std::fill_n(bytes.data() + i * kColorBytes, 3, kGrey);
  return bytes;
}

void fitStoredColors(const PointStore& store, const ColorColumns& columns,
                     const std::vector<char>& keeps, int threads, SLIMSurface& surface) {
  const LabTable lab;
  const double noise = colorNoise(store, columns, lab);
  LeadingWeights weights(store.size());
  std::vector<ColorFitter> fitters(static_cast<std::size_t>(threads),
                                   ColorFitter(store, columns, surface, lab, noise, weights));
  std::vector<std::uint8_t> bytes =
      surface.hasColors() && !keeps.empty() ? surface.colors : greyColors(surface.size());
  parallelFor(surface.size(), threads, 16, [&](std::size_t i, int thread) {
    if (keeps.empty() || keeps[i] == 0)
      fitters[static_cast<std::size_t>(thread)].fit(i, bytes.data() + i * kColorBytes);
  });
  surface.colors = std::move(bytes);
  fitTextures(keeps, threads, fitters, weights, surface);
}

}  // namespace detail

Error fitColors(const PointStore& store, const CloudView& cloud, const ColorView& colors,
                int threads, SLIMSurface& surface) {
  surface.colors.clear();
  surface.dropTextures();
  if (colors.bgr == nullptr || surface.empty()) return {};
  if (store.origin() != surface.info.origin || store.scale() != surface.info.scale)
    return badInput("the surface was not fitted to these points: fit it before its colours");
  threads = resolveThreads(threads);
  const ColorColumns columns = detail::colorsInStoreOrder(store, cloud, colors, threads);
  detail::fitStoredColors(store, columns, {}, threads, surface);
  return {};
}

}  // namespace pcl_slim
#endif
