// SPDX-License-Identifier: BSD-3-Clause
#include "io/ply/ply_header.h"

#include <algorithm>
#include <sstream>
#include <unordered_set>

#include "io/scalar_type.h"

namespace pcl_slim {

namespace {

struct TypeName {
  const char *old_name, *new_name;
  std::uint8_t type;
};

constexpr TypeName kTypeNames[] = {{"char", "int8", kInt8},        {"uchar", "uint8", kUInt8},
                                   {"short", "int16", kInt16},     {"ushort", "uint16", kUInt16},
                                   {"int", "int32", kInt32},       {"uint", "uint32", kUInt32},
                                   {"float", "float32", kFloat32}, {"double", "float64", kFloat64}};

std::uint8_t
typeByName(const std::string& name)
{
  for (const TypeName& entry : kTypeNames) {
    if (name == entry.old_name || name == entry.new_name) return entry.type;
  }
  return 0;
}

const char*
nameOfType(std::uint8_t type)
{
  for (const TypeName& entry : kTypeNames) {
    if (type == entry.type) return entry.old_name;
  }
  return "";
}

bool
parseFormat(const std::vector<std::string>& words, PlyForm& form)
{
  if (words.size() != 3) return false;
  if (words[1] == "ascii")
    form = PlyForm::kAscii;
  else if (words[1] == "binary_little_endian")
    form = PlyForm::kLittleEndian;
  else if (words[1] == "binary_big_endian")
    form = PlyForm::kBigEndian;
  else
    return false;
  return true;
}

bool
parseElement(const std::vector<std::string>& words, PlyHeader& header)
{
  std::uint64_t count = 0;
  if (words.size() != 3) return false;
  if (!parseScalar(words[2].data(), words[2].data() + words[2].size(), kUInt64,
                   reinterpret_cast<std::uint8_t*>(&count))) {
    return false;
  }
  header.elements.push_back({words[1], static_cast<std::size_t>(count), {}});
  return true;
}

bool
parseProperty(const std::vector<std::string>& words, PlyHeader& header)
{
  if (header.elements.empty()) return false;
  PlyProperty property;
  if (words.size() == 5 && words[1] == "list") {
    property = {words[4], typeByName(words[3]), typeByName(words[2])};
    if (property.list_type == 0) return false;
  } else if (words.size() == 3) {
    property = {words[2], typeByName(words[1]), 0};
  }
  if (property.type == 0) return false;
  header.elements.back().properties.push_back(property);
  return true;
}

/** One line after the first. false: it makes no sense. */
bool
parseLine(const std::string& line, PlyHeader& header)
{
  const std::vector<std::string> words = splitWords(line);
  if (words.empty() || words[0] == "obj_info") return true;
  if (words[0] == "comment") {
    const std::size_t text = line.find_first_not_of(" \t", line.find("comment") + 7);
    header.comments.push_back(text == std::string::npos ? "" : line.substr(text));
    return true;
  }
  if (words[0] == "format") return parseFormat(words, header.form);
  if (words[0] == "element") return parseElement(words, header);
  return words[0] == "property" && parseProperty(words, header);
}

/** What is there twice would be read over itself. */
Error
checkElements(const std::vector<PlyElement>& elements)
{
  std::unordered_set<std::string> names;
  for (const PlyElement& element : elements) {
    const auto& properties = element.properties;
    if (std::count_if(properties.begin(), properties.end(), isFaceList) > 1) {
      return badInput("the PLY header lists the vertices of a '" + element.name +
                      "' twice; keep one list");
    }
    if (!names.insert(element.name).second) {
      return badInput("the PLY header has two elements '" + element.name + "'; keep one");
    }
  }
  return {};
}

}  // namespace

bool
isFaceList(const PlyProperty& property)
{
  return property.list_type != 0 &&
         (property.name == "vertex_indices" || property.name == "vertex_index");
}

Error
parsePlyHeader(const std::vector<unsigned char>& bytes, PlyHeader& header)
{
  TextScanner scanner(bytes.data(), bytes.size());
  std::string line;
  if (!scanner.nextLine(line) || splitWords(line) != std::vector<std::string>{"ply"}) {
    return badInput("not a PLY file: it does not start with 'ply'; name a PLY file");
  }
  for (int number = 2; scanner.nextLine(line); ++number) {
    if (splitWords(line) == std::vector<std::string>{"end_header"}) {
      header.size = scanner.position();
      return checkElements(header.elements);
    }
    if (!parseLine(line, header)) {
      return badInput("line " + std::to_string(number) +
                      " is not part of a PLY header: mend it, or write the file again");
    }
  }
  return badInput("the PLY file is truncated inside its header; copy it again");
}

std::string
formatPlyHeader(const std::vector<std::string>& comments, const std::vector<PlyColumn>& columns,
                std::size_t num_points, std::size_t num_faces, bool long_faces)
{
  std::string out = "ply\nformat binary_little_endian 1.0\n";
  for (const std::string& comment : comments) out += "comment " + comment + "\n";
  out += "element vertex " + std::to_string(num_points) + "\n";
  for (const PlyColumn& column : columns) {
    out += "property " + std::string(nameOfType(column.type)) + " " + column.name + "\n";
  }
  if (num_faces > 0) {
    out += "element face " + std::to_string(num_faces) + "\nproperty list " +
           (long_faces ? "uint" : "uchar") + " int vertex_indices\n";
  }
  return out + "end_header\n";
}

}  // namespace pcl_slim
