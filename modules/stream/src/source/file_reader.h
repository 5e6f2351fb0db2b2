// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "pcl_slim/core/error.h"

namespace pcl_slim::detail {

/** \brief A file that is read from any place. */
class FileReader {
 public:
  FileReader() = default;
  ~FileReader();
  FileReader(const FileReader&) = delete;
  FileReader& operator=(const FileReader&) = delete;

  Error open(const std::string& path);
  /** \brief Reads bytes from a place on, fewer at the file's end. \param[out] got how many. */
  Error read(std::uint64_t at, void* to, std::size_t bytes, std::size_t& got) const;
  /** \brief Reads exactly so many bytes; a file that ends before is an error that names the byte. */
  Error readAll(std::uint64_t at, void* to, std::size_t bytes) const;

 private:
  std::string path_;
  int file_ = -1;
};

}  // namespace pcl_slim::detail
