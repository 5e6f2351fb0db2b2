// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "pcl_slim/render/disc_rasterizer.h"
#include "splats/colored_scan.h"

namespace pcl_slim::measure {

/** \brief Every point of a scan as a disc of 1.3 local spacings (mean distance to its 6 nearest, at
 * most 4 times the middle one), in its own colour: what splats are compared with. */
SplatSet everyPoint(const ColoredScan& scan);

/** \brief A ball in world coordinates. */
struct Ball {
  std::array<double, 3> center{};
  double radius = 0;
};

/** \brief How pictures of splats differ from those of all points. */
struct PictureDifference {
  double mean = 0, p95 = 0;  ///< CIELAB distance over pixels that both cover
  double lost = 0;           ///< pixels that only all points cover, share of all they cover
  double extra = 0;          ///< pixels that only the splats cover, likewise
  double holes = 0;          ///< share of inner pixels where splats show nothing or what is behind
  double focus = 0;          ///< mean distance inside the focus; below 0: no view shows it
};

/** \brief Pictures of all points from fixed views, and the comparison with them.
 *
 * One-sided scans are seen from their side and from 30 degrees about, anything else from four
 * sides and twice from above. Pictures are unlit, one ray a pixel. Inner pixels are those around
 * which, 3 pixels far, all points cover everything without a step in depth of more than 2 % of
 * the extent; what is so far behind is seen through a hole.
 */
class PictureComparison {
 public:
  /** \param[in] size pixels a side; \param[in] focus where else to measure, if anywhere. */
  PictureComparison(const SplatSet& every_point, int size, const std::optional<Ball>& focus);

  std::size_t numViews() const { return cameras_.size(); }
  PictureDifference compare(const SplatSet& splats, const DiscRenderParams& params) const;

 private:
  struct Picture {
    std::vector<std::array<float, 3>> lab;  ///< L* below 0 where nothing is
    std::vector<float> depth;
    std::vector<bool> in_focus;
  };

  std::vector<bool> innerPixels(const Picture& picture, const ImageSize& size) const;
  Picture draw(const SplatSet& splats, const Camera& camera, const DiscRenderParams& params) const;

  std::optional<Ball> focus_;
  std::vector<Camera> cameras_;
  std::vector<Picture> reference_;
  std::vector<std::vector<bool>> inner_;  ///< pixels of each reference
  double step_ = 0;                       ///< in depth
};

}  // namespace pcl_slim::measure
