// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/render/disc_rasterizer.h"

#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "discs/disc_tile.h"
#include "pcl_slim/core/parallel.h"

namespace pcl_slim {

using namespace detail;
namespace {

enum class Visibility : std::uint8_t { kVisible, kOutside, kBackFacing };

Visibility
classify(const DiscFrame& frame, std::size_t i, VisibleLeaf& leaf)
{
  const Disc disc(frame, i);
  leaf.surfel = static_cast<std::uint32_t>(i);
  leaf.blend = frame.rays.pixelsOfBall(disc.center, disc.width);
  leaf.nearest = frame.rays.nearestDepth(disc.center, disc.reach);
  if (leaf.blend.empty() || leaf.nearest + 2.0 * disc.reach <= frame.params.near_plane) {
    return Visibility::kOutside;
  }
  if (frame.front_only && dot(disc.normal, frame.rays.directionTo(disc.center)) >= 0.0) {
    return Visibility::kBackFacing;
  }
  return Visibility::kVisible;
}

SurfelBins
binDiscs(const DiscFrame& frame, const ImageSize& size, int threads,
         DiscRenderStatistics& statistics)
{
  const std::size_t n = frame.splats.size();
  std::vector<VisibleLeaf> leaves(n), visible;
  std::vector<Visibility> visibility(n);
  parallelFor(n, threads, 1024,
              [&](std::size_t i, int) { visibility[i] = classify(frame, i, leaves[i]); });
  for (std::size_t i = 0; i < n; ++i) {
    if (visibility[i] == Visibility::kVisible) visible.push_back(leaves[i]);
    if (visibility[i] == Visibility::kOutside) ++statistics.outside_frustum;
    if (visibility[i] == Visibility::kBackFacing) ++statistics.back_facing;
  }
  SurfelBins bins = binByTile(size, std::move(visible), threads);
  statistics.discs += n;
  statistics.tile_entries += bins.entries.size();
  return bins;
}

Error
bad(const std::string& message)
{
  return {ErrorCode::kBadArgument, message};
}

}  // namespace

Error
DiscRenderParams::validate() const
{
  if (!(depth_tolerance >= 0.0 && depth_tolerance <= 100.0)) {
    return bad("the depth tolerance must be 0 to 100 radii");
  }
  if (!(near_plane >= 0.0 && std::isfinite(near_plane))) {
    return bad("the near plane must be a finite distance, 0 or more");
  }
  return checkThreads(threads);
}

DiscRenderStatistics&
DiscRenderStatistics::operator+=(const DiscRenderStatistics& other)
{
  discs += other.discs;
  outside_frustum += other.outside_frustum;
  back_facing += other.back_facing;
  tile_entries += other.tile_entries;
  rays_first += other.rays_first;
  rays_blend += other.rays_blend;
  blended += other.blended;
  covered_pixels += other.covered_pixels;
  return *this;
}

Error
validateDiscs(const SplatSet& splats)
{
  const std::size_t n = splats.size();
  const std::vector<float>* const columns[] = {&splats.x,  &splats.y,  &splats.z,     &splats.nx,
                                               &splats.ny, &splats.nz, &splats.radius};
  for (const std::vector<float>* column : columns) {
    if (column->size() != n) return bad("the discs' columns differ in length");
  }
  if (splats.rgb.size() != n || (!splats.gradient.empty() && splats.gradient.size() != n)) {
    return bad("the discs' columns differ in length");
  }
  if (n >= GBuffer::kNothing) return bad("there are more than 2^32 - 2 discs");
  for (const double value : splats.origin) {
    if (!std::isfinite(value)) return bad("the discs' origin is not finite");
  }
  for (std::size_t i = 0; i < n; ++i) {
    bool finite = splats.radius[i] >= 0.0f;
    for (const std::vector<float>* column : columns) finite = finite && std::isfinite((*column)[i]);
    if (!splats.gradient.empty()) {
      for (const float value : splats.gradient[i]) finite = finite && std::isfinite(value);
    }
    if (!finite) {
      return bad("disc " + std::to_string(i) +
                 " has a value that is not finite or a radius below 0");
    }
  }
  return {};
}

Error
renderDiscs(const SplatSet& splats, const Camera& camera, const DiscRenderParams& params,
            GBuffer& buffer, DiscRenderStatistics* statistics)
{
  buffer.resize(0, 0);
  if (Error error = camera.validate()) return error;
  if (Error error = params.validate()) return error;
  if (Error error = validateDiscs(splats)) return error;
  buffer.resize(camera.size.width, camera.size.height);
  buffer.color.assign(buffer.numPixels(), {});

  const int threads = resolveThreads(params.threads);
  DiscRenderStatistics total;
  const CameraRays rays(camera, splats.origin, 1.0);
  SurfelBins bins;
  const DiscFrame frame{{splats, rays, params, params.sides == VisibleSides::kFront}, bins};
  bins = binDiscs(frame, camera.size, threads, total);

  total += forEachTile<DiscTile, DiscRenderStatistics>(
      bins, threads, [&](std::size_t t, DiscTile& tile, DiscRenderStatistics& counts) {
        tile.begin(frame, camera.size, t);
        tile.findFirst(frame, counts);
        tile.blend(frame, counts);
        tile.resolve(frame, buffer, counts);
      });
  if (statistics) *statistics = total;
  return {};
}

}  // namespace pcl_slim
