// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/render/surface_renderer.h"
#include "pcl_slim/visualization/g_buffer_mapper.h"

namespace pcl_slim::detail {

/** \brief The rasteriser behind a SLIMMapper: the one place that names it. The surface must outlive
 * this object. */
class SurfaceFrames {
 public:
  explicit SurfaceFrames(const SLIMSurface& surface) : renderer_(surface) {}

  Error render(const Camera& camera, const FrameRequest& request, GBuffer& buffer);
  /** \brief What closes the gaps of a frame that the graphics card drew.
   * \param[in] met pixels that it covers, rows from the top \param[out] buffer covered in the gaps alone */
  Error closeGaps(const Camera& camera, const FrameRequest& request,
                  const std::vector<std::uint8_t>& met, GBuffer& buffer);

 private:
  SurfaceRenderer renderer_;
};

}  // namespace pcl_slim::detail
