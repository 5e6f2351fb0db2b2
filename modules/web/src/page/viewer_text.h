// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace pcl_slim::detail {

/** \brief The page without its data: web/viewer.html. */
extern const char* const kViewerText;

}  // namespace pcl_slim::detail
