// SPDX-License-Identifier: BSD-3-Clause
// Clouds of 3D Gaussian splatting (Kerbl et al. 2023): coloured points from fields of their own.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "io/point_formats.h"

namespace pcl_slim {

namespace {

std::string formatShort(double value) {
  char text[40];
  std::snprintf(text, sizeof(text), "%.4g", value);
  return text;
}

constexpr double kHarmonic =
    0.28209479177387814;  ///< the constant spherical harmonic, 1 / sqrt(4 pi)

/** The byte of a channel: what a splat shows from all sides, without what depends on the direction. */
std::uint8_t byteOf(double coefficient) {
  const double share = 0.5 + kHarmonic * coefficient;
  return share > 0 ? static_cast<std::uint8_t>(std::lround(255 * std::min(share, 1.0)))
                   : std::uint8_t{0};
}

/** Opacity is stored before the sigmoid that keeps it between 0 and 1. */
double opacityOf(double stored) {
  return 1 / (1 + std::exp(-stored));
}

}  // namespace

bool hasSplatFields(const std::vector<std::string>& names) {
  const auto has = [&names](const char* name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  return has("f_dc_0") && has("f_dc_1") && has("f_dc_2") && has("opacity");
}

void adoptSplats(double min_opacity, PointFile& file) {
  PointTable& cloud = file.cloud;
  std::vector<std::string> names;
  for (const PointField& field : cloud.fields) names.push_back(field.name);
  if (!hasSplatFields(names) || file.numFaces() > 0) return;
  const auto fieldOf = [&cloud](const char* name) {
    return cloud.fields[static_cast<std::size_t>(findField(cloud, name))];
  };
  const PointField opacity = fieldOf("opacity");
  const PointField channels[3] = {fieldOf("f_dc_2"), fieldOf("f_dc_1"), fieldOf("f_dc_0")};
  const bool colored =
      findField(cloud, "rgb") >= 0 || findField(cloud, "rgba") >= 0 || findField(cloud, "red") >= 0;
  PointTable kept;
  kept.fields = cloud.fields;
  kept.point_step = cloud.point_step;
  if (!colored) addField(kept, "rgb", kFloat32);
  std::size_t left_out = 0;
  for (std::size_t i = 0; i < numPoints(cloud); ++i) {
    if (opacityOf(fieldValue(cloud, i, opacity)) < min_opacity) {
      ++left_out;
      continue;
    }
    const std::uint8_t* row = cloud.data.data() + i * cloud.point_step;
    kept.data.insert(kept.data.end(), row, row + cloud.point_step);
    if (colored) continue;
    for (const PointField& channel : channels)
      kept.data.push_back(byteOf(fieldValue(cloud, i, channel)));
    kept.data.push_back(0);
  }
  kept.width = static_cast<std::uint32_t>(numPoints(cloud) - left_out);
  cloud = std::move(kept);
  std::string note = "3D Gaussian splats: ";
  note += colored ? "colours are the file's own" : "colours from f_dc_0 f_dc_1 f_dc_2";
  if (min_opacity > 0) {
    note += "; " + std::to_string(left_out) + " of opacity below " + formatShort(min_opacity) +
            " left out (-min_opacity)";
  }
  file.notes.push_back(note);
}

}  // namespace pcl_slim
