// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/surface/surfel_texture.h"

#include <gtest/gtest.h>

#include "pcl_slim/surface/surface_components.h"
#include "pcl_slim/surface/surface_io.h"
#include "support/colors.h"
#include "support/sphere_surface.h"
#include "support/trim_maps.h"

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;

TEST(SurfelTexture, IsBilinearBetweenTheMiddlesOfItsTexels) {
  // Red rises along u, green along v.
  constexpr int kSide = 4;
  std::vector<std::uint8_t> rgb;
  for (int k = 0; k < kSide * kSide; ++k) {
    for (const int byte : {20 * (k % kSide), 50 * (k / kSide), 7})
      rgb.push_back(static_cast<std::uint8_t>(byte));
  }
  const SurfelTexture texture{kSide, rgb.data()};
  const auto texelAt = [](double at) {  // a place in units of texels from the square's corner
    return static_cast<float>((2 * at / kSide - 1) * SurfelTexture::kReach);
  };
  for (double x = 0.5; x <= kSide - 0.5; x += 0.25) {
    for (double y = 0.5; y <= kSide - 0.5; y += 0.25) {
      const auto color = texture.colorAt(texelAt(x), texelAt(y));
      EXPECT_NEAR(color[0], 20 * (x - 0.5), 1e-3);
      EXPECT_NEAR(color[1], 50 * (y - 0.5), 1e-3);
      EXPECT_NEAR(color[2], 7, 1e-4);
    }
  }
  EXPECT_EQ(texture.colorAt(-2, -2)[0], 0) << "the border goes on beyond it";
  EXPECT_EQ(texture.colorAt(2, 2)[0], 60);
  const SurfelTexture single{1, rgb.data() + 3};
  EXPECT_EQ(single.colorAt(0.3f, -0.6f), (std::array<float, 3>{20, 0, 7}));
}

TEST(SurfelTexture, CountsMostAtTheMiddleAndNextToNothingBeyond) {
  EXPECT_NEAR(SurfelTexture::weight(0, 1), 1, 1e-3);
  const float reach_sq = SurfelTexture::kReach * SurfelTexture::kReach;
  EXPECT_NEAR(SurfelTexture::weight(reach_sq, 0.1f), 1e-5, 1e-9);
  for (float s_sq = 0; s_sq < 0.9f; s_sq += 0.1f)
    EXPECT_GT(SurfelTexture::weight(s_sq, 0.1f), SurfelTexture::weight(s_sq + 0.1f, 0.05f));
}

TEST(SurfelTexture, StaysInPlaceWhenItsSurfelIsTurnedRound) {
  SLIMSurface surface = sphereSurface(2, 20);
  setRandomColors(surface);
  setRandomTextures(surface);
  const std::vector<std::uint8_t> before = surface.textures;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    if (surface.texture(i).empty()) continue;
    const auto color = surface.texture(i).colorAt(0.3f, -0.2f);
    surface.flip(i);
    const auto turned = surface.texture(i).colorAt(0.3f, 0.2f);
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(turned[c], color[c], 1e-2);
    surface.flip(i);
  }
  EXPECT_EQ(surface.textures, before);
}

TEST(SurfelTexture, GoesWithPartsTilesAndComponents) {
  SLIMSurface surface = sphereSurface(2, 50);
  setRandomColors(surface);
  setRandomTextures(surface);
  ASSERT_FALSE(surface.validate());
  const SLIMSurface low = surface.slice(0, 20), high = surface.slice(20, 50);
  for (std::size_t i = 0; i < 30; ++i) {
    const SurfelTexture whole = surface.texture(20 + i), part = high.texture(i);
    ASSERT_EQ(part.side, whole.side);
    EXPECT_TRUE(std::equal(part.rgb, part.rgb + SurfelTexture::numBytes(part.side), whole.rgb));
  }
  SLIMSurface joined;
  joined.append(low);
  joined.append(high);
  EXPECT_EQ(joined.textures, surface.textures);
  EXPECT_EQ(joined.texture_begin, surface.texture_begin);
  SLIMSurface plain = low;
  plain.dropTextures();
  plain.append(high);
  ASSERT_FALSE(plain.validate()) << "surfels without textures have none in the sum";
  EXPECT_EQ(plain.textures, high.textures);
  plain = low;
  plain.colors.clear();
  plain.dropTextures();
  plain.append(high);
  EXPECT_FALSE(plain.hasTextures()) << "nor have surfaces without colours";
  surface.buildLinks();
  SLIMSurface kept = surface;
  dropComponents(1, kept, 1);
  EXPECT_EQ(kept.textures, surface.textures);
}

TEST(SurfelTexture, OfAnotherSizeIsNamed) {
  SLIMSurface surface = sphereSurface(2, 20);
  setRandomColors(surface);
  setRandomTextures(surface);
  const auto isNamed = [](SLIMSurface broken, const auto& change) {
    change(broken);
    const Error error = broken.validate();
    return error && error.message.find("texture") != std::string::npos;
  };
  EXPECT_TRUE(isNamed(surface, [](SLIMSurface& s) { s.textures.pop_back(); }));
  EXPECT_TRUE(isNamed(surface, [](SLIMSurface& s) { s.texture_begin.pop_back(); }));
  EXPECT_TRUE(isNamed(surface, [](SLIMSurface& s) { s.texture_begin[3] += 1; }));
  EXPECT_TRUE(isNamed(surface, [](SLIMSurface& s) { s.textures[0] = 200; }));
  EXPECT_TRUE(isNamed(surface, [](SLIMSurface& s) { s.textures[0] = 0; }));
  EXPECT_TRUE(isNamed(surface, [](SLIMSurface& s) { s.colors.clear(); }));
}

TEST(SurfelTexture, IsInFilesOfItsOwnVersion) {
  for (const double share : {0.0, 0.1}) {
    for (const int color_error : {0, 2, 8}) {
      SLIMSurface surface = sphereSurface(3, 120);
      setRandomTrimMaps(surface);
      setRandomColors(surface);
      const auto plain = encodeSlim(surface, share);
      setRandomTextures(surface);
      const auto bytes = encodeSlim(surface, {share, color_error});
      EXPECT_EQ(plain[8], share > 0 ? 5 : 4) << "files without textures stay what they were";
      EXPECT_EQ(bytes[8], 6);
      const auto again = decodeSlim(bytes.data(), bytes.size());
      ASSERT_TRUE(again) << again.error().message;
      ASSERT_EQ(again->textures.size(), surface.textures.size());
      if (share > 0) continue;  // the surfels are in another order
      int most = 0;
      for (std::size_t i = 0; i < surface.size(); ++i) {
        const SurfelTexture own = surface.texture(i), read = again->texture(i);
        ASSERT_EQ(read.side, own.side);
        for (std::size_t k = 0; k < SurfelTexture::numBytes(own.side); ++k)
          most = std::max(most, std::abs(int{own.rgb[k]} - int{read.rgb[k]}));
      }
      EXPECT_LE(most, color_error);
      if (color_error == 0) {
        EXPECT_EQ(encodeSlim(*again), bytes);
      }
    }
  }
}

TEST(SurfelTexture, InRoundedFilesBelongsToItsSurfel) {
  SLIMSurface surface = sphereSurface(3, 120);
  setRandomColors(surface);
  setRandomTextures(surface);
  const auto bytes = encodeSlim(surface, {0.1, 0});
  const auto again = decodeSlim(bytes.data(), bytes.size());
  ASSERT_TRUE(again);
  for (std::size_t i = 0; i < surface.size(); ++i) {
    std::size_t nearest = 0;
    double least = HUGE_VAL;
    for (std::size_t k = 0; k < again->size(); ++k) {
      const double distance = std::hypot(surface.cx[i] - again->cx[k], surface.cy[i] - again->cy[k],
                                         surface.cz[i] - again->cz[k]);
      if (distance < least) nearest = k;
      least = std::min(least, distance);
    }
    const SurfelTexture own = surface.texture(i), read = again->texture(nearest);
    ASSERT_EQ(read.side, own.side);
    EXPECT_TRUE(std::equal(own.rgb, own.rgb + SurfelTexture::numBytes(own.side), read.rgb));
  }
}

TEST(SurfelTexture, InDamagedFilesIsAnError) {
  SLIMSurface surface = sphereSurface(2, 20);
  setRandomColors(surface);
  setRandomTextures(surface);
  const auto bytes = encodeSlim(surface);
  for (const std::size_t size : {bytes.size() - 1, bytes.size() - 100, std::size_t{150}})
    EXPECT_FALSE(decodeSlim(bytes.data(), size)) << size;
  EXPECT_TRUE(saveSlim("unused.slim", surface, {0.0, 33}));
  EXPECT_TRUE(saveSlim("unused.slim", surface, {0.0, -1}));
}

TEST(SurfelTexture, StatisticsCountLeaves) {
  SLIMSurface surface = sphereSurface(2, 20);
  EXPECT_EQ(surface.textureStatistics().leaves, 0u);
  setRandomColors(surface);
  setRandomTextures(surface);
  const TextureStatistics textures = surface.textureStatistics();
  std::uint64_t texels = 0, leaves = 0;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const auto side = static_cast<std::uint64_t>(surface.isLeaf(i) ? surface.texture(i).side : 0);
    texels += side * side;
    leaves += side > 0;
  }
  EXPECT_EQ(textures.leaves, leaves);
  EXPECT_EQ(textures.texels, texels);
  EXPECT_GT(textures.finest, 0);
}

}  // namespace
}  // namespace pcl_slim
