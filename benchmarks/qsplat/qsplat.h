// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "camera/camera_rays.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/render/g_buffer.h"

namespace pcl_slim::bench {

/** \brief A point with a normal and the radius of the disc that stands for it. */
struct Splat {
  Vector3 center, normal;
  double radius;
};

/** \brief A plain renderer after Rusinkiewicz and Levoy 2000: a hierarchy of bounding spheres, each
 * with a mean normal and a cone of normals, over points. A node is drawn as one disc where it is
 * smaller than a pixel or a point; nodes outside the view or turned away are left out. Each pixel
 * shows the nearest disc as it is, without any blending. */
class QSplat {
 public:
  /** O(n log n). */
  explicit QSplat(std::vector<Splat> splats);

  /** \brief Draws into a cleared buffer with columns position, depth, normal and surfel. \return
   * discs drawn. */
  std::size_t draw(const detail::CameraRays& rays, GBuffer& buffer) const;

 private:
  struct Node {
    Splat sphere;
    double cosine;  ///< of the cone of normals; below 0: none
    std::uint32_t first_child, children;
  };

  std::uint32_t build(std::vector<Splat>& splats, std::size_t begin, std::size_t end);
  bool isHidden(const detail::CameraRays& rays, const Node& node) const;
  static void drawDisc(const detail::CameraRays& rays, const Splat& disc, std::uint32_t id,
                       GBuffer& buffer);

  std::vector<Node> nodes_;
  std::uint32_t root_ = 0;
  std::vector<std::uint32_t> links_;
};

}  // namespace pcl_slim::bench
