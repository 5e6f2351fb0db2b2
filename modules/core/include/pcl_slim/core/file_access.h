// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"

namespace pcl_slim {

/** \brief Reads a whole file. A missing file, a folder, a device without an end or a failing read
 * gives kIo. A pipe is read to its end. */
PCL_SLIM_EXPORT Result<std::vector<unsigned char>> readFile(const std::string& path);

/** \brief Writes a whole file so that it is seen under its name only when complete.
 *
 * The bytes go to a temporary file in the target's folder, which is then renamed; on any failure
 * the temporary file is removed and an older file under that name is left as it was. A new file
 * takes over an older one's permissions, and a read-only one is not replaced. A symbolic link is
 * followed, also to a place where nothing is yet; what is not a plain file (a pipe, a device) is
 * written directly. For several files that belong together see FileTransaction. What a process of
 * this machine that was killed has left in the folder (.pcl_slim_HOST_PROCESS_NUMBER.part) is
 * removed.
 */
PCL_SLIM_EXPORT Error writeFile(const std::string& path, const void* bytes, std::size_t size);

/** \brief A file that is written piece by piece and seen under its name only when complete, as
 * writeFile() makes it. */
class PCL_SLIM_EXPORT FileWriter {
 public:
  FileWriter();
  /** \brief Removes what was written, unless finish() has been called. */
  ~FileWriter();
  FileWriter(const FileWriter&) = delete;
  FileWriter& operator=(const FileWriter&) = delete;

  Error open(const std::string& path);
  /** \brief Appends bytes. */
  Error write(const void* bytes, std::size_t size);
  /** \brief Replaces bytes that were written before. A pipe or device gives an error. */
  Error rewrite(std::uint64_t at, const void* bytes, std::size_t size);
  std::uint64_t size() const;
  /** \brief Puts the file in its place, or lets it wait for the thread's FileTransaction. */
  Error finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/** \brief Several files that appear together or not at all.
 *
 * While one lives, what its thread's writeFile() calls have written waits in temporary files next
 * to the targets; commit() moves all of it there. What is not committed is removed, and older files
 * stay as they were. Pipes and devices are written immediately. The innermost one counts. */
class PCL_SLIM_EXPORT FileTransaction {
 public:
  struct Waiting;

  FileTransaction();
  ~FileTransaction();
  FileTransaction(const FileTransaction&) = delete;
  FileTransaction& operator=(const FileTransaction&) = delete;

  /** \brief Moves the files to their places. The first that cannot be moved, because its folder has
   * gone meanwhile, gives kIo, and those after it are removed. */
  Error commit();

 private:
  std::unique_ptr<Waiting> waiting_;
  Waiting* outer_;
};

/** \brief Checks before long work whether writeFile could create this file. Leaves nothing behind.
 */
PCL_SLIM_EXPORT Error checkWritable(const std::string& path);

/** \brief The canonical path of a name, links followed, whether or not a file is there yet;
 * empty where there can be none. */
PCL_SLIM_EXPORT std::string placeOf(const std::string& path);

/** \brief Removes the temporary files of writeFile() calls and transactions that are not done. For
 * a program that is about to end in the middle of one; safe in a signal handler. */
PCL_SLIM_EXPORT void removeUnfinishedFiles();

/** \brief Whether what a name opens can be read once only: a pipe, a socket, or an open descriptor
 * (/dev/stdin, /dev/fd/N, as a shell names the output of a command). */
PCL_SLIM_EXPORT bool isStream(const std::string& path);

/** \brief Extension of a path in lower case, with its dot ("scan.PCD" gives ".pcd"; none gives "").
 */
PCL_SLIM_EXPORT std::string lowerExtension(const std::string& path);

}  // namespace pcl_slim
