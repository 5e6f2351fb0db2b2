// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>

#include "pcl_slim/render/bounding_spheres.h"
#include "pcl_slim/render/camera.h"
#include "render/view_request.h"

namespace pcl_slim {

/** \brief The cameras of pictures all the way round an upright object, to the right. One that the
 * request does not give stands so far off that every picture shows the whole object. */
class Turntable {
 public:
  Turntable(const ViewRequest& request, const BoundingSpheres& object, int count);

  int count() const { return count_; }
  Camera camera(int turn) const;

  /** \brief OUT_000.png, OUT_001.png ... for OUT.png; OUT.png itself if there is but one. */
  static std::string path(const std::string& path, int turn, int count);

 private:
  Camera first_;
  std::array<double, 3> axis_{}, pivot_{};
  int count_;
};

}  // namespace pcl_slim
