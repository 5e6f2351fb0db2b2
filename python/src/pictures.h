// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mesh.h"
#include "splats.h"
#include "surface.h"

namespace pcl_slim::python {

/** \brief render() of surfaces, meshes and splats; to_html() of surfaces and splats;
 * save_picture(). */
void bindPictures(py::module_& m, py::class_<Surface, SurfacePointer>& surface,
                  py::class_<Mesh, MeshPointer>& mesh, py::class_<Splats, SplatsPointer>& splats);

}  // namespace pcl_slim::python
