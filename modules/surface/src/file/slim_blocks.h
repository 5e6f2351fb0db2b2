// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include "pcl_slim/core/error.h"
#include "pcl_slim/surface/slim_blocks.h"

// Version 3: header; blocks; directory: offset, bytes, surfels, first and end key (8 each), box (6 floats)
// a block; its offset and the number of blocks (8 each).

namespace pcl_slim::detail {

/** \brief The surface of a file of version 1, 2, 4 or 5, without links. */
Result<SLIMSurface>
decodeSlimBlock(const unsigned char* bytes, std::size_t size);

/** \brief The surfels of all blocks of a file of version 3, without links. */
Result<SLIMSurface>
decodeSlimBlocks(const unsigned char* bytes, std::size_t size);

}  // namespace pcl_slim::detail
