// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/render/disc_rasterizer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "discs/disc_blend.h"
#include "pcl_slim/core/parallel.h"
#include "tiles/surfel_bins.h"

namespace pcl_slim {

using namespace detail;
namespace {

/** \brief What every tile of a frame of discs needs. */
struct DiscFrame : DiscView {
  const SurfelBins& bins;
};

/** \brief One tile's pixels while discs are drawn into them; reused from tile to tile. */
class DiscTile {
 public:
  /** \brief Takes up tile number t and prepares its rays. */
  void begin(const DiscFrame& frame, const ImageSize& size, std::size_t t);

  /** \brief Pass 1: the first disc of each ray. */
  void findFirst(const DiscFrame& frame, DiscRenderStatistics& statistics);
  /** \brief Pass 2: weighted sums over the discs at the first one's depth. */
  void blend(const DiscFrame& frame, DiscRenderStatistics& statistics);
  /** \brief Writes the tile's pixels. */
  void resolve(const DiscFrame& frame, GBuffer& buffer, DiscRenderStatistics& statistics) const;

 private:
  std::size_t index(int x, int y) const
  {
    return static_cast<std::size_t>(y - y0_) * kTileSize + static_cast<std::size_t>(x - x0_);
  }
  template <typename Body>
  void forEachPixel(const DiscFrame& frame, const Body& body) const;
  PixelRect clip(const PixelRect& rect) const;

  std::size_t tile_ = 0;
  int x0_ = 0, y0_ = 0, width_ = 0, height_ = 0;
  std::vector<Ray> rays_;
  std::vector<FirstDisc> first_;
  std::vector<DiscSum> sums_;
};

PixelRect
DiscTile::clip(const PixelRect& rect) const
{
  return {std::max(rect.x0, x0_), std::max(rect.y0, y0_), std::min(rect.x1, x0_ + width_ - 1),
          std::min(rect.y1, y0_ + height_ - 1)};
}

void
DiscTile::begin(const DiscFrame& frame, const ImageSize& size, std::size_t t)
{
  tile_ = t;
  x0_ = static_cast<int>(t) % frame.bins.columns * kTileSize;
  y0_ = static_cast<int>(t) / frame.bins.columns * kTileSize;
  width_ = std::min(kTileSize, size.width - x0_);
  height_ = std::min(kTileSize, size.height - y0_);
  constexpr std::size_t kPixels = std::size_t{kTileSize} * kTileSize;
  rays_.resize(kPixels);
  first_.assign(kPixels, FirstDisc());
  sums_.assign(kPixels, DiscSum());
  for (int y = y0_; y < y0_ + height_; ++y) {
    for (int x = x0_; x < x0_ + width_; ++x) rays_[index(x, y)] = frame.rays.ray(x, y);
  }
}

/** \brief Runs body(leaf, disc, pixel) for every disc of the tile and every pixel it may cover. */
template <typename Body>
void
DiscTile::forEachPixel(const DiscFrame& frame, const Body& body) const
{
  for (std::uint64_t e = frame.bins.begin[tile_]; e < frame.bins.begin[tile_ + 1]; ++e) {
    const VisibleLeaf& leaf = frame.bins.leaves[frame.bins.entries[e]];
    const Disc disc(frame, leaf.surfel);
    const PixelRect rect = clip(leaf.blend);
    for (int y = rect.y0; y <= rect.y1; ++y) {
      for (int x = rect.x0; x <= rect.x1; ++x) {
        body(leaf, disc, index(x, y));
      }
    }
  }
}

void
DiscTile::findFirst(const DiscFrame& frame, DiscRenderStatistics& statistics)
{
  forEachPixel(frame, [&](const VisibleLeaf& leaf, const Disc& disc, std::size_t pixel) {
    FirstDisc& first = first_[pixel];
    if (frame.params.skip && leaf.nearest > first.depth) return;
    ++statistics.rays_first;
    DiscHit hit;
    if (!intersect(frame, rays_[pixel], disc, hit) || hit.depth >= first.depth) return;
    first = {hit.depth, hit.cosine, disc.radius, leaf.surfel};
  });
}

void
DiscTile::blend(const DiscFrame& frame, DiscRenderStatistics& statistics)
{
  forEachPixel(frame, [&](const VisibleLeaf& leaf, const Disc& disc, std::size_t pixel) {
    const FirstDisc& first = first_[pixel];
    if (first.disc == GBuffer::kNothing) return;
    if (!frame.params.filtered && first.disc != leaf.surfel) return;
    if (frame.params.skip && !countsBehind(frame, first, disc, leaf.nearest, 0.0)) return;
    ++statistics.rays_blend;
    DiscHit hit;
    if (!intersect(frame, rays_[pixel], disc, hit)) return;
    if (!countsBehind(frame, first, disc, hit.depth, hit.cosine)) return;
    ++statistics.blended;
    addDisc(frame, hit, disc, leaf.surfel, sums_[pixel]);
  });
}

void
DiscTile::resolve(const DiscFrame& frame, GBuffer& buffer, DiscRenderStatistics& statistics) const
{
  for (int y = y0_; y < y0_ + height_; ++y) {
    for (int x = x0_; x < x0_ + width_; ++x) {
      const std::size_t pixel = index(x, y);
      if (!(sums_[pixel].weight > 0.0)) continue;
      writeDiscs(frame, rays_[pixel], first_[pixel], sums_[pixel], buffer.index(x, y), buffer);
      ++statistics.covered_pixels;
    }
  }
}

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
