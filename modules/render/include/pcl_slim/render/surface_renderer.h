// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/render/camera.h"
#include "pcl_slim/render/g_buffer.h"
#include "pcl_slim/render/render_params.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim {

/** \brief Renders a SLIM surface into G-buffers by blending its leaves along view rays.
 *
 * Ohtake, Belyaev, Alexa 2005, section 3: pass 1 finds q^, the first intersection of a ray inside
 * any leaf's ball shrunk by alpha; pass 2 gathers the leaves whose ball contains q^ and blends, at
 * each one's root nearest to q^, position (eq. 6), gradient (eq. 7) and Hessian (eq. 8, left). Two
 * guards keep leaves of other sheets out: the weight is taken at the larger of |q^ - c| and |q -
 * c|, and a leaf whose own surface passes q^ by more than r/4 does not count.
 *
 * Where the blend's coverage (sum of G(|q - c| / (alpha r))) is below the surface's threshold and
 * the leaves are not all around q, the surface is not defined: leaves reach beyond the rim of
 * what was measured. Rays pass through and both passes run again behind it.
 *
 * An index over the leaves is built once, so that a frame costs what its camera sees. Frames are
 * drawn in single precision with coordinates of each leaf's own, in blocks of 4 x 4 pixels as
 * vector lanes. With RenderParams::lod a surfel whose ball is seen below that size replaces its
 * descendants and fades in over half an octave.
 *
 * A frame is the same for any number of threads, and with skipping on or off. One frame at a time.
 */
class PCL_SLIM_EXPORT SurfaceRenderer {
 public:
  /** \brief Builds the index. O(surfels log surfels).
   * \param[in] surface must outlive the renderer and not change meanwhile */
  explicit SurfaceRenderer(const SLIMSurface& surface, int threads = 0);
  ~SurfaceRenderer();
  SurfaceRenderer(SurfaceRenderer&&) noexcept;
  SurfaceRenderer& operator=(SurfaceRenderer&&) noexcept;

  /** \brief The surface it was made of; an empty one where the renderer has been moved from. */
  const SLIMSurface& surface() const;

  /** \brief Renders one frame. Buffers are reused: a second frame of one size allocates nothing.
   * Cost: O(visible clusters of leaves + sum of visible balls' pixels).
   * \return an error for a bad surface, camera or parameter; the buffer is then empty. */
  Error render(const Camera& camera, const RenderParams& params, GBuffer& buffer,
               RenderStatistics* statistics = nullptr);

  /** \brief Traces what RenderParams::close_gaps closes in a frame that something else drew.
   * Nothing is filled in a frame with a level of detail, with cuts or without trim maps.
   * O(pixels + traced rays).
   * \param[in,out] buffer of the camera's size with the columns of params and positions. Before:
   * surfel is not kNothing where the frame met something. After: only filled pixels are covered.
   * \return an error for a bad surface, camera, parameter or size; the buffer is then empty. */
  Error closeGaps(const Camera& camera, const RenderParams& params, GBuffer& buffer);

 private:
  Error check(const Camera& camera, const RenderParams& params) const;

  struct State;
  std::unique_ptr<State> state_;
};

/** \brief One frame without a renderer to keep. O(surfels log surfels) more than a frame. */
PCL_SLIM_EXPORT Error renderSurface(const SLIMSurface& surface, const Camera& camera,
                                    const RenderParams& params, GBuffer& buffer,
                                    RenderStatistics* statistics = nullptr);

}  // namespace pcl_slim
