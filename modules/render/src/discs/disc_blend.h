// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>

#include "camera/camera_rays.h"
#include "pcl_slim/render/disc_rasterizer.h"
#include "pcl_slim/render/g_buffer.h"

namespace pcl_slim::detail {

/** \brief What every ray through discs needs. Local units: world less splats.origin. */
struct DiscView {
  const SplatSet& splats;
  const CameraRays& rays;
  const DiscRenderParams& params;
  bool front_only;
};

/** \brief One disc as rays meet it. */
struct Disc {
  Vector3 center, normal;
  double radius;
  double pixel;  ///< length of a pixel where the disc is
  double width;  ///< radius of what rays meet: at least half a pixel's diagonal if filtered
  double span;   ///< along a ray no hit is farther from the point next to the centre
  double reach;  ///< nor farther from the centre itself

  Disc(const DiscView& view, std::size_t i);
};

/** \brief Where a ray meets a disc. */
struct DiscHit {
  double depth = 0.0;
  double cosine = 0.0;       ///< of the angle between ray and normal, >= 0
  double distance_sq = 0.0;  ///< s^2 of the weight, in [0, 1)
  Vector3 offset{};          ///< from the centre, within the disc
  bool from_front = true;
};

/** \brief Intersects a ray with a disc. \return false where it passes by. */
bool intersect(const DiscView& view, const Ray& ray, const Disc& disc, DiscHit& hit);

/** \brief The first disc of a ray. */
struct FirstDisc {
  double depth = HUGE_VAL, cosine = 0.0, radius = 0.0;
  std::uint32_t disc = GBuffer::kNothing;
};

/** \brief Weighted sums over the discs of a ray. */
struct DiscSum {
  double weight = 0.0, depth = 0.0, normal[3] = {}, color[3] = {};
};

/** \brief Whether something of a disc at this depth belongs to the surface the first disc shows.
 *
 * Depths of one surface differ by its thickness over the cosine of the view; the larger cosine of
 * the two keeps what is behind a wall seen along its side from counting as the wall. */
bool countsBehind(const DiscView& view, const FirstDisc& first, const Disc& disc, double depth,
                  double cosine);

/** \brief Adds what a ray meets of disc i. */
void addDisc(const DiscView& view, const DiscHit& hit, const Disc& disc, std::size_t i,
             DiscSum& sum);

/** \brief Divides the sums and writes them into a pixel of the buffer. */
void writeDiscs(const DiscView& view, const Ray& ray, const FirstDisc& first, const DiscSum& sum,
                std::size_t pixel, GBuffer& buffer);

}  // namespace pcl_slim::detail
