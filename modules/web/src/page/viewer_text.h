// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace pcl_slim::detail {

/** \brief The page without its data: web/viewer.html. */
std::string
viewerText();

}  // namespace pcl_slim::detail
