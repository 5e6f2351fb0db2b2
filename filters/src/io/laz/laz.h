// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "pcl_slim/core/error.h"

namespace pcl_slim {

/** No error in builds with LASzip's library; else how to convert a file. */
Error checkLaz(const std::string& path);

/** The bytes of the LAS file that a LAZ file was made of. The records of COPC, which describe the order of
 * compressed points, and that of the compression are left out; all others are kept. */
Result<std::vector<unsigned char>> unpackLaz(const std::vector<unsigned char>& bytes);

}  // namespace pcl_slim
