// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "pcl_slim/core/vector3.h"
#include "pcl_slim/query/detail/ray_surfel.h"
#include "pcl_slim/render/detail/frame_constants.h"
#include "pcl_slim/render/render_params.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim::detail {

/** \brief Names a half space without a direction or a place. */
Error
checkHalfSpaces(const std::vector<HalfSpace>& cuts);

/** \brief Half spaces in local coordinates (local = (world - origin) / scale), unit normals. */
std::vector<HalfSpace>
localHalfSpaces(std::vector<HalfSpace> cuts, const Vector3& origin, double scale);

/** \brief Depths along a ray between which it is inside all of some half spaces; near > far: nowhere. */
struct RayStretch {
  double near, far;
};

/** \brief The part of a stretch of a ray inside half spaces. */
RayStretch
within(const std::vector<HalfSpace>& cuts, const Ray& ray, RayStretch stretch);

/** \brief Whether a ball is completely outside of any half space. */
bool
isCutAway(const std::vector<HalfSpace>& cuts, const Vector3& center, double radius);

/** \brief What a frame's parameters mean for a surface, lengths in its local units. */
struct FrameRules {
  double shrink;        ///< alpha of pass 1
  double cover_radius;  ///< alpha of the coverage measure
  double min_coverage;  ///< where it is less, the surface is not defined
  double near_plane;
  double lod;       ///< pixels; 0: none
  bool trim;        ///< heed trim maps
  bool front_only;  ///< only roots at which the gradient faces the viewer count
  bool skip;
  int threads;                  ///< at least 1
  std::vector<HalfSpace> cuts;  ///< local coordinates, unit normals

  FrameRules(const SurfaceInfo& info, const RenderParams& params);
};

}  // namespace pcl_slim::detail
