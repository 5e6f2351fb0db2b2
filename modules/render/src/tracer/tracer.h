// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "camera/camera_rays.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/render/camera.h"
#include "pcl_slim/render/g_buffer.h"
#include "pcl_slim/render/ray_tracer.h"
#include "pcl_slim/render/render_params.h"
#include "pcl_slim/surface/surface.h"
#include "rays/ray_scene.h"

namespace pcl_slim::detail {

/** \brief A frame as an object needs to know it. */
struct TraceView {
  const TraceParams& params;
  const CameraRays* camera;  ///< null: rays of no camera
  bool enclosed = false;     ///< RayRules::enclosed
};

/** \brief What a ray met, in the object's local units. */
struct MetPoint {
  std::uint32_t id = GBuffer::kNothing;
  double depth = 0.0;
  Vector3 normal{};
  Color color{};
  bool back = false;  ///< the inner side of an oriented surface

  bool met() const { return id != GBuffer::kNothing; }
};

/** \brief How rays that leave a met point are to begin, local lengths. */
struct Departure {
  double lift;    ///< they start this far along the normal
  double front;   ///< what they meet from the front nearer than this does not count
  double behind;  ///< nor does what they meet from behind
  double gap;  ///< nor do gaps that they meet, as the rims of leaves differ most around the point
};

/** \brief Something that rays meet. Local = (world - origin) / scale. */
class TracedObject {
 public:
  virtual ~TracedObject() = default;

  Vector3 origin{};
  double scale = 1.0;
  double diagonal = 1.0;  ///< local
  std::uint64_t size = 0;
  bool discs = false;

  /** \brief The first point of each ray. Writes it to buffer as well, at pixels, if there is one.
   */
  virtual void trace(const TraceView& view, const BoundedRay* rays, std::size_t count,
                     MetPoint* met, GBuffer* buffer, const std::size_t* pixels,
                     RayCounts& counts) const = 0;

  /** \brief Whether anything blocks each ray. */
  virtual void block(const BoundedRay* rays, std::size_t count, bool close_gaps,
                     std::uint8_t* blocked, RayCounts& counts) const = 0;

  virtual Departure departure(const MetPoint& point) const = 0;
};

/** \brief A valid surface's leaves under their tree. O(leaves log leaves). */
std::unique_ptr<TracedObject> tracedLeaves(const SLIMSurface& surface, int threads);

/** \brief Valid discs under their tree. O(discs log discs). */
std::unique_ptr<TracedObject> tracedDiscs(const SplatSet& splats, int threads);

/** \brief Whether rays of a rasterised frame are met by the tracer's rules, so that its gaps may be
 * closed. */
bool closesGaps(const RenderParams& params);

/** \brief Fills pixels of a rasterised frame whose rays slipped between shrunk balls: those that
 * met nothing although pixels about them did are traced with TraceParams::close_gaps. */
class GapCloser {
 public:
  /** \brief The surface, a valid one, must outlive this object. */
  explicit GapCloser(const SLIMSurface& surface) : surface_(surface) {}

  /** \brief \param[in,out] buffer a frame by these parameters; the surface's tree is built for the
   * first one that has such pixels. \return pixels filled. O(pixels + traced rays). */
  std::uint64_t close(const Camera& camera, const RenderParams& params, int threads,
                      GBuffer& buffer);

 private:
  const SLIMSurface& surface_;
  std::unique_ptr<TracedObject> leaves_;
};

}  // namespace pcl_slim::detail
