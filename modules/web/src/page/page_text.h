// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "page/json_text.h"
#include "pcl_slim/web/page.h"

namespace pcl_slim::detail {

/** \brief What the viewer takes from the command line and from the C++ renderer's tables. */
JsonText
pageOptions(const Camera& camera, const ShadingParams& shading, const PageParams& params);

/** \brief What is packed into a page, each part deflated. */
struct PageParts {
  std::vector<unsigned char> data;   ///< the model
  std::vector<unsigned char> lines;  ///< packLines()
  std::vector<std::uint8_t> still;   ///< picture as PNG, or empty
};

/** \brief Lines on a grid of 16 bits an axis, deflated. \param[in] origin, scale of the model, in whose
 * local units the viewer works */
Result<std::vector<unsigned char>>
packLines(const std::vector<SpaceLine>& lines, const std::array<double, 3>& origin, double scale);

/** \brief Fills the viewer's text, its script deflated. */
Result<std::string>
fillPage(const std::string& title, JsonText options, const PageParts& parts);

constexpr int kStillSize = 240;  ///< pixels along the longer side of the still picture
constexpr int kRangeSize = 400;  ///< the same of the frame that automatic ranges are taken from

/** \brief The picture that a page shows before, and instead of, its viewer: as PNG, in few colours. */
std::vector<std::uint8_t>
stillPicture(Image image);

/** \brief The same camera for a picture whose longer side is at most `longest` pixels. */
Camera
smallCamera(Camera camera, int longest);

}  // namespace pcl_slim::detail
