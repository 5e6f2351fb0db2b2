// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>
#include <vector>

#include "io/point_formats.h"
#include "io/trim_fields.h"
#include "pcl_slim/cloud/store_frame.h"
#include "pcl_slim/core/base64.h"
#include "pcl_slim/filters/io/surface_files.h"
#include "pcl_slim/surface/surface.h"
#include "pcl_slim/surface/surfel_color.h"

namespace pcl_slim {

namespace {

constexpr int kTrimSide = 8;               ///< nodes a side of the trim maps that points carry
constexpr std::size_t kBytesOfLine = 300;  ///< a multiple of 3: 400 characters of base64
const std::string kTrimLine = "pcl_slim trim_maps ";
const std::string kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

/** Appends what base64() made text of. false: it is none. */
bool addBytes(const std::string& text, std::vector<std::uint8_t>& bytes) {
  if (text.size() % 4 != 0) return false;
  for (std::size_t i = 0; i < text.size(); i += 4) {
    std::uint32_t group = 0;
    std::size_t count = 3;
    for (std::size_t k = 0; k < 4; ++k) {
      const std::size_t digit = kDigits.find(text[i + k]);
      if (digit == std::string::npos && text[i + k] != '=') return false;
      if (digit == std::string::npos && count > 0) --count;
      group = group << 6 | static_cast<std::uint32_t>(digit & 63);
    }
    for (std::size_t k = 0; k < count; ++k)
      bytes.push_back(static_cast<std::uint8_t>(group >> (16 - 8 * k)));
  }
  return true;
}

/** Sets the maps from bytes that contain them one after another, as SLIMSurface::trim_maps does.
 * false: they are not those of the surface's open surfels. */
bool setMaps(const std::vector<std::uint8_t>& bytes, SLIMSurface& surface) {
  std::vector<std::uint8_t> sides(surface.size()), bits;
  std::size_t at = 0;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    if (!surface.isOpen(i)) continue;
    const int side = at < bytes.size() ? bytes[at++] : 0;
    const std::size_t count = TrimMap::numBytes(side);
    if (side < TrimMap::kLeastSide || side > TrimMap::kMostSide || bytes.size() - at < count)
      return false;
    sides[i] = static_cast<std::uint8_t>(side);
    const auto first = bytes.begin() + static_cast<std::ptrdiff_t>(at);
    bits.insert(bits.end(), first, first + static_cast<std::ptrdiff_t>(count));
    at += count;
  }
  if (at != bytes.size()) return false;
  surface.setTrimMaps(sides, bits);
  return true;
}

bool isOfCoarseSide(const SLIMSurface& surface, std::size_t i) {
  return !surface.isOpen(i) || surface.trimMap(i).side == kTrimSide;
}

/** \brief A surfel's trim map brought to 8 x 8 nodes, row by row, lowest bit first; 0 if it is
 * closed. */
std::array<std::uint32_t, 2> coarseTrimMap(const SLIMSurface& surface, std::size_t i) {
  std::array<std::uint32_t, 2> bits{};
  if (!surface.isOpen(i)) return bits;
  const TrimMap map = surface.trimMap(i);
  const auto coordinate = [](int node) { return 2.0 * node / (kTrimSide - 1) - 1.0; };
  for (int k = 0; k < kTrimSide * kTrimSide; ++k) {
    const int column = k % kTrimSide, row = k / kTrimSide;
    const bool inside = map.side == kTrimSide
                            ? map.at(column, row)
                            : outsideShare(map, coordinate(column), coordinate(row)) <= 0.5;
    bits[static_cast<std::size_t>(k >> 5)] |= static_cast<std::uint32_t>(inside) << (k & 31);
  }
  return bits;
}

/** \brief Gives the open surfels maps of 8 x 8 nodes. \param[in] maps one for each surfel */
void setCoarseTrimMaps(const std::vector<std::array<std::uint32_t, 2>>& maps,
                       SLIMSurface& surface) {
  std::vector<std::uint8_t> sides(surface.size()), bits;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    if (!surface.isOpen(i)) continue;
    sides[i] = kTrimSide;
    for (const std::uint32_t half : maps[i]) {
      for (int byte = 0; byte < 4; ++byte)
        bits.push_back(static_cast<std::uint8_t>(half >> 8 * byte));
    }
  }
  surface.setTrimMaps(sides, bits);
}

}  // namespace

void addTrimComments(const SLIMSurface& surface, std::vector<std::string>& comments) {
  bool exact = true;
  for (std::size_t i = 0; exact && i < surface.size(); ++i) exact = isOfCoarseSide(surface, i);
  if (exact) return;
  const std::vector<std::uint8_t>& maps = surface.trim_maps;
  for (std::size_t i = 0; i < maps.size(); i += kBytesOfLine)
    comments.push_back(kTrimLine +
                       base64(maps.data() + i, std::min(kBytesOfLine, maps.size() - i)));
}

void takeTrimComments(const std::vector<std::string>& comments, SLIMSurface& surface) {
  std::vector<std::uint8_t> bytes;
  for (const std::string& comment : comments) {
    if (comment.compare(0, kTrimLine.size(), kTrimLine) != 0) continue;
    if (!addBytes(comment.substr(kTrimLine.size()), bytes)) return;
  }
  if (bytes.empty() || !surface.hasTrimMaps()) return;
  SLIMSurface full = surface;
  if (!setMaps(bytes, full)) return;
  for (std::size_t i = 0; i < full.size(); ++i) {
    if (coarseTrimMap(full, i) != coarseTrimMap(surface, i)) return;
  }
  surface = std::move(full);
}

namespace {

const char* const kChannels[3] = {"red_", "green_", "blue_"};

/** "red_uv": the field of a term other than the first. */
std::string nameOfTerm(std::size_t k, std::size_t channel) {
  int degree = 1;
  auto place = static_cast<int>(k) - 1;
  while (place > degree) place -= ++degree;
  const auto power_of_v = static_cast<std::size_t>(place);
  return kChannels[channel] + std::string(static_cast<std::size_t>(degree) - power_of_v, 'u') +
         std::string(power_of_v, 'v');
}

/** A field of colours packed into four bytes, or null. */
const PointField* packedField(const PointTable& cloud) {
  for (const char* name : {"rgb", "rgba"}) {
    const int i = findField(cloud, name);
    if (i < 0) continue;
    const PointField& field = cloud.fields[static_cast<std::size_t>(i)];
    if (scalarSize(field.datatype) == 4) return &field;
  }
  return nullptr;
}

/** \brief Adds the fields of a coloured surface's colours to an empty cloud: rgb, packed as PCL
 * packs it, at the surfels' centres, then the other terms of surfel_color.h, red_u green_u blue_u
 * red_v ... red_uu ..., in 1/255 of white. */
void addColorFields(PointTable& cloud) {
  addField(cloud, "rgb", kFloat32);
  for (std::size_t k = 1; k < ColorPolynomial().size(); ++k) {
    for (std::size_t c = 0; c < 3; ++c) addField(cloud, nameOfTerm(k, c), kFloat32);
  }
}

/** \brief Values of the fields of surfel i, 4 bytes each in the order of addColorFields(). */
std::vector<float> colorValues(const SLIMSurface& surface, std::size_t i) {
  const std::uint8_t* bytes = surface.colors.data() + i * kColorBytes;
  const ColorPolynomial color = decodeColor(bytes);
  const std::uint8_t bgra[4] = {bytes[2], bytes[1], bytes[0], 0};
  std::vector<float> values(1);
  std::memcpy(values.data(), bgra, sizeof(bgra));
  for (std::size_t k = 1; k < color.size(); ++k)
    values.insert(values.end(), color[k].begin(), color[k].end());
  return values;
}

/** \brief Reads the colours of a cloud of surfels into their surface; terms whose field is missing
 * are 0. A cloud without a field rgb or rgba has none. O(surfels). */
void takeColors(const PointTable& cloud, SLIMSurface& surface) {
  const PointField* packed = packedField(cloud);
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

constexpr int kFieldsBeforeCoefficients = 7;
constexpr int kFieldsAfterCoefficients = 5;
const char* const kFieldsBefore[kFieldsBeforeCoefficients] = {
    "x", "y", "z", "normal_x", "normal_y", "normal_z", "radius"};
const char* const kFieldsAfter[kFieldsAfterCoefficients] = {"degree", "level", "leaf", "error",
                                                            "confidence"};

const char* const kTrimFields[2] = {"trim_low", "trim_high"};

/** A surfel with its fields in world units. */
struct SurfelPoint {
  float x = 0, y = 0, z = 0;
  float normal_x = 0, normal_y = 0, normal_z = 0;
  float radius = 0;
  float c[kMaxCoefficients] = {};  ///< those beyond the degree are 0
  float degree = 1, level = 1, leaf = 1, error = 0, confidence = 0;
  std::uint32_t trim_low = 0, trim_high = 0;
};

double toLocal(float value, int axis, const SurfaceMetadata& metadata) {
  const auto a = static_cast<std::size_t>(axis);
  return (value + (metadata.shift[a] - metadata.info.origin[a])) / metadata.info.scale;
}

/** Whether every centre survives the way into float world coordinates less the shift and back. */
bool exactInWorld(const SLIMSurface& surface, const SurfaceMetadata& metadata) {
  const std::vector<float>* const columns[3] = {&surface.cx, &surface.cy, &surface.cz};
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    const double origin = surface.info.origin[a] - metadata.shift[a];
    for (const float local : *columns[axis]) {
      const auto world = static_cast<float>(origin + surface.info.scale * local);
      if (static_cast<float>(toLocal(world, axis, metadata)) != local) return false;
    }
  }
  return true;
}

SurfaceMetadata makeMetadata(const SLIMSurface& surface) {
  SurfaceMetadata metadata{surface.info, {}};
  if (exactInWorld(surface, metadata)) return metadata;
  metadata.shift = fileShift(surface.info.origin, surface.info.scale);
  if (!exactInWorld(surface, metadata)) metadata.shift = surface.info.origin;
  return metadata;
}

SurfelPoint toPoint(const SLIMSurface& surface, std::size_t i, const SurfaceMetadata& metadata) {
  const SurfaceInfo& info = surface.info;
  const auto place = [&](float local, std::size_t axis) {
    return static_cast<float>((info.origin[axis] - metadata.shift[axis]) + info.scale * local);
  };
  SurfelPoint p;
  p.x = place(surface.cx[i], 0);
  p.y = place(surface.cy[i], 1);
  p.z = place(surface.cz[i], 2);
  p.normal_x = surface.nx[i];
  p.normal_y = surface.ny[i];
  p.normal_z = surface.nz[i];
  p.radius = static_cast<float>(info.scale * surface.radius[i]);
  std::copy_n(surface.coefficientsOf(i), surface.stride(), p.c);
  p.degree = surface.degree[i];
  p.level = surface.level[i];
  p.leaf = surface.flags[i];
  const auto trim = coarseTrimMap(surface, i);
  p.trim_low = trim[0];
  p.trim_high = trim[1];
  p.error = static_cast<float>(info.scale * surface.error[i]);
  p.confidence = surface.effective_count[i];
  return p;
}

/** Writes one point into the surface. false: a small whole number is none. */
bool fromPoint(const SurfelPoint& p, const SurfaceMetadata& metadata, std::size_t i,
               SLIMSurface& surface) {
  const auto isByte = [](float v) { return v >= 0.0f && v <= 255.0f && v == std::floor(v); };
  if (!isByte(p.degree) || !isByte(p.level) || !isByte(p.leaf)) return false;
  const double scale = metadata.info.scale;
  surface.cx[i] = static_cast<float>(toLocal(p.x, 0, metadata));
  surface.cy[i] = static_cast<float>(toLocal(p.y, 1, metadata));
  surface.cz[i] = static_cast<float>(toLocal(p.z, 2, metadata));
  surface.nx[i] = p.normal_x;
  surface.ny[i] = p.normal_y;
  surface.nz[i] = p.normal_z;
  surface.radius[i] = static_cast<float>(p.radius / scale);
  const auto stride = static_cast<std::size_t>(surface.stride());
  std::copy_n(p.c, stride, surface.coefficients.begin() + static_cast<std::ptrdiff_t>(i * stride));
  surface.degree[i] = static_cast<std::uint8_t>(p.degree);
  surface.level[i] = static_cast<std::uint8_t>(p.level);
  surface.flags[i] = static_cast<std::uint8_t>(p.leaf);
  surface.error[i] = static_cast<float>(p.error / scale);
  surface.effective_count[i] = p.confidence;
  return true;
}

/** Units for surfels whose file lost its metadata: a power of two near the object's diagonal, an
 * origin on that scale's grid near its middle. */
SurfaceMetadata deriveMetadata(const std::vector<SurfelPoint>& cloud) {
  SurfaceMetadata metadata;
  metadata.info.degree = 1;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  std::array<double, 3> low{kInfinity, kInfinity, kInfinity},
      high{-kInfinity, -kInfinity, -kInfinity};
  for (const SurfelPoint& p : cloud) {
    if (p.degree >= 1.0f && p.degree <= kMaxDegree) {
      metadata.info.degree = std::max(metadata.info.degree, static_cast<int>(p.degree));
    }
    const double centre[3] = {p.x, p.y, p.z};
    for (std::size_t a = 0; a < 3; ++a) {
      if (!std::isfinite(centre[a]) || !std::isfinite(p.radius)) continue;
      low[a] = std::min(low[a], centre[a] - p.radius);
      high[a] = std::max(high[a], centre[a] + p.radius);
    }
  }
  const double diagonal = std::hypot(high[0] - low[0], high[1] - low[1], high[2] - low[2]);
  if (!std::isfinite(diagonal) || !(diagonal > 0.0)) return metadata;
  metadata.info.scale = std::exp2(std::ceil(std::log2(diagonal)));
  metadata.info.diagonal = diagonal / metadata.info.scale;
  for (std::size_t a = 0; a < 3; ++a) {
    const double middle = 0.5 * (low[a] + high[a]);
    metadata.info.origin[a] = std::round(middle / metadata.info.scale) * metadata.info.scale;
  }
  return metadata;
}

/** A surfel's flags, if they are any, without the one that announces a trim map. */
float closed(float flags) {
  const bool open = flags >= 0.0f && flags <= 255.0f && (static_cast<int>(flags) & kSurfelOpen);
  return open ? flags - static_cast<float>(kSurfelOpen) : flags;
}

/** The columns of a cloud by name; -1 where absent. */
struct Columns {
  int before[kFieldsBeforeCoefficients] = {};
  int coefficients[kMaxCoefficients];
  int after[kFieldsAfterCoefficients] = {};
  int trim[2];
  int degree = 0;  ///< highest degree whose coefficients are all there
};

Error findColumns(const PointTable& cloud, Columns& columns) {
  for (int k = 0; k < kFieldsBeforeCoefficients; ++k) {
    columns.before[k] = findField(cloud, kFieldsBefore[k]);
    if (columns.before[k] < 0) {
      return {ErrorCode::kBadInput, "these points are not SLIM surfels: the field '" +
                                        std::string(kFieldsBefore[k]) +
                                        "' is missing; name a file made by a SLIM fit"};
    }
  }
  int count = 0;
  for (int k = 0; k < kMaxCoefficients; ++k) {
    columns.coefficients[k] = findField(cloud, "c" + std::to_string(k));
    if (columns.coefficients[k] >= 0 && count == k) ++count;
  }
  for (int degree = 1; degree <= kMaxDegree; ++degree) {
    if (count >= numCoefficients(degree)) columns.degree = degree;
  }
  for (int k = 0; k < kFieldsAfterCoefficients; ++k) {
    columns.after[k] = findField(cloud, kFieldsAfter[k]);
  }
  for (int k = 0; k < 2; ++k) columns.trim[k] = findField(cloud, kTrimFields[k]);
  if (columns.degree > 0) return {};
  return {ErrorCode::kBadInput,
          "these points are not SLIM surfels: a field of 'c0', 'c1', 'c2' is missing; name a file "
          "made by a SLIM fit"};
}

std::vector<SurfelPoint> gatherPoints(const PointTable& cloud, const Columns& columns) {
  std::vector<SurfelPoint> points(numPoints(cloud));
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto read = [&](int column, auto& value) {
      if (column < 0) return;
      value = static_cast<std::decay_t<decltype(value)>>(
          fieldValue(cloud, i, cloud.fields[static_cast<std::size_t>(column)]));
    };
    SurfelPoint& p = points[i];
    p.degree = static_cast<float>(columns.degree);
    float* const before[] = {&p.x, &p.y, &p.z, &p.normal_x, &p.normal_y, &p.normal_z, &p.radius};
    float* const after[] = {&p.degree, &p.level, &p.leaf, &p.error, &p.confidence};
    for (int k = 0; k < kFieldsBeforeCoefficients; ++k) read(columns.before[k], *before[k]);
    for (int k = 0; k < numCoefficients(columns.degree); ++k) read(columns.coefficients[k], p.c[k]);
    for (int k = 0; k < kFieldsAfterCoefficients; ++k) read(columns.after[k], *after[k]);
    read(columns.trim[0], p.trim_low);
    read(columns.trim[1], p.trim_high);
    // Without a map an open surfel would be empty; without its mark a map would be none.
    if (columns.trim[0] < 0 || columns.trim[1] < 0) p.leaf = closed(p.leaf);
  }
  return points;
}

/** \brief The surface that points make. \param[in] metadata null: derived from the points */
Result<SLIMSurface> surfaceOf(const std::vector<SurfelPoint>& points,
                              const SurfaceMetadata* metadata) {
  const SurfaceMetadata units = metadata ? *metadata : deriveMetadata(points);
  SLIMSurface surface;
  surface.info = units.info;
  if (surface.info.degree < 1 || surface.info.degree > kMaxDegree || !(surface.info.scale > 0.0)) {
    return Error{ErrorCode::kBadInput, "the metadata name no degree 1..4 or no positive scale"};
  }
  surface.resize(points.size());
  std::vector<std::array<std::uint32_t, 2>> maps;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!fromPoint(points[i], units, i, surface)) {
      return Error{ErrorCode::kBadInput, "degree, level or leaf of surfel " + std::to_string(i) +
                                             " is not a whole number from 0 to 255"};
    }
    maps.push_back({points[i].trim_low, points[i].trim_high});
  }
  setCoarseTrimMaps(maps, surface);
  if (Error error = surface.validate()) return error;
  surface.buildLinks();
  if (Error error = surface.checkOverlap()) return error;
  return surface;
}

}  // namespace

SurfaceMetadata toPointTable(const SLIMSurface& surface, PointTable& cloud) {
  const SurfaceMetadata metadata = makeMetadata(surface);
  const auto stride = static_cast<std::size_t>(surface.stride());
  cloud = PointTable();
  for (const char* name : kFieldsBefore) addField(cloud, name, kFloat32);
  for (std::size_t k = 0; k < stride; ++k) addField(cloud, "c" + std::to_string(k), kFloat32);
  for (const char* name : kFieldsAfter) addField(cloud, name, kFloat32);
  if (surface.hasTrimMaps()) {
    for (const char* name : kTrimFields) addField(cloud, name, kUInt32);
  }
  if (surface.hasColors()) addColorFields(cloud);
  cloud.resize(surface.size());
  auto* at = cloud.data.data();
  const auto put = [&at](const auto* values, std::size_t count) {
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(values);
    at = std::copy(bytes, bytes + count * sizeof(*values), at);
  };
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const SurfelPoint p = toPoint(surface, i, metadata);
    for (const float value : {p.x, p.y, p.z, p.normal_x, p.normal_y, p.normal_z, p.radius}) {
      put(&value, 1);
    }
    put(p.c, stride);
    for (const float value : {p.degree, p.level, p.leaf, p.error, p.confidence}) put(&value, 1);
    for (const std::uint32_t half : {p.trim_low, p.trim_high}) {
      if (surface.hasTrimMaps()) put(&half, 1);
    }
    if (!surface.hasColors()) continue;
    const std::vector<float> colors = colorValues(surface, i);
    put(colors.data(), colors.size());
  }
  return metadata;
}

Result<SLIMSurface> surfaceFrom(const PointTable& cloud, const SurfaceMetadata* metadata) {
  if (Error error = checkPointTable(cloud)) return error;
  Columns columns;
  if (Error error = findColumns(cloud, columns)) return error;
  if (metadata && metadata->info.degree > columns.degree) {
    return Error{ErrorCode::kBadInput,
                 "coefficient fields are missing: degree " + std::to_string(metadata->info.degree) +
                     " is announced, fields reach degree " + std::to_string(columns.degree)};
  }
  Result<SLIMSurface> surface = surfaceOf(gatherPoints(cloud, columns), metadata);
  if (surface) takeColors(cloud, *surface);
  return surface;
}

}  // namespace pcl_slim
