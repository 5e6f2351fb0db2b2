// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/progress_bar.h"
#include "common/report.h"
#include "pcl_slim/mesh/mesh_smoothing.h"
#include "scan/cloud_file.h"

namespace pcl_slim {

/** \brief How a program smooths a scan that has faces. */
struct MeshJob {
  MeshSmoothParams params;
  const SLIMSurface* surface = nullptr;  ///< in place of a fit
  bool normals = false;                  ///< also write the smooth mesh's normals at the vertices
};

/** \brief Smooths the mesh in a file; says and reports so. \return the file to write: the same with
 * x y z brought to new places, and faces and every other field kept. */
Result<PointFile>
smoothMeshFile(const MeshJob& job, const CloudFile& cloud, Console& console, Report& report);

}  // namespace pcl_slim
