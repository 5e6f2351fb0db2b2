// SPDX-License-Identifier: BSD-3-Clause
#include "io/surface/color_fields.h"

#include <cmath>
#include <cstring>

#include "io/scalar_type.h"
#include "pcl_slim/filters/io/point_file.h"
#include "pcl_slim/surface/surfel_color.h"

namespace pcl_slim {

namespace {

const char* const kChannels[3] = {"red_", "green_", "blue_"};

/** "red_uv": the field of a term other than the first. */
std::string
nameOfTerm(std::size_t k, std::size_t channel)
{
  int degree = 1;
  auto place = static_cast<int>(k) - 1;
  while (place > degree) place -= ++degree;
  const auto power_of_v = static_cast<std::size_t>(place);
  return kChannels[channel] + std::string(static_cast<std::size_t>(degree) - power_of_v, 'u') +
         std::string(power_of_v, 'v');
}

/** A field of colours packed into four bytes, or null. */
const pcl::PCLPointField*
packedField(const pcl::PCLPointCloud2& cloud)
{
  for (const char* name : {"rgb", "rgba"}) {
    const int i = findField(cloud, name);
    if (i < 0) continue;
    const pcl::PCLPointField& field = cloud.fields[static_cast<std::size_t>(i)];
    if (scalarSize(field.datatype) == 4) return &field;
  }
  return nullptr;
}

}  // namespace

void
addColorFields(pcl::PCLPointCloud2& cloud)
{
  addField(cloud, "rgb", kFloat32);
  for (std::size_t k = 1; k < ColorPolynomial().size(); ++k) {
    for (std::size_t c = 0; c < 3; ++c) addField(cloud, nameOfTerm(k, c), kFloat32);
  }
}

std::vector<float>
colorValues(const SLIMSurface& surface, std::size_t i)
{
  const std::uint8_t* bytes = surface.colors.data() + i * kColorBytes;
  const ColorPolynomial color = decodeColor(bytes);
  const std::uint8_t bgra[4] = {bytes[2], bytes[1], bytes[0], 0};
  std::vector<float> values(1);
  std::memcpy(values.data(), bgra, sizeof(bgra));
  for (std::size_t k = 1; k < color.size(); ++k)
    values.insert(values.end(), color[k].begin(), color[k].end());
  return values;
}

void
takeColors(const pcl::PCLPointCloud2& cloud, SLIMSurface& surface)
{
  const pcl::PCLPointField* packed = packedField(cloud);
  if (!packed) return;
  std::vector<std::uint8_t> bytes(surface.size() * kColorBytes);
  ColorPolynomial color{};
  std::array<std::array<int, 3>, ColorPolynomial().size()> fields{};
  for (std::size_t k = 1; k < color.size(); ++k) {
    for (std::size_t c = 0; c < 3; ++c) fields[k][c] = findField(cloud, nameOfTerm(k, c));
  }
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const std::uint8_t* bgr = cloud.data.data() + i * cloud.point_step + packed->offset;
    for (std::size_t c = 0; c < 3; ++c) color[0][c] = bgr[2 - c];
    for (std::size_t k = 1; k < color.size(); ++k) {
      for (std::size_t c = 0; c < 3; ++c) {
        const int f = fields[k][c];
        const double value =
            f < 0 ? 0.0 : fieldValue(cloud, i, cloud.fields[static_cast<std::size_t>(f)]);
        color[k][c] = std::isfinite(value) ? static_cast<float>(value) : 0.0f;
      }
    }
    encodeColor(color, bytes.data() + i * kColorBytes);
  }
  surface.colors = std::move(bytes);
}

}  // namespace pcl_slim
