// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pcl_slim/filters/io/point_file.h"

namespace pcl_slim {

/** Vertices and faces as the readers of mesh formats collect them. */
struct MeshPoints {
  std::vector<std::array<double, 3>> positions;
  std::vector<std::array<float, 3>> normals;             ///< one a vertex, or none
  std::vector<std::array<std::uint8_t, 3>> colors;       ///< red green blue, one a vertex, or none
  std::vector<std::uint32_t> face_begin, face_vertices;  ///< as PointFile has them
  bool in_float = true;                                  ///< floats represent every coordinate

  void endFace();
};

/** The file: x y z, normal_x normal_y normal_z, rgb. \return an error for a face that names a
 * vertex that is not there. \param[in] format as errors call it: "OBJ". */
Result<PointFile> toPointFile(const MeshPoints& mesh, const char* format);

}  // namespace pcl_slim
