// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "io/vtp/vtp_markup.h"

namespace pcl_slim {

/** The bytes of an array: of inline or appended data, base64 or raw, packed by zlib or not.
 * \param[in] expected how many; 0: as many as there are, up to a thousand times the file's. */
Result<std::vector<std::uint8_t>>
readVtpBytes(const VtpMarkup& markup, const VtpArray& array, std::size_t expected);

/** The values of an array of numbers, count of them, each in its type and this machine's byte order. */
Result<std::vector<std::uint8_t>>
readVtpValues(const VtpMarkup& markup, const VtpArray& array, std::size_t count);

/** The strings of an array: VTK ends each with a zero byte. */
Result<std::vector<std::string>>
readVtpStrings(const VtpMarkup& markup, const VtpArray& array);

}  // namespace pcl_slim
