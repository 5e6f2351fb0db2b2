// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lines/pixel_frames.h"
#include "pcl_slim/render/picture_lines.h"

namespace pcl_slim::detail {

/** \brief A line's vertex before it is kept or not; strength is in units of the least drawn. */
struct LineVertex {
  float x = 0, y = 0, strength = 0;
};

/** \brief A field over the pixels whose zeros are lines. */
class ZeroField {
 public:
  virtual ~ZeroField() = default;

  bool valid(std::size_t pixel) const { return valid_[pixel] != 0; }
  /** \brief The pixel's value, its sign as seen from another: fields along tangents of arbitrary
   * sign turn theirs with the tangents. */
  float value(std::size_t pixel, std::size_t seen_from) const
  {
    return signless_ || along(frames_[pixel], frames_[seen_from]) >= 0 ? value_[pixel]
                                                                       : -value_[pixel];
  }
  /** \brief Strength of the line at a share of the way between two neighbours; 0: none there. */
  virtual float strength(std::size_t a, std::size_t b, float share) const = 0;

 protected:
  std::vector<std::uint8_t> valid_;  ///< whether a pixel has a value
  std::vector<float> value_;
  std::vector<PixelFrame> frames_;
  bool signless_ = false;  ///< values do not turn with the tangents
};

/** \brief Lines of zeros through the pixels' centres' grid, as chains of sub-pixel vertices.
 * O(pixels); rows in parallel. */
struct ZeroLine {
  std::vector<LineVertex> vertices;
  bool closed = false;
};

std::vector<ZeroLine>
traceZeros(const ZeroField& field, int width, int height, int threads);

/** \brief Stretches of strength 1 and more that reach 2 and the least length, appended to lines. */
void
keepStrong(const std::vector<ZeroLine>& zeros, PictureLineKind kind, double least_length,
           std::vector<PictureLine>& lines);

}  // namespace pcl_slim::detail
