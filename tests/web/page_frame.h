// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pcl_slim/render/camera.h"
#include "pcl_slim/render/g_buffer.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim::test {

/** \brief Whether node and Chromium are there; otherwise the sentence to skip with. */
std::string whyNoBrowser();

/** \brief Runs a script of tests/web with Chromium as its first argument. \return its output, empty
 * for none, behind "FAILED" if it did not end well */
std::string runScript(const std::string& script, const std::string& arguments);

/** \brief What a browser drew of a page. */
struct PageFrame {
  GBuffer buffer;  ///< depth, normal, principal, level, radius; local units of the surface
  std::vector<std::vector<std::uint8_t>> pictures;  ///< rows from the bottom, 4 bytes a pixel
};

/** \brief Draws a page by gbuffer.mjs, in Chromium, or cast.mjs, in node.
 * \param[in] exact sums in 32 bits a number, not in 16 */
PageFrame drawPage(const std::string& script, const std::string& page, const SLIMSurface& surface,
                   const ImageSize& size, double lod, const std::vector<std::string>& modes,
                   bool exact = true);

}  // namespace pcl_slim::test
