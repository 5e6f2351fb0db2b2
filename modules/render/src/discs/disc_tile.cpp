// SPDX-License-Identifier: BSD-3-Clause
#include "discs/disc_tile.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pcl_slim::detail {
namespace {

constexpr double kHalfDiagonal = 0.70710678118654752;  ///< of a pixel: such a circle holds a centre
constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::array<double, 3>
codedColor(std::uint32_t rgb)
{
  return {static_cast<double>(rgb >> 16 & 255u), static_cast<double>(rgb >> 8 & 255u),
          static_cast<double>(rgb & 255u)};
}

/** \brief Colour of a disc at an offset from its centre, 0 ... 255. */
std::array<double, 3>
colorAt(const SplatSet& splats, std::size_t i, const Vector3& offset)
{
  std::array<double, 3> color = codedColor(splats.rgb[i]);
  if (splats.gradient.empty()) return color;
  const SplatSet::Gradient& g = splats.gradient[i];
  for (std::size_t k = 0; k < 3; ++k) {
    const double change =
        g[3 * k] * offset[0] + g[3 * k + 1] * offset[1] + g[3 * k + 2] * offset[2];
    color[k] = std::clamp(color[k] + change, 0.0, 255.0);
  }
  return color;
}

}  // namespace

Disc::Disc(const DiscFrame& frame, std::size_t i)
    : center{frame.splats.x[i], frame.splats.y[i], frame.splats.z[i]},
      normal(normalized({frame.splats.nx[i], frame.splats.ny[i], frame.splats.nz[i]})),
      radius(frame.splats.radius[i]),
      pixel(frame.rays.pixelLength(center)),
      width(frame.params.filtered ? std::max(radius, kHalfDiagonal * pixel) : radius),
      span(frame.params.filtered ? width + pixel : radius),
      reach(frame.params.filtered ? span + pixel : radius)
{
}

bool
intersect(const DiscFrame& frame, const Ray& ray, const Disc& disc, DiscHit& hit)
{
  const Vector3 to_center = subtract(disc.center, ray.origin);
  const double facing = dot(disc.normal, ray.direction);
  const double middle = dot(to_center, ray.direction);
  const double depth = facing != 0.0 ? dot(disc.normal, to_center) / facing : kInfinity;
  const bool meets_plane = std::abs(depth - middle) <= disc.span;
  hit.depth = meets_plane ? depth : middle;
  hit.offset = subtract(scaled(ray.direction, hit.depth), to_center);
  const double radius_sq = disc.radius * disc.radius;
  const double length_sq = dot(hit.offset, hit.offset);
  hit.distance_sq = meets_plane && length_sq < radius_sq ? length_sq / radius_sq : kInfinity;
  if (frame.params.filtered) {
    const Vector3 aside = along(to_center, -middle, ray.direction);
    const double filter = kHalfDiagonal * disc.pixel;
    const double screen_sq = dot(aside, aside) / (filter * filter);
    // The filter reaches past the rim, where the disc has no colours of its own.
    if (length_sq > radius_sq) hit.offset = scaled(hit.offset, disc.radius / std::sqrt(length_sq));
    hit.distance_sq = std::min(hit.distance_sq, screen_sq);
  }
  hit.cosine = std::abs(facing);
  hit.from_front = facing <= 0.0;
  return hit.distance_sq < 1.0 && hit.depth > frame.params.near_plane;
}

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
  first_.assign(kPixels, First{kInfinity, 0.0, 0.0, GBuffer::kNothing});
  sums_.assign(kPixels, Sum{});
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
    First& first = first_[pixel];
    if (frame.params.skip && leaf.nearest > first.depth) return;
    ++statistics.rays_first;
    DiscHit hit;
    if (!intersect(frame, rays_[pixel], disc, hit) || hit.depth >= first.depth) return;
    first = {hit.depth, hit.cosine, disc.radius, leaf.surfel};
  });
}

/** \brief Whether something of a disc at this depth belongs to the surface the first disc shows.
 * Depths of one surface differ by its thickness over the cosine of the view; the larger cosine of
 * the two keeps what lies behind a wall seen along its side from counting as the wall. */
bool
DiscTile::countsBehind(const DiscFrame& frame, const First& first, const Disc& disc, double depth,
                       double cosine) const
{
  const double tolerance =
      frame.params.depth_tolerance * (0.5 * (first.radius + disc.radius) + disc.pixel);
  return (depth - first.depth) * std::max(first.cosine, cosine) <= tolerance;
}

void
DiscTile::add(const DiscFrame& frame, const DiscHit& hit, const Disc& disc, std::size_t i, Sum& sum)
{
  const double falloff = 1.0 - hit.distance_sq, weight = falloff * falloff;
  const double side = frame.front_only || hit.from_front ? weight : -weight;
  const std::array<double, 3> color = colorAt(frame.splats, i, hit.offset);
  sum.weight += weight;
  sum.depth += weight * hit.depth;
  for (std::size_t k = 0; k < 3; ++k) {
    sum.normal[k] += side * disc.normal[k];
    sum.color[k] += weight * color[k];
  }
}

void
DiscTile::blend(const DiscFrame& frame, DiscRenderStatistics& statistics)
{
  forEachPixel(frame, [&](const VisibleLeaf& leaf, const Disc& disc, std::size_t pixel) {
    const First& first = first_[pixel];
    if (first.disc == GBuffer::kNothing) return;
    if (!frame.params.filtered && first.disc != leaf.surfel) return;
    if (frame.params.skip && !countsBehind(frame, first, disc, leaf.nearest, 0.0)) return;
    ++statistics.rays_blend;
    DiscHit hit;
    if (!intersect(frame, rays_[pixel], disc, hit)) return;
    if (!countsBehind(frame, first, disc, hit.depth, hit.cosine)) return;
    ++statistics.blended;
    add(frame, hit, disc, leaf.surfel, sums_[pixel]);
  });
}

void
DiscTile::resolve(const DiscFrame& frame, GBuffer& buffer, DiscRenderStatistics& statistics) const
{
  for (int y = y0_; y < y0_ + height_; ++y) {
    for (int x = x0_; x < x0_ + width_; ++x) {
      const std::size_t pixel = index(x, y), out = buffer.index(x, y);
      const Sum& sum = sums_[pixel];
      if (!(sum.weight > 0.0)) continue;
      const double depth = sum.depth / sum.weight;
      const Vector3 position = along(rays_[pixel].origin, depth, rays_[pixel].direction);
      const Vector3 normal = normalized({sum.normal[0], sum.normal[1], sum.normal[2]});
      buffer.depth[out] = static_cast<float>(depth);
      for (std::size_t k = 0; k < 3; ++k) {
        buffer.position[out][k] = static_cast<float>(position[k]);
        buffer.normal[out][k] = static_cast<float>(normal[k]);
        buffer.gradient[out][k] = buffer.normal[out][k];
        buffer.color[out][k] = static_cast<float>(sum.color[k] / (255.0 * sum.weight));
      }
      buffer.surfel[out] = first_[pixel].disc;
      buffer.radius[out] = frame.splats.radius[first_[pixel].disc];
      buffer.weight[out] = static_cast<float>(sum.weight);
      ++statistics.covered_pixels;
    }
  }
}

}  // namespace pcl_slim::detail
