// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string>

#include "pcl_slim/core/error.h"

namespace pcl_slim::detail {

/** \brief A file for points in some folder. Unless it is kept it has no name, and goes when it is closed,
 * however the program ends. */
class ScratchFile {
 public:
  ScratchFile() = default;
  ~ScratchFile();
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;

  /** \brief Makes it. \param[in] folder empty: the system's for temporary files \param[in] bytes that
   * will be written \return an error where there is no folder or not enough room. */
  Error create(const std::string& folder, std::uint64_t bytes);
  /** \brief Makes one that is kept under a name in the folder, in place of an older one. */
  Error createKept(const std::string& folder, std::uint64_t bytes);
  /** \brief Opens one that was kept, for reading. \return an error where it has not so many bytes. */
  Error openKept(const std::string& folder, std::uint64_t bytes);
  Error write(std::uint64_t at, const void* from, std::size_t bytes);
  Error read(std::uint64_t at, void* to, std::size_t bytes) const;

  std::uint64_t bytesWritten() const { return written_; }
  std::uint64_t bytesRead() const { return read_; }

 private:
  Error checkRoom(std::uint64_t bytes);
  Error failed(const char* verb, std::uint64_t at, int code) const;

  std::string folder_;
  int file_ = -1;
  std::uint64_t written_ = 0;
  mutable std::atomic<std::uint64_t> read_ = 0;
};

}  // namespace pcl_slim::detail
