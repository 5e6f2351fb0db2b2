// SPDX-License-Identifier: BSD-3-Clause
// Sources of a cloud's points, piece by piece: a cloud in memory, and a file of records.
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <limits>
#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/stream/point_source.h"
#include "pcl_slim/stream/record_source.h"

namespace pcl_slim {

namespace {

constexpr std::size_t kPiece = 1 << 18;  ///< points of a piece

}  // namespace

Error CloudSource::pass(const Visit& visit) {
  const auto at = [](const void* base, std::size_t bytes) -> const void* {
    return base ? static_cast<const char*>(base) + bytes : nullptr;
  };
  for (std::size_t first = 0; first < cloud_.count(); first += kPiece) {
    const std::size_t count = std::min(kPiece, cloud_.count() - first);
    CloudView piece = cloud_;
    if (cloud_.indices != nullptr) {
      piece.indices = cloud_.indices + first;
      piece.num_indices = count;
    } else {
      piece.xyz = at(cloud_.xyz, first * cloud_.xyz_stride);
      piece.normal = at(cloud_.normal, first * cloud_.normal_stride);
      piece.size = count;
    }
    if (Error error = visit(piece)) return error;
  }
  return {};
}

namespace {

/** What differs once a file is written to or replaced. */
std::array<std::uint64_t, 4> stateOf(const std::string& path) {
  struct stat state = {};
  if (stat(path.c_str(), &state) != 0) return {};
#ifdef __APPLE__
  const timespec& at = state.st_mtimespec;
#else
  const timespec& at = state.st_mtim;
#endif
  return {static_cast<std::uint64_t>(state.st_ino), static_cast<std::uint64_t>(state.st_size),
          static_cast<std::uint64_t>(at.tv_sec), static_cast<std::uint64_t>(at.tv_nsec)};
}

/** \brief A file that is read from any place. */
class FileReader {
 public:
  FileReader() = default;
  ~FileReader();
  FileReader(const FileReader&) = delete;
  FileReader& operator=(const FileReader&) = delete;

  Error open(const std::string& path);
  /** \brief Reads bytes from a place on, fewer at the file's end. \param[out] got how many. */
  Error read(std::uint64_t at, void* to, std::size_t bytes, std::size_t& got) const;
  /** \brief Reads exactly `bytes` bytes; a file that ends before is an error that names the byte.
   */
  Error readAll(std::uint64_t at, void* to, std::size_t bytes) const;

 private:
  std::string path_;
  int file_ = -1;
};

FileReader::~FileReader() {
  if (file_ >= 0) close(file_);
}

Error FileReader::open(const std::string& path) {
  path_ = path;
  file_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file_ >= 0) return {};
  return {ErrorCode::kIo, "cannot read '" + path + "': " + std::strerror(errno)};
}

Error FileReader::read(std::uint64_t at, void* to, std::size_t bytes, std::size_t& got) const {
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

Error FileReader::readAll(std::uint64_t at, void* to, std::size_t bytes) const {
  std::size_t got = 0;
  if (Error error = read(at, to, bytes, got)) return error;
  if (got == bytes) return {};
  return badInput("'" + path_ + "' ends at byte " + std::to_string(at + got) + " where " +
                  std::to_string(at + bytes) + " are announced: it is truncated, copy it again");
}

constexpr std::size_t kBuffer = 1 << 20;
constexpr std::size_t kRows = 1 << 16;  ///< rows of a piece

bool isSpace(char c) {
  return c == ' ' || c == '\n' || c == '\r' || c == '\t' || c == '\v' || c == '\f';
}

/** Walks over the words of a file. */
class WordReader {
 public:
  WordReader(const FileReader& file, std::uint64_t begin)
      : file_(file), next_(begin), buffer_(kBuffer) {}

  /** \brief The next word, valid until the next call; empty at the end of the file. */
  Error next(const char*& begin, const char*& end) {
    for (;;) {
      while (at_ < filled_ && isSpace(buffer_[at_])) ++at_;
      std::size_t stop = at_;
      while (stop < filled_ && !isSpace(buffer_[stop])) ++stop;
      if (stop < filled_ || ended_) {
        begin = buffer_.data() + at_;
        end = buffer_.data() + stop;
        at_ = stop;
        return {};
      }
      if (Error error = refill()) return error;
    }
  }

 private:
  Error refill() {
    const std::size_t kept = filled_ - at_;
    if (kept == buffer_.size()) buffer_.resize(2 * buffer_.size());
    std::copy(buffer_.begin() + static_cast<std::ptrdiff_t>(at_),
              buffer_.begin() + static_cast<std::ptrdiff_t>(filled_), buffer_.begin());
    std::size_t got = 0;
    if (Error error = file_.read(next_, buffer_.data() + kept, buffer_.size() - kept, got))
      return error;
    ended_ = got < buffer_.size() - kept;
    next_ += got;
    at_ = 0;
    filled_ = kept + got;
    return {};
  }

  const FileReader& file_;
  std::uint64_t next_;
  std::vector<char> buffer_;
  std::size_t at_ = 0, filled_ = 0;
  bool ended_ = false;
};

bool parse(const char* begin, const char* end, ScalarType type, double& value) {
  if (begin != end && *begin == '+') ++begin;
  if (type == kFloat32) {
    float rounded = 0;
    const auto result = std::from_chars(begin, end, rounded);
    value = static_cast<double>(rounded);
    return result.ec == std::errc() && result.ptr == end;
  }
  const auto result = std::from_chars(begin, end, value);
  return result.ec == std::errc() && result.ptr == end;
}

/** What the words of a row are for. */
struct Column {
  int target = -1;  ///< 0 to 2: coordinate, 3 to 5: normal, else none
  ScalarType type = kFloat64;
};

std::vector<Column> columnsOf(const RecordLayout& layout) {
  std::vector<Column> columns(layout.step);
  for (int a = 0; a < 3; ++a) {
    const auto& p = layout.position[static_cast<std::size_t>(a)];
    columns[p.offset] = {a, p.type};
    if (!layout.normal) continue;
    const auto& n = (*layout.normal)[static_cast<std::size_t>(a)];
    columns[n.offset] = {3 + a, n.type};
  }
  return columns;
}

/** Reads one row. \param[out] values coordinates and normal */
Error readRow(const RecordLayout& layout, const std::vector<Column>& columns, std::uint64_t row,
              WordReader& words, double (&values)[6]) {
  for (const Column& column : columns) {
    const char *begin = nullptr, *end = nullptr;
    if (Error error = words.next(begin, end)) return error;
    if (begin == end) {
      return badInput("'" + layout.path + "' ends in point " + std::to_string(row) + " of " +
                      std::to_string(layout.count) + ": it is truncated, copy it again");
    }
    if (column.target < 0 || parse(begin, end, column.type, values[column.target])) continue;
    return badInput("a coordinate of point " + std::to_string(row) + " of '" + layout.path +
                    "' is no number of its type: mend '" + std::string(begin, end) + "'");
  }
  return {};
}

/** \brief A pass over points that are rows of words, [first, end). Coordinates that are float are
 * rounded as such.
 * \return an error that names the row where the text ends or a word is no number. */
Error passText(const RecordLayout& layout, std::uint64_t first, std::uint64_t end,
               const FileReader& file, const PointSource::Visit& visit) {
  const std::vector<Column> columns = columnsOf(layout), passed_over(layout.step);
  WordReader words(file, layout.begin);
  std::vector<double> xyz;
  std::vector<float> normals;
  double unused[6];
  std::uint64_t row = 0;
  for (; row < first; ++row) {
    if (Error error = readRow(layout, passed_over, row, words, unused)) return error;
  }
  while (row < end) {
    xyz.clear();
    normals.clear();
    for (std::size_t i = 0; i < kRows && row < end; ++i, ++row) {
      double values[6] = {};
      if (Error error = readRow(layout, columns, row, words, values)) return error;
      xyz.insert(xyz.end(), values, values + 3);
      if (!layout.normal) continue;
      for (std::size_t a = 3; a < 6; ++a) normals.push_back(static_cast<float>(values[a]));
    }
    CloudView view;
    view.xyz = xyz.data();
    view.xyz_stride = 3 * sizeof(double);
    view.scalar = CloudView::Scalar::kDouble;
    view.normal = layout.normal ? normals.data() : nullptr;
    view.normal_stride = 3 * sizeof(float);
    view.size = xyz.size() / 3;
    view.sensor = layout.sensor;
    if (Error error = visit(view)) return error;
  }
  return {};
}

constexpr std::size_t kPieceBytes = 3 << 20;

/** Whether three numbers of a type are contiguous, as a CloudView needs them. */
bool inPlace(const std::array<RecordLayout::Field, 3>& fields, ScalarType type) {
  const std::size_t bytes = scalarSize(type);
  return fields[0].type == type && fields[1].type == type && fields[2].type == type &&
         fields[1].offset == fields[0].offset + bytes &&
         fields[2].offset == fields[1].offset + bytes;
}

/** Brings a piece's records into the form of a CloudView; records that have it already stay. */
class RecordConverter {
 public:
  explicit RecordConverter(const RecordLayout& layout) : layout_(layout) {
    const bool native = !layout.big_endian;
    floats_ = native && inPlace(layout.position, kFloat32);
    doubles_ = native && inPlace(layout.position, kFloat64);
    normals_ = native && layout.normal && inPlace(*layout.normal, kFloat32);
  }

  CloudView view(const unsigned char* records, std::size_t count) {
    CloudView view;
    view.size = count;
    view.sensor = layout_.sensor;
    if (floats_ || doubles_) {
      view.xyz = records + layout_.position[0].offset;
      view.xyz_stride = layout_.step;
      view.scalar = floats_ ? CloudView::Scalar::kFloat : CloudView::Scalar::kDouble;
    } else {
      convert(records, count, layout_.position, xyz_);
      view.xyz = xyz_.data();
      view.xyz_stride = 3 * sizeof(double);
      view.scalar = CloudView::Scalar::kDouble;
    }
    if (normals_) {
      view.normal = records + (*layout_.normal)[0].offset;
      view.normal_stride = layout_.step;
    } else if (layout_.normal) {
      convert(records, count, *layout_.normal, normal_);
      view.normal = normal_.data();
      view.normal_stride = 3 * sizeof(float);
    }
    return view;
  }

 private:
  template <typename T>
  void convert(const unsigned char* records, std::size_t count,
               const std::array<RecordLayout::Field, 3>& fields, std::vector<T>& out) const {
    out.resize(3 * count);
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t a = 0; a < 3; ++a) {
        const std::size_t bytes = scalarSize(fields[a].type);
        unsigned char value[8];
        std::memcpy(value, records + i * layout_.step + fields[a].offset, bytes);
        if (layout_.big_endian) std::reverse(value, value + bytes);
        out[3 * i + a] = static_cast<T>(readScalar(value, fields[a].type));
      }
    }
  }

  const RecordLayout& layout_;
  bool floats_, doubles_, normals_;
  std::vector<double> xyz_;
  std::vector<float> normal_;
};

}  // namespace

RecordSource::RecordSource(RecordLayout layout, std::uint64_t share, std::uint64_t shares)
    : layout_(std::move(layout)), state_(stateOf(layout_.path)) {
  const std::uint64_t whole = layout_.count / shares, rest = layout_.count % shares;
  first_ = share * whole + std::min(share, rest);
  end_ = first_ + whole + (share < rest ? 1 : 0);
}

CloudView::Scalar RecordSource::scalar() const {
  const auto small = [](const RecordLayout::Field& field) {
    return scalarSize(field.type) <= 2 || field.type == kFloat32;
  };
  const auto& p = layout_.position;
  const bool floats = small(p[0]) && small(p[1]) && small(p[2]);
  return floats ? CloudView::Scalar::kFloat : CloudView::Scalar::kDouble;
}

Error RecordSource::pass(const Visit& visit) {
  if (Error error = passOver(visit)) return error;
  if (stateOf(layout_.path) == state_) return {};
  return badInput("'" + layout_.path +
                  "' changed while it was read: leave the file alone, and start again");
}

Error RecordSource::passOver(const Visit& visit) const {
  FileReader file;
  if (Error error = file.open(layout_.path)) return error;
  if (layout_.text) return passText(layout_, first_, end_, file, visit);
  const std::size_t piece = std::max<std::size_t>(1, kPieceBytes / layout_.step);
  std::vector<unsigned char> records(piece * layout_.step);
  RecordConverter converter(layout_);
  for (std::uint64_t first = first_; first < end_; first += piece) {
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(piece, end_ - first));
    const std::uint64_t at = layout_.begin + first * layout_.step;
    if (Error error = file.readAll(at, records.data(), count * layout_.step)) return error;
    if (Error error = visit(converter.view(records.data(), count))) return error;
  }
  return {};
}

}  // namespace pcl_slim
