// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/render/camera.h"
#include "pcl_slim/render/g_buffer.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim {

/** \brief Which sides of a surface are drawn. */
enum class VisibleSides : unsigned char {
  kAuto,   ///< the front of an oriented surface, both sides of any other
  kFront,  ///< only where the gradient faces the viewer
  kBoth,   ///< either side; derivatives are turned to the viewer leaf by leaf
};

/** \brief A half space: points x with dot(normal, x) >= offset, world coordinates. */
struct HalfSpace {
  std::array<double, 3> normal{0.0, 0.0, 1.0};  ///< any length but 0
  double offset = 0.0;
};

/** \brief Parameters of renderSurface. */
struct RenderParams {
  VisibleSides sides = VisibleSides::kAuto;
  double shrink = 0.0;  ///< alpha of pass 1, (0, 0.95]; 0: the surface's cover radius
  double min_coverage =
      -1.0;                 ///< rays pass through where coverage is less; < 0: the surface's gamma
  double near_plane = 0.0;  ///< smallest depth shown, world units, >= 0
  bool skip = true;         ///< leave out work that cannot change the result
  int threads = 0;          ///< 0: all cores; never changes the result
  /** Rays begin where they enter the last of these half spaces: the surface is cut open. With kAuto
   * both sides of a cut surface are drawn. Where a ray has left one, the caller has to look. */
  std::vector<HalfSpace> cuts;

  /** \brief Names the first parameter out of range. */
  Error validate() const;
};

/** \brief What a frame evaluated and what it left out. */
struct RenderStatistics {
  std::uint64_t leaves = 0;            ///< leaves of the surface
  std::uint64_t outside_frustum = 0;   ///< leaves whose ball no ray meets
  std::uint64_t back_facing = 0;       ///< leaves turned away as a whole
  std::uint64_t tile_entries = 0;      ///< (leaf, tile) pairs
  std::uint64_t occluded_entries = 0;  ///< of those, behind everything pass 1 had found
  std::uint64_t rays_first = 0;        ///< polynomials restricted to a ray in pass 1
  std::uint64_t rays_blend = 0;        ///< the same in pass 2
  std::uint64_t covered_pixels = 0;

  RenderStatistics& operator+=(const RenderStatistics& other);
};

/** \brief Renders a SLIM surface into a G-buffer by blending leaves along view rays.
 *
 * Ohtake, Belyaev, Alexa 2005, section 3, per tile of 32 x 32 pixels: pass 1 finds q^, the first
 * intersection inside any leaf's ball shrunk by alpha; pass 2 gathers the leaves whose ball holds
 * q^ and blends, at each one's root nearest to q^, position (eq. 6), gradient (eq. 7) and Hessian
 * (eq. 8, left). Two guards keep leaves of other sheets out: the weight is taken at the larger of
 * |q^ - c| and |q - c|, and a leaf whose own surface passes q^ by more than r/4 does not count.
 *
 * Where the blend's coverage (sum of G(|q - c| / (alpha r))) is below the surface's threshold and
 * the leaves do not lie all around q, the surface is not defined: leaves reach beyond the rim of
 * what was measured. Rays pass through and both passes run again behind it.
 *
 * The buffer is the same for any number of threads, and with skipping on or off.
 * Cost: O(leaves + sum of visible balls' pixels).
 * \return an error for a bad surface, camera or parameter; the buffer is then empty.
 */
Error
renderSurface(const SLIMSurface& surface, const Camera& camera, const RenderParams& params,
              GBuffer& buffer, RenderStatistics* statistics = nullptr);

}  // namespace pcl_slim
