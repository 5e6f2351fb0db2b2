// SPDX-License-Identifier: BSD-3-Clause
// Scans in tables of any fields, smoothed, with normals, and as splats.
#include "pcl_slim/filters/table/scan_work.h"

#include <gtest/gtest.h>
#include <pcl/PCLPointCloud2.h>

#include <cstdlib>
#include <limits>

#include "pcl_slim/filters/io/point_file.h"
#include "pcl_slim/filters/io/point_message.h"
#include "support/temporary_folder.h"
#include "table/message_clouds.h"

namespace pcl_slim {
namespace {

using pcl_slim_test::bytesOf;
using pcl_slim_test::driverLayouts;
using pcl_slim_test::Layout;
using pcl_slim_test::sphereTable;
using pcl_slim_test::store;
using pcl_slim_test::TemporaryFolder;

constexpr std::size_t kPoints = 3000;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

const Layout& layoutOf(const std::string& name) {
  static const std::vector<Layout> layouts = driverLayouts();
  for (const Layout& layout : layouts)
    if (layout.name == name) return layout;
  return layouts[0];
}

double valueOf(const PointTable& table, std::size_t point, const std::string& name) {
  return fieldValue(table, point, table.fields[static_cast<std::size_t>(findField(table, name))]);
}

bool isPlace(const std::string& name) {
  return name == "x" || name == "y" || name == "z";
}

/** RMS distance of the points from the sphere that they were made on. */
double rmsError(const PointTable& table) {
  double sum = 0;
  for (std::size_t i = 0; i < numPoints(table); ++i) {
    const double r =
        std::hypot(valueOf(table, i, "x"), valueOf(table, i, "y"), valueOf(table, i, "z") - 3000);
    sum += (r - 1000) * (r - 1000);
  }
  return std::sqrt(sum / static_cast<double>(numPoints(table)));
}

Result<ScanTable> scanOf(const Layout& layout, std::uint32_t rows = 1) {
  return ScanTable::from(sphereTable(layout, kPoints, rows));
}

TEST(ScanWork, SmoothingKeepsEveryFieldOfEveryLayout) {
  for (const Layout& layout : driverLayouts()) {
    Result<ScanTable> scan = scanOf(layout, 30);
    ASSERT_TRUE(scan) << layout.name << ": " << scan.error().message;
    const auto smooth = smoothScan(*scan, {});
    ASSERT_TRUE(smooth) << layout.name << ": " << smooth.error().message;
    const PointTable& points = smooth->points;
    EXPECT_FALSE(checkPointTable(points)) << layout.name;
    EXPECT_EQ(points.height, 30u);
    EXPECT_EQ(numPoints(points), kPoints);
    EXPECT_TRUE(smooth->is_dense) << layout.name;
    for (const PointField& field : layout.fields) {
      if (isPlace(field.name)) continue;
      EXPECT_EQ(bytesOf(points, field.name), bytesOf(scan->points, field.name))
          << layout.name << ": " << field.name;
    }
    for (const char* name : {"normal_x", "normal_y", "normal_z", "curvature"})
      EXPECT_GE(findField(points, name), 0) << layout.name << ": " << name;
    // The noise is +- 2: uniform, 1.15 RMS; whole numbers add .3 and are replaced by doubles.
    EXPECT_LT(rmsError(points), .5 * rmsError(scan->points)) << layout.name;
  }
}

TEST(ScanWork, LayoutsOfTheSamePointsGiveTheSameSurface) {
  const auto packed = smoothScan(*scanOf(layoutOf("packed")), {});
  ASSERT_TRUE(packed);
  for (const char* name : {"xyzi of PCL", "velodyne", "ouster", "livox, times first"}) {
    PointTable table = sphereTable(layoutOf(name), kPoints);
    const PointTable places = sphereTable(layoutOf("packed"), kPoints);
    for (std::size_t i = 0; i < kPoints; ++i)
      for (const char* axis : {"x", "y", "z"}) store(table, i, axis, valueOf(places, i, axis));
    const auto other = smoothScan(*ScanTable::from(std::move(table)), {});
    ASSERT_TRUE(other) << name;
    for (const char* field : {"x", "y", "z", "normal_x", "normal_y", "normal_z", "curvature"})
      EXPECT_EQ(bytesOf(other->points, field), bytesOf(packed->points, field)) << name;
  }
}

TEST(ScanWork, NormalsFaceTheSensorAndNothingMoves) {
  Result<ScanTable> scan = scanOf(layoutOf("velodyne"));
  ASSERT_TRUE(scan);
  scan->sensor = {0, 0, 3000};  // inside the sphere
  ScanWorkParams params;
  params.curvatures = true;
  const auto made = normalsOfScan(*scan, params);
  ASSERT_TRUE(made) << made.error().message;
  for (const PointField& field : scan->points.fields)
    EXPECT_EQ(bytesOf(made->points, field.name), bytesOf(scan->points, field.name)) << field.name;
  std::size_t inward = 0;
  for (std::size_t i = 0; i < kPoints; ++i) {
    const double along =
        valueOf(made->points, i, "x") * valueOf(made->points, i, "normal_x") +
        valueOf(made->points, i, "y") * valueOf(made->points, i, "normal_y") +
        (valueOf(made->points, i, "z") - 3000) * valueOf(made->points, i, "normal_z");
    inward += along < -900 ? 1 : 0;
  }
  EXPECT_EQ(inward, kPoints);
  for (const char* name : {"k1", "k2", "mean_curvature", "gaussian_curvature"})
    EXPECT_GE(findField(made->points, name), 0) << name;
}

TEST(ScanWork, PointsWithoutCoordinatesStay) {
  Result<ScanTable> all = scanOf(layoutOf("ouster"), 30);
  PointTable table = all->points;
  for (std::size_t i = 0; i < kPoints; i += 3) store(table, i, "y", kNan);
  const Result<ScanTable> scan = ScanTable::from(table);
  ASSERT_TRUE(scan);
  EXPECT_EQ(scan->columns.num_non_finite, kPoints / 3);
  const auto smooth = smoothScan(*scan, {});
  ASSERT_TRUE(smooth) << smooth.error().message;
  EXPECT_FALSE(smooth->is_dense);
  EXPECT_EQ(numPoints(smooth->points), kPoints);
  EXPECT_TRUE(std::isnan(valueOf(smooth->points, 0, "y")));
  EXPECT_EQ(valueOf(smooth->points, 0, "x"), valueOf(table, 0, "x"));
  EXPECT_TRUE(std::isnan(valueOf(smooth->points, 0, "normal_x")));
  EXPECT_EQ(bytesOf(smooth->points, "ring"), bytesOf(table, "ring"));
}

TEST(ScanWork, NothingFiniteAndNothingAtAllAreNoErrors) {
  for (const std::size_t points : {std::size_t{0}, std::size_t{5}}) {
    PointTable table = sphereTable(layoutOf("velodyne"), points);
    for (std::size_t i = 0; i < points; ++i) store(table, i, "x", kNan);
    const Result<ScanTable> scan = ScanTable::from(table);
    ASSERT_TRUE(scan);
    EXPECT_FALSE(scan->hasFinite());
    const auto smooth = smoothScan(*scan, {});
    ASSERT_TRUE(smooth) << smooth.error().message;
    EXPECT_EQ(numPoints(smooth->points), points);
    EXPECT_GE(findField(smooth->points, "normal_x"), 0);
    const auto splats = splatsOfScan(*scan, {});
    ASSERT_TRUE(splats) << splats.error().message;
    EXPECT_EQ(numPoints(*splats), 0u);
    EXPECT_GE(findField(*splats, "radius"), 0);
  }
}

TEST(ScanWork, PointsThatAreNoSurfaceStayWithAWarning) {
  const Result<ScanTable> scan = ScanTable::from(sphereTable(layoutOf("packed"), 2));
  const auto smooth = smoothScan(*scan, {});
  ASSERT_TRUE(smooth) << smooth.error().message;
  EXPECT_FALSE(smooth->warning.empty());
  for (const char* axis : {"x", "y", "z"})
    EXPECT_EQ(bytesOf(smooth->points, axis), bytesOf(scan->points, axis));
}

TEST(ScanWork, WrongParametersAndCancellationAreErrors) {
  const Result<ScanTable> scan = scanOf(layoutOf("packed"));
  ScanWorkParams params;
  params.fit.degree = 9;
  EXPECT_EQ(smoothScan(*scan, params).error().code, ErrorCode::kBadArgument);
  SplatParams splats;
  splats.normal_neighbors = 1;
  EXPECT_EQ(splatsOfScan(*scan, splats).error().code, ErrorCode::kBadArgument);
  Progress progress;
  progress.cancel();
  EXPECT_EQ(smoothScan(*scan, {}, &progress).error().code, ErrorCode::kCancelled);
}

TEST(ScanWork, FieldsOfCoordinatesAreNeeded) {
  PointTable table = sphereTable(layoutOf("packed"), 10);
  table.fields[1].name = "why";
  const Result<ScanTable> scan = ScanTable::from(table);
  ASSERT_FALSE(scan);
  EXPECT_NE(scan.error().message.find("x y z"), std::string::npos);
}

TEST(ScanWork, SplatsHaveTheColoursOfPackedFields) {
  PointTable table = sphereTable(layoutOf("realsense"), kPoints);
  const PointField& rgb = table.fields[3];
  for (std::size_t i = 0; i < kPoints; ++i) {
    const std::uint8_t bgra[4] = {10, 200, 30, 255};
    std::memcpy(table.data.data() + i * table.point_step + rgb.offset, bgra, 4);
  }
  SplatStatistics statistics;
  const auto splats = splatsOfScan(*ScanTable::from(table), {}, true, &statistics);
  ASSERT_TRUE(splats) << splats.error().message;
  EXPECT_GT(numPoints(*splats), 10u);
  EXPECT_EQ(numPoints(*splats), statistics.splats);
  const auto colors = bytesOf(*splats, "rgba");
  for (std::size_t i = 0; i < numPoints(*splats); ++i) {
    // CIELAB and back rounds by one step.
    EXPECT_NEAR(colors[4 * i], 10, 1);
    EXPECT_NEAR(colors[4 * i + 1], 200, 1);
    EXPECT_NEAR(colors[4 * i + 2], 30, 1);
  }
}

TEST(ScanWork, APclCloudGivesWhatItsTableGives) {
  const PointTable table = sphereTable(layoutOf("xyzi of PCL"), kPoints, 30);
  const auto expected = smoothScan(*ScanTable::from(table), {});
  ASSERT_TRUE(expected);
  const auto message = pcl_slim_test::messageOf<pcl::PCLPointCloud2>(table, 8);
  const auto scan = ScanTable::from(*tableOf(message));
  ASSERT_TRUE(scan);
  EXPECT_EQ(smoothScan(*scan, {})->points.data, expected->points.data);
}

#ifdef PCL_SLIM_SMOOTH_PROGRAM
TEST(ScanWork, TheProgramGivesTheSameFile) {
  const TemporaryFolder folder;
  for (const Layout& layout : driverLayouts()) {
    PointFile file;
    file.cloud = sphereTable(layout, kPoints);
    const std::string in = folder / "in.ply", out = folder / "out.ply", own = folder / "own.ply";
    ASSERT_FALSE(savePointFile(in, file));
    const std::string command = std::string(PCL_SLIM_SMOOTH_PROGRAM) + " " + in + " " + out +
                                " -normals -curvatures -quiet";
    ASSERT_EQ(std::system(command.c_str()), 0) << layout.name;
    ScanWorkParams params;
    params.curvatures = true;
    const auto smooth = smoothScan(*ScanTable::from(loadPointFile(in)->cloud), params);
    ASSERT_TRUE(smooth) << layout.name;
    file.cloud = smooth->points;
    ASSERT_FALSE(savePointFile(own, file));
    EXPECT_EQ(loadPointFile(own)->cloud.data, loadPointFile(out)->cloud.data) << layout.name;
  }
}
#endif

}  // namespace
}  // namespace pcl_slim
