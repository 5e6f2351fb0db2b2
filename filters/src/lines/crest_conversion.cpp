// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <cstring>

#include "io/scalar_type.h"
#include "pcl_slim/filters/io/crest_files.h"
#include "pcl_slim/filters/point_crest.h"

namespace pcl_slim {

namespace {

constexpr double kFloatStep = 0x1p-23;  ///< distance of neighbouring floats over their size
constexpr double kShareOfStep = 1e-3;

const char* const kColumns[] = {
    "x",         "y",  "z",  "normal_x",     "normal_y", "normal_z", "tangent_x", "tangent_y",
    "tangent_z", "k1", "k2", "significance", "strength", "type",     "line"};
constexpr std::size_t kWholeNumbers = 2;  ///< of the columns, the last ones
constexpr std::size_t kNumColumns = sizeof(kColumns) / sizeof(kColumns[0]);

/** Whether float keeps vertices where they are. */
bool
floatsSuffice(const CrestLines& lines)
{
  double farthest = 0, length = 0;
  for (const auto& p : lines.position) {
    for (const double value : p) farthest = std::max(farthest, std::abs(value));
  }
  for (const double l : lines.length) length += l;
  const double step = length / static_cast<double>(std::max<std::size_t>(lines.numVertices(), 1));
  return farthest * kFloatStep <= kShareOfStep * step;
}

template <typename T>
void
put(std::uint8_t*& at, T value)
{
  std::memcpy(at, &value, sizeof(value));
  at += sizeof(value);
}

/** Everything behind a vertex's coordinates. */
void
putRest(const CrestLines& lines, std::size_t line, std::size_t v, std::uint8_t*& at)
{
  for (const auto* vector : {&lines.normal[v], &lines.tangent[v]}) {
    for (const float value : *vector) put(at, value);
  }
  put(at, lines.k1[v]);
  put(at, lines.k2[v]);
  put(at, lines.significance[v]);
  put(at, static_cast<float>(lines.strength[line]));
  put(at, static_cast<std::uint32_t>(lines.type[line]));
  put(at, static_cast<std::uint32_t>(line));
}

}  // namespace

void
toPointCloud(const CrestLines& lines, pcl::PointCloud<PointCrest>& cloud)
{
  cloud = pcl::PointCloud<PointCrest>();
  cloud.reserve(lines.numVertices());
  for (std::size_t line = 0; line < lines.numLines(); ++line) {
    for (std::uint32_t v = lines.line_begin[line]; v < lines.line_begin[line + 1]; ++v) {
      PointCrest p;
      for (std::size_t a = 0; a < 3; ++a) {
        p.data[a] = static_cast<float>(lines.position[v][a]);
        p.data_n[a] = lines.normal[v][a];
      }
      p.tangent_x = lines.tangent[v][0];
      p.tangent_y = lines.tangent[v][1];
      p.tangent_z = lines.tangent[v][2];
      p.k1 = lines.k1[v];
      p.k2 = lines.k2[v];
      p.significance = lines.significance[v];
      p.strength = static_cast<float>(lines.strength[line]);
      p.type = static_cast<std::uint32_t>(lines.type[line]);
      p.line = static_cast<std::uint32_t>(line);
      cloud.push_back(p);
    }
  }
}

PointFile
toPointFile(const CrestLines& lines)
{
  PointFile file;
  pcl::PCLPointCloud2& cloud = file.cloud;
  const bool narrow = floatsSuffice(lines);
  for (std::size_t c = 0; c < kNumColumns; ++c) {
    const bool whole = c + kWholeNumbers >= kNumColumns;
    addField(cloud, kColumns[c], c < 3 && !narrow ? kFloat64 : whole ? kUInt32 : kFloat32);
  }
  cloud.width = static_cast<pcl::uindex_t>(lines.numVertices());
  cloud.height = 1;
  cloud.row_step = cloud.point_step * cloud.width;
  cloud.data.resize(static_cast<std::size_t>(cloud.point_step) * cloud.width);
  std::uint8_t* at = cloud.data.data();
  for (std::size_t line = 0; line < lines.numLines(); ++line) {
    for (std::uint32_t v = lines.line_begin[line]; v < lines.line_begin[line + 1]; ++v) {
      for (const double value : lines.position[v]) {
        if (narrow)
          put(at, static_cast<float>(value));
        else
          put(at, value);
      }
      putRest(lines, line, v, at);
    }
  }
  return file;
}

}  // namespace pcl_slim
