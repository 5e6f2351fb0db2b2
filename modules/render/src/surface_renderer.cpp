// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/render/surface_renderer.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "camera/camera_rays.h"
#include "fast/fast_rasterizer.h"
#include "pcl_slim/core/parallel.h"
#include "projection/projection.h"
#include "pcl_slim/query/partition_of_unity.h"
#include "reference/tile_passes.h"
#include "shading/paint_surface.h"
#include "tiles/frame_rules.h"
#include "tiles/surfel_bins.h"
#include "tracer/gap_closer.h"

namespace pcl_slim {

using namespace detail;

struct SurfaceRenderer::State {
  const SLIMSurface& surface;
  Error defect;  ///< of the surface
  std::unique_ptr<FastRasterizer> fast;
  std::unique_ptr<PartitionOfUnity> unity;  ///< made when a frame first needs it
  SurfacePainter painter;
  GapCloser gaps;
};

namespace {

/** \brief Renders a frame in double, leaf by leaf and ray by ray, in tiles of 32 x 32 pixels.
 *
 * \param[in,out] buffer of the camera's size, marked as met by nothing
 * Cost: O(leaves + sum of visible balls' pixels).
 */
void
renderReference(const SLIMSurface& surface, const Camera& camera, const FrameRules& rules,
                GBuffer& buffer, RenderStatistics& statistics)
{
  const CameraRays rays(camera, surface.info.origin, surface.info.scale);
  const SurfelBins bins = binLeaves(surface, rays, camera.size, rules.shrink, rules.near_plane,
                                    rules.front_only && rules.skip, rules.threads, statistics);
  const FrameContext frame{surface, rays, bins, rules};
  statistics += forEachTile<Tile, RenderStatistics>(
      bins, rules.threads, [&](std::size_t t, Tile& tile, RenderStatistics& counts) {
        tile.begin(frame, camera.size, t);
        for (int layer = 0; layer < kMaxLayers; ++layer) {
          findFirstIntersections(frame, t, tile, counts);
          gatherBlends(frame, t, tile, counts);
          if (!peelUncovered(frame, tile)) break;
        }
        resolveTile(frame, tile, buffer, counts);
      });
}

void
writeCurvatures(const ImplicitJet& jet, double norm, std::size_t pixel, GBuffer& buffer)
{
  const auto [mean, gaussian] = meanAndGaussian(jet.gradient, norm, jet.hessian);
  const float spread = std::sqrt(std::max(0.0f, mean * mean - gaussian));
  buffer.mean_curvature[pixel] = mean;
  buffer.gaussian_curvature[pixel] = gaussian;
  buffer.principal[pixel] = {mean + spread, mean - spread};
}

void
writePixel(ImplicitJet jet, std::size_t pixel, GBuffer& buffer)
{
  const double norm = length(jet.gradient);
  if (!(norm > 0.0)) return;
  if (buffer.back_face[pixel]) {
    // Both sides are shown and this is the inner one: derivatives face the viewer.
    for (double& value : jet.gradient) value = -value;
    for (double& value : jet.hessian) value = -value;
  }
  for (std::size_t k = 0; k < 3; ++k) {
    buffer.normal[pixel][k] = static_cast<float>(jet.gradient[k] / norm);
    if (!buffer.gradient.empty()) buffer.gradient[pixel][k] = static_cast<float>(jet.gradient[k]);
  }
  for (std::size_t k = 0; k < 6 && !buffer.hessian.empty(); ++k) {
    buffer.hessian[pixel][k] = static_cast<float>(jet.hessian[k]);
  }
  if (!buffer.mean_curvature.empty()) writeCurvatures(jet, norm, pixel, buffer);
}

/** \brief Puts the partition of unity's derivatives (eq. 8, right) at a frame's positions in place
 * of the blended ones: normals, and gradients, Hessians and curvatures where the buffer has them.
 * The buffer must have positions. O(covered pixels * leaves near each). */
void
differentiateInSpace(const PartitionOfUnity& unity, int threads, GBuffer& buffer)
{
  parallelFor(buffer.numPixels(), threads, 256, [&](std::size_t pixel, int) {
    if (!buffer.covered(pixel)) return;
    const auto& q = buffer.position[pixel];
    ImplicitJet jet;
    if (unity.evaluate({q[0], q[1], q[2]}, jet)) writePixel(jet, pixel, buffer);
  });
}

/** \brief Looks up the residual of every covered pixel's leaf. */
void
lookUpResiduals(const SLIMSurface& surface, int threads, GBuffer& buffer)
{
  parallelFor(buffer.numPixels(), threads, 16384, [&](std::size_t pixel, int) {
    buffer.residual[pixel] = buffer.covered(pixel) ? surface.error[buffer.surfel[pixel]] : 0.0f;
  });
}

/** \brief Names what keeps a surface from having a partition of unity. */
Error
checkUnity(const SLIMSurface& surface, const RenderParams& params)
{
  if (params.derivatives == Derivatives::kBlended || surface.info.oriented) return {};
  return {ErrorCode::kBadArgument,
          "leaves that differ in orientation have no partition of unity; fit the surface with "
          "normals or take blended derivatives"};
}

/** \brief Whether rays of a frame are met by the tracer's rules. */
bool
closesGaps(const RenderParams& params)
{
  return params.close_gaps && params.lod == 0.0 && params.cuts.empty() && params.shrink == 0.0 &&
         params.min_coverage < 0.0 && params.trim;
}

}  // namespace

SurfaceRenderer::SurfaceRenderer(const SLIMSurface& surface, int threads)
    : state_(new State{surface, surface.validate(), nullptr, nullptr, SurfacePainter(surface),
                       GapCloser(surface)})
{
  if (!state_->defect) {
    state_->fast = std::make_unique<FastRasterizer>(surface, resolveThreads(threads));
  }
}

SurfaceRenderer::~SurfaceRenderer() = default;
SurfaceRenderer::SurfaceRenderer(SurfaceRenderer&&) noexcept = default;
SurfaceRenderer&
SurfaceRenderer::operator=(SurfaceRenderer&&) noexcept = default;

const SLIMSurface&
SurfaceRenderer::surface() const
{
  static const SLIMSurface none;
  return state_ ? state_->surface : none;
}

/** \brief Names what keeps a frame from being drawn. */
Error
SurfaceRenderer::check(const Camera& camera, const RenderParams& params) const
{
  if (Error error = camera.validate()) return error;
  if (Error error = params.validate()) return error;
  if (!state_) return badInput("the renderer has been moved from; make a new one");
  if (state_->defect) return state_->defect;
  return checkUnity(state_->surface, params);
}

Error
SurfaceRenderer::closeGaps(const Camera& camera, const RenderParams& params, GBuffer& buffer)
{
  Error error = check(camera, params);
  if (!error && (buffer.width != camera.size.width || buffer.height != camera.size.height)) {
    error = badInput("the frame's size is not the camera's; draw it by that camera");
  }
  if (error) {
    buffer.resize(0, 0);
    return error;
  }
  std::vector<std::size_t> drawn;
  for (std::size_t i = 0; i < buffer.numPixels(); ++i) {
    if (buffer.covered(i)) drawn.push_back(i);
  }
  const int threads = resolveThreads(params.threads);
  if (closesGaps(params)) state_->gaps.close(camera, params, threads, buffer);
  for (const std::size_t i : drawn) buffer.surfel[i] = GBuffer::kNothing;
  if (params.columns & kResidualColumn) lookUpResiduals(state_->surface, threads, buffer);
  if (params.columns & kColorColumn) state_->painter.paint(threads, buffer);
  return {};
}

Error
SurfaceRenderer::render(const Camera& camera, const RenderParams& params, GBuffer& buffer,
                        RenderStatistics* statistics)
{
  if (Error error = check(camera, params)) {
    buffer.resize(0, 0);
    return error;
  }
  const FrameRules rules(state_->surface.info, params);
  const bool in_space = params.derivatives == Derivatives::kPartitionOfUnity;
  const bool with_place = in_space || (params.columns & kColorColumn) != 0;
  const unsigned columns = params.columns | (with_place ? unsigned{kPositionColumn} : 0u);
  RenderStatistics counts;
  if (params.reference) {
    buffer.resize(camera.size.width, camera.size.height, columns);
    renderReference(state_->surface, camera, rules, buffer, counts);
  } else {
    buffer.reserve(camera.size.width, camera.size.height, columns);
    state_->fast->draw(camera, rules, columns, buffer, counts);
  }
  const int threads = resolveThreads(params.threads);
  if (closesGaps(params)) {
    RenderParams wanted = params;
    wanted.columns = columns;
    counts.closed_pixels = state_->gaps.close(camera, wanted, threads, buffer);
    counts.covered_pixels += counts.closed_pixels;
  }
  if (in_space) {
    if (!state_->unity) state_->unity = std::make_unique<PartitionOfUnity>(state_->surface);
    differentiateInSpace(*state_->unity, threads, buffer);
  }
  if (columns & kResidualColumn) lookUpResiduals(state_->surface, threads, buffer);
  if (columns & kColorColumn) state_->painter.paint(threads, buffer);
  if (statistics) *statistics = counts;
  return {};
}

Error
renderSurface(const SLIMSurface& surface, const Camera& camera, const RenderParams& params,
              GBuffer& buffer, RenderStatistics* statistics)
{
  return SurfaceRenderer(surface, params.threads).render(camera, params, buffer, statistics);
}

}  // namespace pcl_slim
