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
      {"1 2 3\n4 5\n", "line 2"},
      {"1 2 3\n\n4 5 six\n", "line 3: 'six'"},
      {"1 2\n3 4\n", "fewer than 3"},
      {"a b c\n1 2 3\n", "name three of numbers x, y and z"},
      {"x y z\n1 2 3 4\n", "3 are named"},
      {"x y z\n", "no points"},
      {"# nothing\n", "no points"},
      {"5\n1 2 3\n", "1 of 5"},
      {"1,5x;2,5;3,5\n", "no number"},
      {"x;y;z\n1,5;2,5;a\n", "name three"},
      {"C 0 0\n", "no points"},
      {"x y z\n1 2 3 4\n1 2 3 4\n", "line 2 has 4"},
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

TEST(TextFile, ColumnsAreNamedByTheCaller) {
  const TemporaryFolder folder;
  const auto load = [&](const char* text, const char* columns) {
    writeText(folder / "a.csv", text);
    PointFileOptions options;
    options.columns = columns;
    return loadPointFile(folder / "a.csv", options);
  };
  const auto survey = load("1,20.5,10.5,3,TREE\n2,21,11,4,GND\n", "-,y,x,z,-");
  ASSERT_TRUE(survey) << survey.error().message;
  EXPECT_EQ(survey->columns, "- y x z -, as -columns names them");
  EXPECT_EQ(value(*survey, "x", 0), 10.5);
  EXPECT_TRUE(survey->warnings.empty() && survey->left_out.empty());
  const auto colored = load("a,b,c,d,e,f,g\n1,2,3,60,9,8,7\n4,5,6,61,1,2,3\n", "X,Y,Z,i,R,G,B");
  ASSERT_TRUE(colored) << colored.error().message;
  EXPECT_EQ(numPoints(colored->cloud), 2u) << "a header is replaced";
  EXPECT_EQ(value(*colored, "intensity", 1), 61);
  EXPECT_GE(findField(colored->cloud, "rgb"), 0);
  for (const char* wrong : {"x,y", "x,y,z,", "x,,y,z", "a,b,c"}) {
    const auto refused = load("1,2,3\n", wrong);
    ASSERT_FALSE(refused) << wrong;
    EXPECT_NE(refused.error().message.find("name every column"), std::string::npos);
  }
  const auto fewer = load("1,2,3,4\n", "x,y,z");
  ASSERT_FALSE(fewer);
  EXPECT_NE(fewer.error().message.find("-columns names 3"), std::string::npos);
  writeText(folder / "a.obj", "v 1 2 3\n");
  PointFileOptions options;
  options.columns = "x,y,z";
  EXPECT_FALSE(loadPointFile(folder / "a.obj", options)) << "an OBJ file has no columns to name";
}

TEST(TextFile, NumberedPointsAreWarnedOf) {
  std::string text;
  for (int i = 1; i <= 20; ++i)
    text += std::to_string(i + (i > 9)) + " " + std::to_string(i * 7 % 5) + ".5 " +
            std::to_string(i * 3 % 7) + ".25 1\n";
  const auto numbered = loadText("a.txt", text);
  ASSERT_TRUE(numbered) << numbered.error().message;
  EXPECT_EQ(value(*numbered, "x", 0), 2.5) << "the point that is missing does not matter";
  ASSERT_EQ(numbered->warnings.size(), 1u);
  EXPECT_NE(numbered->warnings[0].find("-columns"), std::string::npos);
  const auto profile = loadText("a.txt", "1 2 3\n2 2 3\n3 2 3\n4 2 3\n5 2 3\n6 2 3\n");
  ASSERT_TRUE(profile);
  EXPECT_EQ(value(*profile, "x", 5), 6) << "three columns are coordinates";
}

TEST(TextFile, AnIntensityBesideColoursVariesLessWithThem) {
  std::string first, last;
  for (int i = 0; i < 60; ++i) {
    const std::string place = std::to_string(i % 8) + " " + std::to_string(i / 8) + " 0.5 ";
    const int gray = 4 * i, other = i * 37 % 101;
    const std::string colors = std::to_string(gray) + " " + std::to_string(gray / 2 + 20) + " " +
                               std::to_string(gray / 3 + 30);
    first += place + std::to_string(other) + " " + colors + "\n";
    last += place + colors + " " + std::to_string(other) + "\n";
  }
  EXPECT_EQ(columnsOf("a.txt", first), "x y z intensity red green blue");
  EXPECT_EQ(columnsOf("a.txt", last), "x y z red green blue intensity");
  EXPECT_EQ(columnsOf("a.pts", "60\n" + last), "x y z intensity red green blue") << "by the format";
}

TEST(TextFile, FractionsOf255AreBytesAndOthersStay) {
  const auto bytes = loadText("a.xyzrgb", "1 2 3 0.556863 0.694118 0.117647\n");
  ASSERT_TRUE(bytes);
  const auto& rgb = bytes->cloud.fields[static_cast<std::size_t>(findField(bytes->cloud, "rgb"))];
  EXPECT_EQ(bytes->cloud.data[rgb.offset + 2], 142);
  EXPECT_EQ(bytes->cloud.data[rgb.offset + 1], 177);
  EXPECT_EQ(bytes->cloud.data[rgb.offset], 30);
  const auto fine = loadText("a.xyzrgb", "1 2 3 0.123456 0.5 1\n");
  ASSERT_TRUE(fine);
  EXPECT_FLOAT_EQ(static_cast<float>(value(*fine, "red", 0)), 0.123456f);
}

}  // namespace
}  // namespace pcl_slim
