// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/fit/fit.h"
#include "pcl_slim/mesh/mesh_extraction.h"

namespace pcl_slim::borders {

struct OpenSettings {
  FitParams fit;
  MeshParams mesh;
  std::string scenes = "all";
  std::string normals = "01";    ///< 0: without, 1: with, 01: both
  std::string methods = "slim";  ///< and truth, poisson, front, separated by commas
  std::vector<double> noise;     ///< spacings
  std::string folder;            ///< for points, surfaces and meshes; empty: not written
  double poisson_trim = 2.0;     ///< spacings from the points beyond which Poisson's mesh is cut
  bool picture = true;           ///< measure pictures, too
};

/** \brief Prints one row a scene, noise level, method and choice of normals, with the targets that it
 * misses, and the sums by kind of scene and by noise. \return an error for the unknown name of a scene or method. */
Error printOpenRows(const OpenSettings& settings);

}  // namespace pcl_slim::borders
