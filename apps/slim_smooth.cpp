// SPDX-License-Identifier: BSD-3-Clause
// pcl_slim_smooth: moves a scan's points onto its SLIM surface; every other field stays.
#include <limits>
#include <vector>

#include "pcl_slim/core/parallel.h"
#include "pcl_slim/core/vector3.h"
#include "projection/projection_job.h"
#include "scan/cloud_file.h"

namespace {

using namespace pcl_slim;

/** The output's fields that a projection fills. */
class SmoothFields {
 public:
  SmoothFields(PointTable& cloud, bool normals) : normals_(normals) {
    for (const char* name : {"x", "y", "z"}) position_.emplace_back(cloud, name);
    if (!normals) return;
    for (const char* name : {"normal_x", "normal_y", "normal_z"}) normal_.emplace_back(cloud, name);
    normal_.emplace_back(cloud, "curvature");
  }

  void move(std::size_t i, const ProjectedPoint& point) const {
    for (std::size_t a = 0; a < 3; ++a) {
      position_[a].set(i, point.position[a]);
      if (normals_) normal_[a].set(i, point.normal[a]);
    }
    if (normals_) normal_[3].set(i, point.mean_curvature);
  }

  void clearNormal(std::size_t i) const {
    for (const FieldWriter& field : normal_) field.set(i, std::numeric_limits<float>::quiet_NaN());
  }

 private:
  bool normals_;
  std::vector<FieldWriter> position_, normal_;
};

PointFile smoothed(const PointFile& file, const CloudProjection& projection, bool normals,
                   int threads) {
  const bool had_normals = findField(file.cloud, "normal_x") >= 0;
  // Integer coordinates cannot represent the points' new positions.
  PointFile made = withRealFields(file, {"x", "y", "z"}, kFloat64);
  if (normals) {
    made = withRealFields(made, {"normal_x", "normal_y", "normal_z", "curvature"}, kFloat32);
  }
  const SmoothFields fields(made.cloud, normals);
  parallelFor(projection.size(), resolveThreads(threads), 4096, [&](std::size_t i, int) {
    if (projection.isSupported(i))
      fields.move(i, projection.point(i));
    else if (!had_normals && !projection.isFinite(i))
      fields.clearNormal(i);
  });
  return made;
}

}  // namespace

int main(int argc, char** argv) {
  ProjectionJob job;
  return runProjectionProgram(
      {"pcl_slim_smooth", PCL_SLIM_VERSION,
       "Smooths a scan: moves its points onto the SLIM surface fitted to it.", "normals",
       "also write the surface's normals and mean curvature; of a mesh, normals alone", true, true},
      job, argc, argv, smoothed);
}
