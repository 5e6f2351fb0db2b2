// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl/PCLPointCloud2.h>
#include <cstdint>
#include <string>
#include <vector>

#include "pcl_slim/core/error.h"

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

/** One scalar property to write, and its offset in a point's bytes. */
struct PlyColumn {
  std::string name;
  std::uint8_t type = 0;
  std::size_t offset = 0;
};

/** Whether a face's property lists its vertices. */
bool
isFaceList(const PlyProperty& property);

Error
parsePlyHeader(const std::vector<unsigned char>& bytes, PlyHeader& header);

std::string
formatPlyHeader(const std::vector<std::string>& comments, const std::vector<PlyColumn>& columns,
                std::size_t num_points, std::size_t num_faces, bool long_faces);

/** Gives PLY's properties PCL's names, and packs red green blue (alpha) bytes into rgb (rgba). */
void
adoptPclFields(pcl::PCLPointCloud2& cloud);

/** PLY's columns for a cloud's fields: the inverse of adoptPclFields. */
Error
plyColumns(const pcl::PCLPointCloud2& cloud, std::vector<PlyColumn>& columns);

}  // namespace pcl_slim
