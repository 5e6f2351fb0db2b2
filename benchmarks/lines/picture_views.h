// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <vector>

#include "pcl_slim/core/vector3.h"
#include "pcl_slim/render/picture_lines.h"
#include "pcl_slim/render/surface_renderer.h"

/** \brief Pictures, the lines in them, and where these are on the surface. */
namespace pcl_slim::lines_bench {

/** \brief What one camera sees, and the lines in it. */
struct PictureView {
  Camera camera;
  GBuffer buffer;
  std::vector<PictureLine> lines;
};

/** \brief Renders what finding lines and placing them on the surface needs. */
Error renderView(SurfaceRenderer& renderer, const PictureLineParams& params, PictureView& view);

/** \brief The surface point at a place between pixels, world coordinates. */
bool placeOnSurface(const SLIMSurface& surface, const GBuffer& buffer,
                    const std::array<float, 2>& place, Vector3& world);

/** \brief Crest lines of a view as lines in space. */
std::vector<SpaceLine> crestLinesInSpace(const SLIMSurface& surface, const PictureView& view);

}  // namespace pcl_slim::lines_bench
