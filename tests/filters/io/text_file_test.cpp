// SPDX-License-Identifier: BSD-3-Clause
// Text files: which columns are what, in which type, and which line is at fault.
#include <gtest/gtest.h>

#include <cmath>

#include "filters/io/point_values.h"
#include "pcl_slim/filters/io/point_file.h"

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;

std::string columnsOf(const std::string& name, const std::string& text) {
  const auto file = loadText(name, text);
  return file ? file->columns.substr(0, file->columns.find(',')) : file.error().message;
}

int typeOf(const PointFile& file, const char* name) {
  return file.cloud.fields[static_cast<std::size_t>(findField(file.cloud, name))].datatype;
}

TEST(TextFile, ColumnsAreGuessedFromTheNumbers) {
  const std::pair<std::pair<const char*, const char*>, const char*> cases[] = {
      {{"a.xyz", "1 2 3\n4 5 6\n"}, "x y z"},
      {{"a.txt", "1 2 3 0.5\n4 5 6 7\n"}, "x y z intensity"},
      {{"a.xyz", "1 2 3 255 0 17\n4 5 6 1 2 3\n"}, "x y z red green blue"},
      {{"a.xyz", "1 2 3 0 0.6 0.8\n4 5 6 0 0 -1\n"}, "x y z normal_x normal_y normal_z"},
      {{"a.asc", "1 2 3 0 0.6 0.8 9 8 7\n4 5 6 0 0 -1 1 2 3\n"},
       "x y z normal_x normal_y normal_z red green blue"},
      {{"a.txt", "1 2 3 9 8 7 0 0.6 0.8\n4 5 6 1 2 3 0 0 -1\n"},
       "x y z red green blue normal_x normal_y normal_z"},
      {{"a.txt", "1 2 3 9 8 7 40.5\n4 5 6 1 2 3 4\n"}, "x y z red green blue intensity"},
      {{"a.pts", "2\n1 2 3 40 8 7 6\n4 5 6 50 2 3 4\n"}, "x y z intensity red green blue"},
      {{"a.pts", "1\n1 2 3 -940\n1\n4 5 6 -50\n"}, "x y z intensity"},
      {{"a.txt", "1 2 3 0.5 0.25\n4 5 6 7.5 8\n"}, "x y z intensity column_5"},
      {{"a.csv", "1;2;3;300;2;1\n"}, "x y z intensity column_5 column_6"},
  };
  for (const auto& [file, columns] : cases)
    EXPECT_EQ(columnsOf(file.first, file.second), columns) << file.second;
}

TEST(TextFile, ColumnsAreNamedByTheFile) {
  const std::pair<const char*, const char*> cases[] = {
      {"X,Y,Z,R,G,B\n1,2,3,4,5,6\n", "x y z red green blue"},
      {"\"Easting [m]\";\"Northing [m]\";\"Height [m]\";Label\n1;2;3;4\n", "x y z label"},
      {"//X Y Z Nx Ny Nz Scalar_field\n1 2 3 0 0 1 7\n",
       "x y z normal_x normal_y normal_z scalar_field"},
      {"# a comment\n# x y z time\n1 2 3 4\n", "x y z time"},
      {"time\tz\ty\tx\n1 2 3 4\n", "time z y x"},
      {"x y z a a\n1 2 3 4 5\n", "x y z alpha a"},
  };
  for (const auto& [text, columns] : cases) EXPECT_EQ(columnsOf("a.csv", text), columns) << text;
  const auto swapped = loadText("a.txt", "z y x\n1 2 3\n");
  ASSERT_TRUE(swapped);
  EXPECT_EQ(value(*swapped, "x", 0), 3);
  EXPECT_NE(swapped->columns.find("as the file names them"), std::string::npos);
}

TEST(TextFile, FloatsWhereTheyHoldEveryDigit) {
  const auto near = loadText("a.xyz", "0.123456 1 -2.5\n1e-3 7 3\n");
  ASSERT_TRUE(near);
  EXPECT_EQ(typeOf(*near, "x"), kFloat32);
  const auto far = loadText("a.xyz", "4918360.257 1 -2.5\n1 7 3\n");
  ASSERT_TRUE(far);
  EXPECT_EQ(typeOf(*far, "y"), kFloat64);
  EXPECT_EQ(value(*far, "x", 0), 4918360.257);
  const auto fine = loadText("a.txt", "0.12345678901 1 2 16777217\n");
  ASSERT_TRUE(fine);
  EXPECT_EQ(value(*fine, "x", 0), 0.12345678901);
  EXPECT_EQ(value(*fine, "intensity", 0), 16777217);
}

TEST(TextFile, ColoursArePacked) {
  const auto bytes = loadText("a.txt", "1 2 3 16 32 255\n");
  ASSERT_TRUE(bytes);
  const auto& rgb = bytes->cloud.fields[static_cast<std::size_t>(findField(bytes->cloud, "rgb"))];
  EXPECT_EQ(bytes->cloud.data[rgb.offset + 2], 16);
  EXPECT_EQ(bytes->cloud.data[rgb.offset], 255);
  const auto wide = loadText("a.csv", "x,y,z,red,green,blue\n1,2,3,65535,0,300\n");
  ASSERT_TRUE(wide);
  EXPECT_EQ(typeOf(*wide, "red"), kUInt16);
  EXPECT_EQ(value(*wide, "red", 0), 65535);
}

TEST(TextFile, EmptyFieldsTextColumnsAndOddEnds) {
  const auto file =
      loadText("a.csv", "\xef\xbb\xbfx,y,z,name,q\r\n1,2,3,tree,\r\n4,5,nan,road,7\r\n\r\n");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(numPoints(file->cloud), 2u);
  EXPECT_TRUE(std::isnan(value(*file, "q", 0)));
  EXPECT_TRUE(std::isnan(value(*file, "z", 1)));
  EXPECT_EQ(value(*file, "q", 1), 7);
  EXPECT_EQ(findField(file->cloud, "name"), -1);
  ASSERT_EQ(file->left_out.size(), 1u);
  EXPECT_NE(file->left_out[0].find("'name'"), std::string::npos);
  const auto last = loadText("a.xyz", "+1 2 3\n4 5 -6e-1");
  ASSERT_TRUE(last) << last.error().message;
  EXPECT_FLOAT_EQ(static_cast<float>(value(*last, "z", 1)), -0.6f);
}

TEST(TextFile, TheLineAtFaultIsNamed) {
  const std::pair<const char*, const char*> cases[] = {
      {"1 2 3\n4 5\n", "line 2"},          {"1 2 3\n\n4 5 six\n", "line 3: 'six'"},
      {"1 2\n3 4\n", "fewer than 3"},      {"a b c\n1 2 3\n", "name three of numbers x, y and z"},
      {"x y z\n1 2 3 4\n", "3 are named"}, {"x y z\n", "no points"},
      {"# nothing\n", "no points"},        {"5\n1 2 3\n", "1 of 5"},
      {"1,5;2,5;3,5\n", "no number"},      {"x;y;z\n1,5;2,5;3,5\n", "name three"},
      {"C 0 0 0\n", "no points"},
  };
  for (const auto& [text, words] : cases) {
    const auto file = loadText("a.txt", text);
    ASSERT_FALSE(file) << text;
    EXPECT_NE(file.error().message.find(words), std::string::npos) << file.error().message;
    EXPECT_EQ(file.error().message.find('\n'), std::string::npos);
  }
  const auto zeros = loadText("a.csv", std::string("1 2 3\0 4\n", 9));
  ASSERT_FALSE(zeros);
  EXPECT_NE(zeros.error().message.find("no text"), std::string::npos);
}

}  // namespace
}  // namespace pcl_slim
