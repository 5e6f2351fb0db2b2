// SPDX-License-Identifier: BSD-3-Clause
#include "io/vtp/vtp_data.h"

#include <zlib.h>

#include <algorithm>

namespace pcl_slim {

namespace {

constexpr std::size_t kMostCompression = 1100;  ///< zlib packs a byte no denser than 1032 to 1

Error
damaged(const VtpArray& array)
{
  return {ErrorCode::kBadInput, "the VTP file's array '" + array.name +
                                    "' is truncated or corrupted; copy it again or write it anew"};
}

int
base64Value(char c)
{
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  return c == '+' ? 62 : c == '/' ? 63 : -1;
}

/** A stream of bytes out of base64 or raw text. */
class ByteSource {
 public:
  ByteSource(std::string_view text, bool base64) : text_(text), base64_(base64) {}

  /** \brief Appends count bytes, of whole groups: what is left of the last one is padding. false: too
   * few, or no base64. */
  bool read(std::size_t count, std::vector<std::uint8_t>& bytes)
  {
    if (!base64_) return readRaw(count, bytes);
    if (count / 3 > text_.size() / 4) return false;
    for (std::size_t left = count; left > 0;) {
      if (text_.size() < 4) return false;
      std::uint32_t group = 0;
      for (int i = 0; i < 4; ++i) {
        const int value = text_[i] == '=' ? 0 : base64Value(text_[i]);
        if (value < 0) return false;
        group = group << 6 | static_cast<std::uint32_t>(value);
      }
      text_.remove_prefix(4);
      for (int i = 0; i < 3 && left > 0; ++i, --left) {
        bytes.push_back(static_cast<std::uint8_t>(group >> (16 - 8 * i)));
      }
    }
    return true;
  }

 private:
  bool readRaw(std::size_t count, std::vector<std::uint8_t>& bytes)
  {
    if (count > text_.size()) return false;
    bytes.insert(bytes.end(), text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(count));
    text_.remove_prefix(count);
    return true;
  }

  std::string_view text_;
  bool base64_;
};

/** The next count header words. */
bool
readHeader(ByteSource& source, const VtpMarkup& markup, std::size_t count,
           std::vector<std::uint64_t>& words)
{
  const std::size_t size = markup.wide_headers ? 8 : 4;
  std::vector<std::uint8_t> bytes;
  if (!source.read(count * size, bytes)) return false;
  for (std::size_t i = 0; i < count; ++i) {
    std::uint64_t word = 0;
    for (std::size_t k = 0; k < size; ++k) {
      const std::size_t from = markup.big_endian ? k : size - 1 - k;
      word = word << 8 | bytes[i * size + from];
    }
    words.push_back(word);
  }
  return true;
}

/** Blocks packed by zlib: number of blocks, bytes of a block, bytes of the last one, packed sizes. */
bool
readPacked(std::string_view text, const VtpMarkup& markup, bool base64, std::size_t most,
           std::vector<std::uint8_t>& bytes)
{
  ByteSource peek(text, base64);
  std::vector<std::uint64_t> words;
  if (!readHeader(peek, markup, 3, words)) return false;
  const std::uint64_t blocks = words[0], block = words[1], last = words[2];
  if (blocks > text.size() || last > block || last > most) return false;
  const std::uint64_t whole = last > 0 && blocks > 0 ? blocks - 1 : blocks;
  if (whole > 0 && (block == 0 || whole > (most - last) / block)) return false;
  ByteSource source(text, base64);
  words.clear();
  if (!readHeader(source, markup, 3 + blocks, words)) return false;
  std::uint64_t packed_size = 0;
  for (std::size_t b = 0; b < blocks; ++b) {
    if (words[3 + b] > text.size()) return false;
    packed_size += words[3 + b];
  }
  std::vector<std::uint8_t> packed;
  if (packed_size > text.size() || !source.read(packed_size, packed)) return false;
  const std::uint8_t* at = packed.data();
  for (std::size_t b = 0; b < blocks; ++b) {
    const std::size_t size = b < whole ? block : last, begin = bytes.size();
    if (size > kMostCompression * (words[3 + b] + 1))
      return false;  // before memory is asked for it
    bytes.resize(begin + size);
    auto filled = static_cast<uLongf>(size);
    if (uncompress(bytes.data() + begin, &filled, at, static_cast<uLong>(words[3 + b])) != Z_OK ||
        filled != size) {
      return false;
    }
    at += words[3 + b];
  }
  return true;
}

std::string_view
trimmed(std::string_view text)
{
  const std::size_t begin = text.find_first_not_of(" \t\r\n");
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t\r\n") + 1 - begin);
}

Result<std::vector<std::uint8_t>>
readAsciiValues(const VtpArray& array, std::size_t count)
{
  TextScanner scanner(reinterpret_cast<const unsigned char*>(array.inline_data.data()),
                      array.inline_data.size());
  const std::size_t size = scalarSize(array.type);
  if (count > array.inline_data.size()) return damaged(array);
  std::vector<std::uint8_t> bytes(count * size);
  for (std::size_t i = 0; i < count; ++i) {
    const char *begin = nullptr, *end = nullptr;
    if (!scanner.nextWord(begin, end) ||
        !parseScalar(begin, end, array.type, bytes.data() + i * size)) {
      return damaged(array);
    }
  }
  return bytes;
}

}  // namespace

Result<std::vector<std::uint8_t>>
readVtpBytes(const VtpMarkup& markup, const VtpArray& array, std::size_t expected)
{
  const bool appended = array.format == VtpArray::Format::kAppended;
  const bool base64 = !appended || markup.appended_base64;
  std::string_view text = appended ? markup.appended : trimmed(array.inline_data);
  if (appended) {
    if (array.offset > text.size()) return damaged(array);
    text.remove_prefix(array.offset);
  }
  const std::size_t most = expected > 0 ? expected : kMostCompression * text.size();
  std::vector<std::uint8_t> bytes;
  if (markup.zlib) {
    if (!readPacked(text, markup, base64, most, bytes)) return damaged(array);
  } else {
    // Here header and data are one base64 stream.
    ByteSource peek(text, base64), source(text, base64);
    std::vector<std::uint64_t> words;
    const std::size_t header = markup.wide_headers ? 8 : 4;
    if (!readHeader(peek, markup, 1, words) || words[0] > most ||
        !source.read(header + words[0], bytes)) {
      return damaged(array);
    }
    bytes.erase(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(header));
  }
  if (expected > 0 && bytes.size() != expected) return damaged(array);
  return bytes;
}

Result<std::vector<std::uint8_t>>
readVtpValues(const VtpMarkup& markup, const VtpArray& array, std::size_t count)
{
  if (count == 0) return std::vector<std::uint8_t>();
  if (array.format == VtpArray::Format::kAscii) return readAsciiValues(array, count);
  const std::size_t size = scalarSize(array.type);
  auto bytes = readVtpBytes(markup, array, count * size);
  if (!bytes || !markup.big_endian) return bytes;
  for (std::size_t i = 0; i < count; ++i) swapBytes(bytes->data() + i * size, size);
  return bytes;
}

Result<std::vector<std::string>>
readVtpStrings(const VtpMarkup& markup, const VtpArray& array)
{
  std::vector<std::uint8_t> bytes;
  if (array.format == VtpArray::Format::kAscii) {
    TextScanner scanner(reinterpret_cast<const unsigned char*>(array.inline_data.data()),
                        array.inline_data.size());
    const char *begin = nullptr, *end = nullptr;
    while (scanner.nextWord(begin, end)) {
      std::uint8_t byte = 0;
      if (!parseScalar(begin, end, kUInt8, &byte)) return damaged(array);
      bytes.push_back(byte);
    }
  } else {
    auto read = readVtpBytes(markup, array, 0);
    if (!read) return read.error();
    bytes = std::move(*read);
  }
  std::vector<std::string> strings(1);
  for (const std::uint8_t byte : bytes) {
    if (byte == 0)
      strings.emplace_back();
    else
      strings.back().push_back(static_cast<char>(byte));
  }
  strings.pop_back();
  return strings;
}

}  // namespace pcl_slim
