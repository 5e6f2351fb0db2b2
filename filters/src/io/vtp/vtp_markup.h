// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "io/scalar_type.h"
#include "pcl_slim/core/error.h"

namespace pcl_slim {

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

/** Reads the markup of a VTK XML PolyData file of one piece. Accepts only elements, attributes' values
 * and counts that make sense; an error names the first that does not. */
Result<VtpMarkup>
parseVtpMarkup(std::string_view text);

}  // namespace pcl_slim
