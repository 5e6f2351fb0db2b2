// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/progress.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/fit/fit.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim::detail {

/** \brief Fits a surface to vertices that have normals; those with a zero one are left out. */
Error
fitToVertices(const std::vector<Vector3>& vertices, const std::vector<Vector3>& normals,
              const FitParams& params, SLIMSurface& surface, FitStatistics& statistics,
              Progress* progress);

/** \brief Where faces stand on a surface. */
struct FaceProjection {
  std::vector<Vector3> places;   ///< projected centroids; as given where unsupported
  std::vector<Vector3> normals;  ///< eq. 7, to the side given; zero where unsupported
  std::uint64_t unsupported = 0;
};

/** \brief Projects the faces' centroids onto a surface. */
Error
projectFaces(const std::vector<Vector3>& centroids, const std::vector<Vector3>& normals,
             const SLIMSurface& surface, const FitParams& params, FaceProjection& made,
             Progress* progress);

}  // namespace pcl_slim::detail
