// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/core/file_access.h"

#include <limits.h>
#include <unistd.h>

#include <array>
#include <atomic>
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
  fs::perms permissions = fs::perms::unknown;  ///< of the file that is replaced
};

/** Names of temporary files, kept where a signal handler may read them. */
struct UnfinishedFile {
  std::atomic<bool> taken{false}, exists{false};
  char path[PATH_MAX];
};
std::array<UnfinishedFile, 16> g_unfinished;

/** A temporary file beside a target, removed unless it is renamed. Its name is short and no longer
 * than the longest allowed, however long the target's is. */
class TemporaryFile {
 public:
  explicit TemporaryFile(const fs::path& target)
  {
    std::random_device random;
    std::error_code code;
    do {
      path_ = target.parent_path() / (".pcl_slim_" + std::to_string(random()) + ".part");
    } while (fs::exists(path_, code));
    remember();
  }
  ~TemporaryFile()
  {
    std::error_code code;
    if (!renamed_) fs::remove(path_, code);
    if (slot_ == nullptr) return;
    slot_->exists = false;
    slot_->taken = false;
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  const fs::path& path() const { return path_; }

  std::error_code renameTo(const fs::path& target)
  {
    std::error_code code;
    fs::rename(path_, target, code);
    renamed_ = !code;
    return code;
  }

 private:
  void remember()
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

  fs::path path_;
  bool renamed_ = false;
  UnfinishedFile* slot_ = nullptr;
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
    if (target.direct) return {};
    target.permissions = status.permissions();
    constexpr fs::perms kWrite =
        fs::perms::owner_write | fs::perms::group_write | fs::perms::others_write;
    if ((target.permissions & kWrite) == fs::perms::none ||
        access(target.path.c_str(), W_OK) != 0) {
      return ioError("write", name, "the file is read-only; allow writing it or name another");
    }
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
  if (fs::is_character_file(path, code) || fs::is_block_file(path, code)) {
    return ioError("read", path, "it is a device; name a file");
  }
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
  TemporaryFile temporary(target.path);
  if (!writeAll(temporary.path(), bytes, size)) return ioError("write", path, systemMessage());
  if (target.permissions != fs::perms::unknown) {
    std::error_code ignored;  // the bytes count more than their permissions
    fs::permissions(temporary.path(), target.permissions, ignored);
  }
  const std::error_code code = temporary.renameTo(target.path);
  return code ? ioError("write", path, code.message()) : Error{};
}

Error
checkWritable(const std::string& path)
{
  Target target;
  if (Error error = resolveTarget(path, target)) return error;
  if (target.direct) return {};
  const TemporaryFile temporary(target.path);
  return writeAll(temporary.path(), nullptr, 0) ? Error{} : ioError("write", path, systemMessage());
}

void
removeUnfinishedFiles()
{
  for (const UnfinishedFile& file : g_unfinished) {
    if (file.exists) unlink(file.path);
  }
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
