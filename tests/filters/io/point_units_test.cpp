// SPDX-License-Identifier: BSD-3-Clause
// Points in degrees: said by a coordinate system or names, or shown by the numbers; and what is none.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <string>

#include "filters/io/point_values.h"
#include "pcl_slim/filters/io/point_file.h"
#include "pcl_slim/filters/io/point_units.h"
#include "support/temporary_folder.h"

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;

constexpr const char* kGeographic =
    "GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\"],UNIT[\"degree\",0.01745]]";
constexpr const char* kProjected =
    "PROJCS[\"UTM 33N\",GEOGCS[\"WGS 84\",UNIT[\"degree\",0.01745]],UNIT[\"metre\",1]]";

/** Some 30 m of ground, 80 m up, with an oblong grid. \param[in] step of x and y */
PointFile groundFile(double x, double y, double step, double height) {
  PointFile file;
  for (const char* axis : {"x", "y", "z"}) addField(file.cloud, axis, kFloat64);
  file.cloud.resize(100);
  for (std::size_t i = 0; i < 100; ++i) {
    const double p[3] = {x + step * static_cast<double>(i % 10),
                         y + step * static_cast<double>(i / 10),
                         80 + height * std::sin(static_cast<double>(i))};
    std::memcpy(file.cloud.data.data() + i * file.cloud.point_step, p, sizeof(p));
  }
  return file;
}

/** A LAS file with a record of a coordinate system before its points, or behind them. */
PointFile withSystem(const PointFile& points, std::uint16_t id, const std::string& content,
                     bool behind = false) {
  const TemporaryFolder folder;
  EXPECT_FALSE(savePointFile(folder / "a.las", points));
  std::vector<unsigned char> bytes = fileBytes(folder / "a.las");
  const std::size_t head = behind ? 60 : 54, at = behind ? bytes.size() : 375;
  std::vector<unsigned char> record(head, 0);
  std::memcpy(record.data() + 2, "LASF_Projection", 15);
  std::memcpy(record.data() + 18, &id, 2);
  const std::uint64_t size = content.size();
  std::memcpy(record.data() + 20, &size, behind ? 8 : 2);
  record.insert(record.end(), content.begin(), content.end());
  bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(at), record.begin(), record.end());
  const std::uint32_t one = 1;
  const auto points_at = static_cast<std::uint32_t>(375 + record.size());
  const std::uint64_t begin = at;
  if (behind) {
    std::memcpy(bytes.data() + 235, &begin, 8);
    std::memcpy(bytes.data() + 243, &one, 4);
  } else {
    std::memcpy(bytes.data() + 96, &points_at, 4);
    std::memcpy(bytes.data() + 100, &one, 4);
  }
  writeBytes(folder / "b.las", bytes);
  auto file = loadPointFile(folder / "b.las");
  EXPECT_TRUE(file) << (file ? "" : file.error().message);
  return file ? *file : PointFile();
}

std::string geoKeys(std::uint16_t model) {
  const std::uint16_t keys[] = {1, 1, 0, 1, 1024, 0, 1, model};
  return {reinterpret_cast<const char*>(keys), sizeof(keys)};
}

TEST(PointUnits, CoordinateSystemsOfLas) {
  const PointFile flat = groundFile(13.4, 52.5, 0.001, 0.0001);  // the numbers alone say nothing
  EXPECT_FALSE(checkLengths(flat, "a.las"));
  const Error degrees = checkLengths(withSystem(flat, 2112, kGeographic), "a.las");
  EXPECT_EQ(degrees.code, ErrorCode::kBadInput);
  for (const char* words : {"x and y are degrees", "reproject", "EPSG:32633", "-units length"})
    EXPECT_NE(degrees.message.find(words), std::string::npos) << degrees.message;
  EXPECT_TRUE(checkLengths(withSystem(flat, 2112, kGeographic, true), "a.las"))
      << "behind the points";
  EXPECT_TRUE(checkLengths(withSystem(flat, 34735, geoKeys(2)), "a.las")) << "GeoTIFF keys";
  EXPECT_FALSE(checkLengths(withSystem(flat, 34735, geoKeys(1)), "a.las"));
  EXPECT_FALSE(checkLengths(withSystem(flat, 2112, kProjected), "a.las"));
  const PointFile metres = groundFile(500000, 5400000, 1, 1);
  EXPECT_FALSE(checkLengths(withSystem(metres, 2112, kGeographic), "a.las")) << "it is wrong";
}

TEST(PointUnits, NamesOfColumns) {
  const auto named =
      loadText("a.csv", "lon,lat,height\n13.4,52.5,80\n13.41,52.51,81\n13.4,52.51,82\n");
  ASSERT_TRUE(named) << named.error().message;
  EXPECT_TRUE(named->degrees);
  EXPECT_EQ(value(*named, "y", 0), 52.5);
  EXPECT_TRUE(checkLengths(*named, "a.csv"));
  const auto swapped = loadText("a.csv", "Latitude;Longitude;Alt\n-33.9;151.2;5\n-33.8;151.3;6\n");
  ASSERT_TRUE(swapped) << swapped.error().message;
  EXPECT_FLOAT_EQ(static_cast<float>(value(*swapped, "x", 0)), 151.2f);
  EXPECT_NE(checkLengths(*swapped, "a.csv").message.find("EPSG:32756"), std::string::npos);
  const auto both = loadText("a.csv", "lon,lat,x,y,z\n13.4,52.5,1,2,3\n13.4,52.5,4,5,6\n");
  ASSERT_TRUE(both) << both.error().message;
  EXPECT_FALSE(both->degrees) << "x and y are there as well";
}

TEST(PointUnits, Numbers) {
  EXPECT_TRUE(checkLengths(groundFile(13.4, 52.5, 1e-5, 3), "a.ply")) << "a yard";
  EXPECT_TRUE(checkLengths(groundFile(-70, -33, 1e-3, 100), "a.ply")) << "a mountain";
  EXPECT_FALSE(checkLengths(groundFile(0, 0, 1e-3, 1), "a.ply")) << "a pole at the origin";
  EXPECT_FALSE(checkLengths(groundFile(13.4, 52.5, 1, 30), "a.ply")) << "a tree";
  EXPECT_FALSE(checkLengths(groundFile(400, 52.5, 1e-5, 3), "a.ply")) << "beyond any longitude";
  EXPECT_FALSE(checkLengths(PointFile(), "a.ply"));
}

}  // namespace
}  // namespace pcl_slim
