// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "pcl_slim/core/error.h"

namespace pcl_slim {

/** \brief Reads a whole file. A missing file, a folder, a device without an end or a failing read
 * gives kIo. A pipe is read to its end. */
Result<std::vector<unsigned char>>
readFile(const std::string& path);

/** \brief Writes a whole file so that it is seen under its name only when complete.
 *
 * The bytes go to a temporary file beside the target, which is then renamed; on any failure the
 * temporary file is removed and an older file under that name is left as it was. A new file takes
 * over an older one's permissions, and one that nobody may write is not replaced. A symbolic link
 * is followed; what is not a plain file (a pipe, a device) is written directly.
 */
Error
writeFile(const std::string& path, const void* bytes, std::size_t size);

/** \brief Tells before long work whether writeFile could create this file. Leaves nothing behind. */
Error
checkWritable(const std::string& path);

/** \brief Removes the temporary files of writeFile() calls that are running now. For a program that is
 * about to end in the middle of one; safe in a signal handler. */
void
removeUnfinishedFiles();

/** \brief Extension of a path in lower case, with its dot ("scan.PCD" gives ".pcd"; none gives ""). */
std::string
lowerExtension(const std::string& path);

}  // namespace pcl_slim
