// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "page/json_text.h"
#include "pcl_slim/web/page.h"

namespace pcl_slim::detail {

/** \brief What the viewer takes from the command line and from the C++ renderer's tables.
 * \param[in] origin, scale of the model: lines are given in its local units */
JsonText
pageOptions(const Camera& camera, const ShadingParams& shading, const PageParams& params,
            const std::array<double, 3>& origin, double scale);

/** \brief Fills the viewer's text, its script deflated. \param[in] data of the model \param[in] still picture, PNG or
 * empty */
Result<std::string>
fillPage(const std::string& title, const std::string& options,
         const std::vector<unsigned char>& data, const std::vector<std::uint8_t>& still);

/** \brief The picture that a page shows before, and instead of, its viewer: as PNG, in few colours. */
std::vector<std::uint8_t>
stillPicture(Image image);

/** \brief A camera whose picture has at most so many pixels along its longer side. */
Camera
smallCamera(Camera camera, int longest);

}  // namespace pcl_slim::detail
