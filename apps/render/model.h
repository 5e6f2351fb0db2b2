// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/program.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/filters/io/point_file.h"
#include "pcl_slim/mesh/triangle_mesh.h"
#include "pcl_slim/render/bounding_spheres.h"
#include "pcl_slim/render/disc_rasterizer.h"
#include "pcl_slim/render/mesh_renderer.h"
#include "pcl_slim/render/ray_tracer.h"
#include "pcl_slim/render/render_params.h"
#include "pcl_slim/render/shading.h"
#include "pcl_slim/splat/splat_set.h"
#include "pcl_slim/surface/slim_blocks.h"
#include "pcl_slim/surface/surface.h"
#include "scan/surface_input.h"

namespace pcl_slim {

/** \brief What can be rendered: a surface, splats or a mesh; the other two are empty. */
struct Model {
  bool is_splats = false, is_mesh = false;
  SLIMSurface surface;
  SplatSet splats;
  TriangleMesh mesh;
  std::uint64_t skipped = 0;                ///< splats left out: not finite or without a normal
  std::size_t blocks = 0, blocks_read = 0;  ///< of a surface in blocks
  WorldBox box{};                           ///< of all its blocks
  std::vector<WorldBox> unloaded;           ///< of the blocks that were not read

  /** \brief Whether it has colours of its own. */
  bool hasColors() const {
    return is_mesh ? !mesh.colors.empty() : is_splats ? splats.hasColors() : surface.hasColors();
  }
  /** \brief "5000 leaves of 5329 surfels", "17307 splats" or "9811 triangles". */
  std::string describe() const;
  /** \brief What cameras look at. */
  BoundingSpheres spheres() const;
};

/** \brief Whether a file's extension and fields show a surface or splats, not a plain scan. */
bool holdsModel(const ModelFile& file);

/** \brief The surface (.pcd .ply .vtp .slim), the splats (.pcd .ply .vtp) or, of any other points
 * with faces, the mesh that a file contains; the fields show which. \param[in] path for errors */
Result<Model> modelOf(ModelFile file, const std::string& path);

/** \brief Both. */
Result<Model> loadModel(const std::string& path);

/** \brief Adds what a surface is and what its pictures cost and left out to a report. */
void reportSurface(const Model& model, const RenderStatistics& counts, Report& report);

/** \brief The same of splats. */
void reportSplats(const Model& model, const DiscRenderStatistics& counts, Report& report);

/** \brief The same of a mesh. */
void reportMesh(const Model& model, const MeshRenderStatistics& counts, Report& report);

/** \brief The same of traced pictures of surfaces or splats. */
void reportTraced(const Model& model, const TraceStatistics& counts, Report& report);

}  // namespace pcl_slim
