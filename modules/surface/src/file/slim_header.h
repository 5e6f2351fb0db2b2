// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "file/byte_stream.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/surface/surface.h"

// A .slim file's header: magic (8 bytes), version and header size (4 each), size of the payload,
// checksum (8 each), then what SurfaceInfo holds. Version 2 has trim maps behind the columns; files
// without any are written as version 1.

namespace pcl_slim::detail {

constexpr std::size_t kSlimHeaderBytes = 136;

/** \brief Writes the header of a surface whose columns take payload bytes; the checksum is left 0,
 * for sealSlim. */
void
putSlimHeader(const SLIMSurface& surface, std::uint64_t payload, ByteWriter& out);

/** \brief Writes the checksum into a complete file. */
void
sealSlim(std::vector<unsigned char>& bytes);

/** \brief Names what is wrong with a file before anything is allocated for it: its magic, version,
 * sizes and checksum. */
Error
checkSlimFrame(const unsigned char* bytes, std::size_t size);

/** \brief Whether a file that checkSlimFrame passed is of a version with trim maps. */
bool
holdsTrimMaps(const unsigned char* bytes);

/** \brief Reads the header of a file that checkSlimFrame passed.
 * \return the number of surfels, or an error where a value cannot be. */
Result<std::uint64_t>
getSlimHeader(const unsigned char* bytes, SurfaceInfo& info);

/** \brief What is said of a file whose numbers contradict each other. */
Error
contradictorySlim();

}  // namespace pcl_slim::detail
