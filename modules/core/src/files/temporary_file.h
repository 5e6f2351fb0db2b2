// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <system_error>

namespace pcl_slim::detail {

struct UnfinishedFile;

/** \brief A temporary file beside a target, removed unless it is renamed. Its name is short and no
 * longer than the longest allowed, however long the target's is. */
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::filesystem::path& target);
  ~TemporaryFile();
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  const std::filesystem::path& path() const { return path_; }

  std::error_code renameTo(const std::filesystem::path& target);

 private:
  void remember();

  std::filesystem::path path_;
  bool renamed_ = false;
  UnfinishedFile* slot_ = nullptr;
};

}  // namespace pcl_slim::detail
