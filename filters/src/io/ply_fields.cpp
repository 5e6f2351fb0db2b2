// SPDX-License-Identifier: BSD-3-Clause
// Fields of a cloud as PLY's properties, and back: normals and colours have names of their own.
#include <algorithm>
#include <cstring>
#include <unordered_set>

#include "io/ply_file.h"
#include "io/point_formats.h"

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
int findByte(const PointTable& cloud, const char* name) {
  const int i = findField(cloud, name);
  return i >= 0 && cloud.fields[static_cast<std::size_t>(i)].datatype == kUInt8 ? i : -1;
}

/** Fields of a cloud whose colour bytes, listed in channel, become one field in the place of red.
 */
PointTable packedLayout(const PointTable& cloud, const int (&channel)[4],
                        std::vector<std::size_t>& sources) {
  PointTable packed;
  for (int i = 0; i < static_cast<int>(cloud.fields.size()); ++i) {
    if (i != channel[0] && std::find(channel, channel + 4, i) != channel + 4) continue;
    const PointField& field = cloud.fields[static_cast<std::size_t>(i)];
    sources.push_back(field.offset);
    if (i != channel[0])
      addField(packed, field.name, field.datatype);
    else if (channel[3] >= 0)
      addField(packed, "rgba", kUInt32);
    else
      addField(packed, "rgb", kFloat32);
  }
  packed.resize(numPoints(cloud));
  return packed;
}

/** Replaces the colour bytes by one field of PCL's: blue, green, red, alpha in memory. */
void packColour(PointTable& cloud, const int (&channel)[4]) {
  std::vector<std::size_t> sources;
  PointTable packed = packedLayout(cloud, channel, sources);
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

}  // namespace

void adoptPclFields(PointTable& cloud) {
  adoptCapitals(cloud);
  for (PointField& field : cloud.fields) {
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

namespace {

/** PLY's name of a field, by which readers find normals. */
std::string plyNameOf(const PointField& field) {
  for (std::size_t i = 0; i < kNumNormalRenames; ++i) {
    if (field.name == kRenames[i].pcl) return kRenames[i].ply;
  }
  return field.name;
}

/** The names by which readers find a cloud's colour and normals. */
std::unordered_set<std::string> takenNames(const PointTable& cloud, const PointField* colour) {
  std::unordered_set<std::string> taken;
  if (colour) taken = {"red", "green", "blue", "alpha", "rgb", "rgba"};
  for (const PointField& field : cloud.fields) {
    if (const std::string name = plyNameOf(field); name != field.name) taken.insert(name);
  }
  return taken;
}

}  // namespace

Error plyColumns(const PointTable& cloud, std::vector<PlyColumn>& columns) {
  const auto packed = std::find_if(cloud.fields.begin(), cloud.fields.end(), isPackedColor);
  const PointField* const colour = packed == cloud.fields.end() ? nullptr : &*packed;
  std::unordered_set<std::string> taken = takenNames(cloud, colour);
  for (const PointField& field : cloud.fields) {
    if (&field == colour) {
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
    const std::string ply = plyNameOf(field);
    for (std::size_t k = 0; k < std::max<std::size_t>(field.count, 1); ++k) {
      std::string name = field.count > 1 ? ply + "_" + std::to_string(k) : ply;
      const bool is_normal = ply != field.name && field.count <= 1;
      while (!is_normal && !taken.insert(name).second) name += '_';
      columns.push_back({name, type, field.offset + k * scalarSize(type)});
    }
  }
  return {};
}

}  // namespace pcl_slim
