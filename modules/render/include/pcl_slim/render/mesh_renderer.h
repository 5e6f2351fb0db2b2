// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/mesh/triangle_mesh.h"
#include "pcl_slim/render/camera.h"
#include "pcl_slim/render/g_buffer.h"
#include "pcl_slim/render/image.h"
#include "pcl_slim/render/render_params.h"
#include "pcl_slim/render/shading.h"

namespace pcl_slim {

/** \brief Parameters of renderMesh(). */
struct PCL_SLIM_EXPORT MeshRenderParams {
  VisibleSides sides = VisibleSides::kAuto;  ///< kAuto: both alike, as corners may run either way
  double near_plane = 0.0;                   ///< smallest depth shown, world units, >= 0
  std::vector<HalfSpace> cuts;               ///< shows only what is in all of these
  int threads = 0;                           ///< 0: all cores; never changes the result

  /** \brief Names the first parameter out of range. */
  Error validate() const;
};

/** \brief What a frame of a mesh drew and left out. */
struct PCL_SLIM_EXPORT MeshRenderStatistics {
  std::uint64_t triangles = 0;        ///< of the mesh
  std::uint64_t outside_frustum = 0;  ///< triangles that no ray meets
  std::uint64_t back_facing = 0;      ///< triangles turned away, where only fronts are drawn
  std::uint64_t rays_first = 0;       ///< (triangle, ray) pairs
  std::uint64_t covered_pixels = 0;

  MeshRenderStatistics& operator+=(const MeshRenderStatistics& other);
};

/** \brief Renders a mesh into a G-buffer: each pixel shows the first triangle on its ray (Moeller
 * and Trumbore 1997) with the normals of its corners interpolated (Phong 1975).
 *
 * A corner's normal counts where it is within 45 degrees of the triangle's own, so that edges stay
 * sharp; missing normals are the triangles'. Colours and curvatures are interpolated as the normals
 * are, where the mesh has them. Local units are the world's, about origin; surfel is the triangle.
 * The same for any number of threads. O(triangles + sum of their pixels).
 * \param[in] columns GBufferColumn bits; levels, weights and residuals stay 0
 * \return an error for indices or columns that do not fit the vertices, for coordinates that are
 * not finite, or a bad camera or parameter; the buffer is then empty. */
PCL_SLIM_EXPORT Error renderMesh(const TriangleMesh& mesh, const Camera& camera,
                                 const MeshRenderParams& params, unsigned columns, GBuffer& buffer,
                                 MeshRenderStatistics* statistics = nullptr);

/** \brief A finished picture of a mesh, as those of surfaces. Modes that show what a mesh has not
 * are refused: levels, sizes, residuals; curvatures without k1 and k2. */
PCL_SLIM_EXPORT Result<Image> renderPicture(const TriangleMesh& mesh, const Camera& camera,
                                            const MeshRenderParams& render_params,
                                            const ShadingParams& shading_params,
                                            MeshRenderStatistics* statistics = nullptr);

}  // namespace pcl_slim
