// SPDX-License-Identifier: BSD-3-Clause
#include "source/text_pass.h"

#include <charconv>
#include <limits>
#include <string>
#include <vector>

namespace pcl_slim::detail {

namespace {

constexpr std::size_t kBuffer = 1 << 20;
constexpr std::size_t kRows = 1 << 16;  ///< rows of a piece

bool
isSpace(char c)
{
  return c == ' ' || c == '\n' || c == '\r' || c == '\t' || c == '\v' || c == '\f';
}

/** Walks over the words of a file. */
class WordReader {
 public:
  WordReader(const FileReader& file, std::uint64_t begin)
      : file_(file), next_(begin), buffer_(kBuffer)
  {
  }

  /** \brief The next word, valid until the next call; empty at the end of the file. */
  Error next(const char*& begin, const char*& end)
  {
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
  Error refill()
  {
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

bool
parse(const char* begin, const char* end, ScalarType type, double& value)
{
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

std::vector<Column>
columnsOf(const RecordLayout& layout)
{
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
Error
readRow(const RecordLayout& layout, const std::vector<Column>& columns, std::uint64_t row,
        WordReader& words, double (&values)[6])
{
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

}  // namespace

Error
passText(const RecordLayout& layout, std::uint64_t first, std::uint64_t end, const FileReader& file,
         const PointSource::Visit& visit)
{
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

}  // namespace pcl_slim::detail
