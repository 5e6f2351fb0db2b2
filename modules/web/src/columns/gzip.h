// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "pcl_slim/core/error.h"

namespace pcl_slim::detail {

/** \brief Deflates bytes into a gzip stream with its checksum. */
Result<std::vector<unsigned char>>
gzip(const std::vector<unsigned char>& bytes);

/** \brief Inverse of gzip(). Truncated or damaged bytes give an error. */
Result<std::vector<unsigned char>>
gunzip(const std::vector<unsigned char>& bytes);

}  // namespace pcl_slim::detail
