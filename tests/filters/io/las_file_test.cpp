// SPDX-License-Identifier: BSD-3-Clause
// LAS files: what the specification's tables say of each value, and that nothing of a file is lost.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "filters/io/point_values.h"
#include "pcl_slim/filters/io/point_file.h"
#include "support/las_bytes.h"
#include "support/temporary_folder.h"

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;

Result<PointFile> load(const TemporaryFolder& folder, const std::vector<unsigned char>& bytes) {
  writeBytes(folder / "in.las", bytes);
  return loadPointFile(folder / "in.las");
}

std::vector<unsigned char> saved(const TemporaryFolder& folder, const PointFile& file) {
  const Error error = savePointFile(folder / "out.las", file);
  EXPECT_FALSE(error) << error.message;
  return fileBytes(folder / "out.las");
}

/** Adds a field of floats, as programs do. */
void addFloats(PointFile& file, const std::string& name, float step) {
  PointTable& cloud = file.cloud;
  const std::size_t n = numPoints(cloud), old_step = cloud.point_step, new_step = old_step + 8;
  addField(cloud, name, kFloat32);
  std::vector<std::uint8_t> data(n * new_step);
  for (std::size_t i = 0; i < n; ++i) {
    const float number = step * static_cast<float>(i);
    std::memcpy(&data[i * new_step], &cloud.data[i * old_step], old_step);
    std::memcpy(&data[i * new_step + old_step], &number, 4);
  }
  cloud.point_step = static_cast<std::uint32_t>(new_step);
  cloud.data = std::move(data);
}

TEST(LasFile, EveryFormatComesBackBitByBit) {
  const TemporaryFolder folder;
  for (int format = 0; format <= 10; ++format) {
    for (const bool extra : {false, true}) {
      for (const std::size_t count : {0u, 1u, 333u}) {
        const LasBytes las = lasBytes(format, count, extra);
        const auto file = load(folder, las.bytes);
        ASSERT_TRUE(file) << format << ": " << file.error().message;
        EXPECT_EQ(numPoints(file->cloud), count);
        EXPECT_EQ(saved(folder, *file), las.bytes) << format << extra << count;
      }
    }
  }
}

TEST(LasFile, CoordinatesAreScaledInDouble) {
  const TemporaryFolder folder;
  LasBytes las = lasBytes(1, 2, false);
  const std::int32_t codes[3] = {-2147483647 - 1, 2147483647, 123456789};
  std::memcpy(las.record(1), codes, sizeof(codes));
  const auto file = load(folder, las.bytes);
  ASSERT_TRUE(file);
  EXPECT_EQ(value(*file, "x", 1), codes[0] * 0.01 + 500000);
  EXPECT_EQ(value(*file, "y", 1), codes[1] * 0.001 + 4918360.25);
  EXPECT_EQ(value(*file, "z", 1), codes[2] * 0.25 - 7);
  const auto again = saved(folder, *file);
  EXPECT_TRUE(
      std::equal(las.record(0), las.bytes.data() + las.bytes.size(), &again[las.points_at]));
}

TEST(LasFile, OldRecordsHoldWhatTheSpecificationSays) {
  const TemporaryFolder folder;
  LasBytes las = lasBytes(3, 1, false);
  unsigned char* r = las.record(0);
  const std::uint16_t intensity = 40000, source = 513, color[3] = {65535, 256, 7};
  const double time = 123456.789012;
  std::memcpy(r + 12, &intensity, 2);
  r[14] = 2 | 5 << 3 | 1 << 6;
  r[15] = 6 | 1 << 7;
  r[16] = static_cast<unsigned char>(-12);
  r[17] = 200;
  std::memcpy(r + 18, &source, 2);
  std::memcpy(r + 20, &time, 8);
  std::memcpy(r + 28, color, 6);
  const auto file = load(folder, las.bytes);
  ASSERT_TRUE(file);
  const std::pair<const char*, double> wanted[] = {{"intensity", 40000},
                                                   {"return_number", 2},
                                                   {"number_of_returns", 5},
                                                   {"scan_direction_flag", 1},
                                                   {"edge_of_flight_line", 0},
                                                   {"classification", 6},
                                                   {"synthetic", 0},
                                                   {"key_point", 0},
                                                   {"withheld", 1},
                                                   {"scan_angle_rank", -12},
                                                   {"user_data", 200},
                                                   {"point_source_id", 513},
                                                   {"gps_time", time},
                                                   {"red", 65535},
                                                   {"green", 256},
                                                   {"blue", 7}};
  for (const auto& [name, number] : wanted) EXPECT_EQ(value(*file, name, 0), number) << name;
}

TEST(LasFile, NewRecordsHoldWhatTheSpecificationSays) {
  const TemporaryFolder folder;
  LasBytes las = lasBytes(10, 1, true);
  unsigned char* r = las.record(0);
  const std::int16_t angle = -15000;
  const std::uint64_t wave = 0x123456789abcu;
  const float depth = 2.5f, location = 77.0f;
  r[14] = 15 | 9 << 4;
  r[15] = 1 << 3 | 2 << 4 | 1 << 7;
  r[16] = 255;
  std::memcpy(r + 18, &angle, 2);
  std::memcpy(r + 39, &wave, 8);
  std::memcpy(r + 51, &location, 4);
  std::memcpy(r + 67, &depth, 4);
  r[71] = 9;
  const auto file = load(folder, las.bytes);
  ASSERT_TRUE(file);
  const std::pair<const char*, double> wanted[] = {{"return_number", 15},
                                                   {"number_of_returns", 9},
                                                   {"overlap", 1},
                                                   {"synthetic", 0},
                                                   {"scanner_channel", 2},
                                                   {"scan_direction_flag", 0},
                                                   {"edge_of_flight_line", 1},
                                                   {"classification", 255},
                                                   {"scan_angle", -15000},
                                                   {"wave_offset", static_cast<double>(wave)},
                                                   {"wave_location", 77},
                                                   {"depth", 2.5},
                                                   {"my_triple", 9}};
  for (const auto& [name, number] : wanted) EXPECT_EQ(value(*file, name, 0), number) << name;
  const int undescribed = findField(file->cloud, "extra_bytes");
  ASSERT_GE(undescribed, 0);
  EXPECT_EQ(file->cloud.fields[static_cast<std::size_t>(undescribed)].count, 2u);
}

/** Smoothed points do not stand on the grid of hundredths that the file has. */
TEST(LasFile, MovedPointsGetAFinerScale) {
  const TemporaryFolder folder;
  const LasBytes las = lasBytes(6, 500, true);
  auto file = load(folder, las.bytes);
  ASSERT_TRUE(file);
  PointFile moved = *file;
  for (std::size_t i = 0; i < 500; i += 2) {
    double x = 0;
    std::memcpy(&x, &moved.cloud.data[i * moved.cloud.point_step], 8);
    x += 0.0012345 * static_cast<double>(i % 7);
    std::memcpy(&moved.cloud.data[i * moved.cloud.point_step], &x, 8);
  }
  const auto again = load(folder, saved(folder, moved));
  ASSERT_TRUE(again) << again.error().message;
  for (std::size_t i = 0; i < 500; ++i) {
    EXPECT_NEAR(value(*again, "x", i), value(moved, "x", i), 1e-5);
    EXPECT_NEAR(value(*again, "y", i), value(moved, "y", i), 1e-9);
    const std::size_t step = file->cloud.point_step;
    ASSERT_EQ(
        std::memcmp(&again->cloud.data[i * step + 24], &moved.cloud.data[i * step + 24], step - 24),
        0);
  }
}

TEST(LasFile, NewFieldsBecomeExtraBytes) {
  const TemporaryFolder folder;
  for (const int format : {0, 3, 7}) {
    for (const bool extra : {false, true}) {
      const LasBytes las = lasBytes(format, 40, extra);
      auto file = load(folder, las.bytes);
      ASSERT_TRUE(file);
      PointFile more = *file;
      addFloats(more, "normal_x", 0.25f);
      addFloats(more, "k1", -3.0f);
      const auto bytes = saved(folder, more);
      const auto again = load(folder, bytes);
      ASSERT_TRUE(again) << again.error().message;
      for (std::size_t i = 0; i < 40; ++i) {
        EXPECT_EQ(value(*again, "normal_x", i), 0.25 * static_cast<double>(i));
        EXPECT_EQ(value(*again, "k1", i), -3.0 * static_cast<double>(i));
        for (const auto& field : file->cloud.fields)
          ASSERT_EQ(value(*again, field.name.c_str(), i), value(*file, field.name.c_str(), i));
      }
      // What stood behind the points stands there, and the header knows where.
      EXPECT_EQ(again->las_tail, file->las_tail);
      LasBytes made;
      made.bytes = bytes;
      if (format == 7) {
        EXPECT_EQ(made.get<std::uint64_t>(235), bytes.size() - file->las_tail.size());
      }
      EXPECT_EQ(saved(folder, *again), bytes);
    }
  }
}

TEST(LasFile, OtherPointsBecomeAFileOfVersion14) {
  const TemporaryFolder folder;
  writeText(folder / "a.csv",
            "x,y,z,red,green,blue,intensity,gps_time,label\n"
            "0.5,1.25,-2,255,128,0,17,1234.5,-3\n1.5,1.75,-1,0,1,2,18,1235.5,4\n");
  const auto csv = loadPointFile(folder / "a.csv");
  ASSERT_TRUE(csv) << csv.error().message;
  const auto las = load(folder, saved(folder, *csv));
  ASSERT_TRUE(las) << las.error().message;
  const std::pair<const char*, double> wanted[] = {
      {"red", 65535},       {"green", 128 * 257}, {"blue", 0},   {"intensity", 17},
      {"gps_time", 1234.5}, {"return_number", 1}, {"label", -3}, {"number_of_returns", 1}};
  for (const auto& [name, number] : wanted) EXPECT_EQ(value(*las, name, 0), number) << name;
  EXPECT_NEAR(value(*las, "y", 1), 1.75, 1e-9);
  EXPECT_NEAR(value(*las, "x", 0), 0.5, 1e-9);
  EXPECT_EQ(findField(las->cloud, "rgb"), -1);
}

TEST(LasFile, WhatLasCannotHoldIsNamed) {
  const TemporaryFolder folder;
  for (const char* text : {"nan 0 0\n0 0 0\n", "1e200 0 0\n0 0 0\n"}) {
    writeText(folder / "a.xyz", text);
    const auto file = loadPointFile(folder / "a.xyz");
    ASSERT_TRUE(file) << file.error().message;
    const Error error = savePointFile(folder / "a.las", *file);
    EXPECT_NE(error.message.find("point 0"), std::string::npos) << error.message;
    EXPECT_EQ(folder.numFiles(), 1u);
  }
  writeText(folder / "a.csv", "x,y,z,classification\n0,0,0,2.5\n");
  const auto file = loadPointFile(folder / "a.csv");
  ASSERT_TRUE(file);
  EXPECT_NE(savePointFile(folder / "a.las", *file).message.find("classification"),
            std::string::npos);
}

TEST(LasFile, OtherFilesNameTheCommand) {
  EXPECT_NE(loadPointFile("c.e57").error().message.find("pdal translate 'c.e57' 'c.las'"),
            std::string::npos);
}

TEST(LasFile, BoastfulHeadersAreErrors) {
  const TemporaryFolder folder;
  const std::function<void(LasBytes&)> defects[] = {
      [](LasBytes& l) { l.bytes.resize(100); },
      [](LasBytes& l) { l.bytes[0] = 'X'; },
      [](LasBytes& l) { l.bytes[25] = 5; },
      [](LasBytes& l) { l.put(94, std::uint16_t{10}); },
      [](LasBytes& l) { l.put(96, std::uint32_t{4000000000u}); },
      [](LasBytes& l) { l.put(96, std::uint32_t{12}); },
      [](LasBytes& l) { l.bytes[104] = 11; },
      [](LasBytes& l) { l.put(105, std::uint16_t{3}); },
      [](LasBytes& l) { l.put(247, std::uint64_t{1} << 60); },
      [](LasBytes& l) { l.put(131, 0.0); },
      [](LasBytes& l) { l.put(139, std::nan("")); },
      [](LasBytes& l) { l.put(155, std::numeric_limits<double>::infinity()); },
      [](LasBytes& l) { l.bytes.resize(l.points_at + 5 * l.record_bytes); },
  };
  for (std::size_t k = 0; k < std::size(defects); ++k) {
    LasBytes las = lasBytes(6, 10, true);
    defects[k](las);
    const auto file = load(folder, las.bytes);
    ASSERT_FALSE(file) << k;
    EXPECT_NE(file.error().message.find_first_of(":;", folder.numFiles()), std::string::npos);
    EXPECT_EQ(file.error().message.find('\n'), std::string::npos);
  }
}

TEST(LasFile, AHeaderThatAnnouncesFewerPointsThanThereAreIsRefused) {
  LasBytes las = lasBytes(1, 600, false);
  const TemporaryFolder folder;
  ASSERT_TRUE(load(folder, las.bytes));
  las.put(107, std::uint32_t{599});
  const auto file = load(folder, las.bytes);
  ASSERT_FALSE(file);
  EXPECT_NE(file.error().message.find("599 points, and the file has 600"), std::string::npos)
      << file.error().message;
}

TEST(LasFile, DamagedFilesNeverCrash) {
  const TemporaryFolder folder;
  std::mt19937 random(3);
  for (int run = 0; run < 3000; ++run) {
    LasBytes las = lasBytes(run % 11, 5, run % 2 == 0, static_cast<unsigned int>(run));
    for (int k = 0; k < 3; ++k)
      las.bytes[random() % (run % 3 == 0 ? las.bytes.size() : 260)] =
          static_cast<unsigned char>(random());
    if (run % 5 == 0) las.bytes.resize(random() % las.bytes.size());
    const auto file = load(folder, las.bytes);
    if (!file) continue;
    if (savePointFile(folder / "out.las", *file)) continue;
    const auto again = loadPointFile(folder / "out.las");
    ASSERT_TRUE(again) << run << ": " << again.error().message;
    EXPECT_EQ(numPoints(again->cloud), numPoints(file->cloud));
  }
}

}  // namespace
}  // namespace pcl_slim
