// SPDX-License-Identifier: BSD-3-Clause
#include "discs/disc_blend.h"

#include <algorithm>
#include <limits>

namespace pcl_slim::detail {
namespace {

constexpr double kHalfDiagonal = 0.70710678118654752;  ///< of a pixel: such a disc covers a centre
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

Disc::Disc(const DiscView& view, std::size_t i)
    : center{view.splats.x[i], view.splats.y[i], view.splats.z[i]},
      normal(normalized({view.splats.nx[i], view.splats.ny[i], view.splats.nz[i]})),
      radius(view.splats.radius[i]),
      pixel(view.rays.pixelLength(center)),
      width(view.params.filtered ? std::max(radius, kHalfDiagonal * pixel) : radius),
      span(view.params.filtered ? width + pixel : radius),
      reach(view.params.filtered ? span + pixel : radius)
{
}

bool
intersect(const DiscView& view, const Ray& ray, const Disc& disc, DiscHit& hit)
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
  if (view.params.filtered) {
    const Vector3 aside = along(to_center, -middle, ray.direction);
    const double filter = kHalfDiagonal * disc.pixel;
    const double screen_sq = dot(aside, aside) / (filter * filter);
    // The filter reaches past the rim, where the disc has no colours of its own.
    if (length_sq > radius_sq) hit.offset = scaled(hit.offset, disc.radius / std::sqrt(length_sq));
    hit.distance_sq = std::min(hit.distance_sq, screen_sq);
  }
  hit.cosine = std::abs(facing);
  hit.from_front = facing <= 0.0;
  return hit.distance_sq < 1.0 && hit.depth > view.params.near_plane;
}

bool
countsBehind(const DiscView& view, const FirstDisc& first, const Disc& disc, double depth,
             double cosine)
{
  const double tolerance =
      view.params.depth_tolerance * (0.5 * (first.radius + disc.radius) + disc.pixel);
  return (depth - first.depth) * std::max(first.cosine, cosine) <= tolerance;
}

void
addDisc(const DiscView& view, const DiscHit& hit, const Disc& disc, std::size_t i, DiscSum& sum)
{
  const double falloff = 1.0 - hit.distance_sq, weight = falloff * falloff;
  const double side = view.front_only || hit.from_front ? weight : -weight;
  const std::array<double, 3> color = colorAt(view.splats, i, hit.offset);
  sum.weight += weight;
  sum.depth += weight * hit.depth;
  for (std::size_t k = 0; k < 3; ++k) {
    sum.normal[k] += side * disc.normal[k];
    sum.color[k] += weight * color[k];
  }
}

void
writeDiscs(const DiscView& view, const Ray& ray, const FirstDisc& first, const DiscSum& sum,
           std::size_t pixel, GBuffer& buffer)
{
  const double depth = sum.depth / sum.weight;
  const Vector3 position = along(ray.origin, depth, ray.direction);
  const Vector3 normal = normalized({sum.normal[0], sum.normal[1], sum.normal[2]});
  buffer.depth[pixel] = static_cast<float>(depth);
  for (std::size_t k = 0; k < 3; ++k) {
    buffer.position[pixel][k] = static_cast<float>(position[k]);
    buffer.normal[pixel][k] = static_cast<float>(normal[k]);
    buffer.gradient[pixel][k] = buffer.normal[pixel][k];
    buffer.color[pixel][k] = static_cast<float>(sum.color[k] / (255.0 * sum.weight));
  }
  buffer.surfel[pixel] = first.disc;
  buffer.radius[pixel] = view.splats.radius[first.disc];
  buffer.weight[pixel] = static_cast<float>(sum.weight);
}

}  // namespace pcl_slim::detail
