// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "pcl_slim/filters/io/point_file.h"

namespace pcl_slim {

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
