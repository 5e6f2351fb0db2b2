// SPDX-License-Identifier: BSD-3-Clause
// Discs on rays, and frames of them in tiles.
#include "pcl_slim/render/disc_rasterizer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "discs/disc_blend.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/core/vector3.h"
#include "tiles/tiles.h"

namespace pcl_slim::detail {
namespace {

constexpr double kHalfDiagonal = 0.70710678118654752;  ///< of a pixel: such a disc covers a centre
constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::array<double, 3> codedColor(std::uint32_t rgb) {
  return {static_cast<double>(rgb >> 16 & 255u), static_cast<double>(rgb >> 8 & 255u),
          static_cast<double>(rgb & 255u)};
}

/** \brief Colour of a disc at an offset from its centre, 0 ... 255. */
std::array<double, 3> colorAt(const SplatSet& splats, std::size_t i, const Vector3& offset) {
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
      reach(view.params.filtered ? span + pixel : radius) {}

bool intersect(const DiscView& view, const Ray& ray, const Disc& disc, DiscHit& hit) {
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

bool countsBehind(const DiscView& view, const FirstDisc& first, const Disc& disc, double depth,
                  double cosine) {
  const double tolerance =
      view.params.depth_tolerance * (0.5 * (first.radius + disc.radius) + disc.pixel);
  return (depth - first.depth) * std::max(first.cosine, cosine) <= tolerance;
}

void addDisc(const DiscView& view, const DiscHit& hit, const Disc& disc, std::size_t i,
             DiscSum& sum) {
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

void writeDiscs(const DiscView& view, const Ray& ray, const FirstDisc& first, const DiscSum& sum,
                std::size_t pixel, GBuffer& buffer) {
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
  std::size_t index(int x, int y) const {
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

PixelRect DiscTile::clip(const PixelRect& rect) const {
  return {std::max(rect.x0, x0_), std::max(rect.y0, y0_), std::min(rect.x1, x0_ + width_ - 1),
          std::min(rect.y1, y0_ + height_ - 1)};
}

void DiscTile::begin(const DiscFrame& frame, const ImageSize& size, std::size_t t) {
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
void DiscTile::forEachPixel(const DiscFrame& frame, const Body& body) const {
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

void DiscTile::findFirst(const DiscFrame& frame, DiscRenderStatistics& statistics) {
  forEachPixel(frame, [&](const VisibleLeaf& leaf, const Disc& disc, std::size_t pixel) {
    FirstDisc& first = first_[pixel];
    if (frame.params.skip && leaf.nearest > first.depth) return;
    ++statistics.rays_first;
    DiscHit hit;
    if (!intersect(frame, rays_[pixel], disc, hit) || hit.depth >= first.depth) return;
    first = {hit.depth, hit.cosine, disc.radius, leaf.surfel};
  });
}

void DiscTile::blend(const DiscFrame& frame, DiscRenderStatistics& statistics) {
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

void DiscTile::resolve(const DiscFrame& frame, GBuffer& buffer,
                       DiscRenderStatistics& statistics) const {
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

Visibility classify(const DiscFrame& frame, std::size_t i, VisibleLeaf& leaf) {
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

SurfelBins binDiscs(const DiscFrame& frame, const ImageSize& size, int threads,
                    DiscRenderStatistics& statistics) {
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

Error bad(const std::string& message) {
  return {ErrorCode::kBadArgument, message};
}

}  // namespace

Error DiscRenderParams::validate() const {
  if (!(depth_tolerance >= 0.0 && depth_tolerance <= 100.0)) {
    return bad("the depth tolerance must be 0 to 100 radii");
  }
  if (!(near_plane >= 0.0 && std::isfinite(near_plane))) {
    return bad("the near plane must be a finite distance, 0 or more");
  }
  return checkThreads(threads);
}

DiscRenderStatistics& DiscRenderStatistics::operator+=(const DiscRenderStatistics& other) {
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

Error validateDiscs(const SplatSet& splats) {
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

Error renderDiscs(const SplatSet& splats, const Camera& camera, const DiscRenderParams& params,
                  GBuffer& buffer, DiscRenderStatistics* statistics) {
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

SplatSet splatsWithin(const SplatSet& splats, const std::vector<HalfSpace>& cuts) {
  const auto lies = [&](std::size_t i) {
    const Vector3 center{splats.origin[0] + double{splats.x[i]},
                         splats.origin[1] + double{splats.y[i]},
                         splats.origin[2] + double{splats.z[i]}};
    return std::all_of(cuts.begin(), cuts.end(),
                       [&](const HalfSpace& cut) { return dot(cut.normal, center) >= cut.offset; });
  };
  SplatSet kept = splats;
  std::size_t n = 0;
  for (std::size_t i = 0; i < splats.size(); ++i) {
    if (!lies(i)) continue;
    for (auto column :
         {&SplatSet::x, &SplatSet::y, &SplatSet::z, &SplatSet::nx, &SplatSet::ny, &SplatSet::nz,
          &SplatSet::radius, &SplatSet::confidence, &SplatSet::normal_variance}) {
      (kept.*column)[n] = (splats.*column)[i];
    }
    kept.rgb[n] = splats.rgb[i];
    kept.kept[n] = splats.kept[i];
    if (!splats.gradient.empty()) kept.gradient[n] = splats.gradient[i];
    ++n;
  }
  kept.resize(n, !splats.gradient.empty());
  return kept;
}

}  // namespace pcl_slim
