// SPDX-License-Identifier: BSD-3-Clause
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "fuzz/fuzz_targets.h"
#include "pcl_slim/filters/io/point_file.h"
#include "pcl_slim/filters/io/splat_files.h"
#include "pcl_slim/filters/io/surface_files.h"
#include "render/camera_file.h"

namespace pcl_slim_test {

namespace {

using namespace pcl_slim;

/** A file of this process that contains some bytes. */
class BytesFile {
 public:
  BytesFile(const std::uint8_t* bytes, std::size_t size, const std::string& extension)
      : path_("/tmp/pcl_slim_fuzz_" + std::to_string(getpid()) + extension) {
    std::FILE* const file = std::fopen(path_.c_str(), "wb");
    if (file == nullptr || std::fwrite(bytes, 1, size, file) != size) std::abort();
    std::fclose(file);
  }
  ~BytesFile() { std::remove(path_.c_str()); }
  BytesFile(const BytesFile&) = delete;
  BytesFile& operator=(const BytesFile&) = delete;

  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

/** Whether two fields have the same values. */
bool haveSameValues(const PointTable& a, const PointField& field_a, const PointTable& b,
                    const PointField& field_b) {
  const auto at = [](const PointTable& cloud, const PointField& field, std::size_t i,
                     std::size_t k) {
    const std::size_t offset = field.offset + k * scalarSize(field.datatype);
    return readScalar(cloud.data.data() + i * cloud.point_step + offset, field.datatype);
  };
  if (field_a.count != field_b.count) return false;
  for (std::size_t i = 0; i < numPoints(a); ++i) {
    for (std::size_t k = 0; k < field_a.count; ++k) {
      const double x = at(a, field_a, i, k), y = at(b, field_b, i, k);
      if (!(x == y || (std::isnan(x) && std::isnan(y)))) return false;
    }
  }
  return true;
}

/** Whether a name is another one with any number of '_' behind. */
bool continues(const std::string& name, const std::string& other) {
  return name.compare(0, other.size(), other) == 0 &&
         name.find_first_not_of('_', other.size()) == std::string::npos;
}

/** Whether a table has all values of another. Fields may have moved and have wider types, and names
 * that occur twice may have got a '_'; a packed colour may have come back as another type. */
bool hasValuesOf(const PointTable& table, const PointTable& other) {
  if (numPoints(table) != numPoints(other)) return false;
  if (table.data == other.data) return true;
  return std::all_of(other.fields.begin(), other.fields.end(), [&](const PointField& field) {
    if (field.name == "rgb" || field.name == "rgba") return true;
    return std::any_of(table.fields.begin(), table.fields.end(), [&](const PointField& found) {
      return continues(found.name, field.name) && haveSameValues(table, found, other, field);
    });
  });
}

/** Points, and what surfaces and splats they make; a file that is read is written and read again.
 */
void readPoints(const std::string& path, const std::string& extension) {
  const Result<PointFile> file = loadPointFile(path);
  if (!file) return;
  if (file->validate()) std::abort();
  static_cast<void>(surfaceFrom(*file));
  static_cast<void>(splatsFrom(*file));
  const std::string copy = path + ".copy" + extension;
  if (!savePointFile(copy, *file)) {
    const Result<PointFile> again = loadPointFile(copy);
    if (!again || !hasValuesOf(again->cloud, file->cloud)) std::abort();
  }
  std::remove(copy.c_str());
}

}  // namespace

int fuzzPcd(const std::uint8_t* bytes, std::size_t size) {
  const BytesFile file(bytes, size, ".pcd");
  readPoints(file.path(), ".pcd");
  return 0;
}

int fuzzPly(const std::uint8_t* bytes, std::size_t size) {
  const BytesFile file(bytes, size, ".ply");
  readPoints(file.path(), ".ply");
  return 0;
}

/** Coordinates that a LAS file cannot store are an error; what is written can be read. */
int fuzzLas(const std::uint8_t* bytes, std::size_t size) {
  const BytesFile file(bytes, size, ".las");
  const Result<PointFile> points = loadPointFile(file.path());
  if (!points) return 0;
  const std::string copy = file.path() + ".copy.las";
  if (!savePointFile(copy, *points)) {
    const Result<PointFile> again = loadPointFile(copy);
    if (!again || numPoints(again->cloud) != numPoints(points->cloud)) std::abort();
  }
  std::remove(copy.c_str());
  return 0;
}

int fuzzText(const std::uint8_t* bytes, std::size_t size) {
  for (const char* extension : {".csv", ".pts", ".ptx"}) {
    const BytesFile file(bytes, size, extension);
    readPoints(file.path(), ".pcd");
  }
  return 0;
}

int fuzzMesh(const std::uint8_t* bytes, std::size_t size) {
  for (const char* extension : {".obj", ".off", ".stl"}) {
    const BytesFile file(bytes, size, extension);
    readPoints(file.path(), ".ply");
  }
  return 0;
}

int fuzzVtp(const std::uint8_t* bytes, std::size_t size) {
  const BytesFile file(bytes, size, ".vtp");
  readPoints(file.path(), ".vtp");
  const Result<SLIMSurface> surface = loadSurface(file.path());
  if (surface && surface->validate()) std::abort();
  return 0;
}

int fuzzCamera(const std::uint8_t* bytes, std::size_t size) {
  const BytesFile file(bytes, size, ".txt");
  const Result<Camera> camera = loadCamera(file.path());
  if (!camera) return 0;
  const Result<Camera> again = cameraFromText(cameraText(*camera), Camera().fov);
  if (!again || cameraText(*again) != cameraText(*camera)) std::abort();
  return 0;
}

}  // namespace pcl_slim_test
