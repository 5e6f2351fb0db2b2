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

namespace {

constexpr const char* kKeptName = "points";

}  // namespace

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

/** Whether there is a folder, with so much room. */
Error
ScratchFile::checkRoom(std::uint64_t bytes)
{
  std::error_code code;
  if (!fs::is_directory(folder_, code)) {
    return {ErrorCode::kIo, "the scratch folder '" + folder_ + "' does not exist; create it first"};
  }
  struct statvfs space = {};
  if (statvfs(folder_.c_str(), &space) != 0) return {};
  const double free = static_cast<double>(space.f_bavail) * static_cast<double>(space.f_frsize);
  if (static_cast<double>(bytes) <= free) return {};
  return {ErrorCode::kIo, "the scratch folder '" + folder_ + "' has " +
                              std::to_string(static_cast<std::uint64_t>(free) >> 20) +
                              " MB left where " + std::to_string((bytes >> 20) + 1) +
                              " are needed: make room, or name another folder"};
}

Error
ScratchFile::create(const std::string& folder, std::uint64_t bytes)
{
  std::error_code code;
  folder_ = folder.empty() ? fs::temp_directory_path(code).string() : folder;
  if (Error error = checkRoom(bytes)) return error;
  std::string name = (fs::path(folder_) / "pcl_slim-XXXXXX").string();
  file_ = mkostemp(name.data(), O_CLOEXEC);
  if (file_ < 0) return failed("create", 0, errno);
  unlink(name.c_str());
  return {};
}

Error
ScratchFile::createKept(const std::string& folder, std::uint64_t bytes)
{
  folder_ = folder;
  const std::string name = (fs::path(folder_) / kKeptName).string();
  unlink(name.c_str());
  if (Error error = checkRoom(bytes)) return error;
  file_ = open(name.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  return file_ < 0 ? failed("create", 0, errno) : Error();
}

Error
ScratchFile::openKept(const std::string& folder, std::uint64_t bytes)
{
  folder_ = folder;
  const std::string name = (fs::path(folder_) / kKeptName).string();
  std::error_code code;
  file_ = open(name.c_str(), O_RDONLY | O_CLOEXEC);
  if (file_ < 0) return failed("read", 0, errno);
  const std::uint64_t size = fs::file_size(name, code);
  return size == bytes ? Error() : failed("read", size, EIO);
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
