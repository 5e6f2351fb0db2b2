// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "pcl_slim/filters/io/point_file.h"

namespace pcl_slim::detail {

/** \brief Decodes LZF (Marc Lehmann's liblzf), as DATA binary_compressed has it. pcl::lzfDecompress
 * does the same, but its library loads VTK and drivers of sensors, which takes 25 MB and .03 s at
 * every start.
 * \param[out] plain room for size bytes. \return whether the input is whole and fills it exactly.
 * O(size). */
bool decodeLzf(const std::uint8_t* packed, std::size_t packed_size, std::uint8_t* plain,
               std::size_t size);

}  // namespace pcl_slim::detail

namespace pcl_slim {

/** A field as a PCD header lists it; "_" is padding. */
struct PcdColumn {
  std::string name;
  std::size_t size = 4, count = 1;
  char type = 'F';

  std::size_t bytes() const { return size * count; }
  bool isPadding() const { return name == "_"; }
};

/** The header of a PCD file. */
struct PcdHeader {
  std::vector<PcdColumn> columns;
  std::size_t width = 0, height = 1, points = 0;
  bool has_width = false, has_points = false;
  std::string data;       ///< form of the data, the header's last word
  std::size_t bytes = 0;  ///< of the header

  /** Bytes of one point in the file. */
  std::size_t step() const;
};

/** A column's type by PCLPointField's numbers; 0: its TYPE and SIZE do not go together. */
std::uint8_t scalarType(const PcdColumn& column);

/** Reads the header; viewpoint and comments go into the file. */
Error parsePcdHeader(const std::vector<unsigned char>& bytes, PcdHeader& header, PointFile& file);

}  // namespace pcl_slim
