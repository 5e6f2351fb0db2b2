// SPDX-License-Identifier: BSD-3-Clause
#include "file/slim_blocks.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <limits>
#include <utility>

#include "file/byte_stream.h"
#include "file/slim_header.h"
#include "pcl_slim/surface/surface_io.h"

namespace pcl_slim {

using namespace detail;

namespace {

constexpr std::size_t kEntryBytes = 5 * sizeof(std::uint64_t) + 6 * sizeof(float);
constexpr std::size_t kTrailerBytes = 2 * sizeof(std::uint64_t);

using Bytes = std::vector<unsigned char>;

/** Reads bytes of a file or of memory. */
using ReadAt = std::function<bool(std::uint64_t at, std::size_t bytes, Bytes& out)>;

Error
corrupted()
{
  return badInput("the .slim file's directory of blocks is corrupted or cut off; copy it again");
}

void
putEntry(const SlimBlock& block, ByteWriter& out)
{
  for (const std::uint64_t value :
       {block.offset, block.bytes, block.surfels, block.first_key, block.end_key})
    out.putUnsigned(value);
  for (const float value : block.low) out.putFloat(value);
  for (const float value : block.high) out.putFloat(value);
}

SlimBlock
getEntry(ByteReader& in)
{
  SlimBlock block;
  for (std::uint64_t* value :
       {&block.offset, &block.bytes, &block.surfels, &block.first_key, &block.end_key})
    *value = in.getUnsigned<std::uint64_t>();
  for (float& value : block.low) value = in.getFloat();
  for (float& value : block.high) value = in.getFloat();
  return block;
}

/** The header of a file of blocks followed by its directory: what its checksum is over. */
Bytes
sealedHeader(const SlimDirectory& directory, std::uint64_t file_bytes, const Bytes& entries)
{
  ByteWriter out;
  putSlimHeader(directory.info, kSlimBlocksVersion, directory.surfels,
                file_bytes - kSlimHeaderBytes, out);
  out.putBytes(entries);
  sealSlim(out.bytes);
  out.bytes.resize(kSlimHeaderBytes);
  return out.bytes;
}

/** The box of the balls of a surface. */
void
setBox(const SLIMSurface& s, SlimBlock& block)
{
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

Result<SlimDirectory>
readDirectory(const ReadAt& read, std::uint64_t size)
{
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
  for (std::uint64_t b = 0; b < count; ++b) {
    directory.blocks.push_back(getEntry(in));
    const SlimBlock& block = directory.blocks.back();
    if (block.offset > begin || block.bytes > begin - block.offset) return corrupted();
  }
  return directory;
}

/** The surfels of the blocks that are wanted, without links. */
Result<SLIMSurface>
readBlocks(const ReadAt& read, const SlimDirectory& directory,
           const std::function<bool(const SlimBlock&)>& wanted)
{
  SLIMSurface surface;
  surface.info = directory.info;
  Bytes bytes;
  for (std::size_t b = 0; b < directory.blocks.size(); ++b) {
    const SlimBlock& block = directory.blocks[b];
    if (!wanted(block)) continue;
    const std::string name = "block " + std::to_string(b) + ": ";
    if (!read(block.offset, static_cast<std::size_t>(block.bytes), bytes)) return corrupted();
    Result<SLIMSurface> tile = decodeSlimBlock(bytes.data(), bytes.size());
    if (!tile) return Error{tile.error().code, name + tile.error().message};
    const SurfaceInfo &own = tile->info, &all = directory.info;
    if (tile->size() != block.surfels || own.degree != all.degree || own.scale != all.scale ||
        own.origin != all.origin)
      return Error{ErrorCode::kBadInput, name + contradictorySlim().message};
    surface.append(*tile);
  }
  surface.info = directory.info;
  return surface;
}

ReadAt
reading(std::ifstream& file)
{
  return [&file](std::uint64_t at, std::size_t bytes, Bytes& out) {
    out.resize(bytes);
    file.clear();
    file.seekg(static_cast<std::streamoff>(at));
    file.read(reinterpret_cast<char*>(out.data()), static_cast<std::streamsize>(bytes));
    return static_cast<std::size_t>(file.gcount()) == bytes;
  };
}

Error
named(const std::string& path, const Error& error)
{
  return {error.code, "'" + path + "': " + error.message};
}

/** Opens a file. \return its size, or why it cannot be read. */
Result<std::uint64_t>
openFile(const std::string& path, std::ifstream& file)
{
  errno = 0;
  file.open(path, std::ios::binary | std::ios::ate);
  const std::streamoff end = file ? static_cast<std::streamoff>(file.tellg()) : -1;
  if (end < 0) return Error{ErrorCode::kIo, "cannot read '" + path + "': " + std::strerror(errno)};
  return static_cast<std::uint64_t>(end);
}

}  // namespace

Result<SLIMSurface>
detail::decodeSlimBlocks(const unsigned char* bytes, std::size_t size)
{
  const ReadAt read = [=](std::uint64_t at, std::size_t count, Bytes& out) {
    out.assign(bytes + at, bytes + at + count);
    return true;
  };
  const Result<SlimDirectory> directory = readDirectory(read, size);
  if (!directory) return directory.error();
  return readBlocks(read, *directory, [](const SlimBlock&) { return true; });
}

Error
SlimBlockWriter::open(const std::string& path, double rounding)
{
  directory_ = {};
  rounding_ = rounding;
  if (Error error = file_.open(path)) return error;
  const Bytes room(kSlimHeaderBytes, 0);
  return file_.write(room.data(), room.size());
}

Error
SlimBlockWriter::add(const SLIMSurface& tile, std::uint64_t first_key, std::uint64_t end_key)
{
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

Error
SlimBlockWriter::finish()
{
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

Result<SlimDirectory>
loadSlimDirectory(const std::string& path)
{
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

Result<SLIMSurface>
loadSlimBlocks(const std::string& path, const std::function<bool(const SlimBlock&)>& wanted)
{
  std::ifstream file;
  const Result<std::uint64_t> size = openFile(path, file);
  if (!size) return size.error();
  Bytes head;
  const bool whole = reading(file)(0, kSlimHeaderBytes, head);
  if (!whole || slimVersionOf(head.data(), head.size()) != kSlimBlocksVersion)
    return loadSlim(path);
  const Result<SlimDirectory> directory = readDirectory(reading(file), *size);
  if (!directory) return named(path, directory.error());
  Result<SLIMSurface> surface = readBlocks(reading(file), *directory, wanted);
  if (!surface) return named(path, surface.error());
  surface->buildLinks();
  return surface;
}

Result<SLIMSurface>
loadSlimBox(const std::string& path, const std::array<double, 3>& low,
            const std::array<double, 3>& high)
{
  const Result<SlimDirectory> directory = loadSlimDirectory(path);
  if (!directory) return loadSlim(path);
  const SurfaceInfo& info = directory->info;
  return loadSlimBlocks(path, [&](const SlimBlock& block) {
    bool meets = true;
    for (std::size_t a = 0; a < 3; ++a) {
      meets = meets && info.origin[a] + info.scale * static_cast<double>(block.high[a]) >= low[a] &&
              info.origin[a] + info.scale * static_cast<double>(block.low[a]) <= high[a];
    }
    return meets;
  });
}

}  // namespace pcl_slim
