// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pcl_slim/core/error.h"
#include "pcl_slim/mesh/triangle_mesh.h"
#include "support/lab/scenes.h"

namespace pcl_slim::reconstruction_bench {

/** \brief pcl::Poisson of a scene's points and normals. */
Error poisson(const measure::Scene& scene, int depth, TriangleMesh& mesh);

/** \brief pcl::GreedyProjectionTriangulation with a radius of four spacings and mu = 2.5. */
Error greedyProjection(const measure::Scene& scene, double spacing, TriangleMesh& mesh);

/** \brief Whether this build has CGAL's methods. */
bool hasCgal();

/** \brief CGAL's Poisson reconstruction with its default criteria. */
Error cgalPoisson(const measure::Scene& scene, double spacing, TriangleMesh& mesh);

}  // namespace pcl_slim::reconstruction_bench
