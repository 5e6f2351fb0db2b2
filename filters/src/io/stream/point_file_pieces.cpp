// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/filters/io/point_file_pieces.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <vector>

#include "io/pcd/pcd_header.h"
#include "io/point_formats.h"
#include "pcl_slim/filters/io/record_layout.h"

namespace pcl_slim {

namespace {

using Bytes = std::vector<unsigned char>;

Error
whole(const std::string& path, const std::string& why)
{
  return {ErrorCode::kBadArgument,
          "'" + path + "' can only be read as a whole: " + why + "; write its points as binary"};
}

/** A header with other numbers of points. \param[in] width,height of a PCD */
std::string
recounted(const std::string& header, bool pcd, std::uint64_t width, std::uint64_t height)
{
  std::istringstream lines(header);
  std::string line, text;
  const auto isKey = [&](const char* key) { return line.rfind(key, 0) == 0; };
  while (std::getline(lines, line)) {
    if (pcd && isKey("WIDTH ")) line = "WIDTH " + std::to_string(width);
    if (pcd && isKey("HEIGHT ")) line = "HEIGHT " + std::to_string(height);
    if (pcd && isKey("POINTS ")) line = "POINTS " + std::to_string(width * height);
    if (!pcd && isKey("element vertex ")) line = "element vertex " + std::to_string(width * height);
    text += line + "\n";
  }
  return text;
}

/** The header of a file without one. */
std::string
rawHeader(const RecordLayout& layout)
{
  const bool floats = layout.position[0].type == kFloat32;
  std::string text = "ply\nformat binary_little_endian 1.0\nelement vertex 0\n";
  for (const char* axis : {"x", "y", "z"})
    text += std::string("property ") + (floats ? "float " : "double ") + axis + "\n";
  return text + "end_header\n";
}

/** Bytes of a file up to a place. */
std::string
readHead(const std::string& path, std::uint64_t bytes)
{
  std::ifstream file(path, std::ios::binary);
  std::string head(static_cast<std::size_t>(bytes), '\0');
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  return head;
}

/** Bytes of a formatted file's header. */
std::size_t
headerBytes(const Bytes& bytes, bool pcd)
{
  const std::string last = pcd ? "\nDATA binary\n" : "\nend_header\n";
  const auto at = std::search(bytes.begin(), bytes.end(), last.begin(), last.end());
  return static_cast<std::size_t>(at - bytes.begin()) + last.size();
}

}  // namespace

Error
PointFileReader::open(const std::string& path)
{
  Result<RecordLayout> layout = recordLayoutOf(path, false);
  if (!layout) return layout.error();
  layout_ = *layout;
  done_ = 0;
  pcd_ = lowerExtension(path) == ".pcd";
  if (layout_.text) return whole(path, "it is text");
  width_ = layout_.count;
  height_ = 1;
  if (isRawPointFile(path)) {
    header_ = rawHeader(layout_);
    return {};
  }
  header_ = readHead(path, layout_.begin);
  if (pcd_) {
    PcdHeader header;
    PointFile file;
    if (Error error = parsePcdHeader({header_.begin(), header_.end()}, header, file)) return error;
    width_ = header.width;
    height_ = header.height;
    return {};
  }
  std::error_code code;
  const std::uint64_t bytes = std::filesystem::file_size(path, code);
  const bool only = bytes == layout_.begin + layout_.count * layout_.step;
  const bool first = header_.find("end_header") + 16 > header_.size();
  return only && first ? Error() : whole(path, "it has more than points, which would be lost");
}

std::string
PointFileReader::headerFor(std::uint64_t points) const
{
  return recounted(header_, pcd_, points, 1);
}

Error
PointFileReader::next(std::size_t most, PointFile& piece)
{
  piece = PointFile();
  const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(most, size() - done_));
  if (count == 0) return {};
  const std::string header = headerFor(count);
  Bytes bytes(header.begin(), header.end());
  const std::size_t wanted = count * layout_.step;
  bytes.resize(header.size() + wanted);
  std::ifstream file(layout_.path, std::ios::binary);
  const std::uint64_t at = layout_.begin + done_ * layout_.step;
  file.seekg(static_cast<std::streamoff>(at));
  file.read(reinterpret_cast<char*>(bytes.data()) + header.size(),
            static_cast<std::streamsize>(wanted));
  if (static_cast<std::size_t>(file.gcount()) != wanted) {
    return badInput("'" + layout_.path + "' ends at byte " +
                    std::to_string(at + static_cast<std::uint64_t>(file.gcount())) +
                    ", before its last point: it is truncated, copy it again");
  }
  done_ += count;
  Result<PointFile> parsed = pcd_ ? parsePcd(bytes) : parsePly(bytes);
  if (!parsed) return parsed.error();
  piece = std::move(*parsed);
  return {};
}

Error
PointFileWriter::open(const std::string& path, std::uint64_t width, std::uint64_t height)
{
  const std::string extension = lowerExtension(path);
  pcd_ = extension == ".pcd";
  if (!pcd_ && extension != ".ply") {
    return {ErrorCode::kBadArgument,
            "'" + path + "' cannot be written in pieces; name a .pcd or .ply file"};
  }
  width_ = width;
  height_ = height;
  begun_ = false;
  return file_.open(path);
}

Error
PointFileWriter::add(const PointFile& piece)
{
  Result<Bytes> bytes = pcd_ ? Result<Bytes>(formatPcd(piece)) : formatPly(piece);
  if (!bytes) return bytes.error();
  const std::size_t head = headerBytes(*bytes, pcd_);
  if (!begun_) {
    const std::string header(bytes->begin(), bytes->begin() + static_cast<std::ptrdiff_t>(head));
    const std::string all = recounted(header, pcd_, width_, height_);
    if (Error error = file_.write(all.data(), all.size())) return error;
    begun_ = true;
  }
  return file_.write(bytes->data() + head, bytes->size() - head);
}

Error
PointFileWriter::finish()
{
  return file_.finish();
}

}  // namespace pcl_slim
