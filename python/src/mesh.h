// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "pcl_slim/mesh/mesh_extraction.h"
#include "surface.h"

namespace pcl_slim::python {

/** \brief Triangles that Python holds. */
struct Mesh {
  TriangleMesh triangles;
  MeshStatistics statistics;
};
using MeshPointer = std::shared_ptr<Mesh>;

void bindMesh(py::class_<Surface, SurfacePointer>& type, py::class_<Mesh, MeshPointer>& mesh_type);

}  // namespace pcl_slim::python
