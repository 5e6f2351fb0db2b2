// SPDX-License-Identifier: BSD-3-Clause
// Headers, separators and encodings that other programs' documents describe, two points of each. Every
// first point is (1.5, 2.5, 3.5); docs/point_files.md lists the same kinds.
#include <gtest/gtest.h>

#include <string>

#include "filters/io/point_values.h"
#include "pcl_slim/filters/io/point_file.h"

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;

struct TextKindOfFile {
  const char* source;  ///< program and what is particular
  const char* file;    ///< its extension gives the format
  const char* text;
  const char* columns;  ///< that the note names; "": there is no note
};

const TextKindOfFile kHeaders[] = {
    {"CloudCompare, header in a comment", "a.asc",
     "//X Y Z R G B\n1.5 2.5 3.5 9 8 7\n4 5 6 1 2 3\n", "x y z red green blue"},
    {"CloudCompare, commas and a scalar field", "a.txt",
     "//X,Y,Z,Intensity\n1.5,2.5,3.5,7\n4,5,6,8\n", "x y z intensity"},
    {"CloudCompare, colours as fractions", "a.txt",
     "X Y Z Rf Gf Bf Nx Ny Nz\n1.5 2.5 3.5 0.2 0.4 1 0 0 1\n4 5 6 0 0.6 0.8 0 1 0\n",
     "x y z red green blue normal_x normal_y normal_z"},
    {"CloudCompare, number of points after the header", "a.asc", "//X Y Z\n2\n1.5 2.5 3.5\n4 5 6\n",
     "x y z"},
    {"CloudCompare, extension .neu", "a.neu", "1.5 2.5 3.5\n4 5 6\n", "x y z"},
    {"PDAL writers.text, quoted header", "a.csv", "\"X\",\"Y\",\"Z\"\n1.5,2.5,3.5\n4,5,6\n",
     "x y z"},
    {"PDAL writers.text, dimensions", "a.csv",
     "X,Y,Z,Intensity,ReturnNumber,GpsTime\n1.5,2.5,3.5,7,1,5.25\n4,5,6,8,2,5.5\n",
     "x y z intensity returnnumber gpstime"},
    {"QGIS, all fields quoted", "a.csv",
     "\"X\";\"Y\";\"Z\"\n\"1.5\";\"2.5\";\"3.5\"\n\"4\";\"5\";\"6\"\n", "x y z"},
    {"spreadsheet, a comma inside quotes", "a.csv",
     "x,y,z,\"note, if any\"\n1.5,2.5,3.5,\"oak, old\"\n4,5,6,\"elm\"\n", "x y z -"},
    {"RFC 4180, quotes inside quotes", "a.csv",
     "x,y,z,\"the \"\"tag\"\"\"\n1.5,2.5,3.5,7\n4,5,6,8\n", "x y z the_\"tag\""},
    {"spreadsheet, sep= line", "a.csv", "sep=;\r\nX;Y;Z\r\n1.5;2.5;3.5\r\n4;5;6\r\n", "x y z"},
    {"spreadsheet, sep= line in quotes", "a.csv", "\"sep=,\"\nX,Y,Z\n1.5,2.5,3.5\n4,5,6\n",
     "x y z"},
    {"spreadsheet, sep= with a tab", "a.csv", "sep=\t\nX\tY\tZ\n1.5\t2.5\t3.5\n4\t5\t6\n", "x y z"},
    {"spreadsheet, decimal commas", "a.csv", "X;Y;Z\r\n1,5;2,5;3,5\r\n4;5;6,25\r\n", "x y z"},
    {"decimal commas between blanks", "a.txt", "1,5 2,5 3,5\n4,0 5,0 6,0\n", "x y z"},
    {"decimal commas between tabs", "a.txt", "X\tY\tZ\n1,5\t2,5\t3,5\n4\t5\t6\n", "x y z"},
    {"decimal commas in quotes", "a.csv", "X,Y,Z\n\"1,5\",\"2,5\",\"3,5\"\n4,5,6\n", "x y z"},
    {"R write.csv, row names", "a.csv", "\"\",\"x\",\"y\",\"z\"\n\"1\",1.5,2.5,3.5\n\"2\",4,5,6\n",
     "- x y z"},
    {"R write.table, no name over the row names", "a.txt",
     "\"x\" \"y\" \"z\"\n\"1\" 1.5 2.5 3.5\n\"2\" 4 5 6\n", "- x y z"},
    {"R write.table, missing values", "a.txt", "\"x\" \"y\" \"z\" \"w\"\n1.5 2.5 3.5 NA\n4 5 6 7\n",
     "x y z w"},
    {"pandas to_csv, index", "a.csv", ",x,y,z\n0,1.5,2.5,3.5\n1,4,5,6\n", "- x y z"},
    {"pandas to_csv, tabs and index", "a.txt", "\tx\ty\tz\n0\t1.5\t2.5\t3.5\n1\t4\t5\t6\n",
     "- x y z"},
    {"numpy savetxt with a header", "a.txt",
     "# x y z\n1.500000000000000000e+00 2.500000000000000000e+00 3.500000000000000000e+00\n4 5 6\n",
     "x y z"},
    {"ParaView, points of a spreadsheet", "a.csv",
     "\"Normals:0\",\"Normals:1\",\"Normals:2\",\"Points:0\",\"Points:1\",\"Points:2\"\n"
     "0,0,1,1.5,2.5,3.5\n0,1,0,4,5,6\n",
     "normal_x normal_y normal_z x y z"},
    {"ParaView 5.10, points of a spreadsheet", "a.csv",
     "\"Points_0\",\"Points_1\",\"Points_2\",\"T\"\n1.5,2.5,3.5,7\n4,5,6,8\n", "x y z t"},
    {"ArcGIS, point table", "a.csv", "OID_,POINT_X,POINT_Y,POINT_Z\n1,1.5,2.5,3.5\n2,4,5,6\n",
     "oid x y z"},
    {"survey, units in brackets", "a.csv",
     "Easting [m];Northing [m];Height [m]\n1.5;2.5;3.5\n4;5;6\n", "x y z"},
    {"survey, E N H", "a.txt", "E N H\n1.5 2.5 3.5\n4 5 6\n", "x y z"},
    {"survey, P N E Z D", "a.csv", "P,N,E,Z,D\n1,2.5,1.5,3.5,TREE\n2,5,4,6,GND\n", "p y x z -"},
    {"survey, east north up", "a.csv", "east,north,up\n1.5,2.5,3.5\n4,5,6\n", "x y z"},
    {"survey, German names", "a.csv", "Rechtswert;Hochwert;H\xc3\xb6he\n1,5;2,5;3,5\n4;5;6\n",
     "x y z"},
    {"a title before the header", "a.csv", "Scan of the yard\nX,Y,Z\n1.5,2.5,3.5\n4,5,6\n",
     "x y z"},
    {"units in a line of their own", "a.csv", "X,Y,Z\nm,m,m\n1.5,2.5,3.5\n4,5,6\n", "x y z"},
    {"a free comment", "a.txt", "# points of site 7 in x y z order\n1.5 2.5 3.5\n4 5 6\n", "x y z"},
    {"a comment of fewer names than columns", "a.xyz", "# x y z\n1.5 2.5 3.5 9 8 7\n4 5 6 1 2 3\n",
     "x y z red green blue"},
    {"MATLAB, comments of per cent", "a.txt", "% x y z t\n1.5 2.5 3.5 7\n4 5 6 8\n", "x y z t"},
    {"COLMAP, points3D", "a.txt",
     "# 3D point list with one line of data per point:\n"
     "#   POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[] as (IMAGE_ID, POINT2D_IDX)\n"
     "# Number of points: 2, mean track length: 2.5\n"
     "63390 1.5 2.5 3.5 9 8 7 0.5 1 2 3 4\n63376 4 5 6 1 2 3 0.25 5 6\n",
     "point3d_id x y z red green blue error"},
    {"trailing separators", "a.csv", "X,Y,Z,\n1.5,2.5,3.5,\n4,5,6,\n", "x y z"},
    {"bars between columns", "a.txt", "x|y|z\n1.5|2.5|3.5\n4|5|6\n", "x y z"},
    {"tabs and names of several words", "a.txt",
     "X\tY\tZ\tscan angle\n1.5\t2.5\t3.5\t7\n4\t5\t6\t8\n", "x y z scan_angle"},
    {"tabs and an empty field", "a.txt", "X\tY\tZ\tw\tv\n1.5\t2.5\t3.5\t\t7\n4\t5\t6\t8\t\n",
     "x y z w v"},
};

const TextKindOfFile kNumbers[] = {
    {"x y z", "a.xyz", "1.5 2.5 3.5\n4 5 6\n", "x y z"},
    {"commas and blanks", "a.txt", "1.5, 2.5, 3.5\n4, 5, 6\n", "x y z"},
    {"columns aligned by blanks", "a.txt", "   1.5    2.5    3.5\n   4      5      6\n", "x y z"},
    {"plus signs and exponents", "a.txt", "+1.5E+00 +2.5E+00 +3.5E+00\n4 5 6\n", "x y z"},
    {"Fortran's exponents", "a.txt", "0.15D+01 0.25D+01 0.35D+01\n4 5 6\n", "x y z"},
    {"Leica .pts", "a.pts", "2\n1.5 2.5 3.5 -940 9 8 7\n4 5 6 -950 1 2 3\n",
     "x y z intensity red green blue"},
    {"several scans of .pts", "a.pts", "1\n1.5 2.5 3.5 40\n1\n4 5 6 50\n", "x y z intensity"},
    {"Semantic3D: intensity, colours", "a.txt", "1.5 2.5 3.5 -1100 9 8 7\n4 5 6 -1200 1 2 3\n",
     "x y z intensity red green blue"},
    {"intensity as a byte, colours", "a.txt", "1.5 2.5 3.5 60 9 8 7\n4 5 6 61 1 2 3\n",
     "x y z intensity red green blue"},
    {"colours, intensity as a fraction", "a.txt", "1.5 2.5 3.5 9 8 7 0.25\n4 5 6 1 2 3 0.5\n",
     "x y z red green blue intensity"},
    {"S3DIS: colours", "a.txt", "1.5 2.5 3.5 142 177 220\n4 5 6 230 146 220\n",
     "x y z red green blue"},
    {"Open3D .xyzn", "a.xyzn", "1.5 2.5 3.5 0 0 1\n4 5 6 0 1 0\n",
     "x y z normal_x normal_y normal_z"},
    {"Open3D .xyzn, normals of any length", "a.xyzn", "1.5 2.5 3.5 0 0 7\n4 5 6 0 3 0\n",
     "x y z normal_x normal_y normal_z"},
    {"Open3D .xyzrgb", "a.xyzrgb", "1.5 2.5 3.5 0.2 0.4 1\n4 5 6 0 0.6 0.8\n",
     "x y z red green blue"},
    {"fractions in .txt", "a.txt", "1.5 2.5 3.5 0.3 0.4 0.9\n4 5 6 0.1 0.6 0.2\n",
     "x y z red green blue"},
    {"MeshLab .asc with normals", "a.asc", "1.5 2.5 3.5 0 0.6 0.8\n4 5 6 0 0 -1\n",
     "x y z normal_x normal_y normal_z"},
    {"ModelNet40: commas and normals", "a.txt", "1.5,2.5,3.5,0,0.6,0.8\n4,5,6,0,0,-1\n",
     "x y z normal_x normal_y normal_z"},
    {"colours and normals", "a.txt", "1.5 2.5 3.5 9 8 7 0 0.6 0.8\n4 5 6 1 2 3 0 0 -1\n",
     "x y z red green blue normal_x normal_y normal_z"},
    {"numbered points", "a.txt", "1,1.5,2.5,3.5\n2,4,5,6\n3,4,5,7\n4,4,5,8\n5,4,5,9\n6,4,5,1\n",
     "- x y z"},
    {"numbered points from 0 with codes", "a.csv",
     "0,1.5,2.5,3.5,TREE\n1,4,5,6,GND\n2,4,5,7,GND\n3,4,5,8,GND\n4,4,5,9,GND\n", "- x y z -"},
    {"codes before the numbers", "a.txt", "TREE 1.5 2.5 3.5\nGND 4 5 6\n", "- x y z"},
    {"missing values of several programs", "a.txt",
     "1.5 2.5 3.5 N/A\n4 5 6 null\n7 8 9 1.#QNAN\n7 8 9 3\n", "x y z intensity"},
    {"line ends of old Macs", "a.txt", "1.5 2.5 3.5\r4 5 6\r", "x y z"},
    {"no line end behind the last point", "a.txt", "1.5 2.5 3.5\n4 5 6", "x y z"},
    {"blank lines", "a.txt", "\n1.5 2.5 3.5\n\n4 5 6\n\n", "x y z"},
    {"comments of //", "a.txt", "// made by hand\n1.5 2.5 3.5\n4 5 6\n", "x y z"},
    {"Leica .ptx", "a.ptx",
     "1\n2\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n1.5 2.5 3.5 0.5\n4 5 6 "
     "0.5\n",
     ""},
};

void expectKind(const TextKindOfFile& kind) {
  const auto file = loadText(kind.file, kind.text);
  ASSERT_TRUE(file) << kind.source << ": " << file.error().message;
  EXPECT_EQ(file->columns.substr(0, file->columns.find(',')), kind.columns) << kind.source;
  EXPECT_GE(numPoints(file->cloud), 2u) << kind.source;
  EXPECT_EQ(value(*file, "x", 0), 1.5) << kind.source;
  EXPECT_EQ(value(*file, "y", 0), 2.5) << kind.source;
  EXPECT_EQ(value(*file, "z", 0), 3.5) << kind.source;
}

TEST(TextKinds, HeadersOfOtherPrograms) {
  for (const TextKindOfFile& kind : kHeaders) expectKind(kind);
}

TEST(TextKinds, NumbersWithoutAHeader) {
  for (const TextKindOfFile& kind : kNumbers) expectKind(kind);
}

std::string encoded(const std::string& text, int unit, bool big_endian) {
  std::string bytes;
  for (const char c : text) {
    std::string character(static_cast<std::size_t>(unit), '\0');
    character[big_endian ? character.size() - 1 : 0] = c;
    bytes += character;
  }
  return bytes;
}

TEST(TextKinds, Encodings) {
  const std::string text = "X;Y;Z\r\n1.5;2.5;3.5\r\n4;5;6\r\n";
  const std::pair<const char*, std::string> files[] = {
      {"UTF-8 with a mark", "\xef\xbb\xbf" + text},
      {"UTF-16 with a mark", "\xff\xfe" + encoded(text, 2, false)},
      {"UTF-16, big-endian, with a mark", "\xfe\xff" + encoded(text, 2, true)},
      {"UTF-16 without a mark", encoded(text, 2, false)},
      {"UTF-16, big-endian, without a mark", encoded(text, 2, true)},
      {"UTF-32 with a mark", std::string("\xff\xfe\0\0", 4) + encoded(text, 4, false)},
      {"UTF-32, big-endian, with a mark", std::string("\0\0\xfe\xff", 4) + encoded(text, 4, true)},
  };
  for (const auto& [source, bytes] : files) {
    const auto file = loadText("a.csv", bytes);
    ASSERT_TRUE(file) << source << ": " << file.error().message;
    EXPECT_EQ(file->columns, "x y z, as the file names them") << source;
    EXPECT_EQ(value(*file, "z", 0), 3.5) << source;
  }
  const auto cut = loadText("a.csv", ("\xff\xfe" + encoded(text, 2, false)).substr(0, 41));
  ASSERT_FALSE(cut);
  EXPECT_NE(cut.error().message.find("UTF-16"), std::string::npos) << cut.error().message;
  const auto names =
      loadText("a.csv", "\xff\xfe" + encoded("x,y,z,", 2, false) + "\xe9" + std::string(1, '\0') +
                            encoded("\n1.5,2.5,3.5,7\n", 2, false));
  ASSERT_TRUE(names) << names.error().message;
  EXPECT_GE(findField(names->cloud, "\xc3\xa9"), 0) << "a letter of two bytes in UTF-8";
}

TEST(TextKinds, WhatIsNoListOfPointsNamesTheRemedy) {
  const std::pair<std::string, const char*> cases[] = {
      {"ncols 2\nnrows 2\nxllcorner 0.0\nyllcorner 0.0\ncellsize 1.0\n1 2\n3 4\n",
       "gdal_translate"},
      {std::string("1 2 3\n4 5 6\n7 8\0009\n", 18), "line 3 has a byte of 0"},
      {"1.5;2,5;3\n", "line 1 has decimals with a comma"},
      {"x;y;z\n1,5;2;3\n1.5;2;3\n", "line 2 has decimals with a comma, line 3 with a point"},
      {"1,234.5;2;3\n", "no number"},
  };
  for (const auto& [text, words] : cases) {
    const auto file = loadText("a.txt", text);
    ASSERT_FALSE(file) << text;
    EXPECT_NE(file.error().message.find(words), std::string::npos) << file.error().message;
    EXPECT_EQ(file.error().message.find('\n'), std::string::npos);
  }
}

}  // namespace
}  // namespace pcl_slim
