// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace pcl_slim::detail {

/** \brief Which surfels of a hierarchy stand for a surface in a picture, and with what share of
 * their weight (Ohtake, Belyaev, Alexa 2005, section 3.2).
 *
 * A surfel whose size (DetailSizes) is seen smaller than lod pixels stands for its descendants; from there
 * to one and a half times that size it fades out and they fade in, so that nothing pops when the camera
 * moves: its share is coarse(own size) (1 - coarse(size of its parent)). As sizes never grow from level
 * to level, older ancestors are then large enough to be out of it.
 */
struct DetailRule {
  static constexpr float kFade = 1.5f;  ///< sizes, in lod, over which surfels fade
  static constexpr float kMeets =
      0.4f;  ///< surfels of a smaller share are not met by rays of pass 1

  float lod = 0.0f;  ///< pixels; 0: leaves alone stand for the surface

  bool active() const { return lod > 0.0f; }
};

}  // namespace pcl_slim::detail
