// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "frame/view_camera.h"
#include "pcl_slim/visualization/g_buffer_mapper.h"

class vtkShaderProgram;

namespace pcl_slim::detail {

/** \brief Vertex shader: a rectangle of the viewport from gl_VertexID. */
const char*
resolveVertexShader();

/** \brief Puts the resolve of a packed frame into VTK's fragment shader of polygons, before VTK
 * itself replaces the rest: vertexVC, normalVCVSOutput, gl_FragDepth and the colours. */
void
insertResolve(std::string& fragment_shader);

/** \brief Sets the program's values of rays, projection and cuts. */
void
tellView(const ViewCamera& view, const GLView& seen, const std::vector<HalfSpace>& planes,
         vtkShaderProgram* program);

}  // namespace pcl_slim::detail
