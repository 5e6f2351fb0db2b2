// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pcl_slim/render/g_buffer.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim::test {

/** \brief Whether node and Chromium are there; otherwise the sentence to skip with. */
std::string
whyNoBrowser();

/** \brief Runs a script of tests/web with Chromium as its first argument. \return its output, empty for
 * none, behind "FAILED" if it did not end well */
std::string
runScript(const std::string& script, const std::string& arguments);

/** \brief What a browser drew of a page. */
struct PageFrame {
  int width = 0, height = 0;
  GBuffer buffer;  ///< depth, normal, principal, level, radius; local units of the surface
  std::vector<std::vector<std::uint8_t>> pictures;  ///< rows from the bottom, 4 bytes a pixel
};

/** \brief Draws a page in Chromium. */
PageFrame
drawPage(const std::string& page, const SLIMSurface& surface, int width, int height, double lod,
         const std::vector<std::string>& modes);

/** \brief How far two G-buffers differ. */
struct FrameDifference {
  std::size_t both = 0, one = 0;  ///< pixels that both cover, that one does
  double normal_p95 = 0, normal_p99 = 0;  ///< degrees
  double depth_p99 = 0;                   ///< of the surface's diagonal
  double curvature_p95 = 0;               ///< of the curvature's own 95th percentile
  std::size_t levels = 0;                 ///< pixels whose leaf has another level or radius
};

FrameDifference
compareFrames(const GBuffer& seen, const GBuffer& truth, double diagonal);

}  // namespace pcl_slim::test
