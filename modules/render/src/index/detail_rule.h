// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pcl_slim/render/detail/frame_constants.h"

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
  static constexpr auto kFade = static_cast<float>(kDetailFade);
  static constexpr auto kMeets = static_cast<float>(kDetailMeets);

  float lod = 0.0f;  ///< pixels; 0: leaves alone stand for the surface

  bool active() const { return lod > 0.0f; }
};

}  // namespace pcl_slim::detail
