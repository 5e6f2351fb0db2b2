// SPDX-License-Identifier: BSD-3-Clause
#include "scratch/scratch_file.h"

#include <fcntl.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>

namespace pcl_slim::detail {

namespace fs = std::filesystem;

ScratchFile::~ScratchFile()
{
  if (file_ >= 0) close(file_);
}

Error
ScratchFile::failed(const char* verb, std::uint64_t at, int code) const
{
  const bool full = code == ENOSPC || code == EDQUOT || code == EFBIG;
  return {ErrorCode::kIo, std::string("cannot ") + verb + " the scratch file in '" + folder_ +
                              "' at byte " + std::to_string(at) + ": " + std::strerror(code) +
                              (full ? "; make room, or name another folder" : "")};
}

Error
ScratchFile::create(const std::string& folder, std::uint64_t bytes)
{
  std::error_code code;
  folder_ = folder.empty() ? fs::temp_directory_path(code).string() : folder;
  if (!fs::is_directory(folder_, code)) {
    return {ErrorCode::kIo, "the scratch folder '" + folder_ + "' does not exist; create it first"};
  }
  struct statvfs space = {};
  if (statvfs(folder_.c_str(), &space) == 0) {
    const double free = static_cast<double>(space.f_bavail) * static_cast<double>(space.f_frsize);
    if (static_cast<double>(bytes) > free) {
      return {ErrorCode::kIo, "the scratch folder '" + folder_ + "' has " +
                                  std::to_string(static_cast<std::uint64_t>(free) >> 20) +
                                  " MB left where " + std::to_string((bytes >> 20) + 1) +
                                  " are needed: make room, or name another folder"};
    }
  }
  std::string name = (fs::path(folder_) / "pcl_slim-XXXXXX").string();
  file_ = mkostemp(name.data(), O_CLOEXEC);
  if (file_ < 0) return failed("create", 0, errno);
  unlink(name.c_str());
  return {};
}

Error
ScratchFile::write(std::uint64_t at, const void* from, std::size_t bytes)
{
  for (std::size_t done = 0; done < bytes;) {
    const ssize_t now = pwrite(file_, static_cast<const char*>(from) + done, bytes - done,
                               static_cast<off_t>(at + done));
    if (now < 0 && errno == EINTR) continue;
    if (now < 0) return failed("write", at + done, errno);
    done += static_cast<std::size_t>(now);
  }
  written_ += bytes;
  return {};
}

Error
ScratchFile::read(std::uint64_t at, void* to, std::size_t bytes) const
{
  for (std::size_t done = 0; done < bytes;) {
    const ssize_t now =
        pread(file_, static_cast<char*>(to) + done, bytes - done, static_cast<off_t>(at + done));
    if (now < 0 && errno == EINTR) continue;
    if (now <= 0) return failed("read", at + done, now < 0 ? errno : EIO);
    done += static_cast<std::size_t>(now);
  }
  read_ += bytes;
  return {};
}

}  // namespace pcl_slim::detail
