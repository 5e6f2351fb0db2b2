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
#include "pcl_slim/cloud/neighbor_planes.h"
#include "pcl_slim/cloud/store_frame.h"

namespace pcl_slim {

namespace {

constexpr const char* kGradient[9] = {"red_x",   "red_y",  "red_z",  "green_x", "green_y",
                                      "green_z", "blue_x", "blue_y", "blue_z"};

}  // namespace

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

/** The surface variation of the discs' centres; 0 where there are too few. */
static std::vector<float> variationOf(const SplatSet& splats) {
  std::vector<std::array<float, 3>> centers(splats.size());
  for (std::size_t i = 0; i < centers.size(); ++i)
    centers[i] = {splats.x[i], splats.y[i], splats.z[i]};
  CloudView view;
  view.xyz = centers.data();
  view.xyz_stride = sizeof(centers[0]);
  view.size = centers.size();
  std::vector<float> variation = surfaceVariation(view, 0);
  for (float& value : variation)
    if (std::isnan(value)) value = 0.0f;
  return variation;
}

PointFile toPointFile(const SplatSet& splats, const std::array<double, 3>& shift) {
  PointFile file;
  PointTable& cloud = file.cloud;
  for (const char* name : {"x", "y", "z", "normal_x", "normal_y", "normal_z"}) {
    addField(cloud, name, kFloat32);
  }
  addField(cloud, "rgba", kUInt32);
  for (const char* name : {"radius", "confidence", "curvature"}) {
    addField(cloud, name, kFloat32);
  }
  for (const char* name : kGradient) {
    if (!splats.gradient.empty()) addField(cloud, name, kFloat32);
  }
  cloud.resize(splats.size());
  const std::vector<float> variation = variationOf(splats);
  std::array<double, 3> offset;
  for (std::size_t a = 0; a < 3; ++a) offset[a] = splats.origin[a] - shift[a];
  std::uint8_t* at = cloud.data.data();
  const auto put = [&at](const auto& values) {
    std::memcpy(at, &values, sizeof(values));
    at += sizeof(values);
  };
  for (std::size_t i = 0; i < splats.size(); ++i) {
    put(static_cast<float>(offset[0] + splats.x[i]));
    put(static_cast<float>(offset[1] + splats.y[i]));
    put(static_cast<float>(offset[2] + splats.z[i]));
    for (const float value : {splats.nx[i], splats.ny[i], splats.nz[i]}) put(value);
    put(0xff000000u | splats.rgb[i]);
    for (const float value : {splats.radius[i], splats.confidence[i], variation[i]}) put(value);
    if (!splats.gradient.empty()) put(splats.gradient[i]);
  }
  file.comments = {"pcl_slim version 1", "pcl_slim kind splats",
                   "pcl_slim shift " + formatScalar(shift[0]) + " " + formatScalar(shift[1]) + " " +
                       formatScalar(shift[2])};
  return file;
}

namespace {

using Field = const PointField*;

constexpr const char* kNeeded[] = {"x", "y", "z", "normal_x", "normal_y", "normal_z", "radius"};
constexpr std::size_t kNumNeeded = std::size(kNeeded);
constexpr std::uint32_t kWhite = 0xffffffu;

Field fieldOf(const PointTable& cloud, const char* name) {
  const int i = findField(cloud, name);
  return i < 0 ? nullptr : &cloud.fields[static_cast<std::size_t>(i)];
}

/** The fields discs are read from; absent ones are null. */
struct Columns {
  std::array<Field, kNumNeeded> needed{};
  Field rgb = nullptr, confidence = nullptr;
  std::array<Field, 9> gradient{};
  bool has_gradient = true;

  explicit Columns(const PointTable& cloud) : confidence(fieldOf(cloud, "confidence")) {
    for (std::size_t k = 0; k < kNumNeeded; ++k) needed[k] = fieldOf(cloud, kNeeded[k]);
    for (std::size_t k = 0; k < 9; ++k) {
      gradient[k] = fieldOf(cloud, kGradient[k]);
      has_gradient = has_gradient && gradient[k];
    }
    for (const char* name : {"rgba", "rgb"}) {
      const Field field = fieldOf(cloud, name);
      const bool packed = field && (field->datatype == kFloat32 || field->datatype == kUInt32 ||
                                    field->datatype == kInt32);
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
    splats_.kept[out] = static_cast<std::uint32_t>(point);
    splats_.rgb[out] = colorOf(point);
    return !columns_.has_gradient || readGradient(point, out);
  }

  /** Coordinates of type double may need a nearer zero than the file's; floats stay as they are. */
  void takeBase(const std::array<double, kNumNeeded>& v) {
    for (std::size_t a = 0; a < 3; ++a) {
      if (columns_.needed[a]->datatype == kFloat32 || base_[a] != 0.0) continue;
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

  const PointTable& cloud_;
  Columns columns_;
  SplatSet splats_;
  std::array<double, 3> base_{};
};

}  // namespace

bool holdsSplats(const PointFile& file) {
  return findField(file.cloud, "radius") >= 0 && findField(file.cloud, "c0") < 0;
}

Result<SplatSet> splatsFrom(const PointFile& file, std::uint64_t* skipped) {
  if (Error error = file.validate()) return error;
  std::uint64_t own = 0;
  return Reader(file).read(skipped ? *skipped : own);
}

}  // namespace pcl_slim
