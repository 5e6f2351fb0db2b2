// SPDX-License-Identifier: BSD-3-Clause
#define PCL_SLIM_PCL_POINTS_ONLY
#include "pcl_slim/filters/slim_reconstruction_base.h"

#include <algorithm>
#include <utility>

#include "input_types.h"
#include "pcl_slim/filters/impl/slim_reconstruction.hpp"
#include "pcl_slim/filters/mesh_colors.h"
#include "pcl_slim/query/surface_probe.h"

namespace pcl_slim {

namespace {

constexpr double kLeastHole = 2, kUsualHole = 4;  ///< spacings that trim maps may and do keep

/** The fit's parameters for a mesh: trim maps keep holes as small as the mesh is to have. */
FitParams
fitParamsFor(const FitParams& fit, const MeshParams& mesh)
{
  FitParams made = fit;
  if (mesh.hole_size > 0) made.hole_size = std::clamp(mesh.hole_size, kLeastHole, kUsualHole);
  return made;
}

}  // namespace

void
SLIMReconstructionBase::clearMesh()
{
  clearResults();
  mesh_.clear();
  mesh_statistics_ = {};
  fitted_surface_.reset();
}

bool
SLIMReconstructionBase::makeMesh(const CloudView& cloud, const ColorView& colors)
{
  MeshParams params = mesh_params_;
  params.trim = params_.trim;
  params.threads = params_.threads;
  if (const Error error = params.validate()) return fail(error.code, error.message);
  SurfaceConstPtr surface = surface_;
  SLIMSurface sharp;
  if (!surface) {
    auto fitted = std::make_shared<SLIMSurface>();
    const bool sharpened = params_.sharp_features && cloud.normal != nullptr;
    const FitParams own = std::exchange(params_, fitParamsFor(params_, params));
    bool done = true;
    if (sharpened) {  // edges from one fit, what is between them and how it is connected from another
      params_.trim = false;
      done = run(cloud, sharp);
      params_.trim = own.trim;
      params_.sharp_features = false;
      params.sharp = &sharp;
    }
    done = done && run(cloud, *fitted);
    params_ = own;
    if (!done) return false;
    surface = fitted;
  }
  const CancellableRun cancellable(control_.progress);
  const bool done = guarded("the extraction", "raise the tolerance", [&]() -> Error {
    if (Error error = extractMesh(*surface, params, mesh_, &mesh_statistics_, &control_.progress)) {
      return error;
    }
    if (colors_ && colors.bgr != nullptr)
      return colorFromPoints(cloud, colors, params.threads, mesh_);
    if (colors_)
      mesh_.colors = surfaceColors(*surface, mesh_.vertices, mesh_.normals, params.threads);
    return {};
  });
  if (!done) {
    mesh_.clear();
    return false;
  }
  if (!surface_) fitted_surface_ = surface;
  return true;
}

}  // namespace pcl_slim

// The class of all point types it is compiled for.
PCL_SLIM_FOR_INPUT_TYPES(PCL_SLIM_INSTANTIATE_SLIMReconstruction)
