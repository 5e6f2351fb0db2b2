// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "pcl_slim/filters/io/point_file.h"

namespace pcl_slim {

/** The content of a PCD file, versions 0.5 to 0.7, in all three of its data forms. */
Result<PointFile>
parsePcd(const std::vector<unsigned char>& bytes);

/** The bytes of a binary PCD 0.7 file. */
std::vector<unsigned char>
formatPcd(const PointFile& file);

/** The vertices and faces of a PLY file of any of the three data forms. */
Result<PointFile>
parsePly(const std::vector<unsigned char>& bytes);

/** The bytes of a binary_little_endian PLY file, or why the fields do not fit the format. */
Result<std::vector<unsigned char>>
formatPly(const PointFile& file);

/** The points of a LAS file, versions 1.0 to 1.4, point formats 0 to 10 (ASPRS, LAS 1.4 R15). */
Result<PointFile>
parseLas(const std::vector<unsigned char>& bytes);

/** The bytes of a LAS file: those of the one read where a file comes from one, and else of version
 * 1.4, format 6, or 7 where there are colours. \return an error for coordinates that are not finite. */
Result<std::vector<unsigned char>>
formatLas(const PointFile& file);

/** The points of a text file, one a line; text_table.h and column_names.h describe the format.
 *
 * Coordinates and other numbers are floats where those represent every digit written, else doubles.
 * \param[in] pts whether it is a .pts file, whose intensity precedes the colours. */
Result<PointFile>
parseText(const std::vector<unsigned char>& bytes, bool pts);

/** A Wavefront OBJ file: v with or without colours, vn, f. A vertex that faces give several normals has
 * their mean. Texture coordinates, lines, groups and materials are left out, and named. */
Result<PointFile>
parseObj(const std::vector<unsigned char>& bytes);

/** An STL file, binary or ASCII. Corners of equal coordinates become one vertex. */
Result<PointFile>
parseStl(const std::vector<unsigned char>& bytes);

/** An OFF, COFF, NOFF or CNOFF file in ASCII. Colours of faces are left out, and named. */
Result<PointFile>
parseOff(const std::vector<unsigned char>& bytes);

}  // namespace pcl_slim
