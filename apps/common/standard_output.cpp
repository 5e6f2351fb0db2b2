// SPDX-License-Identifier: BSD-3-Clause
#include "common/standard_output.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <random>

#include "common/run_program.h"
#include "pcl_slim/core/file_access.h"

namespace pcl_slim {

namespace fs = std::filesystem;

namespace {

std::string g_path;  ///< of the temporary file

/** A new name in the system's folder for temporary files. */
std::string temporaryPath(const std::string& extension) {
  std::error_code code;
  std::random_device random;
  const std::string number = std::to_string(random()) + std::to_string(random());
  return (fs::temp_directory_path(code) / ("pcl_slim-" + number + extension)).string();
}

bool isText(const std::string& extension) {
  for (const char* text : {"", ".json", ".svg", ".obj", ".html"}) {
    if (extension == text) return true;
  }
  return false;
}

Error refused(const std::string& why) {
  return {ErrorCode::kBadArgument, "standard output " + why};
}

/** Why a file of this extension cannot be the stream. */
Error checkStream(const OptionTable& options, const std::string& extension, bool is_output) {
  if (is_output && extension.empty()) {
    std::string formats;
    for (const std::string& format : options.formats())
      formats += (formats.empty() ? "" : " ") + format.substr(1);
    return refused("has no name to tell its format: give -format, one of " + formats);
  }
  if (extension == ".pvtp") return refused("is one stream, a .pvtp a folder of files: name a file");
  if (isatty(STDOUT_FILENO) == 1 && !isText(extension))
    return refused("is a terminal, which shows no " + extension + ": redirect it, or name a file");
  return {};
}

}  // namespace

bool isStandardOutput(const std::string& path) {
  return !g_path.empty() && path == g_path;
}

std::string shownName(const std::string& path) {
  return isStandardOutput(path) ? "standard output" : path;
}

StandardOutput::~StandardOutput() {
  if (!path_.empty()) unlink(path_.c_str());
}

Error StandardOutput::take(OptionTable& options) {
  for (const OptionTable::NamedFile& file : options.files()) {
    if (file.use != FileUse::kWritten || *file.target != "-") continue;
    const bool is_output = file.target == options.output();
    std::string input;
    for (const OptionTable::NamedFile& other : options.files()) {
      if (input.empty() && other.use == FileUse::kRead) input = *other.target;
    }
    const std::string extension =
        is_output ? options.unnamedExtension(input) : lowerExtension(file.value_name);
    if (Error error = checkStream(options, extension, is_output)) return error;
    stream_ = fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
    if (stream_ < 0) return refused("is closed: redirect it, or name a file");
    dup2(STDERR_FILENO, STDOUT_FILENO);
    path_ = g_path = *file.target = temporaryPath(extension);
  }
  return {};
}

Error StandardOutput::send() {
  if (path_.empty()) return {};
  const int file = open(path_.c_str(), O_RDONLY | O_CLOEXEC);
  // There is none where the work was one part of several.
  if (file < 0 && errno == ENOENT) return {};
  if (file < 0) return {ErrorCode::kIo, "cannot read '" + path_ + "': " + std::strerror(errno)};
  unlink(path_.c_str());
  path_.clear();
  endOnSignals();
  Error error = send(file);
  close(file);
  return error;
}

Error StandardOutput::send(int file) {
  const auto failed = [](int code) {
    return Error{ErrorCode::kIo,
                 std::string("cannot write standard output: ") + std::strerror(code) +
                     (code == EPIPE ? "; what read it has ended" : "; name a file")};
  };
  char bytes[1 << 16];
  for (;;) {
    const ssize_t size = read(file, bytes, sizeof(bytes));
    if (size < 0) return failed(errno);
    if (size == 0) return close(stream_) == 0 ? Error() : failed(errno);
    for (ssize_t done = 0; done < size;) {
      const ssize_t written = write(stream_, bytes + done, static_cast<std::size_t>(size - done));
      if (written < 0 && errno != EINTR) return failed(errno);
      if (written > 0) done += written;
    }
  }
}

}  // namespace pcl_slim
