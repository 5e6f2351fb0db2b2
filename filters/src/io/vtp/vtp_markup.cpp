// SPDX-License-Identifier: BSD-3-Clause
#include "io/vtp/vtp.h"

#include <algorithm>
#include <array>
#include <utility>

namespace pcl_slim {

namespace {

constexpr std::size_t kMostCompression = 1100;  ///< zlib packs a byte no denser than 1032 to 1

Error bad(const std::string& what) {
  return {ErrorCode::kBadInput, "the VTP file " + what + "; write it again"};
}

/** One tag: "<name a="b">", "</name>" or "<name/>". */
struct Tag {
  std::string_view name;
  std::vector<std::pair<std::string_view, std::string_view>> attributes;
  bool closes = false, empty = false;

  std::string_view operator[](std::string_view key) const {
    for (const auto& [name_of, value] : attributes) {
      if (name_of == key) return value;
    }
    return {};
  }
};

bool isSpace(char c) {
  return c == ' ' || c == '\n' || c == '\r' || c == '\t';
}

/** The text between "<" and ">", taken apart. */
Tag parseTag(std::string_view inside) {
  Tag tag;
  tag.closes = inside[0] == '/';
  if (tag.closes) inside.remove_prefix(1);
  tag.empty = !inside.empty() && inside.back() == '/';
  if (tag.empty) inside.remove_suffix(1);
  std::size_t i = 0;
  while (i < inside.size() && !isSpace(inside[i])) ++i;
  tag.name = inside.substr(0, i);
  for (;;) {
    while (i < inside.size() && isSpace(inside[i])) ++i;
    const std::size_t equals = inside.find('=', i);
    if (equals == std::string_view::npos || equals + 1 >= inside.size()) return tag;
    const char quote = inside[equals + 1];
    const std::size_t close = inside.find(quote, equals + 2);
    if ((quote != '"' && quote != '\'') || close == std::string_view::npos) return tag;
    tag.attributes.emplace_back(inside.substr(i, equals - i),
                                inside.substr(equals + 2, close - equals - 2));
    i = close + 1;
  }
}

/** The next tag that is neither a comment nor a declaration. \param[in,out] at where to look, then
 * behind the tag. false: none, or none that ends. */
bool nextTag(std::string_view text, std::size_t& at, Tag& tag) {
  for (;;) {
    at = text.find('<', at);
    if (at == std::string_view::npos) return false;
    const bool comment = text.compare(at, 4, "<!--") == 0;
    const std::size_t end = text.find(comment ? "-->" : ">", at);
    if (end == std::string_view::npos) return false;
    const std::string_view inside = text.substr(at + 1, end - at - 1);
    at = end + (comment ? 3 : 1);
    if (comment || inside.empty() || inside[0] == '?' || inside[0] == '!') continue;
    tag = parseTag(inside);
    return true;
  }
}

/** A count in an attribute; absent: the value it has. false: it is no number or more than the
 * limit. */
bool readCount(const Tag& tag, std::string_view key, std::size_t most, std::size_t& value) {
  const std::string_view text = tag[key];
  if (text.empty()) return true;
  std::uint64_t parsed = 0;
  if (!parseScalar(text.data(), text.data() + text.size(), kUInt64,
                   reinterpret_cast<std::uint8_t*>(&parsed)) ||
      parsed > most) {
    return false;
  }
  value = static_cast<std::size_t>(parsed);
  return true;
}

std::uint8_t typeOf(std::string_view name) {
  constexpr std::array<std::pair<const char*, std::uint8_t>, 10> kTypes{{{"Int8", kInt8},
                                                                         {"UInt8", kUInt8},
                                                                         {"Int16", kInt16},
                                                                         {"UInt16", kUInt16},
                                                                         {"Int32", kInt32},
                                                                         {"UInt32", kUInt32},
                                                                         {"Int64", kInt64},
                                                                         {"UInt64", kUInt64},
                                                                         {"Float32", kFloat32},
                                                                         {"Float64", kFloat64}}};
  for (const auto& [known, type] : kTypes) {
    if (name == known) return type;
  }
  return 0;
}

Error readFileTag(const Tag& tag, VtpMarkup& markup) {
  if (tag["type"] != "PolyData") return bad("holds no PolyData");
  const std::string_view order = tag["byte_order"], header = tag["header_type"];
  const std::string_view compressor = tag["compressor"];
  markup.big_endian = order == "BigEndian";
  markup.wide_headers = header == "UInt64";
  markup.zlib = compressor == "vtkZLibDataCompressor";
  if (!markup.big_endian && order != "LittleEndian") return bad("names no known byte order");
  if (!header.empty() && !markup.wide_headers && header != "UInt32")
    return bad("has headers of no known type");
  if (!compressor.empty() && !markup.zlib) {
    return bad("is compressed by '" + std::string(compressor) + "', not by zlib");
  }
  return {};
}

/** An array's tag, and its data where they follow it. */
Error readArray(const Tag& tag, std::string_view section, std::string_view text, std::size_t at,
                VtpMarkup& markup) {
  VtpArray array;
  array.section = section;
  array.name = tag["Name"];
  array.type = typeOf(tag["type"]);
  if (array.type == 0 && tag["type"] != "String") {
    return bad("has an array '" + array.name + "' of no known type");
  }
  const std::string_view format = tag["format"];
  using Format = VtpArray::Format;
  array.format = format == "appended" ? Format::kAppended
                 : format == "binary" ? Format::kBinary
                                      : Format::kAscii;
  if (array.format == Format::kAscii && !format.empty() && format != "ascii")
    return bad("has an array '" + array.name + "' of no known format");
  if (!readCount(tag, "NumberOfComponents", 1000, array.components) || array.components == 0 ||
      !readCount(tag, "NumberOfTuples", text.size() * kMostCompression, array.tuples) ||
      !readCount(tag, "offset", text.size(), array.offset)) {
    return bad("has an array '" + array.name + "' with a count that makes no sense");
  }
  if (!tag.empty) {
    const std::size_t end = text.find('<', at);
    array.inline_data = text.substr(at, end == std::string_view::npos ? 0 : end - at);
  }
  markup.arrays.push_back(std::move(array));
  return {};
}

/** \param[in] at behind the tag of AppendedData. */
Error readAppended(const Tag& tag, std::string_view text, std::size_t at, VtpMarkup& markup) {
  markup.appended_base64 = tag["encoding"] == "base64";
  if (!markup.appended_base64 && tag["encoding"] != "raw")
    return bad("has appended data of no known encoding");
  while (at < text.size() && isSpace(text[at])) ++at;
  const std::size_t end = text.rfind("</AppendedData>");
  if (at >= text.size() || text[at] != '_' || end == std::string_view::npos || end < at + 1)
    return bad("is truncated within its appended data");
  markup.appended = text.substr(at + 1, end - at - 1);
  return {};
}

/** What the tags read so far describe; see parseVtpMarkup(). */
class MarkupReader {
 public:
  explicit MarkupReader(std::string_view text) : text_(text) {}

  /** \param[in] at behind the tag */
  Error read(const Tag& tag, std::size_t at) {
    if (tag.closes) {
      if (tag.name == section_) section_ = {};
      return {};
    }
    if (tag.name == "VTKFile") {
      is_file_ = true;
      return readFileTag(tag, markup_);
    }
    if (tag.name == "Piece") return readPiece(tag);
    if (tag.name == "AppendedData") {
      ended_ = true;  // what follows is data, which may look like tags
      return readAppended(tag, text_, at, markup_);
    }
    if (tag.name == "DataArray" || tag.name == "Array") return readArrayTag(tag, at);
    beginSection(tag);
    return {};
  }

  bool ended() const { return ended_; }
  bool isFile() const { return is_file_; }
  VtpMarkup& markup() { return markup_; }

 private:
  Error readArrayTag(const Tag& tag, std::size_t at) {
    const std::string_view name = tag["Name"];
    if (std::any_of(name.begin(), name.end(), [](unsigned char c) { return c < ' '; }))
      return bad("has an array whose name has control characters");
    if (section_ == "CellData")
      markup_.left_out.push_back("array '" + std::string(name) + "' of its cells");
    const bool wanted = section_ == "FieldData" || section_ == "PointData" ||
                        section_ == "Points" || section_ == "Polys";
    return wanted ? readArray(tag, section_, text_, at, markup_) : Error{};
  }

  Error readPiece(const Tag& tag) {
    if (++pieces_ > 1) return bad("has several pieces: merge them first");
    std::size_t lines = 0, strips = 0;
    const std::pair<const char*, std::size_t*> counts[] = {{"NumberOfPoints", &markup_.points},
                                                           {"NumberOfPolys", &markup_.polygons},
                                                           {"NumberOfLines", &lines},
                                                           {"NumberOfStrips", &strips}};
    for (const auto& [name, count] : counts) {
      if (!readCount(tag, name, text_.size() * kMostCompression, *count))
        return bad("has a " + std::string(name) + " that makes no sense");
    }
    if (lines > 0) markup_.left_out.push_back("element 'Lines'");
    if (strips > 0) markup_.left_out.push_back("element 'Strips'");
    return {};
  }

  void beginSection(const Tag& tag) {
    for (const char* name :
         {"FieldData", "PointData", "CellData", "Points", "Verts", "Lines", "Strips", "Polys"}) {
      if (tag.name == name && !tag.empty) section_ = tag.name;
    }
    if (tag.name == "PointData") markup_.normals = tag["Normals"];
  }

  std::string_view text_, section_;
  VtpMarkup markup_;
  std::size_t pieces_ = 0;
  bool is_file_ = false, ended_ = false;
};

}  // namespace

Result<VtpMarkup> parseVtpMarkup(std::string_view text) {
  MarkupReader reader(text);
  Tag tag;
  for (std::size_t at = 0; !reader.ended() && nextTag(text, at, tag);) {
    if (Error error = reader.read(tag, at)) return error;
  }
  if (!reader.isFile()) return badInput("it is no VTK XML file; name a .vtp file");
  if (text.find("</VTKFile>") == std::string_view::npos) {
    return badInput("the VTP file is truncated; copy it again");
  }
  return std::move(reader.markup());
}

}  // namespace pcl_slim
