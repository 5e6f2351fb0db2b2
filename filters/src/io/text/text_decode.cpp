// SPDX-License-Identifier: BSD-3-Clause
// From bytes to characters, and from characters to numbers.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>

#include "io/point_formats.h"
#include "io/text/text.h"

namespace pcl_slim {

namespace {

constexpr int kMostDecimals = 40;  ///< a float with more has them all or is zero

/** Half a unit of the last decimal. */
double halfUnit(int decimals) {
  static const auto table = [] {
    struct {
      double of[kMostDecimals + 1];
    } made{};
    for (int k = 0; k <= kMostDecimals; ++k) made.of[k] = 0.5 * std::pow(10.0, -k);
    return made;
  }();
  return table.of[std::clamp(decimals, 0, kMostDecimals)];
}

/** Digits behind the point, less the exponent. */
int decimalsOf(const char* begin, const char* end) {
  const char* point = std::find(begin, end, '.');
  const char* power = std::find_if(begin, end, [](char c) { return c == 'e' || c == 'E'; });
  const auto digits = point < power ? static_cast<int>(power - point) - 1 : 0;
  if (power == end) return digits;
  int exponent = 0;
  const char* from = power + 1;
  if (from != end && *from == '+') ++from;
  std::from_chars(from, end, exponent);
  return digits - std::clamp(exponent, -400, 400);
}

}  // namespace

bool parseDecimal(const char* begin, const char* end, double& value, bool& in_float) {
  if (begin != end && *begin == '+') ++begin;
  const auto [stop, code] = std::from_chars(begin, end, value);
  if (code == std::errc::result_out_of_range) {  // beyond doubles: infinite, or zero
    if (stop != end) return false;
    value = decimalsOf(begin, end) > 0 ? 0.0 : std::numeric_limits<double>::infinity();
    return true;
  }
  if (code != std::errc() || stop != end || begin == end) return false;
  if (!in_float || !std::isfinite(value)) return true;
  const auto narrow = static_cast<float>(value);
  in_float = std::abs(narrow - value) < halfUnit(decimalsOf(begin, end));
  return true;
}

namespace {

bool isMissing(const TextWord& word) {
  constexpr std::size_t kLongest = 8;
  if (word.empty()) return true;
  if (word.size() > kLongest) return false;
  std::string text(word.begin, word.end);
  for (char& c : text) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  // The last ones are what programs of Microsoft's compilers write for NaN.
  for (const char* known : {"na", "n/a", "#n/a", "null", "none", "1.#qnan", "-1.#ind", "1.#ind"}) {
    if (text == known) return true;
  }
  return false;
}

/** A number as other programs write it: 1,5 or 1.0D+03. */
bool parseForeign(const TextWord& word, bool commas, double& value, bool& in_float) {
  constexpr std::size_t kLongest = 64;
  if (word.size() > kLongest) return false;
  char text[kLongest];
  bool changed = false;
  for (std::size_t i = 0; i < word.size(); ++i) {
    text[i] = word.begin[i];
    const bool power = i > 0 && (text[i] == 'D' || text[i] == 'd');
    if (power) text[i] = 'e';
    if (commas && text[i] == ',') text[i] = '.';
    changed = changed || text[i] != word.begin[i];
  }
  return changed && parseDecimal(text, text + word.size(), value, in_float);
}

}  // namespace

bool parseField(const TextWord& word, bool commas, double& value, bool& in_float) {
  if (parseDecimal(word.begin, word.end, value, in_float)) return true;
  if (parseForeign(word, commas, value, in_float)) return true;
  value = std::numeric_limits<double>::quiet_NaN();
  return isMissing(word);
}

bool isNumber(const TextWord& word, bool commas) {
  double value = 0;
  bool in_float = false;
  return !word.empty() && parseField(word, commas, value, in_float);
}

namespace {

using Bytes = std::vector<unsigned char>;

/** A character in UTF-8. */
void append(std::uint32_t code, Bytes& text) {
  const auto tail = [&](int shift) {
    text.push_back(static_cast<unsigned char>(0x80u | (code >> shift & 0x3fu)));
  };
  if (code < 0x80) {
    text.push_back(static_cast<unsigned char>(code));
  } else if (code < 0x800) {
    text.push_back(static_cast<unsigned char>(0xc0u | code >> 6));
    tail(0);
  } else if (code < 0x10000) {
    text.push_back(static_cast<unsigned char>(0xe0u | code >> 12));
    tail(6);
    tail(0);
  } else {
    text.push_back(static_cast<unsigned char>(0xf0u | (code >> 18 & 7u)));
    tail(12);
    tail(6);
    tail(0);
  }
}

struct Encoding {
  const char* name;
  std::size_t unit, mark;  ///< bytes of a code unit and of the byte order mark
  bool big_endian;
};

std::uint32_t unitAt(const Bytes& bytes, std::size_t at, const Encoding& encoding) {
  std::uint32_t code = 0;
  for (std::size_t k = 0; k < encoding.unit; ++k) {
    const std::size_t from = encoding.big_endian ? at + k : at + encoding.unit - 1 - k;
    code = code << 8 | bytes[from];
  }
  return code;
}

Error transcode(const Bytes& bytes, const Encoding& encoding, Bytes& text) {
  if ((bytes.size() - encoding.mark) % encoding.unit != 0) {
    return badInput(std::string("the text is ") + encoding.name +
                    " and ends inside a character: it is truncated, copy it again");
  }
  text.reserve(bytes.size() / encoding.unit + 1);
  for (std::size_t at = encoding.mark; at < bytes.size(); at += encoding.unit) {
    std::uint32_t code = unitAt(bytes, at, encoding);
    const bool high = encoding.unit == 2 && code >= 0xd800 && code < 0xdc00;
    if (high && at + 3 < bytes.size()) {
      at += 2;
      code = 0x10000 + ((code & 0x3ffu) << 10) + (unitAt(bytes, at, encoding) & 0x3ffu);
    }
    append(code, text);
  }
  return {};
}

/** The encoding of text that is not UTF-8, or null. */
const Encoding* encodingOf(const Bytes& bytes) {
  static constexpr Encoding kMarked[] = {{"UTF-32", 4, 4, false},
                                         {"UTF-32", 4, 4, true},
                                         {"UTF-16", 2, 2, false},
                                         {"UTF-16", 2, 2, true}};
  static constexpr Encoding kBare[] = {{"UTF-16", 2, 0, false}, {"UTF-16", 2, 0, true}};
  const char* const marks[] = {"\xff\xfe\0\0", "\0\0\xfe\xff", "\xff\xfe", "\xfe\xff"};
  for (std::size_t k = 0; k < 4; ++k) {
    const std::size_t size = kMarked[k].mark;
    if (bytes.size() >= size && std::memcmp(bytes.data(), marks[k], size) == 0) return &kMarked[k];
  }
  if (bytes.size() < 4) return nullptr;
  const bool zero[4] = {bytes[0] == 0, bytes[1] == 0, bytes[2] == 0, bytes[3] == 0};
  if (!zero[0] && zero[1] && !zero[2] && zero[3]) return &kBare[0];
  if (zero[0] && !zero[1] && zero[2] && !zero[3]) return &kBare[1];
  return nullptr;
}

}  // namespace

Error decodeText(const std::vector<unsigned char>& bytes, PlainText& text) {
  const Bytes* plain = &bytes;
  if (const Encoding* encoding = encodingOf(bytes)) {
    if (Error error = transcode(bytes, *encoding, text.made)) return error;
    plain = &text.made;
  }
  text.begin = reinterpret_cast<const char*>(plain->data());
  text.end = text.begin + plain->size();
  if (text.begin == text.end) return {};
  const auto size = static_cast<std::size_t>(text.end - text.begin);
  if (size >= 3 && std::memcmp(text.begin, "\xef\xbb\xbf", 3) == 0) text.begin += 3;
  const auto* zero = static_cast<const char*>(
      std::memchr(text.begin, 0, static_cast<std::size_t>(text.end - text.begin)));
  if (zero == nullptr) return {};
  const auto line = 1 + std::count(text.begin, zero, lineEndOf(text.begin, text.end));
  return badInput(
      "it is no text, or damaged: line " + std::to_string(line) +
      " has a byte of 0; copy it again or, if the other lines are right, mend that line "
      "(sed -n " +
      std::to_string(line) + "p shows it)");
}

}  // namespace pcl_slim
