// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "pcl_slim/core/export.h"
#include "pcl_slim/core/symmetric.h"

namespace pcl_slim {

/** \brief Columns of a G-buffer that a frame may do without; bits of a set. */
enum GBufferColumn : std::uint8_t {
  kPositionColumn = 1,
  kGradientColumn = 2,  ///< not normalised
  kHessianColumn = 4,
  kCurvatureColumn = 8,  ///< mean, Gaussian and principal
  kLeafColumns = 16,     ///< level and radius
  kWeightColumns = 32,   ///< weight and coverage
  kResidualColumn = 64,
  kAllColumns = 127,   ///< but colours
  kColorColumn = 128,  ///< of a surface that has colours; takes positions as well
};

/** \brief What a picture's rays met, one value per pixel and column, rows from the top.
 *
 * Lengths are in the surface's local units (world = origin + scale * local), directions in world
 * axes. Where a ray meets nothing surfel is kNothing, depth is infinity and the rest is 0; no
 * value is ever NaN. Columns that were not requested are empty; depth, normal, surfel and back_face
 * are always there. Normals and the derivatives face the viewer when the surface has no
 * orientation or both of its sides are shown. Discs leave derivatives, curvatures and levels at 0.
 */
struct PCL_SLIM_EXPORT GBuffer {
  static constexpr std::uint32_t kNothing = 0xffffffffu;

  int width = 0, height = 0;
  std::vector<float> depth;                     ///< t along the unit ray
  std::vector<std::array<float, 3>> position;   ///< blended point q (eq. 6)
  std::vector<std::array<float, 3>> normal;     ///< unit (eq. 7)
  std::vector<std::array<float, 3>> gradient;   ///< blended gradient, not normalised
  std::vector<Symmetric3<float>> hessian;       ///< blended Hessian (eq. 8, left)
  std::vector<float> mean_curvature;            ///< 1/length, positive on a ball
  std::vector<float> gaussian_curvature;        ///< 1/length^2
  std::vector<std::array<float, 2>> principal;  ///< k_max >= k_min, 1/length
  std::vector<std::uint32_t> surfel;            ///< leaf of the largest weight
  std::vector<std::uint8_t> level;              ///< its level
  std::vector<float> radius;                    ///< its support radius
  std::vector<float> residual;                  ///< its root mean square residual
  std::vector<float> weight;                    ///< sum of blending weights
  std::vector<float> coverage;                  ///< sum of cover weights, G(|q - c| / (alpha r))
  std::vector<std::uint8_t> back_face;          ///< 1: an oriented surface seen from behind
  std::vector<std::array<float, 3>>
      color;  ///< sRGB in [0, 1]; of discs and, if requested, of coloured surfaces; else empty

  /** \brief Sets the size and marks every pixel as met by nothing.
   * \param[in] columns GBufferColumn bits: columns in addition to depth, normal, surfel, back_face
   */
  void resize(int new_width, int new_height, unsigned columns = kAllColumns);
  /** \brief Sets the size only: the caller writes every pixel of every column. */
  void reserve(int new_width, int new_height, unsigned columns);

  std::size_t numPixels() const { return depth.size(); }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  }
  bool covered(std::size_t pixel) const { return surfel[pixel] != kNothing; }
  /** \brief Number of pixels whose ray met the surface. */
  std::size_t numCovered() const;
};

}  // namespace pcl_slim
