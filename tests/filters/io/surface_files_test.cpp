// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/filters/io/surface_files.h"

#include <gtest/gtest.h>
#include <pcl/io/pcd_io.h>
#include <pcl/io/ply_io.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "pcl_slim/filters/io/surface_conversion.h"
#include "pcl_slim/fit/fit.h"
#include "pcl_slim/fit/fit_colors.h"
#include "pcl_slim/render/shading.h"
#include "pcl_slim/surface/surface_io.h"
#include "support/colors.h"
#include "support/sphere_surface.h"
#include "support/trim_maps.h"

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;

constexpr const char* kFormats[] = {".pcd", ".ply", ".vtp", ".slim"};

// Equal .slim bytes mean equal surfaces: that format stores everything but links.
void expectSame(const SLIMSurface& a, const SLIMSurface& b) {
  EXPECT_EQ(encodeSlim(a), encodeSlim(b));
  EXPECT_EQ(a.nz, b.nz);
  EXPECT_EQ(a.children, b.children);
  EXPECT_EQ(a.roots, b.roots);
}

void expectSame(const SLIMSurface& a, const Result<SLIMSurface>& b) {
  ASSERT_TRUE(b) << b.error().message;
  expectSame(a, *b);
}

class SurfaceFiles : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    if (checkSurfaceExtension(std::string("a") + GetParam())) GTEST_SKIP() << "not in this build";
  }
};

/** Saves, loads and saves again: the same surface, the same bytes. */
void expectRoundTrip(const SLIMSurface& surface, const TemporaryFolder& folder,
                     const std::string& ending) {
  const std::string first = folder / ("first" + ending), second = folder / ("second" + ending);
  ASSERT_FALSE(saveSurface(first, surface));
  const auto loaded = loadSurface(first);
  ASSERT_TRUE(loaded) << loaded.error().message;
  expectSame(surface, *loaded);
  ASSERT_FALSE(saveSurface(second, *loaded));
  EXPECT_EQ(fileBytes(first), fileBytes(second));
}

TEST_P(SurfaceFiles, SaveAndLoadGiveTheSameBytes) {
  const TemporaryFolder folder;
  for (int degree = 1; degree <= 4; ++degree) {
    const SLIMSurface surface = sphereSurface(degree, 300);
    expectRoundTrip(surface, folder, GetParam());
  }
  EXPECT_EQ(folder.numFiles(), 2u);
}

TEST_P(SurfaceFiles, TrimMapsAndColoursAreKeptInFull) {
  const TemporaryFolder folder;
  for (const bool colored : {false, true}) {
    SLIMSurface surface = sphereSurface(2, 900);  // maps of every side
    setRandomTrimMaps(surface);
    if (colored) setRandomColors(surface);
    expectRoundTrip(surface, folder, GetParam());
  }
}

TEST_P(SurfaceFiles, AScanWithBordersIsDrawnAsFromSlim) {
  // A wavy sheet with a round hole, coloured by its height.
  std::vector<double> xyz;
  for (int i = 0; i < 120; ++i) {
    for (int j = 0; j < 120; ++j) {
      const double x = i / 119.0, y = j / 119.0;
      if (std::hypot(x - 0.6, y - 0.4) < 0.17) continue;
      xyz.insert(xyz.end(), {x, y, 0.1 * std::sin(5 * x) * std::cos(4 * y)});
    }
  }
  CloudView view;
  view.xyz = xyz.data();
  view.xyz_stride = 3 * sizeof(double);
  view.scalar = CloudView::Scalar::kDouble;
  view.size = xyz.size() / 3;
  const auto store = PointStore::build(view);
  ASSERT_TRUE(store);
  SLIMSurface surface;
  ASSERT_FALSE(fitSurface(*store, {}, surface));
  const auto bgr = bgrOf(xyz, [](const std::array<double, 3>& p) {
    return std::array<double, 3>{128 + 1000 * p[2], 128, 128 - 1000 * p[2]};
  });
  ASSERT_FALSE(fitColors(*store, view, {bgr.data(), 3}, 0, surface));
  surface.dropTextures();  // they are in .slim alone
  bool wider_than_fields = false;
  for (std::size_t i = 0; i < surface.size(); ++i)
    wider_than_fields = wider_than_fields || surface.trimMap(i).side > 8;
  ASSERT_TRUE(wider_than_fields) << "the fields' own maps would do";

  const TemporaryFolder folder;
  const std::string path = folder / ("sheet" + std::string(GetParam()));
  ASSERT_FALSE(saveSurface(path, surface));
  const auto loaded = loadSurface(path);
  ASSERT_TRUE(loaded) << loaded.error().message;
  const Camera camera = fitCamera(spheresOf(surface), {{0.2, -0.5, 1.0}, {0, 1, 0}}, {160, 120});
  for (const ShadingMode mode : {ShadingMode::kShaded, ShadingMode::kColor}) {
    ShadingParams shading;
    shading.mode = mode;
    const auto before = renderPicture(surface, camera, {}, shading);
    const auto after = renderPicture(*loaded, camera, {}, shading);
    ASSERT_TRUE(before && after);
    EXPECT_EQ(before->rgb, after->rgb);
  }
}

TEST(SurfaceFiles, MapsOfAFileThatAnotherProgramHasChangedAreTheFieldsOwn) {
  SLIMSurface surface = sphereSurface(2, 90);
  setRandomTrimMaps(surface);
  const TemporaryFolder folder;
  const std::string path = folder / "surface.pcd";
  ASSERT_FALSE(saveSurface(path, surface));
  auto file = loadPointFile(path);
  ASSERT_TRUE(file);
  for (const std::string& comment : file->comments)
    EXPECT_LT(comment.size(), 480u) << "MeshLab reads no longer lines";
  // The last surfel is cut off, the comments stay.
  file->cloud.width -= 1;
  file->cloud.data.resize(file->cloud.width * file->cloud.point_step);
  const auto cut = surfaceFrom(*file);
  ASSERT_TRUE(cut) << cut.error().message;
  ASSERT_EQ(cut->size(), 89u);
  for (std::size_t i = 0; i < cut->size(); ++i)
    EXPECT_EQ(cut->trimMap(i).side, surface.isOpen(i) ? 8 : 0);
}

TEST(SurfaceFiles, PclReadsTheFieldsOfAColouredOpenSurface) {
  SLIMSurface surface = sphereSurface(2, 300);
  setRandomTrimMaps(surface);
  setRandomColors(surface);
  const TemporaryFolder folder;
  const std::string pcd = folder / "surface.pcd", ply = folder / "surface.ply";
  ASSERT_FALSE(saveSurface(pcd, surface));
  ASSERT_FALSE(saveSurface(ply, surface));
  pcl::PointCloud<pcl::PointXYZRGB> cloud;
  ASSERT_EQ(pcl::io::loadPCDFile(pcd, cloud), 0);
  ASSERT_EQ(cloud.size(), surface.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const std::uint8_t* rgb = surface.colors.data() + i * kColorBytes;
    ASSERT_EQ(cloud[i].r, rgb[0]);
    ASSERT_EQ(cloud[i].g, rgb[1]);
    ASSERT_EQ(cloud[i].b, rgb[2]);
  }
  ASSERT_EQ(pcl::io::loadPLYFile(ply, cloud), 0);
  ASSERT_EQ(cloud.size(), surface.size());
  EXPECT_EQ(cloud[7].g, surface.colors[7 * kColorBytes + 1]);
}

TEST(SurfaceFiles, PointsWithoutTheirTrimColumnsAreClosed) {
  SLIMSurface surface = sphereSurface(2, 30);
  setRandomTrimMaps(surface);
  pcl::PCLPointCloud2 cloud;
  const SurfaceMetadata metadata = toPCL(surface, cloud);
  ASSERT_EQ(cloud.fields.back().name, "trim_high");
  cloud.fields.pop_back();
  const auto loaded = fromPCL(cloud, &metadata);
  ASSERT_TRUE(loaded) << loaded.error().message;
  surface.dropTrimMaps();
  expectSame(surface, loaded);
}

TEST_P(SurfaceFiles, FarOriginsAreKeptByAShift) {
  const TemporaryFolder folder;
  SLIMSurface surface = sphereSurface(2, 100);
  surface.info.origin = {515384.8125, 4918360.75, 2330.7531};
  surface.info.scale = 64.0;
  const std::string path = folder / ("far" + std::string(GetParam()));
  ASSERT_FALSE(saveSurface(path, surface));
  const auto loaded = loadSurface(path);
  ASSERT_TRUE(loaded) << loaded.error().message;
  expectSame(surface, *loaded);
}

TEST_P(SurfaceFiles, AnEmptySurfaceIsKept) {
  const TemporaryFolder folder;
  SLIMSurface surface;
  surface.info.degree = 3;
  const std::string path = folder / ("empty" + std::string(GetParam()));
  ASSERT_FALSE(saveSurface(path, surface));
  const auto loaded = loadSurface(path);
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_TRUE(loaded->empty());
  EXPECT_EQ(loaded->info.degree, 3);
}

TEST_P(SurfaceFiles, TruncationsAreToldInOneLine) {
  const TemporaryFolder folder;
  const std::string path = folder / ("part" + std::string(GetParam()));
  ASSERT_FALSE(saveSurface(path, sphereSurface(2, 40)));
  const auto bytes = fileBytes(path);
  for (std::size_t part = 0; part < 24; ++part) {
    writeBytes(path, {bytes.begin(),
                      bytes.begin() + static_cast<std::ptrdiff_t>(bytes.size() * part / 24)});
    const auto loaded = loadSurface(path);
    ASSERT_FALSE(loaded) << part << " of 24";
    EXPECT_NE(loaded.error().message, "");
    EXPECT_EQ(loaded.error().message.find('\n'), std::string::npos);
  }
}

TEST_P(SurfaceFiles, ForeignFilesAreToldInOneLine) {
  const TemporaryFolder folder;
  const std::string path = folder / ("foreign" + std::string(GetParam()));
  for (const std::string& text :
       {std::string("hello"), std::string(1000, '\0'), std::string("<VTKFile></VTKFile>"),
        std::string("<VTKFile type=\"PolyData\"><a></VTKFile>"), std::string("ply\nformat\n"),
        std::string("VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 1\nPOINTS 1\nDATA "
                    "ascii\n1 2 3\n")}) {
    writeText(path, text);
    const auto loaded = loadSurface(path);
    ASSERT_FALSE(loaded) << text;
    EXPECT_NE(loaded.error().message.find(path), std::string::npos);
    EXPECT_EQ(loaded.error().message.find('\n'), std::string::npos);
  }
}

TEST_P(SurfaceFiles, UnwritableAndAbsentPlacesLeaveNothing) {
  const TemporaryFolder folder;
  const SLIMSurface surface = sphereSurface(2, 10);
  const Error error = saveSurface(folder / ("absent/a" + std::string(GetParam())), surface);
  EXPECT_EQ(error.code, ErrorCode::kIo);
  EXPECT_EQ(loadSurface(folder / ("absent" + std::string(GetParam()))).error().code,
            ErrorCode::kIo);
  EXPECT_EQ(folder.numFiles(), 0u);
}

INSTANTIATE_TEST_SUITE_P(Formats, SurfaceFiles, testing::ValuesIn(kFormats),
                         [](const auto& format) { return std::string(format.param + 1); });

TEST(SurfaceFiles, ExtensionsInAnyCaseButNoOthers) {
  const TemporaryFolder folder;
  const SLIMSurface surface = sphereSurface(1, 10);
  EXPECT_FALSE(saveSurface(folder / "a.PCD", surface));
  EXPECT_TRUE(loadSurface(folder / "a.PCD"));
  EXPECT_EQ(saveSurface(folder / "a.obj", surface).code, ErrorCode::kBadArgument);
  EXPECT_EQ(loadSurface(folder / "a").error().code, ErrorCode::kBadArgument);
}

TEST(SurfaceFiles, PclReadsThePcd) {
  const TemporaryFolder folder;
  const SLIMSurface surface = sphereSurface(4, 50);
  ASSERT_FALSE(saveSurface(folder / "a.pcd", surface));
  pcl::PointCloud<PointSLIM> cloud;
  ASSERT_EQ(pcl::io::loadPCDFile(folder / "a.pcd", cloud), 0);
  ASSERT_EQ(cloud.size(), 50u);
  pcl::PointCloud<PointSLIM> expected;
  const SurfaceMetadata metadata = toPCL(surface, expected);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    EXPECT_EQ(cloud[i].x, expected[i].x);
    EXPECT_EQ(cloud[i].normal_z, expected[i].normal_z);
    EXPECT_EQ(cloud[i].c[14], expected[i].c[14]);
    EXPECT_EQ(cloud[i].confidence, expected[i].confidence);
  }
  expectSame(surface, fromPCL(cloud, &metadata));
}

TEST(SurfaceFiles, PclReadsThePly) {
  const TemporaryFolder folder;
  const SLIMSurface surface = sphereSurface(2, 50);
  ASSERT_FALSE(saveSurface(folder / "a.ply", surface));
  pcl::PCLPointCloud2 cloud, expected;
  ASSERT_EQ(pcl::io::loadPLYFile(folder / "a.ply", cloud), 0);
  const SurfaceMetadata metadata = toPCL(surface, expected);
  EXPECT_EQ(cloud.width, 50u);
  EXPECT_EQ(cloud.data, expected.data);
  expectSame(surface, fromPCL(cloud, &metadata));
}

TEST(SurfaceFiles, GiveBackThatSidesAreInDoubt) {
  const TemporaryFolder folder;
  SLIMSurface surface = sphereSurface(3, 50);
  surface.info.sides_in_doubt = true;
  for (const char* name : {"doubt.slim", "doubt.ply", "doubt.pcd", "doubt.vtp"}) {
    ASSERT_FALSE(saveSurface(folder / name, surface)) << name;
    const auto loaded = loadSurface(folder / name);
    ASSERT_TRUE(loaded) << loaded.error().message;
    EXPECT_TRUE(loaded->info.sides_in_doubt) << name;
  }
}

TEST(SurfaceFiles, SurfelsWithoutMetadataAreStillASurface) {
  const TemporaryFolder folder;
  const SLIMSurface surface = sphereSurface(3, 200);
  pcl::PCLPointCloud2 cloud;
  toPCL(surface, cloud);
  ASSERT_EQ(pcl::io::savePCDFile(folder / "rewritten.pcd", cloud), 0);
  const auto loaded = loadSurface(folder / "rewritten.pcd");
  ASSERT_TRUE(loaded) << loaded.error().message;
  ASSERT_EQ(loaded->size(), surface.size());
  EXPECT_EQ(loaded->info.degree, 3);
  EXPECT_FALSE(loaded->info.oriented);
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const double expected = surface.info.origin[0] + surface.info.scale * surface.cx[i];
    EXPECT_NEAR(loaded->info.origin[0] + loaded->info.scale * loaded->cx[i], expected, 1e-5);
    EXPECT_NEAR(loaded->info.scale * loaded->radius[i], surface.info.scale * surface.radius[i],
                1e-7);
  }
}

TEST(SurfaceFiles, NewerMetadataAreRefused) {
  const TemporaryFolder folder;
  const std::string path = folder / "a.ply";
  ASSERT_FALSE(saveSurface(path, sphereSurface(1, 5)));
  auto bytes = fileBytes(path);
  const std::string key = "pcl_slim version 1";
  const auto at = std::search(bytes.begin(), bytes.end(), key.begin(), key.end());
  ASSERT_NE(at, bytes.end());
  at[static_cast<std::ptrdiff_t>(key.size()) - 1] = '7';
  writeBytes(path, bytes);
  EXPECT_NE(loadSurface(path).error().message.find("newer"), std::string::npos);
}

TEST(SurfaceConversion, BadSurfelsAreNamed) {
  pcl::PointCloud<PointSLIM> cloud;
  EXPECT_TRUE(fromPCL(cloud)) << "no surfels are a surface without surfels";
  cloud.resize(1);
  cloud[0].normal_z = 1.0f;
  EXPECT_FALSE(fromPCL(cloud)) << "radius 0";
  cloud[0].radius = 1.0f;
  EXPECT_TRUE(fromPCL(cloud));
  cloud[0].degree = 1.5f;
  EXPECT_FALSE(fromPCL(cloud));
  cloud[0].degree = 9.0f;
  EXPECT_FALSE(fromPCL(cloud));
  cloud[0].degree = 1.0f;
  cloud[0].x = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(fromPCL(cloud));
}

}  // namespace
}  // namespace pcl_slim
