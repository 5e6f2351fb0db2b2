// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/filters/io/splat_files.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "pcl_slim/filters/io/surface_files.h"
#include "support/sphere_surface.h"

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;

SplatSet someSplats(bool gradient, const std::array<double, 3>& origin) {
  SplatSet set;
  set.origin = origin;
  set.resize(50, gradient);
  for (std::size_t i = 0; i < set.size(); ++i) {
    const auto t = static_cast<float>(i);
    set.x[i] = std::sin(t);
    set.y[i] = std::cos(1.3f * t);
    set.z[i] = 0.1f * t;
    set.nx[i] = 0.6f;
    set.ny[i] = 0.0f;
    set.nz[i] = 0.8f;
    set.radius[i] = 0.01f * (t + 1.0f);
    set.rgb[i] = static_cast<std::uint32_t>(i) * 40503u & 0xffffffu;
    set.confidence[i] = t + 1.0f;
    if (gradient) set.gradient[i] = {t, -t, 0.5f, 1, 2, 3, 4, 5, -6.5f};
  }
  return set;
}

TEST(SplatFiles, WhatIsWrittenIsRead) {
  const TemporaryFolder folder;
  for (const bool gradient : {false, true}) {
    for (const double far : {0.0, 4918360.25}) {
      const SplatSet set = someSplats(gradient, {far, far, 0.0});
      for (const char* name : {"a.pcd", "a.ply"}) {
        const std::string path = folder / name;
        ASSERT_FALSE(savePointFile(path, toPointFile(set, splatShift(set))));
        const auto file = loadPointFile(path);
        ASSERT_TRUE(file) << file.error().message;
        ASSERT_TRUE(holdsSplats(*file));
        std::uint64_t skipped = 1;
        const auto read = splatsFrom(*file, &skipped);
        ASSERT_TRUE(read) << read.error().message;
        EXPECT_EQ(skipped, 0u);
        // Floats less the shift: of a cloud's diagonal of 6 they resolve 2^-21.
        for (std::size_t i = 0; i < set.size(); ++i) {
          EXPECT_NEAR(read->origin[0] + read->x[i], set.origin[0] + set.x[i], 4e-6);
          EXPECT_NEAR(read->origin[1] + read->y[i], set.origin[1] + set.y[i], 4e-6);
          EXPECT_NEAR(read->origin[2] + read->z[i], set.origin[2] + set.z[i], 4e-6);
        }
        EXPECT_EQ(read->nz, set.nz);
        EXPECT_EQ(read->radius, set.radius);
        EXPECT_EQ(read->rgb, set.rgb);
        EXPECT_EQ(read->confidence, set.confidence);
        EXPECT_EQ(read->gradient, set.gradient);
      }
    }
  }
}

TEST(SplatFiles, UnusableDiscsAreLeftOut) {
  SplatSet set = someSplats(true, {});
  set.x[3] = std::nanf("");
  set.radius[4] = -1.0f;
  set.nx[5] = set.nz[5] = 0.0f;
  set.gradient[6][2] = std::numeric_limits<float>::infinity();
  std::uint64_t skipped = 0;
  const auto read = splatsFrom(toPointFile(set, {}), &skipped);
  ASSERT_TRUE(read);
  EXPECT_EQ(skipped, 4u);
  EXPECT_EQ(read->size(), set.size() - 4);
  EXPECT_EQ(read->kept[3], 7u);
  EXPECT_EQ(read->x[3], set.x[7]);
}

TEST(SplatFiles, OtherFilesAreToldApart) {
  const TemporaryFolder folder;
  const std::string path = folder / "surface.pcd";
  ASSERT_FALSE(saveSurface(path, pcl_slim_test::sphereSurface(2, 50)));
  const auto surface = loadPointFile(path);
  ASSERT_TRUE(surface);
  EXPECT_FALSE(holdsSplats(*surface));
  EXPECT_TRUE(surfaceFrom(*surface));

  PointFile file = toPointFile(someSplats(false, {}), {});
  for (auto& field : file.cloud.fields) {
    if (field.name == "normal_y") field.name = "other";
  }
  const auto read = splatsFrom(file);
  ASSERT_FALSE(read);
  EXPECT_NE(read.error().message.find("normal_y"), std::string::npos);
  EXPECT_FALSE(surfaceFrom(file));
}

TEST(SplatFiles, WithoutColorsDiscsAreWhite) {
  PointFile file = toPointFile(someSplats(false, {}), {});
  for (auto& field : file.cloud.fields) {
    if (field.name == "rgba" || field.name == "confidence") field.name += "_gone";
  }
  const auto read = splatsFrom(file);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->rgb[7], 0xffffffu);
  EXPECT_EQ(read->confidence[7], 1.0f);
}

}  // namespace
}  // namespace pcl_slim
