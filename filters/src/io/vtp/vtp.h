// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "io/point_formats.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/features/crest_lines.h"
#include "pcl_slim/filters/io/point_file.h"
#include "pcl_slim/mesh/triangle_mesh.h"

namespace pcl_slim {

inline constexpr const char* kVtpCommentArray = "pcl_slim";  ///< of the field data
inline constexpr const char* kVtpNormalArray = "Normals";
inline constexpr const char* kVtpColorArray = "RGB";    ///< three bytes of the field rgb or rgba
inline constexpr const char* kVtpAlphaArray = "alpha";  ///< the fourth
inline constexpr const char* kVtpCoordinates[3] = {"x", "y", "z"};
inline constexpr const char* kVtpNormals[3] = {"normal_x", "normal_y", "normal_z"};

inline bool isNameOf(const char* const (&names)[3], const std::string& name) {
  return name == names[0] || name == names[1] || name == names[2];
}

/** No error where this build has VTK's reader and writer; otherwise names what to give instead of
 * path. The functions below give the same error then. */
Error checkVtp(const std::string& path);

/** Writes points as VTK's XML PolyData, bit for bit: "Normals" for the normals, "RGB" (and "alpha",
 * unless it is 0 in a field rgb) for a packed colour, for each other field an array of its name,
 * type and count, comments as strings of the field data. Faces become polygons; without faces each
 * point that has finite coordinates is a vertex cell. Rows of an organised cloud and the sensor are
 * not kept. */
Error saveVtp(const std::string& path, const PointFile& file);

/** An array of points as saveVtp() writes it. */
struct VtpColumn {
  std::string name;
  std::uint8_t type;  ///< ScalarType
  std::size_t components;
};

/** The arrays that saveVtp() writes for points, without their coordinates. */
Result<std::vector<VtpColumn>> vtpColumns(const PointFile& file);

/** Reads what saveVtp() or VTK has written: points, their arrays as fields, and polygons. */
Result<PointFile> parseVtp(const std::vector<unsigned char>& bytes);

/** The vertices of a line in order; a closed one's first again at the end. */
inline std::vector<std::uint32_t> pathOf(const CrestLines& lines, std::size_t line) {
  std::vector<std::uint32_t> path;
  for (std::uint32_t v = lines.line_begin[line]; v < lines.line_begin[line + 1]; ++v) {
    path.push_back(v);
  }
  if (lines.closed[line] != 0) path.push_back(lines.line_begin[line]);
  return path;
}

/** Writes lines as VTK polylines. */
Error saveCrestVtp(const std::string& path, const CrestLines& lines);

/** Writes triangles as VTK polygons. \param[in] narrow floats keep the vertices where they are */
Error saveMeshVtp(const std::string& path, const TriangleMesh& mesh, bool narrow);

/** An array that a VTK XML file announces. */
struct VtpArray {
  std::string section;  ///< the element around it: FieldData, PointData, Points, Polys
  std::string name;
  std::uint8_t type = 0;  ///< ScalarType; 0: strings
  std::size_t components = 1;
  std::size_t tuples = 0;        ///< of strings: how many
  std::string_view inline_data;  ///< between its tags
  enum class Format : std::uint8_t { kAscii, kBinary, kAppended } format = Format::kAscii;
  std::size_t offset = 0;  ///< of appended data
};

/** The contents of a .vtp file's markup; views are into the file's bytes. */
struct VtpMarkup {
  std::size_t points = 0, polygons = 0;
  std::string normals;                ///< name of the array that PointData names as normals
  std::vector<VtpArray> arrays;       ///< of field data, point data, points and polygons
  std::vector<std::string> left_out;  ///< what the file has besides, in words
  std::string_view appended;          ///< what follows the underscore of AppendedData
  bool appended_base64 = false;
  bool big_endian = false, wide_headers = false, zlib = false;
};

/** Reads the markup of a VTK XML PolyData file of one piece. Accepts only elements, attributes'
 * values and counts that make sense; an error names the first that does not. */
Result<VtpMarkup> parseVtpMarkup(std::string_view text);

}  // namespace pcl_slim
