// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lines/pixel_frames.h"
#include "lines/zero_lines.h"

namespace pcl_slim::detail {

/** \brief The derivative of the greatest curvature along its direction, whose zeros are crest lines
 * where it falls. */
class CrestField : public ZeroField {
 public:
  /** \param[in] frames of ridges or of ravines; \param[in] least_curvature 1/local length */
  CrestField(const PixelGeometry& geometry, std::vector<PixelFrame> frames, float least_curvature,
             int threads);
  float strength(std::size_t a, std::size_t b, float share) const override;

 private:
  void derive(std::size_t row);
  bool falls(std::size_t a, std::size_t b) const;
  float significance(std::size_t pixel) const;

  const PixelGeometry& geometry_;
  float least_curvature_;
};

/** \brief The radial curvature, whose zeros are suggestive contours where it grows towards the
 * viewer. */
class RadialField : public ZeroField {
 public:
  /** \param[in] least_derivative 1/local length squared */
  RadialField(const PixelGeometry& geometry, float least_derivative, int threads);
  float strength(std::size_t a, std::size_t b, float share) const override;

 private:
  float derivative(std::size_t pixel) const;

  const PixelGeometry& geometry_;
  float least_derivative_;
};

}  // namespace pcl_slim::detail
