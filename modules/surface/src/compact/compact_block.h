// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/surface/surface.h"

// What follows the header in a .slim of version 5: tolerance (double, local units), steps of a normal's
// coordinate (4 bytes), whether there are colours (1 byte), and the surfels, range coded.

namespace pcl_slim::detail {

/** \brief The surfels of a surface, rounded so that it moves by a share of the RMS residual of its leaves.
 * \return nothing where a number is out of proportion to that; store such surfaces as floats. */
std::vector<unsigned char>
packSurfels(const SLIMSurface& surface, double share);

/** \brief Inverse of packSurfels, without links. \param[in,out] surface its info is that of the header */
Error
unpackSurfels(const unsigned char* bytes, std::size_t size, std::uint64_t surfels,
              SLIMSurface& surface);

}  // namespace pcl_slim::detail
