// SPDX-License-Identifier: BSD-3-Clause
#include "files/temporary_file.h"

#include <limits.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cstring>
#include <random>
#include <string>

#include "pcl_slim/core/file_access.h"

namespace pcl_slim {

namespace fs = std::filesystem;

namespace detail {

/** Name of a temporary file, kept where a signal handler may read it. */
struct UnfinishedFile {
  std::atomic<bool> taken{false}, exists{false};
  char path[PATH_MAX];
};

namespace {

std::array<UnfinishedFile, 16> g_unfinished;

}  // namespace

TemporaryFile::TemporaryFile(const fs::path& target)
{
  std::random_device random;
  std::error_code code;
  do {
    path_ = target.parent_path() / (".pcl_slim_" + std::to_string(random()) + ".part");
  } while (fs::exists(path_, code));
  remember();
}

TemporaryFile::~TemporaryFile()
{
  std::error_code code;
  if (!renamed_) fs::remove(path_, code);
  if (slot_ == nullptr) return;
  slot_->exists = false;
  slot_->taken = false;
}

std::error_code
TemporaryFile::renameTo(const fs::path& target)
{
  std::error_code code;
  fs::rename(path_, target, code);
  renamed_ = !code;
  return code;
}

void
TemporaryFile::remember()
{
  const std::string name = fs::absolute(path_).string();
  if (name.size() >= PATH_MAX) return;
  for (UnfinishedFile& file : g_unfinished) {
    if (file.taken.exchange(true)) continue;
    std::memcpy(file.path, name.c_str(), name.size() + 1);
    file.exists = true;
    slot_ = &file;
    return;
  }
}

}  // namespace detail

void
removeUnfinishedFiles()
{
  for (const detail::UnfinishedFile& file : detail::g_unfinished) {
    if (file.exists) unlink(file.path);
  }
}

}  // namespace pcl_slim
