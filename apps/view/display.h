// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pcl_slim/core/error.h"

namespace pcl_slim {

/** \brief Whether a window can be opened here. VTK ends the program where it cannot, so this tries
 * the X server first. */
Error
checkDisplay();

}  // namespace pcl_slim
