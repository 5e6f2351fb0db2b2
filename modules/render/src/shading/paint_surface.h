// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "pcl_slim/query/surface_probe.h"
#include "pcl_slim/render/g_buffer.h"

namespace pcl_slim::detail {

/** \brief Fills the colours of a frame from those of a surface's leaves, at the positions and with the
 * normals of its pixels. Its index is built for the first frame with colours. */
class SurfacePainter {
 public:
  /** \brief The surface must outlive this object. */
  explicit SurfacePainter(const SLIMSurface& surface) : surface_(surface) {}

  /** \brief \param[in,out] buffer with positions; its colours are set, white where a pixel is in no
   * leaf's ball, and none are set for a surface without. O(covered pixels times leaves near them). */
  void paint(int threads, GBuffer& buffer);

 private:
  const SLIMSurface& surface_;
  std::unique_ptr<ProbeIndex> index_;
};

}  // namespace pcl_slim::detail
