// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/fit/fit.h"
#include "pcl_slim/mesh/mesh_extraction.h"

namespace pcl_slim::borders {

struct ClosedSettings {
  FitParams fit;
  MeshParams mesh;
  std::string bodies = "sphere,torus,bumpy,ellipsoid,amphora";
  std::string spreads = "random,uneven,step";
  std::vector<double> noise;  ///< spacings
  std::string files;          ///< closed scans, separated by commas; empty: generated bodies
  bool use_normals = true;
};

/** \brief Prints one row a body, spread, noise level and seed, or a file: leaves that are open, the
 * mesh's components, border edges and triangles of zero area; and the sums by spread and noise.
 * \return an error for an unknown name or a file that cannot be read. */
Error printClosedRows(const ClosedSettings& settings);

}  // namespace pcl_slim::borders
