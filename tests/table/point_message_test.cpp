// SPDX-License-Identifier: BSD-3-Clause
// Messages of any layout as tables, and back.
#include "pcl_slim/filters/io/point_message.h"

#include <gtest/gtest.h>
#include <pcl/PCLPointCloud2.h>

#include <functional>

#include "table/message_clouds.h"

namespace pcl_slim {
namespace {

using pcl::PCLPointCloud2;
using pcl_slim_test::driverLayouts;
using pcl_slim_test::Layout;
using pcl_slim_test::messageOf;
using pcl_slim_test::sphereTable;

TEST(PointMessage, EveryLayoutComesBackAsItWas) {
  for (const Layout& layout : driverLayouts()) {
    const PointTable table = sphereTable(layout, 60, 6);
    for (const std::uint32_t padding : {0u, 1u, 12u}) {
      const auto message = messageOf<PCLPointCloud2>(table, padding);
      const Result<PointTable> read = tableOf(message);
      ASSERT_TRUE(read) << layout.name << ": " << read.error().message;
      EXPECT_EQ(read->data, table.data) << layout.name;
      EXPECT_EQ(read->height, 6u);
      PCLPointCloud2 again;
      putPoints(*read, true, again);
      const auto expected = messageOf<PCLPointCloud2>(table);
      EXPECT_EQ(again.data, expected.data) << layout.name;
      EXPECT_EQ(again.row_step, expected.row_step);
      EXPECT_EQ(again.is_dense, 1);
      ASSERT_EQ(again.fields.size(), expected.fields.size());
      for (std::size_t k = 0; k < again.fields.size(); ++k) {
        EXPECT_EQ(again.fields[k].name, expected.fields[k].name);
        EXPECT_EQ(again.fields[k].offset, expected.fields[k].offset);
        EXPECT_EQ(again.fields[k].datatype, expected.fields[k].datatype);
        EXPECT_EQ(again.fields[k].count, expected.fields[k].count);
      }
    }
  }
}

TEST(PointMessage, AMovedMessageIsNotCopied) {
  auto message = messageOf<PCLPointCloud2>(sphereTable(driverLayouts()[1], 100));
  const std::uint8_t* const bytes = message.data.data();
  Result<PointTable> table = tableOf(std::move(message));
  ASSERT_TRUE(table);
  EXPECT_EQ(table->data.data(), bytes);
  PCLPointCloud2 out;
  putPoints(std::move(*table), false, out);
  EXPECT_EQ(out.data.data(), bytes);
}

TEST(PointMessage, EmptyCloudsHaveNoPoints) {
  const PointTable table = sphereTable(driverLayouts()[2], 0);
  const Result<PointTable> read = tableOf(messageOf<PCLPointCloud2>(table));
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(numPoints(*read), 0u);
  EXPECT_EQ(read->fields.size(), table.fields.size());
}

struct Contradiction {
  const char* name;
  std::function<void(PCLPointCloud2&)> make;
  const char* in_sentence;
};

TEST(PointMessage, ContradictionsAreOneSentence) {
  const Contradiction contradictions[] = {
      {"big-endian", [](PCLPointCloud2& m) { m.is_bigendian = 1; }, "little-endian"},
      {"short rows", [](PCLPointCloud2& m) { m.row_step = 10; }, "row_step"},
      {"missing bytes", [](PCLPointCloud2& m) { m.data.resize(m.data.size() - 1); }, "bytes"},
      {"more bytes", [](PCLPointCloud2& m) { m.data.push_back(0); }, "bytes"},
      {"more points", [](PCLPointCloud2& m) { m.height = 1000; }, "bytes"},
      {"a field outside", [](PCLPointCloud2& m) { m.fields[2].offset = 31; }, "'z'"},
      {"an unknown type", [](PCLPointCloud2& m) { m.fields[0].datatype = 99; }, "type"},
      {"no fields", [](PCLPointCloud2& m) { m.fields.clear(); }, "fields"},
  };
  for (const auto& [name, make, in_sentence] : contradictions) {
    auto message = messageOf<PCLPointCloud2>(sphereTable(driverLayouts()[1], 40, 4));
    make(message);
    const Result<PointTable> read = tableOf(message);
    ASSERT_FALSE(read) << name;
    EXPECT_EQ(read.error().code, ErrorCode::kBadInput) << name;
    EXPECT_NE(read.error().message.find(in_sentence), std::string::npos) << read.error().message;
  }
}

TEST(PointMessage, ARowStepOfOneRowIsOfNoImportance) {
  for (const std::uint32_t step : {0u, 5u, 1000000u}) {
    auto message = messageOf<PCLPointCloud2>(sphereTable(driverLayouts()[0], 40));
    message.row_step = step;
    EXPECT_TRUE(tableOf(message)) << step;
  }
}

}  // namespace
}  // namespace pcl_slim
