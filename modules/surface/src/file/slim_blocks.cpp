// SPDX-License-Identifier: BSD-3-Clause
#include "file/slim_file.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <iterator>
#include <limits>
#include <utility>

#include "pcl_slim/core/file_access.h"
#include "pcl_slim/surface/surface_io.h"

namespace pcl_slim {

using namespace detail;

namespace {

constexpr std::size_t kEntryBytes = 5 * sizeof(std::uint64_t) + 6 * sizeof(float);
constexpr std::size_t kTrailerBytes = 2 * sizeof(std::uint64_t);

using Bytes = std::vector<unsigned char>;

/** Reads bytes of a file or of memory. */
using ReadAt = std::function<bool(std::uint64_t at, std::size_t bytes, Bytes& out)>;

Error corrupted() {
  return badInput("the .slim file's directory of blocks is corrupted or cut off; copy it again");
}

void putEntry(const SlimBlock& block, ByteWriter& out) {
  for (const std::uint64_t value :
       {block.offset, block.bytes, block.surfels, block.first_key, block.end_key})
    out.putUnsigned(value);
  for (const float value : block.low) out.putFloat(value);
  for (const float value : block.high) out.putFloat(value);
}

SlimBlock getEntry(ByteReader& in) {
  SlimBlock block;
  for (std::uint64_t* value :
       {&block.offset, &block.bytes, &block.surfels, &block.first_key, &block.end_key})
    *value = in.getUnsigned<std::uint64_t>();
  for (float& value : block.low) value = in.getFloat();
  for (float& value : block.high) value = in.getFloat();
  return block;
}

/** The header of a file of blocks followed by its directory: what its checksum is over. */
Bytes sealedHeader(const SlimDirectory& directory, std::uint64_t file_bytes, const Bytes& entries) {
  ByteWriter out;
  putSlimHeader(directory.info, kSlimBlocksVersion, directory.surfels,
                file_bytes - kSlimHeaderBytes, out);
  out.putBytes(entries);
  sealSlim(out.bytes);
  out.bytes.resize(kSlimHeaderBytes);
  return out.bytes;
}

/** The box of the balls of a surface. */
void setBox(const SLIMSurface& s, SlimBlock& block) {
  block.low.fill(std::numeric_limits<float>::max());
  block.high.fill(std::numeric_limits<float>::lowest());
  const std::vector<float>* columns[3] = {&s.cx, &s.cy, &s.cz};
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t i = 0; i < s.size(); ++i) {
      block.low[a] = std::min(block.low[a], (*columns[a])[i] - s.radius[i]);
      block.high[a] = std::max(block.high[a], (*columns[a])[i] + s.radius[i]);
    }
  }
}

Result<SlimDirectory> readDirectory(const ReadAt& read, std::uint64_t size) {
  Bytes head, trailer, entries;
  if (size < kSlimHeaderBytes + kTrailerBytes || !read(0, kSlimHeaderBytes, head) ||
      !read(size - kTrailerBytes, kTrailerBytes, trailer))
    return corrupted();
  SlimDirectory directory;
  const Result<std::uint64_t> surfels = getSlimHeader(head.data(), directory.info);
  if (!surfels) return surfels.error();
  directory.surfels = *surfels;
  ByteReader ends(trailer.data());
  const auto begin = ends.getUnsigned<std::uint64_t>(), count = ends.getUnsigned<std::uint64_t>();
  const std::uint64_t room = size - kTrailerBytes;
  if (begin < kSlimHeaderBytes || begin > room || count != (room - begin) / kEntryBytes ||
      (room - begin) % kEntryBytes != 0 ||
      !read(begin, static_cast<std::size_t>(size - begin), entries))
    return corrupted();
  head.insert(head.end(), entries.begin(), entries.end());
  if (slimChecksum(head.data(), head.size()) != announcedChecksum(head.data())) return corrupted();
  ByteReader in(entries.data());
  std::uint64_t sum = 0;
  for (std::uint64_t b = 0; b < count; ++b) {
    directory.blocks.push_back(getEntry(in));
    const SlimBlock& block = directory.blocks.back();
    if (block.offset > begin || block.bytes > begin - block.offset) return corrupted();
    sum += block.surfels;
  }
  if (sum != directory.surfels) return contradictorySlim();
  return directory;
}

/** The surfels of one block, without links. */
Result<SLIMSurface> readBlock(const ReadAt& read, const SlimDirectory& directory, std::size_t b) {
  const SlimBlock& block = directory.blocks[b];
  const std::string name = "block " + std::to_string(b) + ": ";
  Bytes bytes;
  if (!read(block.offset, static_cast<std::size_t>(block.bytes), bytes)) return corrupted();
  Result<SLIMSurface> tile = decodeSlimBlock(bytes.data(), bytes.size());
  if (!tile) return Error{tile.error().code, name + tile.error().message};
  const SurfaceInfo &own = tile->info, &all = directory.info;
  if (tile->size() != block.surfels || own.degree != all.degree || own.scale != all.scale ||
      own.origin != all.origin)
    return Error{ErrorCode::kBadInput, name + contradictorySlim().message};
  return tile;
}

ReadAt reading(std::ifstream& file) {
  return [&file](std::uint64_t at, std::size_t bytes, Bytes& out) {
    out.resize(bytes);
    file.clear();
    file.seekg(static_cast<std::streamoff>(at));
    file.read(reinterpret_cast<char*>(out.data()), static_cast<std::streamsize>(bytes));
    return static_cast<std::size_t>(file.gcount()) == bytes;
  };
}

Error named(const std::string& path, const Error& error) {
  return {error.code, "'" + path + "': " + error.message};
}

/** Opens a file. \return its size, or why it cannot be read. */
Result<std::uint64_t> openFile(const std::string& path, std::ifstream& file) {
  errno = 0;
  file.open(path, std::ios::binary | std::ios::ate);
  const std::streamoff end = file ? static_cast<std::streamoff>(file.tellg()) : -1;
  if (end < 0) return Error{ErrorCode::kIo, "cannot read '" + path + "': " + std::strerror(errno)};
  return static_cast<std::uint64_t>(end);
}

}  // namespace

Result<SLIMSurface> detail::decodeSlimBlocks(const unsigned char* bytes, std::size_t size) {
  const ReadAt read = [=](std::uint64_t at, std::size_t count, Bytes& out) {
    out.assign(bytes + at, bytes + at + count);
    return true;
  };
  const Result<SlimDirectory> directory = readDirectory(read, size);
  if (!directory) return directory.error();
  SLIMSurface surface;
  for (std::size_t b = 0; b < directory->blocks.size(); ++b) {
    const Result<SLIMSurface> tile = readBlock(read, *directory, b);
    if (!tile) return tile.error();
    surface.append(*tile);
  }
  surface.info = directory->info;
  return surface;
}

Error SlimBlockWriter::open(const std::string& path, const SlimRounding& rounding) {
  directory_ = {};
  rounding_ = rounding;
  if (Error error = file_.open(path)) return error;
  const Bytes room(kSlimHeaderBytes, 0);
  return file_.write(room.data(), room.size());
}

Error SlimBlockWriter::add(const SLIMSurface& tile, std::uint64_t first_key,
                           std::uint64_t end_key) {
  if (directory_.blocks.empty()) directory_.info = tile.info;
  if (tile.empty()) return {};
  if (Error error = tile.validate()) return error;
  const Bytes bytes = encodeSlim(tile, rounding_);
  SlimBlock block;
  block.offset = file_.size();
  block.bytes = bytes.size();
  block.surfels = tile.size();
  block.first_key = first_key;
  block.end_key = end_key;
  setBox(tile, block);
  directory_.blocks.push_back(block);
  directory_.surfels += tile.size();
  return file_.write(bytes.data(), bytes.size());
}

Error SlimBlockWriter::finish() {
  if (directory_.surfels == 0) return badInput("there is no surfel to write");
  ByteWriter out;
  for (const SlimBlock& block : directory_.blocks) putEntry(block, out);
  out.putUnsigned(file_.size());
  out.putUnsigned(static_cast<std::uint64_t>(directory_.blocks.size()));
  const std::uint64_t file_bytes = file_.size() + out.bytes.size();
  const Bytes header = sealedHeader(directory_, file_bytes, out.bytes);
  if (Error error = file_.write(out.bytes.data(), out.bytes.size())) return error;
  if (Error error = file_.rewrite(0, header.data(), header.size())) return error;
  return file_.finish();
}

Result<SlimDirectory> loadSlimDirectory(const std::string& path) {
  if (isStream(path)) return named(path, badInput("a pipe is read once, as a whole"));
  std::ifstream file;
  const Result<std::uint64_t> size = openFile(path, file);
  if (!size) return size.error();
  Bytes head;
  reading(file)(0, kSlimHeaderBytes, head);
  if (slimVersionOf(head.data(), head.size()) != kSlimBlocksVersion)
    return named(path, badInput("not a .slim file of blocks; fit the scan by tiles"));
  Result<SlimDirectory> directory = readDirectory(reading(file), *size);
  if (!directory) return named(path, directory.error());
  return directory;
}

WorldBox SlimDirectory::boxOf(const SlimBlock& block) const {
  constexpr double kSlack = 1e-6;  // local units: floats round
  WorldBox box;
  for (std::size_t a = 0; a < 3; ++a) {
    box[0][a] = info.origin[a] + info.scale * (static_cast<double>(block.low[a]) - kSlack);
    box[1][a] = info.origin[a] + info.scale * (static_cast<double>(block.high[a]) + kSlack);
  }
  return box;
}

WorldBox SlimDirectory::box() const {
  if (blocks.empty()) return {};
  SlimBlock all = blocks.front();
  for (const SlimBlock& block : blocks) {
    for (std::size_t a = 0; a < 3; ++a) {
      all.low[a] = std::min(all.low[a], block.low[a]);
      all.high[a] = std::max(all.high[a], block.high[a]);
    }
  }
  return boxOf(all);
}

std::uint64_t SlimDirectory::memoryOf(const SlimBlock& block) const {
  constexpr std::uint64_t kFloats = 9, kBytes = 3;  // of a surfel besides its coefficients
  const auto terms = static_cast<std::uint64_t>(numCoefficients(info.degree));
  return block.surfels * ((kFloats + terms) * sizeof(float) + kBytes) + block.bytes;
}

Error SlimBlockReader::open(const std::string& path) {
  Result<SlimDirectory> directory = loadSlimDirectory(path);
  if (!directory) return directory.error();
  directory_ = std::move(*directory);
  path_ = path;
  kept_.clear();
  read_.assign(directory_.blocks.size(), false);
  const Result<std::uint64_t> size = openFile(path, file_);
  return size ? Error() : size.error();
}

Result<SLIMSurface> SlimBlockReader::read(std::size_t block) {
  Result<SLIMSurface> tile = readBlock(reading(file_), directory_, block);
  if (!tile) return named(path_, tile.error());
  read_[block] = true;
  return tile;
}

/** Makes room for what is wanted. */
void SlimBlockReader::drop(const std::vector<bool>& wanted, std::uint64_t most_kept) {
  std::uint64_t bytes = 0;
  for (std::size_t b = 0; b < wanted.size(); ++b) {
    if (wanted[b] || kept_.count(b) > 0) bytes += directory_.memoryOf(directory_.blocks[b]);
  }
  for (auto block = kept_.begin(); block != kept_.end() && bytes > most_kept;) {
    const bool stays = wanted[block->first];
    if (!stays) bytes -= directory_.memoryOf(directory_.blocks[block->first]);
    block = stays ? std::next(block) : kept_.erase(block);
  }
}

Result<SLIMSurface> SlimBlockReader::load(const std::vector<bool>& wanted,
                                          std::uint64_t most_kept) {
  SLIMSurface surface;
  drop(wanted, most_kept);
  for (std::size_t b = 0; b < wanted.size(); ++b) {
    if (!wanted[b]) continue;
    if (const auto kept = kept_.find(b); kept != kept_.end()) {
      surface.append(kept->second);
      continue;
    }
    Result<SLIMSurface> tile = read(b);
    if (!tile) return tile.error();
    surface.append(*tile);
    if (most_kept > 0) kept_.emplace(b, std::move(*tile));
  }
  surface.info = directory_.info;
  return surface;
}

std::size_t SlimBlockReader::blocksRead() const {
  return static_cast<std::size_t>(std::count(read_.begin(), read_.end(), true));
}

Result<SLIMSurface> loadSlimBlocks(const std::string& path,
                                   const std::function<bool(const SlimBlock&)>& wanted) {
  SlimBlockReader reader;
  if (reader.open(path)) return loadSlim(path);  // of another version, or it returns the error
  std::vector<bool> blocks;
  for (const SlimBlock& block : reader.directory().blocks) blocks.push_back(wanted(block));
  Result<SLIMSurface> surface = reader.load(blocks);
  if (surface) surface->buildLinks();
  return surface;
}

bool boxesMeet(const WorldBox& a, const WorldBox& b) {
  bool meet = true;
  for (std::size_t k = 0; k < 3; ++k) meet = meet && a[1][k] >= b[0][k] && a[0][k] <= b[1][k];
  return meet;
}

Result<SLIMSurface> loadSlimBox(const std::string& path, const WorldBox& box) {
  const Result<SlimDirectory> directory = loadSlimDirectory(path);
  if (!directory) return loadSlim(path);
  return loadSlimBlocks(
      path, [&](const SlimBlock& block) { return boxesMeet(directory->boxOf(block), box); });
}

}  // namespace pcl_slim
