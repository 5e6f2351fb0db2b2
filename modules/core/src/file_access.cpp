// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/core/file_access.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <system_error>

namespace pcl_slim {

namespace fs = std::filesystem;

namespace {

Error
ioError(const std::string& verb, const std::string& path, const std::string& why)
{
  return {ErrorCode::kIo, "cannot " + verb + " '" + path + "': " + why};
}

std::string
systemMessage()
{
  return errno != 0 ? std::strerror(errno) : "the operating system gave no reason";
}

/** Where the bytes of path really go, and whether a rename can put them there. */
struct Target {
  fs::path path;
  bool direct = false;
};

Error
resolveTarget(const std::string& name, Target& target)
{
  std::error_code code;
  target.path = name;
  const fs::file_status status = fs::status(target.path, code);
  if (fs::is_directory(status)) return ioError("write", name, "it is a folder; name a file");
  if (fs::exists(status)) {
    target.direct = !fs::is_regular_file(status);
    const fs::path real = fs::canonical(target.path, code);
    if (!code) target.path = real;
    return {};
  }
  const fs::path folder = target.path.has_parent_path() ? target.path.parent_path() : ".";
  if (name.empty() || !target.path.has_filename()) return ioError("write", name, "name a file");
  if (!fs::is_directory(folder, code)) {
    return ioError("write", name,
                   "the folder '" + folder.string() + "' does not exist; create it first");
  }
  return {};
}

fs::path
temporaryBeside(const fs::path& target)
{
  std::random_device random;
  std::error_code code;
  for (;;) {
    fs::path candidate = target;
    candidate += "." + std::to_string(random()) + ".part";
    if (!fs::exists(candidate, code)) return candidate;
  }
}

bool
writeAll(const fs::path& path, const void* bytes, std::size_t size)
{
  errno = 0;
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(static_cast<const char*>(bytes), static_cast<std::streamsize>(size));
  file.close();
  return !file.fail();
}

}  // namespace

Result<std::vector<unsigned char>>
readFile(const std::string& path)
{
  std::error_code code;
  if (fs::is_directory(path, code)) return ioError("read", path, "it is a folder; name a file");
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  if (!file) return ioError("read", path, systemMessage());
  std::vector<unsigned char> bytes;
  const auto known_size = fs::file_size(path, code);
  if (!code && fs::is_regular_file(path, code)) {
    bytes.resize(static_cast<std::size_t>(known_size));
    file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    bytes.resize(static_cast<std::size_t>(file.gcount()));
  } else {  // a pipe: its size shows only at its end
    char buffer[1 << 16];
    while (file.read(buffer, sizeof(buffer)) || file.gcount() > 0) {
      bytes.insert(bytes.end(), buffer, buffer + file.gcount());
    }
  }
  if (file.bad()) return ioError("read", path, systemMessage());
  return bytes;
}

Error
writeFile(const std::string& path, const void* bytes, std::size_t size)
{
  Target target;
  if (Error error = resolveTarget(path, target)) return error;
  if (target.direct) {
    return writeAll(target.path, bytes, size) ? Error{} : ioError("write", path, systemMessage());
  }
  const fs::path temporary = temporaryBeside(target.path);
  std::error_code code;
  if (!writeAll(temporary, bytes, size)) {
    const std::string why = systemMessage();
    fs::remove(temporary, code);
    return ioError("write", path, why);
  }
  fs::rename(temporary, target.path, code);
  if (!code) return {};
  const std::string why = code.message();
  fs::remove(temporary, code);
  return ioError("write", path, why);
}

Error
checkWritable(const std::string& path)
{
  Target target;
  if (Error error = resolveTarget(path, target)) return error;
  if (target.direct) return {};
  const fs::path temporary = temporaryBeside(target.path);
  const bool written = writeAll(temporary, nullptr, 0);
  const std::string why = systemMessage();
  std::error_code code;
  fs::remove(temporary, code);
  return written ? Error{} : ioError("write", path, why);
}

std::string
lowerExtension(const std::string& path)
{
  std::string extension = fs::path(path).extension().string();
  for (char& c : extension) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return extension;
}

}  // namespace pcl_slim
