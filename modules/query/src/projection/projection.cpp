// SPDX-License-Identifier: BSD-3-Clause
// Points onto the surface: equations (6) to (8), with the guards of theory.md, "Projection".
#include "pcl_slim/query/projection.h"

#include <algorithm>

#include "pcl_slim/core/parallel.h"
#include "projection/block_lists.h"
#include "projection/block_projector.h"

namespace pcl_slim {

using namespace detail;

namespace {

void
allocate(std::size_t points, const ProjectionParams& params, Projection& result)
{
  result.position.resize(points);
  result.normal.assign(points, {0, 0, 0});
  result.supported.assign(points, 0);
  result.inside.assign(points, 0);
  const bool directions = params.directions || params.extremality;
  if (params.curvature || directions) result.curvature.assign(points, {0, 0});
  if (directions) result.principal.assign(points, {});
}

}  // namespace

Error
projectPoints(const PointStore& store, const SLIMSurface& surface, const ProjectionParams& params,
              Projection& result, Progress* progress)
{
  result = Projection();
  const double factor = surface.info.scale / store.scale();
  if (!(factor > 1e-30 && factor < 1e30)) {
    return {ErrorCode::kBadArgument,
            "the surface has nothing of the cloud's size; project the cloud it was fitted to"};
  }
  const int threads = resolveThreads(params.threads);
  allocate(store.size(), params, result);
  if (progress != nullptr) progress->report(0.0f, "projecting");
  const std::vector<std::uint32_t> leaves = surface.leaves();
  const BlockLists lists = listLeaves(store, surface, leaves, threads);
  const BlockProjector projector(store, surface, leaves, params, threads);
  std::vector<BlockProjector::Scratch> scratch(static_cast<std::size_t>(threads));
  parallelFor(store.numBlocks(), threads, 64, [&](std::size_t b, int thread) {
    if (progress != nullptr && progress->cancelled()) return;
    projector.project(b, lists.leaves.data() + lists.begin[b],
                      lists.leaves.data() + lists.begin[b + 1],
                      scratch[static_cast<std::size_t>(thread)], result);
  });
  if (progress != nullptr && progress->cancelled()) {
    result = Projection();
    return {ErrorCode::kCancelled, "the projection was cancelled"};
  }
  result.num_unsupported =
      static_cast<std::uint64_t>(std::count(result.supported.begin(), result.supported.end(), 0));
  return {};
}

}  // namespace pcl_slim
