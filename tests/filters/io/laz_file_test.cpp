// SPDX-License-Identifier: BSD-3-Clause
// LAZ and COPC: what LASzip compresses comes back as the LAS file it was made of; and what builds without
// LASzip answer.
#include <gtest/gtest.h>

#include <cstring>

#include "filters/io/point_values.h"
#include "pcl_slim/filters/io/point_file.h"
#include "support/las_bytes.h"
#include "support/temporary_folder.h"

#ifdef PCL_SLIM_WITH_LAZ
#include <laszip/laszip_api.h>
#endif

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;

#ifdef PCL_SLIM_WITH_LAZ

/** Compresses a file as other programs do, by LASzip's own reader and writer. */
void packLaz(const std::string& in, const std::string& out) {
  laszip_POINTER reader = nullptr, writer = nullptr;
  laszip_header* header = nullptr;
  laszip_point* point = nullptr;
  laszip_BOOL compressed = 0;
  ASSERT_EQ(laszip_create(&reader), 0);
  ASSERT_EQ(laszip_create(&writer), 0);
  ASSERT_EQ(laszip_open_reader(reader, in.c_str(), &compressed), 0);
  laszip_get_header_pointer(reader, &header);
  ASSERT_EQ(laszip_set_header(writer, header), 0);
  laszip_request_native_extension(writer, 1);
  ASSERT_EQ(laszip_open_writer(writer, out.c_str(), 1), 0);
  laszip_get_point_pointer(reader, &point);
  const auto points = header->extended_number_of_point_records > 0
                          ? header->extended_number_of_point_records
                          : header->number_of_point_records;
  for (laszip_U64 i = 0; i < points; ++i) {
    ASSERT_EQ(laszip_read_point(reader), 0);
    ASSERT_EQ(laszip_set_point(writer, point), 0);
    ASSERT_EQ(laszip_write_point(writer), 0);
  }
  laszip_close_writer(writer);
  laszip_close_reader(reader);
  laszip_destroy(writer);
  laszip_destroy(reader);
}

TEST(LazFile, EveryFormatGivesTheValuesOfItsLas) {
  // Formats with waves are left out: LASzip's writer wants their packets from another file.
  for (const int format : {0, 1, 2, 3, 6, 7, 8}) {
    for (const bool extra : {false, true}) {
      const TemporaryFolder folder;
      LasBytes las = lasBytes(format, 500, extra);
      if (format >= 6) {  // without the record behind the points, which LASzip does not copy
        las.put(235, std::uint64_t{0});
        las.put(243, std::uint32_t{0});
        las.bytes.resize(las.points_at + las.count * las.record_bytes);
      }
      writeBytes(folder / "a.las", las.bytes);
      packLaz(folder / "a.las", folder / "a.laz");
      const auto wanted = loadPointFile(folder / "a.las"), got = loadPointFile(folder / "a.laz");
      ASSERT_TRUE(wanted) << wanted.error().message;
      ASSERT_TRUE(got) << format << ": " << got.error().message;
      ASSERT_EQ(got->cloud.fields.size(), wanted->cloud.fields.size()) << format;
      EXPECT_EQ(got->cloud.data, wanted->cloud.data)
          << format << (extra ? " with extra bytes" : "");
      ASSERT_FALSE(savePointFile(folder / "b.las", *got));
      const auto again = loadPointFile(folder / "b.las");
      ASSERT_TRUE(again) << again.error().message;
      EXPECT_EQ(again->cloud.data, wanted->cloud.data) << "what is written is LAS";
    }
  }
}

TEST(LazFile, OtherNamesAndRecordsOfCopc) {
  const TemporaryFolder folder;
  LasBytes las = lasBytes(6, 300, false);
  las.put(235, std::uint64_t{0});
  las.put(243, std::uint32_t{0});
  las.bytes.resize(las.points_at + las.count * las.record_bytes);
  writeBytes(folder / "a.las", las.bytes);
  packLaz(folder / "a.las", folder / "a.laz");
  std::vector<unsigned char> bytes = fileBytes(folder / "a.laz");
  // As COPC has them: a record behind the points that describes their order, and one of a projection.
  const std::uint64_t at = bytes.size();
  for (const char* user : {"copc", "LASF_Projection"}) {
    std::vector<unsigned char> record(60 + 4, 7);
    std::fill(record.begin(), record.begin() + 60, std::uint8_t{0});
    std::memcpy(record.data() + 2, user, std::strlen(user));
    record[20] = 4;
    bytes.insert(bytes.end(), record.begin(), record.end());
  }
  const std::uint32_t records = 2;
  std::memcpy(bytes.data() + 235, &at, 8);
  std::memcpy(bytes.data() + 243, &records, 4);
  writeBytes(folder / "a.copc.laz", bytes);
  writeBytes(folder / "named.las", bytes);
  const auto wanted = loadPointFile(folder / "a.las");
  ASSERT_TRUE(wanted) << wanted.error().message;
  for (const char* name : {"a.copc.laz", "named.las"}) {
    const auto got = loadPointFile(folder / name);
    ASSERT_TRUE(got) << got.error().message;
    EXPECT_EQ(got->cloud.data, wanted->cloud.data);
    ASSERT_EQ(got->las_tail.size(), 64u) << "the projection stays, the order of COPC does not";
    EXPECT_EQ(std::memcmp(got->las_tail.data() + 2, "LASF_Projection", 15), 0);
  }
  for (std::size_t size = 0; size < bytes.size(); size += 97) {
    writeBytes(folder / "cut.laz",
               {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)});
    const auto cut = loadPointFile(folder / "cut.laz");
    if (!cut) {
      EXPECT_EQ(cut.error().message.find('\n'), std::string::npos) << cut.error().message;
    }
  }
}

#else

TEST(LazFile, WithoutLaszipTheCommandIsNamed) {
  const auto refused = loadPointFile("a b.laz");
  ASSERT_FALSE(refused);
  for (const char* words : {"liblaszip-dev", "laspy.read('a b.laz').write('a b.las')"})
    EXPECT_NE(refused.error().message.find(words), std::string::npos) << refused.error().message;
  const TemporaryFolder folder;
  LasBytes las = lasBytes(1, 3, false);
  las.bytes[104] |= 0x80;
  writeBytes(folder / "a.las", las.bytes);
  const auto named = loadPointFile(folder / "a.las");
  ASSERT_FALSE(named);
  EXPECT_NE(named.error().message.find("a_plain.las"), std::string::npos) << named.error().message;
}

#endif

}  // namespace
}  // namespace pcl_slim
