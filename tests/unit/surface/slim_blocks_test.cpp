// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/surface/slim_blocks.h"

#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <vector>

#include "file/slim_file.h"
#include "pcl_slim/surface/surface_io.h"
#include "support/sphere_surface.h"
#include "support/temporary_folder.h"
#include "support/trim_maps.h"

namespace {

using namespace pcl_slim;
using namespace pcl_slim_test;

/** A surface whose surfels ascend in x, so that slices are side by side. */
SLIMSurface someSurface() {
  SLIMSurface surface = sphereSurface(3, 400);
  setRandomTrimMaps(surface);
  return surface;
}

Error writeBlocks(const std::string& path, const SLIMSurface& surface, std::size_t blocks,
                  double rounding = 0.0) {
  SlimBlockWriter writer;
  if (Error error = writer.open(path, rounding)) return error;
  for (std::size_t b = 0; b < blocks; ++b) {
    const std::size_t begin = b * surface.size() / blocks, end = (b + 1) * surface.size() / blocks;
    if (Error error = writer.add(surface.slice(begin, end), 10 * b, 10 * b + 10)) return error;
  }
  if (Error error = writer.add(surface.slice(0, 0), 999, 1000)) return error;
  return writer.finish();
}

TEST(SlimBlocks, GiveTheWholeSurfaceBack) {
  const TemporaryFolder folder;
  const std::string path = folder / "a.slim";
  const SLIMSurface surface = someSurface();
  ASSERT_TRUE(surface.hasTrimMaps());
  const Error error = writeBlocks(path, surface, 7);
  ASSERT_FALSE(error) << error.message;
  const auto loaded = loadSlim(path);
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_EQ(encodeSlim(*loaded), encodeSlim(surface));
  EXPECT_FALSE(loaded->child_begin.empty());
}

TEST(SlimBlocks, CanBeRounded) {
  const TemporaryFolder folder;
  const std::string whole = folder / "a.slim", rounded = folder / "b.slim";
  const SLIMSurface surface = someSurface();
  ASSERT_FALSE(writeBlocks(whole, surface, 3));
  ASSERT_FALSE(writeBlocks(rounded, surface, 3, 0.3));
  // The maps' bits are random, so that they take as much as before.
  EXPECT_LT(fileBytes(rounded).size(), fileBytes(whole).size() - 20 * surface.size());
  const auto loaded = loadSlim(rounded);
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_EQ(loaded->size(), surface.size());
  EXPECT_EQ(loaded->numLeaves(), surface.numLeaves());
}

TEST(SlimBlocks, AreFoundByDirectoryAndBox) {
  const TemporaryFolder folder;
  const std::string path = folder / "a.slim";
  const SLIMSurface surface = someSurface();
  ASSERT_FALSE(writeBlocks(path, surface, 7));
  const auto directory = loadSlimDirectory(path);
  ASSERT_TRUE(directory) << directory.error().message;
  ASSERT_EQ(directory->blocks.size(), 7u) << "a tile without surfels leaves no block";
  EXPECT_EQ(directory->surfels, surface.size());
  std::size_t first = 0;
  for (const SlimBlock& block : directory->blocks) {
    for (std::size_t i = first; i < first + block.surfels; ++i) {
      EXPECT_LE(block.low[2], surface.cz[i] - surface.radius[i]);
      EXPECT_GE(block.high[0], surface.cx[i] + surface.radius[i]);
    }
    first += block.surfels;
  }
  const auto third = loadSlimBlocks(path, [](const SlimBlock& b) { return b.first_key == 20; });
  ASSERT_TRUE(third);
  EXPECT_EQ(third->size(), directory->blocks[2].surfels);
  const SurfaceInfo& info = surface.info;
  std::array<double, 3> low, high;
  for (std::size_t a = 0; a < 3; ++a) {
    low[a] = info.origin[a] + info.scale * static_cast<double>(directory->blocks[0].low[a]);
    high[a] = low[a] + 1e-6 * info.scale;
  }
  const auto corner = loadSlimBox(path, {low, high});
  ASSERT_TRUE(corner);
  std::size_t expected = 0;
  for (const SlimBlock& block : directory->blocks) {
    bool meets = true;
    for (std::size_t a = 0; a < 3; ++a) {
      meets = meets && block.low[a] <= directory->blocks[0].low[a] + 1e-6f &&
              block.high[a] >= directory->blocks[0].low[a];
    }
    if (meets) expected += block.surfels;
  }
  EXPECT_EQ(corner->size(), expected);
  EXPECT_LT(corner->size(), surface.size());
}

TEST(SlimBlocks, AreReadOnceWhileTheyAreKept) {
  const TemporaryFolder folder;
  const std::string path = folder / "a.slim";
  const SLIMSurface surface = someSurface();
  ASSERT_FALSE(writeBlocks(path, surface, 7));
  SlimBlockReader reader;
  ASSERT_FALSE(reader.open(path));
  const std::vector<bool> some{false, true, false, true, false, false, false};
  const std::vector<bool> more{false, true, true, true, false, false, false};
  constexpr std::uint64_t kAll = 1 << 30;
  const auto first = reader.load(some, kAll);
  ASSERT_TRUE(first);
  EXPECT_EQ(reader.blocksRead(), 2u);
  // What is kept needs no file any more; order and bytes are the file's.
  std::fstream(path, std::ios::in | std::ios::out | std::ios::binary)
      .seekp(static_cast<std::streamoff>(reader.directory().blocks[1].offset))
      .write("??", 2);
  const auto second = reader.load(more, kAll);
  ASSERT_TRUE(second) << second.error().message;
  EXPECT_EQ(reader.blocksRead(), 3u);
  const std::size_t n = surface.size();
  EXPECT_EQ(encodeSlim(*second), encodeSlim(surface.slice(n / 7, 4 * n / 7)));
  // Without room block 1 is dropped, and the next call reads it again.
  ASSERT_TRUE(reader.load({false, false, false, true, false, false, false}, 1));
  EXPECT_FALSE(reader.load(some, kAll));
}

TEST(SlimBlocks, AnyChangedByteIsNoticed) {
  const TemporaryFolder folder;
  const std::string path = folder / "a.slim";
  ASSERT_FALSE(writeBlocks(path, someSurface(), 3));
  const auto bytes = fileBytes(path);
  for (std::size_t at = 0; at < bytes.size(); at += at < 200 || at + 300 > bytes.size() ? 1 : 97) {
    auto changed = bytes;
    changed[at] ^= 0x20;
    EXPECT_FALSE(decodeSlim(changed.data(), changed.size())) << at;
  }
}

TEST(SlimBlocks, AHeaderThatCannotBeIsAnErrorWithoutABlock) {
  const auto decoded = [](const SurfaceInfo& info, std::uint64_t surfels) {
    detail::ByteWriter file;
    detail::putSlimHeader(info, detail::kSlimBlocksVersion, surfels, 16, file);
    file.putUnsigned(std::uint64_t{detail::kSlimHeaderBytes});  // where the directory begins
    file.putUnsigned(std::uint64_t{0});                         // its entries
    detail::sealSlim(file.bytes);
    return decodeSlim(file.bytes.data(), file.bytes.size());
  };
  EXPECT_TRUE(decoded({}, 0));
  EXPECT_FALSE(decoded({}, 1));
  for (double SurfaceInfo::*const member : {&SurfaceInfo::scale, &SurfaceInfo::lambda,
                                            &SurfaceInfo::penalty, &SurfaceInfo::cover_radius}) {
    SurfaceInfo info;
    info.*member = -1.0;
    EXPECT_FALSE(decoded(info, 0));
  }
}

TEST(SlimBlocks, ACutOffFileIsAnError) {
  const TemporaryFolder folder;
  const std::string path = folder / "a.slim";
  ASSERT_FALSE(writeBlocks(path, someSurface(), 3));
  const auto bytes = fileBytes(path);
  for (std::size_t size = 0; size < bytes.size(); size += 61) {
    const auto cut = decodeSlim(bytes.data(), size);
    ASSERT_FALSE(cut) << size;
    EXPECT_EQ(cut.error().code, ErrorCode::kBadInput);
  }
}

TEST(SlimBlocks, AFileOfOneSurfaceIsOneBlock) {
  const TemporaryFolder folder;
  const std::string path = folder / "a.slim";
  const SLIMSurface surface = someSurface();
  ASSERT_FALSE(saveSlim(path, surface));
  EXPECT_FALSE(loadSlimDirectory(path));
  const auto loaded = loadSlimBlocks(path, [](const SlimBlock&) { return false; });
  ASSERT_TRUE(loaded);
  EXPECT_EQ(loaded->size(), surface.size());
  EXPECT_EQ(loadSlimBlocks(folder / "none.slim", nullptr).error().code, ErrorCode::kIo);
}

TEST(SlimBlocks, NothingAppearsWithoutASurfel) {
  const TemporaryFolder folder;
  SlimBlockWriter writer;
  ASSERT_FALSE(writer.open(folder / "a.slim"));
  EXPECT_TRUE(writer.finish());
  EXPECT_TRUE(fileBytes(folder / "a.slim").empty());
}

TEST(SLIMSurfaceParts, SlicesAppendToTheWhole) {
  const SLIMSurface surface = someSurface();
  SLIMSurface joined;
  for (std::size_t begin = 0; begin < surface.size(); begin += 37)
    joined.append(surface.slice(begin, std::min(surface.size(), begin + 37)));
  EXPECT_EQ(encodeSlim(joined), encodeSlim(surface));
  SLIMSurface closed = sphereSurface(3, 50), mixed = closed;
  mixed.append(surface.slice(0, 40));
  EXPECT_FALSE(mixed.validate());
  EXPECT_EQ(mixed.size(), 90u);
}

}  // namespace
