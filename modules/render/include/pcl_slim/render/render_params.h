// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/render/g_buffer.h"

namespace pcl_slim {

/** \brief Which sides of a surface are drawn. */
enum class VisibleSides : unsigned char {
  kAuto,  ///< the front of a surface that has one (SurfaceInfo::hasFront()), both sides of any other
  kFront,  ///< only where the gradient faces the viewer
  kBoth,   ///< either side; derivatives are turned to the viewer leaf by leaf
};

/** \brief A half space: points x with dot(normal, x) >= offset, world coordinates. */
struct HalfSpace {
  std::array<double, 3> normal{0.0, 0.0, 1.0};  ///< any length but 0
  double offset = 0.0;
};

/** \brief Parameters of SurfaceRenderer::render. */
struct PCL_SLIM_EXPORT RenderParams {
  VisibleSides sides = VisibleSides::kAuto;
  double shrink = 0.0;  ///< alpha of pass 1, (0, 0.95]; 0: the surface's cover radius
  double min_coverage =
      -1.0;                 ///< rays pass through where coverage is less; < 0: the surface's gamma
  bool trim = true;         ///< end open surfaces, and open holes, by their trim maps
  double near_plane = 0.0;  ///< smallest depth shown along a ray, world units, >= 0
  double lod = 0.0;         ///< surfels of this projected diameter in pixels, or an error of a
                            ///< sixteenth, replace their descendants; 0: every leaf is drawn
  unsigned columns = kAllColumns;  ///< GBufferColumn bits: what the picture needs
  /** Rays that slip between shrunk balls where most pixels about theirs meet the surface are traced
   * again, as with TraceParams::close_gaps. A frame with lod, cuts, shrink, min_coverage or without
   * trim has open gaps. */
  bool close_gaps = false;
  bool skip = true;  ///< leave out work that cannot change the result
  int threads = 0;   ///< 0: all cores; never changes the result
  /** Only what is in all of these half spaces is met: the surface is cut open, and with kAuto both
   * of its sides are drawn. Balls that are completely outside are left out with their nodes, so
   * that a part of a large surface costs what it shows. */
  std::vector<HalfSpace> cuts;

  /** \brief Names the first parameter out of range. */
  Error validate() const;
};

/** \brief What a frame evaluated and what it left out. */
struct PCL_SLIM_EXPORT RenderStatistics {
  std::uint64_t leaves = 0;            ///< leaves of the surface
  std::uint64_t outside_frustum = 0;   ///< leaves whose ball no ray meets
  std::uint64_t outside_region = 0;    ///< leaves whose ball RenderParams::cuts leave nothing of
  std::uint64_t back_facing = 0;       ///< leaves turned away as a whole
  std::uint64_t below_detail = 0;      ///< leaves replaced by coarser surfels, with lod
  std::uint64_t coarse_surfels = 0;    ///< surfels drawn that are no leaves, with lod
  std::uint64_t tile_entries = 0;      ///< (surfel, tile) pairs
  std::uint64_t occluded_entries = 0;  ///< of those, behind everything pass 1 had found
  std::uint64_t rays_first = 0;        ///< polynomials restricted to a ray in pass 1
  std::uint64_t rays_blend = 0;        ///< the same in pass 2
  std::uint64_t rays_bracketed = 0;    ///< of both, those whose roots had to be isolated one by one
  std::uint64_t covered_pixels = 0;
  std::uint64_t closed_pixels = 0;  ///< of those, filled by close_gaps

  RenderStatistics& operator+=(const RenderStatistics& other);
};

}  // namespace pcl_slim
