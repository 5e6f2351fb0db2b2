// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "pcl_slim/compare/deviation_summary.h"
#include "pcl_slim/compare/place_columns.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/core/progress.h"
#include "pcl_slim/mesh/triangle_mesh.h"
#include "pcl_slim/surface/surface.h"
#include "pcl_slim/surface/surface_components.h"

namespace pcl_slim {

/** \brief How densely an object is covered by places. */
struct PCL_SLIM_EXPORT CarrierParams {
  /// edges above it are divided [world units]; 0: twice the spacing of the points behind a surface,
  /// or what most_places allows for
  double longest_edge = 0;
  std::uint64_t most_places = 400000;  ///< about; a longer edge is chosen where it would be more
  /// of a surface: components of fewer points are left out, as in meshes and pictures
  double min_component_points = kLeastComponentPoints;
  int threads = 0;  ///< 0: all cores; never changes the result

  /** \brief Names the first parameter out of range. */
  Error validate() const;
};

/** \brief An object as triangles with short edges, whose vertices are the places at which
 * deviations are measured, each with its share of the object's area. */
struct CarrierMesh {
  TriangleMesh mesh;
  PlaceColumns places;       ///< one for each vertex
  DeviationCarrier carrier;  ///< one entry for each vertex
  double area = 0;           ///< [world units squared]
  double longest_edge = 0;   ///< as used [world units]
};

/** \brief The carrier of a surface: extractMesh() with all holes open, edges above the longest
 * divided at their middles, and each vertex put onto the surface by equations (6) and (7) of Ohtake,
 * Belyaev, Alexa 2005, with its standard error. \return an error for bad parameters, of extractMesh(),
 * or cancellation. O(leaves + places); the same for any number of threads. */
PCL_SLIM_EXPORT Result<CarrierMesh> carrierMeshOf(const SLIMSurface& surface,
                                                  const CarrierParams& params,
                                                  Progress* progress = nullptr);

/** \brief The longest edge of a mesh's carrier that shows all that its points know of a surface it is
 * compared with: twice the median, over the leaves, of their points' spacing [world units]; 0 for no
 * leaves. O(leaves). */
PCL_SLIM_EXPORT double longestEdgeFor(const SLIMSurface& surface);

/** \brief The carrier of a mesh: its own vertices, in their order, and those that divide edges above
 * the longest. They have the mesh's standard errors, or none, and are oriented where no edge is run in the same direction by both of its
 * triangles. \return an error for bad parameters, an invalid mesh, or one without area.
 * O(T log T + places). */
PCL_SLIM_EXPORT Result<CarrierMesh> carrierMeshOf(const TriangleMesh& mesh,
                                                  const CarrierParams& params);

}  // namespace pcl_slim
