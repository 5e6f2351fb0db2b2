// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/filters/io/splat_files.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <iterator>
#include <locale>
#include <sstream>
#include <string>
#include <vector>

#include "io/point_formats.h"
#include "pcl_slim/cloud/store_frame.h"
#include "pcl_slim/filters/io/splat_conversion.h"

namespace pcl_slim {

std::array<double, 3> splatShift(const SplatSet& splats) {
  if (splats.empty()) return {};
  std::array<double, 3> low, high;
  const std::vector<float>* const columns[3] = {&splats.x, &splats.y, &splats.z};
  for (std::size_t a = 0; a < 3; ++a) {
    const auto [least, most] = std::minmax_element(columns[a]->begin(), columns[a]->end());
    low[a] = splats.origin[a] + *least;
    high[a] = splats.origin[a] + *most;
  }
  return fileShift(low, high);
}

void toPCL(const SplatSet& splats, const std::array<double, 3>& shift,
           pcl::PointCloud<pcl::PointSurfel>& cloud) {
  cloud.resize(splats.size());
  cloud.width = static_cast<std::uint32_t>(splats.size());
  cloud.height = 1;
  cloud.is_dense = true;
  std::array<double, 3> offset;
  for (std::size_t a = 0; a < 3; ++a) offset[a] = splats.origin[a] - shift[a];
  for (std::size_t i = 0; i < splats.size(); ++i) {
    pcl::PointSurfel& p = cloud[i];
    p.x = static_cast<float>(offset[0] + splats.x[i]);
    p.y = static_cast<float>(offset[1] + splats.y[i]);
    p.z = static_cast<float>(offset[2] + splats.z[i]);
    p.normal_x = splats.nx[i];
    p.normal_y = splats.ny[i];
    p.normal_z = splats.nz[i];
    p.rgba = 0xff000000u | splats.rgb[i];
    p.radius = splats.radius[i];
    p.confidence = splats.confidence[i];
    p.curvature = splats.normal_variance[i];
  }
}

PointFile toPointFile(const SplatSet& splats, const std::array<double, 3>& shift) {
  PointFile file;
  pcl::PCLPointCloud2& cloud = file.cloud;
  for (const char* name : {"x", "y", "z", "normal_x", "normal_y", "normal_z"}) {
    addField(cloud, name, kFloat32);
  }
  addField(cloud, "rgba", kUInt32);
  for (const char* name : {"radius", "confidence", "curvature"}) {
    addField(cloud, name, kFloat32);
  }
  if (!splats.gradient.empty()) {
    for (const char* channel : {"red", "green", "blue"}) {
      for (const char* axis : {"_x", "_y", "_z"}) {
        addField(cloud, std::string(channel) + axis, kFloat32);
      }
    }
  }
  cloud.width = static_cast<std::uint32_t>(splats.size());
  cloud.height = 1;
  cloud.is_dense = 1;
  cloud.row_step = cloud.point_step * cloud.width;
  cloud.data.resize(std::size_t{cloud.point_step} * splats.size());
  pcl::PointCloud<pcl::PointSurfel> surfels;
  toPCL(splats, shift, surfels);
  for (std::size_t i = 0; i < splats.size(); ++i) {
    const pcl::PointSurfel& p = surfels[i];
    const float before[6] = {p.x, p.y, p.z, p.normal_x, p.normal_y, p.normal_z};
    const float after[3] = {p.radius, p.confidence, p.curvature};
    unsigned char* at = cloud.data.data() + i * cloud.point_step;
    std::memcpy(at, before, sizeof(before));
    std::memcpy(at + 24, &p.rgba, 4);
    std::memcpy(at + 28, after, sizeof(after));
    if (!splats.gradient.empty()) std::memcpy(at + 40, splats.gradient[i].data(), 36);
  }
  file.comments = {"pcl_slim version 1", "pcl_slim kind splats",
                   "pcl_slim shift " + formatScalar(shift[0]) + " " + formatScalar(shift[1]) + " " +
                       formatScalar(shift[2])};
  return file;
}

namespace {

using Field = const pcl::PCLPointField*;

constexpr const char* kNeeded[] = {"x", "y", "z", "normal_x", "normal_y", "normal_z", "radius"};
constexpr std::size_t kNumNeeded = std::size(kNeeded);
constexpr const char* kGradient[9] = {"red_x",   "red_y",  "red_z",  "green_x", "green_y",
                                      "green_z", "blue_x", "blue_y", "blue_z"};
constexpr std::uint32_t kWhite = 0xffffffu;

Field fieldOf(const pcl::PCLPointCloud2& cloud, const char* name) {
  const int i = findField(cloud, name);
  return i < 0 ? nullptr : &cloud.fields[static_cast<std::size_t>(i)];
}

/** The fields discs are read from; absent ones are null. */
struct Columns {
  std::array<Field, kNumNeeded> needed{};
  Field rgb = nullptr, confidence = nullptr, normal_variance = nullptr;
  std::array<Field, 9> gradient{};
  bool has_gradient = true;

  explicit Columns(const pcl::PCLPointCloud2& cloud)
      : confidence(fieldOf(cloud, "confidence")), normal_variance(fieldOf(cloud, "curvature")) {
    for (std::size_t k = 0; k < kNumNeeded; ++k) needed[k] = fieldOf(cloud, kNeeded[k]);
    for (std::size_t k = 0; k < 9; ++k) {
      gradient[k] = fieldOf(cloud, kGradient[k]);
      has_gradient = has_gradient && gradient[k];
    }
    for (const char* name : {"rgba", "rgb"}) {
      const Field field = fieldOf(cloud, name);
      const bool packed = field && (field->datatype == pcl::PCLPointField::FLOAT32 ||
                                    field->datatype == pcl::PCLPointField::UINT32 ||
                                    field->datatype == pcl::PCLPointField::INT32);
      if (packed && !rgb) rgb = field;
    }
  }
};

/** The shift of a comment line "pcl_slim shift X Y Z"; zero without one. */
std::array<double, 3> shiftOf(const PointFile& file) {
  for (const std::string& comment : file.comments) {
    std::istringstream words(comment);
    words.imbue(std::locale::classic());
    std::string prefix, key;
    std::array<double, 3> shift{};
    if (words >> prefix >> key >> shift[0] >> shift[1] >> shift[2] && prefix == "pcl_slim" &&
        key == "shift") {
      return shift;
    }
  }
  return {};
}

/** Reads one file's discs, one after the other. */
class Reader {
 public:
  explicit Reader(const PointFile& file) : cloud_(file.cloud), columns_(file.cloud) {
    splats_.origin = shiftOf(file);
  }

  Result<SplatSet> read(std::uint64_t& skipped) {
    for (std::size_t k = 0; k < kNumNeeded; ++k) {
      if (columns_.needed[k]) continue;
      return Error{ErrorCode::kBadInput, std::string("these points are not splats: the field '") +
                                             kNeeded[k] +
                                             "' is missing; name a file made by "
                                             "pcl_color_splat_sampling"};
    }
    splats_.resize(numPoints(cloud_), columns_.has_gradient);
    std::size_t count = 0;
    for (std::size_t i = 0; i < numPoints(cloud_); ++i) count += readDisc(i, count) ? 1 : 0;
    skipped = numPoints(cloud_) - count;
    splats_.resize(count, columns_.has_gradient);
    return std::move(splats_);
  }

 private:
  /** Fills slot out; false when the point makes no disc. */
  bool readDisc(std::size_t point, std::size_t out) {
    std::array<double, kNumNeeded> v;
    for (std::size_t k = 0; k < kNumNeeded; ++k) {
      v[k] = fieldValue(cloud_, point, *columns_.needed[k]);
      if (!std::isfinite(v[k])) return false;
    }
    const double length = std::hypot(v[3], v[4], v[5]);
    if (!(length > 0.0) || v[6] < 0.0) return false;
    if (out == 0) takeBase(v);
    float* const columns[kNumNeeded] = {&splats_.x[out],     &splats_.y[out],  &splats_.z[out],
                                        &splats_.nx[out],    &splats_.ny[out], &splats_.nz[out],
                                        &splats_.radius[out]};
    for (std::size_t k = 0; k < kNumNeeded; ++k) {
      *columns[k] = static_cast<float>(k < 3 ? v[k] - base_[k] : v[k]);
    }
    splats_.confidence[out] = optional(point, columns_.confidence, 1.0f);
    splats_.normal_variance[out] = optional(point, columns_.normal_variance, 0.0f);
    splats_.kept[out] = static_cast<std::uint32_t>(point);
    splats_.rgb[out] = colorOf(point);
    return !columns_.has_gradient || readGradient(point, out);
  }

  /** Coordinates of type double may need a nearer zero than the file's; floats stay as they are. */
  void takeBase(const std::array<double, kNumNeeded>& v) {
    for (std::size_t a = 0; a < 3; ++a) {
      if (columns_.needed[a]->datatype == pcl::PCLPointField::FLOAT32 || base_[a] != 0.0) continue;
      base_[a] = v[a];
      splats_.origin[a] += base_[a];
    }
  }

  float optional(std::size_t point, Field field, float otherwise) const {
    return field ? static_cast<float>(fieldValue(cloud_, point, *field)) : otherwise;
  }

  std::uint32_t colorOf(std::size_t point) const {
    if (!columns_.rgb) return kWhite;
    std::uint32_t rgba = 0;
    std::memcpy(&rgba, cloud_.data.data() + point * cloud_.point_step + columns_.rgb->offset, 4);
    return rgba & 0xffffffu;
  }

  bool readGradient(std::size_t point, std::size_t out) {
    for (std::size_t k = 0; k < 9; ++k) {
      splats_.gradient[out][k] = optional(point, columns_.gradient[k], 0.0f);
      if (!std::isfinite(splats_.gradient[out][k])) return false;
    }
    return true;
  }

  const pcl::PCLPointCloud2& cloud_;
  Columns columns_;
  SplatSet splats_;
  std::array<double, 3> base_{};
};

}  // namespace

bool holdsSplats(const PointFile& file) {
  return findField(file.cloud, "radius") >= 0 && findField(file.cloud, "c0") < 0;
}

Result<SplatSet> splatsFrom(const PointFile& file, std::uint64_t* skipped) {
  std::uint64_t own = 0;
  return Reader(file).read(skipped ? *skipped : own);
}

}  // namespace pcl_slim
