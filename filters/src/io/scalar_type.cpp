// SPDX-License-Identifier: BSD-3-Clause
#include "io/scalar_type.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <sstream>
#include <type_traits>

namespace pcl_slim {

namespace {

template <typename T>
bool
parseAs(const char* begin, const char* end, std::uint8_t* at)
{
  if (begin != end && *begin == '+') ++begin;
  T value{};
  auto [stop, code] = std::from_chars(begin, end, value);
  if constexpr (std::is_floating_point_v<T>) {
    // Values beyond the type's range are written by some programs; they become infinite or zero.
    if (code == std::errc::result_out_of_range) {
      double wide = 0.0;
      if (std::from_chars(begin, end, wide).ec == std::errc()) value = static_cast<T>(wide);
      code = std::errc();
    }
  } else if (code == std::errc() && stop != end) {  // an integer written as 1.0 or 1e3
    double wide = 0.0;
    const auto again = std::from_chars(begin, end, wide);
    stop = again.ptr;
    // The largest integer of 64 bits is no double: values below the next power of two fit.
    const double behind = std::ldexp(1.0, std::numeric_limits<T>::digits);
    if (!(wide >= static_cast<double>(std::numeric_limits<T>::min()) && wide < behind)) {
      return false;
    }
    value = static_cast<T>(wide);
  }
  std::memcpy(at, &value, sizeof(value));
  return code == std::errc() && stop == end;
}

bool
isSpace(char c)
{
  return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\v' || c == '\f';
}

}  // namespace

bool
parseScalar(const char* begin, const char* end, std::uint8_t type, std::uint8_t* at)
{
  switch (type) {
    case kInt8: return parseAs<std::int8_t>(begin, end, at);
    case kUInt8:
    case kBool: return parseAs<std::uint8_t>(begin, end, at);
    case kInt16: return parseAs<std::int16_t>(begin, end, at);
    case kUInt16: return parseAs<std::uint16_t>(begin, end, at);
    case kInt32: return parseAs<std::int32_t>(begin, end, at);
    case kUInt32: return parseAs<std::uint32_t>(begin, end, at);
    case kFloat32: return parseAs<float>(begin, end, at);
    case kFloat64: return parseAs<double>(begin, end, at);
    case kInt64: return parseAs<std::int64_t>(begin, end, at);
    case kUInt64: return parseAs<std::uint64_t>(begin, end, at);
    default: return false;
  }
}

std::string
formatScalar(double value)
{
  char buffer[40];
  std::snprintf(buffer, sizeof(buffer), "%.17g", value);
  std::string text = buffer;
  std::replace(text.begin(), text.end(), ',', '.');  // some locales write commas
  return text;
}

void
addField(pcl::PCLPointCloud2& cloud, const std::string& name, std::uint8_t type, std::size_t count)
{
  pcl::PCLPointField field;
  field.name = name;
  field.offset = cloud.point_step;
  field.datatype = type;
  field.count = static_cast<pcl::uindex_t>(count);
  cloud.fields.push_back(field);
  cloud.point_step += static_cast<pcl::uindex_t>(scalarSize(type) * count);
}

void
swapBytes(std::uint8_t* at, std::size_t size)
{
  std::reverse(at, at + size);
}

bool
TextScanner::nextLine(std::string& line)
{
  if (at_ == end_) return false;
  const char* stop =
      static_cast<const char*>(std::memchr(at_, '\n', static_cast<std::size_t>(end_ - at_)));
  if (!stop) stop = end_;
  const char* text_end = stop;
  if (text_end != at_ && text_end[-1] == '\r') --text_end;
  line.assign(at_, text_end);
  at_ = stop == end_ ? end_ : stop + 1;
  return true;
}

bool
TextScanner::nextWord(const char*& begin, const char*& end)
{
  while (at_ != end_ && isSpace(*at_)) ++at_;
  begin = at_;
  while (at_ != end_ && !isSpace(*at_)) ++at_;
  end = at_;
  return begin != end;
}

std::vector<std::string>
splitWords(const std::string& line)
{
  std::istringstream stream(line);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

}  // namespace pcl_slim
