// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "file/byte_stream.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/surface/surface.h"

// A .slim file's header: magic (8 bytes), version and header size (4 each), size of the payload,
// checksum (8 each), then what SurfaceInfo holds. Version 2 has trim maps behind the columns, version 4
// behind these colours; files without any are written as version 1. Version 3 consists of blocks, each a
// file of one of the other versions. Version 5 is a rounded surface (compact/compact_block.h).

namespace pcl_slim::detail {

constexpr std::size_t kSlimHeaderBytes = 136;
constexpr std::uint32_t kSlimVersion = 1;        ///< one surface without trim maps
constexpr std::uint32_t kSlimMapsVersion = 2;    ///< one surface with trim maps
constexpr std::uint32_t kSlimBlocksVersion = 3;  ///< blocks of such surfaces (slim_blocks.h)
constexpr std::uint32_t kSlimColorsVersion =
    4;  ///< one surface with colours, and maps where it has any
constexpr std::uint32_t kSlimRoundedVersion = 5;  ///< one rounded surface (compact/compact_block.h)

/** \brief Writes the header of so many surfels that take payload bytes; the checksum is left 0, for
 * sealSlim. */
void
putSlimHeader(const SurfaceInfo& info, std::uint32_t version, std::uint64_t surfels,
              std::uint64_t payload, ByteWriter& out);

/** \brief FNV-1a over the bytes of a header, but for its checksum, and of what is behind them: any
 * single changed byte changes the result. */
std::uint64_t
slimChecksum(const unsigned char* bytes, std::size_t size);

/** \brief Sets a header's checksum. */
void
setSlimChecksum(std::uint64_t sum, std::vector<unsigned char>& bytes);

/** \brief The format version that bytes announce; 0 where they are no .slim file. */
std::uint32_t
slimVersionOf(const unsigned char* bytes, std::size_t size);

/** \brief The checksum that a header announces. */
std::uint64_t
announcedChecksum(const unsigned char* bytes);

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

/** \brief Whether such a file is of the version with colours. */
bool
holdsColors(const unsigned char* bytes);

/** \brief Reads the header of a file that checkSlimFrame passed.
 * \return the number of surfels, or an error where a value cannot be. */
Result<std::uint64_t>
getSlimHeader(const unsigned char* bytes, SurfaceInfo& info);

/** \brief What is said of a file whose numbers contradict each other. */
Error
contradictorySlim();

}  // namespace pcl_slim::detail
