// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

namespace pcl_slim::detail {

/** \brief Decodes LZF (Marc Lehmann's liblzf), as DATA binary_compressed has it. pcl::lzfDecompress does the
 * same, but its library loads VTK and drivers of sensors, which takes 25 MB and .03 s at every start.
 * \param[out] plain room for size bytes. \return whether the input is whole and fills it exactly. O(size). */
bool
decodeLzf(const std::uint8_t* packed, std::size_t packed_size, std::uint8_t* plain,
          std::size_t size);

}  // namespace pcl_slim::detail
