// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/filters/io/point_table.h"

namespace pcl_slim {

enum class PlyForm { kAscii, kLittleEndian, kBigEndian };

struct PlyProperty {
  std::string name;
  std::uint8_t type = 0;       ///< ScalarType of the value or of the list's items
  std::uint8_t list_type = 0;  ///< ScalarType of the list's length; 0: no list
};

struct PlyElement {
  std::string name;
  std::size_t count = 0;
  std::vector<PlyProperty> properties;
};

struct PlyHeader {
  PlyForm form = PlyForm::kAscii;
  std::vector<std::string> comments;
  std::vector<PlyElement> elements;
  std::size_t size = 0;  ///< bytes up to the body
};

Error parsePlyHeader(const std::vector<unsigned char>& bytes, PlyHeader& header);

/** Gives PLY's properties PCL's names, and packs red green blue (alpha) bytes into rgb (rgba). */
void adoptPclFields(PointTable& cloud);

/** One scalar property to write, and its offset in a point's bytes. */
struct PlyColumn {
  std::string name;
  std::uint8_t type = 0;
  std::size_t offset = 0;
};

/** PLY's columns for a cloud's fields: the inverse of adoptPclFields(). No two have one name:
 * another field whose name is taken gets a longer one. */
Error plyColumns(const PointTable& cloud, std::vector<PlyColumn>& columns);

}  // namespace pcl_slim
