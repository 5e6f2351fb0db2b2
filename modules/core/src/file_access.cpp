// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/core/file_access.h"

#include <limits.h>
#include <signal.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <random>
#include <set>
#include <string>
#include <system_error>
#include <utility>

namespace pcl_slim {

namespace fs = std::filesystem;

namespace {

/** Name of a temporary file, kept where a signal handler may read it. */
struct UnfinishedFile {
  std::atomic<bool> taken{false}, exists{false};
  char path[PATH_MAX];
};

std::array<UnfinishedFile, 16> g_unfinished;

/** A temporary file in the target's folder, removed unless it is renamed. Its name is short and no
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

constexpr const char* kPrefix = ".pcl_slim_";
constexpr const char* kSuffix = ".part";

/** What names of this machine's temporary files begin with, before the process that makes them. */
std::string ownPrefix() {
  char host[64] = {};
  gethostname(host, sizeof(host) - 1);
  return kPrefix + std::string(host) + "_";
}

/** Removes what processes of this machine that were killed have left in a folder. O(files). */
void removeLeftovers(const fs::path& folder) {
  const std::string prefix = ownPrefix();
  std::error_code code;
  for (fs::directory_iterator at(folder, code), end; !code && at != end; at.increment(code)) {
    const std::string name = at->path().filename().string();
    const bool temporary = name.rfind(prefix, 0) == 0 && at->path().extension() == kSuffix;
    const long process = temporary ? std::atol(name.c_str() + prefix.size()) : 0;
    if (process <= 0 || kill(static_cast<pid_t>(process), 0) == 0 || errno != ESRCH) continue;
    std::error_code ignored;
    fs::remove(at->path(), ignored);
  }
}

/** The same, once for each folder. */
void removeLeftoversOnce(const fs::path& folder) {
  static std::mutex mutex;
  static std::set<std::string> done;
  {
    const std::lock_guard<std::mutex> lock(mutex);
    if (!done.insert(folder.string()).second) return;
  }
  removeLeftovers(folder);
}

TemporaryFile::TemporaryFile(const fs::path& target) {
  const fs::path folder = target.has_parent_path() ? target.parent_path() : ".";
  removeLeftoversOnce(folder);
  const std::string prefix = ownPrefix() + std::to_string(getpid()) + "_";
  std::random_device random;
  std::error_code code;
  do {
    path_ = target.parent_path() / (prefix + std::to_string(random()) + kSuffix);
  } while (fs::exists(path_, code));
  remember();
}

TemporaryFile::~TemporaryFile() {
  std::error_code code;
  if (!renamed_) fs::remove(path_, code);
  if (slot_ == nullptr) return;
  slot_->exists = false;
  slot_->taken = false;
}

std::error_code TemporaryFile::renameTo(const fs::path& target) {
  std::error_code code;
  fs::rename(path_, target, code);
  renamed_ = !code;
  return code;
}

void TemporaryFile::remember() {
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

Error ioError(const std::string& verb, const std::string& path, const std::string& why) {
  return {ErrorCode::kIo, "cannot " + verb + " '" + path + "': " + why};
}

/** The remedy for an error code of the operating system; empty: none known. */
std::string remedyOf(int code) {
  switch (code) {
    case EACCES:
    case EPERM: return "; allow it or name another place";
    case EROFS: return "; name another place";
    case ENOSPC:
    case EDQUOT: return "; make room or name another place";
    case EFBIG: return "; raise the limit of ulimit -f";
    case ENAMETOOLONG: return "; give a shorter name";
    case ENOENT: return "; check the name";
    case ENOTDIR: return "; make it a folder or name another";
    case ELOOP: return "; its links lead to themselves, name a file";
    case EPIPE: return "; what read it has ended";
    default: return "";
  }
}

std::string systemMessage(int code) {
  if (code == 0) return "the operating system gave no reason";
  return std::strerror(code) + remedyOf(code);
}

std::string systemMessage() {
  return systemMessage(errno);
}

/** Where the bytes of path really go, and whether a rename can put them there. */
struct Target {
  fs::path path;
  bool direct = false;
  fs::perms permissions = fs::perms::unknown;  ///< of the file that is replaced
};

/** The place that links lead to, whether or not something is there yet. */
fs::path behindLinks(fs::path path) {
  std::error_code code;
  while (fs::is_symlink(fs::symlink_status(path, code))) {
    path = path.parent_path() / fs::read_symlink(path, code);
  }
  return path;
}

Error resolveTarget(const std::string& name, Target& target) {
  std::error_code code;
  target.path = name;
  const fs::file_status status = fs::status(target.path, code);
  if (!fs::status_known(status)) return ioError("write", name, systemMessage(code.value()));
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
  if (name.empty() || !target.path.has_filename()) return ioError("write", name, "name a file");
  target.path = behindLinks(target.path);
  const fs::path folder = target.path.has_parent_path() ? target.path.parent_path() : ".";
  if (!fs::is_directory(folder, code)) {
    return ioError("write", name,
                   "the folder '" + folder.string() + "' does not exist; create it first");
  }
  return {};
}

bool writeAll(const fs::path& path, const void* bytes, std::size_t size) {
  errno = 0;
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(static_cast<const char*>(bytes), static_cast<std::streamsize>(size));
  file.close();
  return !file.fail();
}

/** A file that is complete but for its name. */
struct WaitingFile {
  std::string name;  ///< as the caller gave it
  fs::path target;
  std::unique_ptr<TemporaryFile> temporary;
};

Error putInPlace(const WaitingFile& file) {
  const std::error_code code = file.temporary->renameTo(file.target);
  return code ? ioError("write", file.name, systemMessage(code.value())) : Error{};
}

}  // namespace

struct FileTransaction::Waiting : std::vector<WaitingFile> {};

namespace {

thread_local FileTransaction::Waiting* t_waiting = nullptr;

Error putOrWait(WaitingFile file) {
  if (t_waiting == nullptr) return putInPlace(file);
  t_waiting->push_back(std::move(file));
  return {};
}

}  // namespace

Result<std::vector<unsigned char>> readFile(const std::string& path) {
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

Error writeFile(const std::string& path, const void* bytes, std::size_t size) {
  Target target;
  if (Error error = resolveTarget(path, target)) return error;
  if (target.direct) {
    return writeAll(target.path, bytes, size) ? Error{} : ioError("write", path, systemMessage());
  }
  auto temporary = std::make_unique<TemporaryFile>(target.path);
  if (!writeAll(temporary->path(), bytes, size)) return ioError("write", path, systemMessage());
  if (target.permissions != fs::perms::unknown) {
    std::error_code ignored;  // the bytes count more than their permissions
    fs::permissions(temporary->path(), target.permissions, ignored);
  }
  return putOrWait({path, target.path, std::move(temporary)});
}

struct FileWriter::State {
  std::string name;
  Target target;
  std::unique_ptr<TemporaryFile> temporary;
  std::ofstream file;
  std::uint64_t size = 0;
};

FileWriter::FileWriter() = default;
FileWriter::~FileWriter() = default;

Error FileWriter::open(const std::string& path) {
  state_ = std::make_unique<State>();
  state_->name = path;
  if (Error error = resolveTarget(path, state_->target)) return error;
  if (!state_->target.direct)
    state_->temporary = std::make_unique<TemporaryFile>(state_->target.path);
  errno = 0;
  state_->file.open(state_->temporary ? state_->temporary->path() : state_->target.path,
                    std::ios::binary | std::ios::trunc);
  return state_->file ? Error{} : ioError("write", path, systemMessage());
}

Error FileWriter::write(const void* bytes, std::size_t size) {
  errno = 0;
  state_->file.write(static_cast<const char*>(bytes), static_cast<std::streamsize>(size));
  state_->size += size;
  return state_->file ? Error{} : ioError("write", state_->name, systemMessage());
}

Error FileWriter::rewrite(std::uint64_t at, const void* bytes, std::size_t size) {
  errno = 0;
  state_->file.seekp(static_cast<std::streamoff>(at));
  state_->file.write(static_cast<const char*>(bytes), static_cast<std::streamsize>(size));
  state_->file.seekp(0, std::ios::end);
  return state_->file ? Error{} : ioError("write", state_->name, systemMessage());
}

std::uint64_t FileWriter::size() const {
  return state_->size;
}

Error FileWriter::finish() {
  const std::unique_ptr<State> state = std::move(state_);
  errno = 0;
  state->file.close();
  if (state->file.fail()) return ioError("write", state->name, systemMessage());
  if (!state->temporary) return {};
  if (state->target.permissions != fs::perms::unknown) {
    std::error_code ignored;  // the bytes count more than their permissions
    fs::permissions(state->temporary->path(), state->target.permissions, ignored);
  }
  return putOrWait({state->name, state->target.path, std::move(state->temporary)});
}

FileTransaction::FileTransaction() : waiting_(std::make_unique<Waiting>()), outer_(t_waiting) {
  t_waiting = waiting_.get();
}

FileTransaction::~FileTransaction() {
  t_waiting = outer_;
}

Error FileTransaction::commit() {
  Error error;
  for (const WaitingFile& file : *waiting_) {
    if (!error) error = putInPlace(file);
  }
  waiting_->clear();
  return error;
}

Error checkWritable(const std::string& path) {
  Target target;
  if (Error error = resolveTarget(path, target)) return error;
  if (target.direct) return {};
  const TemporaryFile temporary(target.path);
  return writeAll(temporary.path(), nullptr, 0) ? Error{} : ioError("write", path, systemMessage());
}

std::string placeOf(const std::string& path) {
  std::error_code code;
  if (!fs::status_known(fs::status(path, code))) return "";
  return fs::weakly_canonical(fs::absolute(behindLinks(path), code), code).string();
}

bool isStream(const std::string& path) {
  for (const char* names : {"/dev/stdin", "/dev/fd/", "/proc/self/fd/"})
    if (path.rfind(names, 0) == 0) return true;
  std::error_code code;
  const fs::file_type type = fs::status(path, code).type();
  return type == fs::file_type::fifo || type == fs::file_type::socket;
}

std::string lowerExtension(const std::string& path) {
  std::string extension = fs::path(path).extension().string();
  for (char& c : extension) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return extension;
}

void removeUnfinishedFiles() {
  for (const UnfinishedFile& file : g_unfinished) {
    if (file.exists) unlink(file.path);
  }
}

}  // namespace pcl_slim
