// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/surface/surface_io.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "support/clouds.h"
#include "support/sphere_surface.h"
#include "support/trim_maps.h"

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;

constexpr std::size_t kHeaderBytes = 136;

std::string decodeError(const std::vector<unsigned char>& bytes) {
  const auto surface = decodeSlim(bytes.data(), bytes.size());
  return surface ? "" : surface.error().message;
}

void expectSame(const SLIMSurface& a, const SLIMSurface& b) {
  for (const auto column :
       {&SLIMSurface::cx, &SLIMSurface::cy, &SLIMSurface::cz, &SLIMSurface::radius,
        &SLIMSurface::nx, &SLIMSurface::ny, &SLIMSurface::nz, &SLIMSurface::coefficients,
        &SLIMSurface::error, &SLIMSurface::effective_count}) {
    EXPECT_EQ(a.*column, b.*column);
  }
  for (const auto column : {&SLIMSurface::degree, &SLIMSurface::level, &SLIMSurface::flags}) {
    EXPECT_EQ(a.*column, b.*column);
  }
  for (const auto links :
       {&SLIMSurface::children, &SLIMSurface::child_begin, &SLIMSurface::roots}) {
    EXPECT_EQ(a.*links, b.*links);
  }
  EXPECT_EQ(a.trim_begin, b.trim_begin);
  EXPECT_EQ(a.trim_maps, b.trim_maps);
  EXPECT_EQ(a.info.origin, b.info.origin);
  EXPECT_EQ(a.info.scale, b.info.scale);
  EXPECT_EQ(a.info.diagonal, b.info.diagonal);
  EXPECT_EQ(a.info.lambda, b.info.lambda);
  EXPECT_EQ(a.info.correlation, b.info.correlation);
  EXPECT_EQ(a.info.num_points, b.info.num_points);
  EXPECT_EQ(a.info.oriented, b.info.oriented);
  EXPECT_EQ(a.info.sides_in_doubt, b.info.sides_in_doubt);
  EXPECT_EQ(a.info.fit_kernel, b.info.fit_kernel);
}

class SurfaceIo : public testing::TestWithParam<int> {};

TEST_P(SurfaceIo, GivesTheSurfaceBackExactly) {
  const SLIMSurface surface = sphereSurface(GetParam(), 500);
  const auto bytes = encodeSlim(surface);
  const auto again = decodeSlim(bytes.data(), bytes.size());
  ASSERT_TRUE(again) << again.error().message;
  expectSame(surface, *again);
  EXPECT_EQ(bytes, encodeSlim(*again));
}

TEST_P(SurfaceIo, GivesTheCorrelationOfNoiseBack) {
  SLIMSurface surface = sphereSurface(GetParam(), 50);
  surface.info.correlation = 7.25;
  const auto bytes = encodeSlim(surface);
  const auto again = decodeSlim(bytes.data(), bytes.size());
  ASSERT_TRUE(again) << again.error().message;
  expectSame(surface, *again);
}

TEST_P(SurfaceIo, GivesDoubtsBack) {
  SLIMSurface surface = sphereSurface(GetParam(), 50);
  surface.info.sides_in_doubt = true;
  const auto bytes = encodeSlim(surface);
  const auto again = decodeSlim(bytes.data(), bytes.size());
  ASSERT_TRUE(again) << again.error().message;
  expectSame(surface, *again);
}

TEST_P(SurfaceIo, GivesTrimMapsBackExactly) {
  SLIMSurface surface = sphereSurface(GetParam(), 300);
  const auto closed = encodeSlim(surface);
  setRandomTrimMaps(surface);
  const auto bytes = encodeSlim(surface);
  EXPECT_EQ(closed[8], 1) << "files without maps stay what older programs read";
  EXPECT_EQ(bytes[8], 2);
  EXPECT_EQ(bytes.size(), closed.size() + surface.trim_maps.size());
  const auto again = decodeSlim(bytes.data(), bytes.size());
  ASSERT_TRUE(again) << again.error().message;
  expectSame(surface, *again);
  EXPECT_EQ(bytes, encodeSlim(*again));
}

TEST_P(SurfaceIo, HoldsTheFloatsItPromises) {
  SLIMSurface surface = sphereSurface(GetParam(), 100);
  for (auto& degree : surface.degree) degree = static_cast<std::uint8_t>(GetParam());
  for (std::size_t i = 0; GetParam() == 1 && i < surface.size(); ++i) {
    // As the fit makes linear surfels: the normal is the plane's own.
    surface.coefficients[3 * i + 1] = surface.coefficients[3 * i + 2] = 0.0f;
  }
  const std::size_t floats[] = {7, 12, 16, 21};
  const std::size_t beside = 3 + 2 * sizeof(float);  // degree, level, flags, error, confidence
  EXPECT_EQ(encodeSlim(surface).size(),
            kHeaderBytes + 100 * (floats[GetParam() - 1] * sizeof(float) + beside));
}

TEST(SurfaceIo, ALinearSurfelWhoseFrameIsNotItsPlanesHasNineFloats) {
  SLIMSurface surface = sphereSurface(1, 100);
  for (std::size_t i = 0; i < surface.size(); ++i) {
    surface.coefficients[3 * i + 1] = i < 40 ? 0.25f : 0.0f;
    surface.coefficients[3 * i + 2] = 0.0f;
  }
  const std::size_t beside = 3 + 2 * sizeof(float);
  EXPECT_EQ(encodeSlim(surface).size(),
            kHeaderBytes + 100 * beside + (40 * 9 + 60 * 7) * sizeof(float));
}

TEST(SurfaceIo, AFitOfDegreeOneHasSevenFloatsASurfel) {
  FitParams params;
  params.degree = 1;
  params.trim = false;
  const Fitted f = fitted(sceneCloud(measure::Shape::kSphere, 3000, 0.0), params);
  const std::size_t floats = 7 + 2;  // and error and confidence
  EXPECT_EQ(encodeSlim(f.surface).size(),
            kHeaderBytes + f.surface.size() * (3 + floats * sizeof(float)));
}

INSTANTIATE_TEST_SUITE_P(Degrees, SurfaceIo, testing::Range(1, 5));

TEST(SurfaceIo, NormalsOffTheGridStayWithinItsReach) {
  SLIMSurface surface = sphereSurface(2, 200);
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const double n[3] = {surface.nx[i] + 0.1, surface.ny[i], surface.nz[i]};
    const double length = std::hypot(n[0], n[1], n[2]);
    surface.nx[i] = static_cast<float>(n[0] / length);
    surface.ny[i] = static_cast<float>(n[1] / length);
    surface.nz[i] = static_cast<float>(n[2] / length);
  }
  const auto bytes = encodeSlim(surface);
  const auto again = decodeSlim(bytes.data(), bytes.size());
  ASSERT_TRUE(again);
  for (std::size_t i = 0; i < surface.size(); ++i) {
    EXPECT_LT(std::hypot(surface.nx[i] - again->nx[i], surface.ny[i] - again->ny[i],
                         surface.nz[i] - again->nz[i]),
              7e-7);
  }
  EXPECT_EQ(bytes, encodeSlim(*again));
}

TEST(SurfaceIo, EmptySurfaceIsAFileToo) {
  SLIMSurface surface;
  const auto bytes = encodeSlim(surface);
  const auto again = decodeSlim(bytes.data(), bytes.size());
  ASSERT_TRUE(again);
  EXPECT_TRUE(again->empty());
}

TEST(SurfaceIo, EveryTruncationIsNamed) {
  SLIMSurface open = sphereSurface(3, 20);
  setRandomTrimMaps(open);
  const auto bytes = encodeSlim(open);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const auto surface = decodeSlim(bytes.data(), size);
    ASSERT_FALSE(surface) << size;
    const std::string& message = surface.error().message;
    const bool names_it = message.find("truncated") != std::string::npos;
    EXPECT_TRUE(names_it || size < 8) << size << message;
    EXPECT_EQ(message.find('\n'), std::string::npos);
  }
}

TEST(SurfaceIo, EveryFlippedBitIsFound) {
  const auto bytes = encodeSlim(sphereSurface(2, 10));
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    auto damaged = bytes;
    damaged[i] ^= static_cast<unsigned char>(1u << (i % 8));
    EXPECT_NE(decodeError(damaged), "") << "byte " << i;
  }
}

TEST(SurfaceIo, ForeignNewerAndLongerFilesAreTold) {
  auto bytes = encodeSlim(sphereSurface(2, 10));
  EXPECT_NE(decodeError({'p', 'l', 'y', '\n', 0, 0, 0, 0, 0, 0}).find("not a .slim file"),
            std::string::npos);
  auto newer = bytes;
  newer[8] = 9;
  EXPECT_NE(decodeError(newer).find("newer"), std::string::npos);
  bytes.push_back(0);
  EXPECT_NE(decodeError(bytes).find("followed by other data"), std::string::npos);
}

TEST(SurfaceIo, FilesAppearOnlyWhenComplete) {
  const TemporaryFolder folder;
  const SLIMSurface surface = sphereSurface(4, 50);
  const std::string path = folder / "sphere.slim";
  ASSERT_FALSE(saveSlim(path, surface));
  EXPECT_EQ(folder.numFiles(), 1u);
  const auto again = loadSlim(path);
  ASSERT_TRUE(again) << again.error().message;
  expectSame(surface, *again);
  EXPECT_EQ(fileBytes(path), encodeSlim(surface));

  const Error unwritable = saveSlim(folder / "absent/sphere.slim", surface);
  EXPECT_EQ(unwritable.code, ErrorCode::kIo);
  EXPECT_EQ(loadSlim(folder / "absent.slim").error().code, ErrorCode::kIo);

  SLIMSurface broken = surface;
  broken.radius[3] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(saveSlim(folder / "broken.slim", broken));
  EXPECT_EQ(folder.numFiles(), 1u);
}

}  // namespace
}  // namespace pcl_slim
