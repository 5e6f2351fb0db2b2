// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "camera/camera_rays.h"
#include "pcl_slim/render/ray_tracer.h"
#include "tracer/traced_object.h"

namespace pcl_slim::detail {

constexpr int kTraceTile = 16;  ///< pixels a side: the rays of one batch

/** \brief What all tiles of a traced frame share. */
struct TraceFrame {
  const TracedObject& object;
  const TraceView& view;
  const Camera& camera;
  std::vector<Vector3> towards;  ///< unit, of each light
  std::vector<double> tangent;   ///< of each light's radius
  std::vector<HalfSpace> cuts;   ///< local
  double near_plane, reach;      ///< local

  TraceFrame(const TracedObject& object, const TraceView& view, const Camera& camera);
};

/** \brief The rays of one tile and what they met; reused from tile to tile. */
class TraceTile {
 public:
  /** \brief Traces every ray of the pixels [x0, x0 + 16) x [y0, y0 + 16) that the picture has. */
  void trace(const TraceFrame& frame, int x0, int y0, GBuffer& buffer, LightBuffer& light,
             TraceStatistics& statistics);

 private:
  void traceCamera(const TraceFrame& frame, int x0, int y0, GBuffer& buffer);
  void traceLight(const TraceFrame& frame, std::size_t l, const GBuffer& buffer,
                  LightBuffer& light);
  void traceOcclusion(const TraceFrame& frame, LightBuffer& light);
  static void cut(const TraceFrame& frame, BoundedRay& ray);
  BoundedRay leaving(const TraceFrame& frame, std::size_t i, const Vector3& direction) const;
  void block(const TraceFrame& frame, bool close_gaps);

  std::vector<BoundedRay> rays_, outgoing_;
  std::vector<MetPoint> met_;
  std::vector<std::size_t> pixels_, source_;  ///< source_: place in rays_ of each outgoing ray
  std::vector<std::uint8_t> blocked_;
  RayCounts counts_;
  std::uint64_t shadow_ = 0, occlusion_ = 0;
};

}  // namespace pcl_slim::detail
