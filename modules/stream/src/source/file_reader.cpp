// SPDX-License-Identifier: BSD-3-Clause
#include "source/file_reader.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace pcl_slim::detail {

FileReader::~FileReader()
{
  if (file_ >= 0) close(file_);
}

Error
FileReader::open(const std::string& path)
{
  path_ = path;
  file_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file_ >= 0) return {};
  return {ErrorCode::kIo, "cannot read '" + path + "': " + std::strerror(errno)};
}

Error
FileReader::read(std::uint64_t at, void* to, std::size_t bytes, std::size_t& got) const
{
  got = 0;
  while (got < bytes) {
    const ssize_t now =
        pread(file_, static_cast<char*>(to) + got, bytes - got, static_cast<off_t>(at + got));
    if (now < 0 && errno == EINTR) continue;
    if (now < 0) {
      return {ErrorCode::kIo, "cannot read '" + path_ + "' at byte " + std::to_string(at + got) +
                                  ": " + std::strerror(errno)};
    }
    if (now == 0) return {};
    got += static_cast<std::size_t>(now);
  }
  return {};
}

Error
FileReader::readAll(std::uint64_t at, void* to, std::size_t bytes) const
{
  std::size_t got = 0;
  if (Error error = read(at, to, bytes, got)) return error;
  if (got == bytes) return {};
  return badInput("'" + path_ + "' ends at byte " + std::to_string(at + got) + " where " +
                  std::to_string(at + bytes) + " are announced: it is truncated, copy it again");
}

}  // namespace pcl_slim::detail
