// SPDX-License-Identifier: BSD-3-Clause
#include "io/ply/ply_header.h"

#include <algorithm>
#include <cstring>
#include <sstream>
#include <unordered_set>

#include "io/scalar_type.h"
#include "pcl_slim/filters/io/point_file.h"

namespace pcl_slim {

namespace {

struct Rename {
  const char *ply, *pcl;
};

constexpr Rename kRenames[] = {{"nx", "normal_x"},         {"ny", "normal_y"},
                               {"nz", "normal_z"},         {"diffuse_red", "red"},
                               {"diffuse_green", "green"}, {"diffuse_blue", "blue"}};
constexpr std::size_t kNumNormalRenames = 3;

/** Index of a byte-valued field, or -1. */
int
findByte(const pcl::PCLPointCloud2& cloud, const char* name)
{
  const int i = findField(cloud, name);
  return i >= 0 && cloud.fields[static_cast<std::size_t>(i)].datatype == kUInt8 ? i : -1;
}

/** Fields of a cloud whose colour bytes, listed in channel, become one field in the place of red. */
pcl::PCLPointCloud2
packedLayout(const pcl::PCLPointCloud2& cloud, const int (&channel)[4],
             std::vector<std::size_t>& sources)
{
  pcl::PCLPointCloud2 packed;
  packed.width = cloud.width;
  packed.height = cloud.height;
  std::size_t step = 0;
  for (int i = 0; i < static_cast<int>(cloud.fields.size()); ++i) {
    if (i != channel[0] && std::find(channel, channel + 4, i) != channel + 4) continue;
    pcl::PCLPointField field = cloud.fields[static_cast<std::size_t>(i)];
    sources.push_back(field.offset);
    field.offset = static_cast<pcl::uindex_t>(step);
    if (i == channel[0]) {
      field.name = channel[3] >= 0 ? "rgba" : "rgb";
      field.datatype = channel[3] >= 0 ? kUInt32 : kFloat32;
    }
    packed.fields.push_back(field);
    step += scalarSize(field.datatype);
  }
  packed.point_step = static_cast<pcl::uindex_t>(step);
  packed.row_step = static_cast<pcl::uindex_t>(step * cloud.width);
  packed.data.resize(step * numPoints(cloud));
  return packed;
}

/** Replaces the colour bytes by one field of PCL's: blue, green, red, alpha in memory. */
void
packColour(pcl::PCLPointCloud2& cloud, const int (&channel)[4])
{
  std::vector<std::size_t> sources;
  pcl::PCLPointCloud2 packed = packedLayout(cloud, channel, sources);
  std::size_t from_channel[4] = {};
  for (int k = 0; k < 4; ++k) {
    if (channel[k] >= 0)
      from_channel[k] = cloud.fields[static_cast<std::size_t>(channel[k])].offset;
  }
  const std::string colour = channel[3] >= 0 ? "rgba" : "rgb";
  for (std::size_t p = 0; p < numPoints(cloud); ++p) {
    const std::uint8_t* from = cloud.data.data() + p * cloud.point_step;
    std::uint8_t* to = packed.data.data() + p * packed.point_step;
    for (std::size_t f = 0; f < packed.fields.size(); ++f) {
      std::uint8_t* at = to + packed.fields[f].offset;
      if (packed.fields[f].name == colour) {
        for (int k = 0; k < 3; ++k) at[2 - k] = from[from_channel[k]];
        at[3] = channel[3] >= 0 ? from[from_channel[3]] : std::uint8_t{0};
      } else {
        std::memcpy(at, from + sources[f], scalarSize(packed.fields[f].datatype));
      }
    }
  }
  cloud = std::move(packed);
}

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

/** A property that occurs twice would overwrite itself. */
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

void
adoptPclFields(pcl::PCLPointCloud2& cloud)
{
  for (pcl::PCLPointField& field : cloud.fields) {
    for (const Rename& rename : kRenames) {
      if (field.name == rename.ply && findField(cloud, rename.pcl) < 0) field.name = rename.pcl;
    }
  }
  const int channel[4] = {findByte(cloud, "red"), findByte(cloud, "green"), findByte(cloud, "blue"),
                          findByte(cloud, "alpha")};
  const bool has_packed = findField(cloud, "rgb") >= 0 || findField(cloud, "rgba") >= 0;
  if (channel[0] >= 0 && channel[1] >= 0 && channel[2] >= 0 && !has_packed) {
    packColour(cloud, channel);
  }
}

Error
plyColumns(const pcl::PCLPointCloud2& cloud, std::vector<PlyColumn>& columns)
{
  for (const pcl::PCLPointField& field : cloud.fields) {
    if ((field.name == "rgb" || field.name == "rgba") && scalarSize(field.datatype) == 4) {
      // In memory PCL's colour is blue, green, red, alpha.
      columns.push_back({"red", kUInt8, field.offset + 2u});
      columns.push_back({"green", kUInt8, field.offset + 1u});
      columns.push_back({"blue", kUInt8, field.offset + 0u});
      if (field.name == "rgba") columns.push_back({"alpha", kUInt8, field.offset + 3u});
      continue;
    }
    std::uint8_t type = field.datatype == kBool ? std::uint8_t{kUInt8} : field.datatype;
    if (scalarSize(type) == 0 || type == kInt64 || type == kUInt64) {
      return {ErrorCode::kBadArgument,
              "PLY has no type for the field '" + field.name + "'; write a PCD file instead"};
    }
    std::string name = field.name;
    for (std::size_t i = 0; i < kNumNormalRenames; ++i) {
      if (name == kRenames[i].pcl) name = kRenames[i].ply;
    }
    for (std::size_t k = 0; k < std::max<std::size_t>(field.count, 1); ++k) {
      const std::string suffix = field.count > 1 ? "_" + std::to_string(k) : "";
      columns.push_back({name + suffix, type, field.offset + k * scalarSize(type)});
    }
  }
  return {};
}

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
