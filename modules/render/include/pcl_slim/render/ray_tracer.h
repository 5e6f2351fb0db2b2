// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/core/progress.h"
#include "pcl_slim/render/camera.h"
#include "pcl_slim/render/color_map.h"
#include "pcl_slim/render/g_buffer.h"
#include "pcl_slim/render/render_params.h"
#include "pcl_slim/splat/splat_set.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim {

/** \brief A light far away, as the sun. */
struct RayLight {
  std::array<double, 3> towards{0.0, 0.0, 1.0};  ///< from the object to the light, any length but 0
  Color color{1.0f, 1.0f, 1.0f};                 ///< linear light on a surface that faces it, >= 0
  double spread = 0.0;  ///< radius in degrees, [0, 45]; 0: shadows with sharp rims
};

/** \brief Parameters of RayTracer::trace. */
struct PCL_SLIM_EXPORT TraceParams {
  VisibleSides sides = VisibleSides::kAuto;  ///< as the rasterisers': kAuto of discs is both
  double near_plane = 0.0;  ///< smallest depth shown along a ray, world units, >= 0
  /** As RenderParams::cuts, for rays of every kind: what is cut away casts no shadow. Discs that
   * cross a half space's plane are met in it. */
  std::vector<HalfSpace> cuts;
  /** Of surfaces: where a ray would meet nothing but slips between shrunk balls it meets the blend
   * of the leaves around, if these are on all sides, have similar normals and face it. false: such
   * gaps are open, as they are to a rasteriser without RenderParams::close_gaps. */
  bool close_gaps = true;
  bool filtered = true;            ///< of discs, as DiscRenderParams::filtered
  double depth_tolerance = 0.5;    ///< of discs, as DiscRenderParams::depth_tolerance
  unsigned columns = kAllColumns;  ///< GBufferColumn bits; discs fill every one they have
  std::vector<RayLight> lights;    ///< each has a shadow ray from every point that faces it
  int occlusion_rays = 0;          ///< rays a point into the open half space, [0, 4096]
  double occlusion_reach = 0.1;    ///< how far these look, in diagonals of the object, > 0
  unsigned sample = 0;  ///< frames that are to be averaged differ in it; turns the random rays
  int threads = 0;      ///< 0: all cores; never changes the result

  /** \brief Names the first parameter out of range. */
  Error validate() const;
};

/** \brief How light comes to the points of a G-buffer. */
struct LightBuffer {
  std::vector<float> visible;  ///< 1: light l reaches pixel i; at l * pixels + i. 0 also where the
                               ///< point is turned away from the light or there is none
  std::vector<float> open;     ///< share of the occlusion rays that met nothing; 1 without any
};

/** \brief What rays cost. */
struct PCL_SLIM_EXPORT TraceStatistics {
  std::uint64_t leaves = 0;  ///< leaves or discs of the object
  std::uint64_t rays_primary = 0;
  std::uint64_t rays_shadow = 0;
  std::uint64_t rays_occlusion = 0;
  std::uint64_t nodes = 0;         ///< nodes of the tree looked at, eight boxes each
  std::uint64_t tested_first = 0;  ///< leaves or discs intersected with a ray to find the first
  std::uint64_t tested_blend = 0;  ///< the same to blend
  std::uint64_t bracketed = 0;     ///< of both, those whose roots had to be isolated one by one
  std::uint64_t closed = 0;        ///< camera rays that met a gap that close_gaps closed
  std::uint64_t peeled = 0;        ///< blends that did not belong to the surface
  std::uint64_t covered_pixels = 0;

  /** \brief Leaves or discs intersected, a ray of any kind. */
  double testedPerRay() const;
  TraceStatistics& operator+=(const TraceStatistics& other);
};

/** \brief A ray in world coordinates, and the stretch of it that counts. */
struct PCL_SLIM_EXPORT WorldRay {
  std::array<double, 3> origin{};
  std::array<double, 3> direction{0.0, 0.0, 1.0};  ///< any length but 0
  double nearest = 0.0;                            ///< world lengths from the origin, >= 0
  double farthest = std::numeric_limits<double>::infinity();
};

/** \brief What a ray met first. */
struct PCL_SLIM_EXPORT WorldHit {
  double depth = std::numeric_limits<double>::infinity();  ///< world length along the ray
  std::array<double, 3> position{};                        ///< blended point (eq. 6)
  std::array<float, 3> normal{};                           ///< unit (eq. 7)
  Color color{};                                           ///< sRGB; of discs only
  std::uint32_t surfel = GBuffer::kNothing;  ///< leaf of the largest weight, or the first disc

  bool met() const { return surfel != GBuffer::kNothing; }
};

/** \brief Follows rays through a surface or coloured discs: what they meet, and what is between
 * a point and the light.
 *
 * A ray's hit is the rasteriser's, by the same rules: q^ is the first intersection with a leaf
 * inside its ball shrunk by alpha; the blend of the leaves whose ball contains q^ is the hit (eqs.
 * 6, 7), if it is covered or in a gap between leaves; else the ray continues behind it. Gaps
 * between shrunk balls are closed (TraceParams::close_gaps). Discs are blended as renderDiscs()
 * blends them. A shadow ray is blocked by any root of a leaf at which the blend belongs to the
 * surface, from either side of it, so that shadows end where silhouettes do. It starts a little
 * above its point, by what leaves that meet there may disagree, and sees the inner side of an
 * oriented surface only from a leaf's radius on: neighbouring leaves cast no shadow on each other.
 *
 * The leaves are in a tree of eight boxes a node, and in blocks of eight that are intersected in
 * parallel in single precision, each block in local coordinates.
 *
 * Results are the same for any number of threads. One frame at a time.
 */
class PCL_SLIM_EXPORT RayTracer {
 public:
  /** \brief Builds the tree. O(leaves log leaves).
   * \param[in] surface must outlive the tracer and not change meanwhile */
  explicit RayTracer(const SLIMSurface& surface, int threads = 0);
  /** \brief The same of discs. */
  explicit RayTracer(const SplatSet& splats, int threads = 0);
  ~RayTracer();
  RayTracer(RayTracer&&) noexcept;
  RayTracer& operator=(RayTracer&&) noexcept;

  /** \brief Whether frames have colours: those of discs, or of a coloured surface where
   * TraceParams::columns has kColorColumn. */
  bool hasColors() const;
  /** \brief World units per local unit of the G-buffers. */
  double scale() const;

  /** \brief Traces one frame: a ray a pixel, and from where it meets the object one to each light
   * that the point faces and occlusion_rays to the open side. Cost: O(rays log leaves).
   * \param[out] buffer as SurfaceRenderer's or renderDiscs' \param[out] light of the same size
   * \param[in] progress reported and polled for cancellation now and then; may be null
   * \return an error for a bad object, camera or parameter, or cancellation; both buffers are then
   * empty. */
  Error trace(const Camera& camera, const TraceParams& params, GBuffer& buffer, LightBuffer& light,
              TraceStatistics* statistics = nullptr, Progress* progress = nullptr);

  /** \brief What each of some rays meets first. Discs are not widened to pixels, which rays without
   * a camera lack. \return an error for a bad object or ray; hits is then empty. */
  Error cast(const std::vector<WorldRay>& rays, VisibleSides sides, std::vector<WorldHit>& hits,
             int threads = 0) const;

  /** \brief Whether anything blocks each ray, 1 or 0: seen from either side.
   * \return an error for a bad object or ray; blocked is then empty. */
  Error castShadows(const std::vector<WorldRay>& rays, std::vector<std::uint8_t>& blocked,
                    int threads = 0) const;

 private:
  struct State;

  /** \brief Why there is nothing to trace, if so. */
  Error defect() const;

  std::unique_ptr<State> state_;
};

}  // namespace pcl_slim
