// SPDX-License-Identifier: BSD-3-Clause
// What a build without libpng or without VTK answers. The program is linked from the stand-ins in
// place of the library's own sources, so a build that has both can test it.
#include <gtest/gtest.h>

#include "pcl_slim/core/file_access.h"
#include "pcl_slim/filters/io/surface_files.h"
#include "pcl_slim/render/image.h"
#include "support/sphere_surface.h"
#include "support/temporary_folder.h"

namespace pcl_slim {
namespace {

using pcl_slim_test::sphereSurface;
using pcl_slim_test::TemporaryFolder;

void expectRefused(const Error& error, const std::string& path, const std::string& remedy) {
  EXPECT_EQ(error.code, ErrorCode::kBadArgument);
  EXPECT_NE(error.message.find(path), std::string::npos) << error.message;
  EXPECT_NE(error.message.find(remedy), std::string::npos) << error.message;
}

TEST(StandIns, WithoutPngPicturesArePpm) {
  const TemporaryFolder folder;
  const Image image{2, 1, {255, 0, 0, 0, 0, 255}};
  const std::string png = folder / "a.png";
  expectRefused(checkImageExtension(png), png, ".ppm");
  expectRefused(saveImage(png, image), png, ".ppm");
  expectRefused(savePng(png, image), png, ".ppm");
  expectRefused(loadPng(png).error(), png, "PCL_SLIM_WITH_PNG");
  EXPECT_EQ(folder.numFiles(), 0u);

  const std::string ppm = folder / "a.PPM";
  EXPECT_FALSE(checkImageExtension(ppm));
  ASSERT_FALSE(saveImage(ppm, image));
  const auto bytes = readFile(ppm);
  ASSERT_TRUE(bytes);
  const std::string expected =
      std::string("P6\n2 1\n255\n\377", 12) + std::string(4, '\0') + "\377";
  EXPECT_EQ(std::string(bytes->begin(), bytes->end()), expected);
}

TEST(StandIns, WithoutVtpSurfacesAreOtherFiles) {
  const TemporaryFolder folder;
  const SLIMSurface surface = sphereSurface(2, 50);
  const std::string vtp = folder / "a.VTP";
  expectRefused(checkSurfaceExtension(vtp), vtp, ".ply");
  expectRefused(saveSurface(vtp, surface), vtp, ".ply");
  expectRefused(loadSurface(vtp).error(), vtp, ".ply");
  EXPECT_EQ(folder.numFiles(), 0u);
  for (const char* name : {"a.pcd", "a.ply", "a.slim"}) {
    EXPECT_FALSE(saveSurface(folder / name, surface)) << name;
    const auto read = loadSurface(folder / name);
    ASSERT_TRUE(read) << name;
    EXPECT_EQ(read->size(), surface.size()) << name;
  }
}

}  // namespace
}  // namespace pcl_slim
