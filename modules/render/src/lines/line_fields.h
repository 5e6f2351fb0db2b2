// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "lines/pixel_geometry.h"
#include "lines/zero_lines.h"

namespace pcl_slim::detail {

/** \brief A curvature of every pixel that shows the surface; what others hold is not defined. */
class CurvatureMap {
 public:
  using Kernel = void (*)(const PictureRow&, FrameRow&);

  /** O(pixels), rows in parallel. */
  CurvatureMap(const PixelGeometry& geometry, Kernel kernel, int threads);
  float operator[](std::size_t pixel) const { return values_[pixel]; }

 private:
  std::unique_ptr<float[]> values_;  ///< rows that show nothing take no memory
};

/** \brief The derivative of the greatest curvature along its direction, whose zeros are crest lines
 * where it falls. */
class CrestField : public ZeroField {
 public:
  static constexpr int kRidge = 1, kRavine = 2;  ///< kinds

  /** \param[in] least_curvature 1/local length */
  CrestField(const PixelGeometry& geometry, float least_curvature, int threads);
  void fill(int y, FieldRow& row) const override;
  float mostBetween(const FieldRow& a, std::size_t xa, const FieldRow& b, std::size_t xb,
                    float share, std::size_t axis) const override;
  float strength(const Crossing& at, std::size_t nearer, int kind) const override;

 private:
  CurvatureMap map_;
  float least_curvature_;
};

/** \brief The radial curvature, whose zeros are suggestive contours where it grows towards the
 * viewer. Its values are all of kind 1. */
class RadialField : public ZeroField {
 public:
  /** \param[in] least_derivative 1/local length squared */
  RadialField(const PixelGeometry& geometry, float least_derivative, int threads);
  void fill(int y, FieldRow& row) const override;
  float mostBetween(const FieldRow& a, std::size_t xa, const FieldRow& b, std::size_t xb,
                    float share, std::size_t axis) const override;
  float strength(const Crossing& at, std::size_t nearer, int kind) const override;

 private:
  CurvatureMap map_;
  float least_derivative_;
};

}  // namespace pcl_slim::detail
