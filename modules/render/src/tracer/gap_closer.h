// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "pcl_slim/render/camera.h"
#include "pcl_slim/render/g_buffer.h"
#include "pcl_slim/render/render_params.h"
#include "pcl_slim/surface/surface.h"
#include "tracer/traced_object.h"

namespace pcl_slim::detail {

/** \brief Fills pixels of a rasterised frame whose rays slipped between shrunk balls: those that met nothing
 * although pixels about them did are traced with TraceParams::close_gaps. */
class GapCloser {
 public:
  /** \brief The surface, a valid one, must outlive this object. */
  explicit GapCloser(const SLIMSurface& surface) : surface_(surface) {}

  /** \brief \param[in,out] buffer a frame by these parameters; the surface's tree is built for the first one
   * that has such pixels. \return pixels filled. O(pixels + traced rays). */
  std::uint64_t close(const Camera& camera, const RenderParams& params, int threads,
                      GBuffer& buffer);

 private:
  const SLIMSurface& surface_;
  std::unique_ptr<TracedObject> leaves_;
};

}  // namespace pcl_slim::detail
