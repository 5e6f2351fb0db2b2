// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "camera/camera_rays.h"
#include "pcl_slim/core/aligned.h"
#include "pcl_slim/render/detail/frame_constants.h"
#include "pcl_slim/render/render_params.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim::detail {

/** \brief Which surfels of a hierarchy represent a surface in a picture, and with what share of
 * their weight (Ohtake, Belyaev, Alexa 2005, section 3.2).
 *
 * A surfel whose size (DetailSizes) is seen smaller than lod pixels replaces its descendants; from there
 * to one and a half times that size it fades out and they fade in, so that nothing pops when the camera
 * moves: its share is coarse(own size) (1 - coarse(size of its parent)). As sizes never grow from level
 * to level, older ancestors are then large enough to be out of it.
 */
struct DetailRule {
  static constexpr auto kFade = static_cast<float>(kDetailFade);
  static constexpr auto kMeets = static_cast<float>(kDetailMeets);

  float lod = 0.0f;  ///< pixels; 0: leaves alone represent the surface

  bool active() const { return lod > 0.0f; }
};

constexpr std::uint32_t kClusterSize = 64;  ///< leaves looked at together

/** \brief Neighbouring leaves: a sphere around their balls and a cone around their gradients. */
struct LeafCluster {
  float center[3];
  float radius;
  float axis[3];
  float cone;      ///< half angle in radians; pi and more: the gradients have no side in common
  float smallest;  ///< of own_size
  float largest;   ///< of parent_size
  std::uint32_t begin, end;  ///< leaves, in the clusters' order
};

/** \brief Whether a ball or cluster may be seen, and if not, why. */
enum class Visibility : std::uint8_t {
  kVisible,
  kOutside,
  kCutAway,  ///< outside of a half space
  kBackFacing,
  kTooSmall,  ///< a coarser surfel replaces it
  kTooLarge,  ///< its descendants replace it
};
constexpr int kVisibilities = 6;

/** \brief Which surfels of a surface are clustered. */
enum class ClusteredSurfels : std::uint8_t { kLeaves, kInternal };

/** \brief What a frame looks for. */
struct VisibilityRules {
  bool front_only;  ///< leave out back-facing surfels
  DetailRule detail;
  const std::vector<HalfSpace>& cuts;  ///< local coordinates, unit normals
};

/** \brief A surface's leaves, or its internal surfels level by level, along a space-filling curve, in
 * clusters that a frame sees or leaves out as a whole.
 *
 * There is no tree over the clusters: of a million leaves, looking at every one of them takes .2 ms.
 * Columns are padded to whole clusters. Built once per surface: O(surfels log surfels + links).
 */
class LeafClusters {
 public:
  LeafClusters(const SLIMSurface& surface, int threads,
               ClusteredSurfels which = ClusteredSurfels::kLeaves);

  std::size_t size() const { return surfel.size(); }

  /** \brief Appends the clusters that may be seen, in order, and adds the surfels of the others to
   * the counts, by reason. */
  void findVisible(const FrameView& view, const VisibilityRules& rules,
                   std::vector<std::uint32_t>& visible, std::uint64_t* hidden) const;

  const LeafCluster& cluster(std::uint32_t c) const { return clusters_[c]; }

  std::vector<std::uint32_t> surfel;     ///< of the surface
  AlignedVector<float> x, y, z, radius;  ///< the ball
  AlignedVector<float> nx, ny, nz;       ///< the normal
  AlignedVector<float> sine;  ///< of the largest angle between normal and gradient in the ball
  AlignedVector<float> variance_weight;
  AlignedVector<float> own_size, parent_size;  ///< DetailSizes

 private:
  void sortSurfels(const SLIMSurface& surface, std::vector<std::uint32_t> surfels, int threads);
  void fillColumns(const SLIMSurface& surface);
  void fillSizes(const SLIMSurface& surface);
  LeafCluster enclose(std::uint32_t begin, std::uint32_t end) const;

  std::vector<LeafCluster> clusters_;
};

}  // namespace pcl_slim::detail
