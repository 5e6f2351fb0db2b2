// SPDX-License-Identifier: BSD-3-Clause
// How even organized frames come out, thinned or not: the angles between neighbouring triangles of
// the grid after SLIMProjectionSmoother with a search radius and after MovingLeastSquares with the
// same one.
#include <pcl/io/pcd_io.h>
#include <pcl/point_types.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "common/options.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/filters/slim_projection_smoother.h"
#include "rivals/mls.h"
#include "support/lab/bench.h"

namespace {

using namespace pcl_slim;

constexpr double kJump = 0.02;  ///< of the depth: cells across a larger step are left out

struct Frame {
  std::size_t width = 0, height = 0;
  std::vector<Vector3> points;
};

/** Every n-th row and column of an organized cloud. */
Frame thinned(const pcl::PointCloud<pcl::PointXYZ>& cloud, std::size_t n) {
  Frame frame;
  for (std::size_t y = 0; y < cloud.height; y += n) {
    ++frame.height;
    for (std::size_t x = 0; x < cloud.width; x += n) {
      const pcl::PointXYZ& p = cloud[y * cloud.width + x];
      frame.points.push_back({p.x, p.y, p.z});
    }
  }
  frame.width = frame.points.size() / frame.height;
  return frame;
}

bool isFinite(const Vector3& p) {
  return std::isfinite(p[0] + p[1] + p[2]);
}

/** RMS angle between the two triangles of each cell, in degrees. */
double roughness(const Frame& raw, const std::vector<Vector3>& points) {
  double squares = 0, count = 0;
  for (std::size_t y = 0; y + 1 < raw.height; ++y) {
    for (std::size_t x = 0; x + 1 < raw.width; ++x) {
      const std::size_t k = y * raw.width + x;
      const std::size_t at[4] = {k, k + 1, k + raw.width, k + raw.width + 1};
      double near = HUGE_VAL, far = 0;
      bool whole = true;
      for (const std::size_t i : at) {
        near = std::min(near, raw.points[i][2]);
        far = std::max(far, raw.points[i][2]);
        whole = whole && isFinite(raw.points[i]) && isFinite(points[i]);
      }
      if (!whole || far - near > kJump * near) continue;
      const auto side = [&](std::size_t a, std::size_t b, std::size_t c) {
        return normalized(cross(subtract(points[b], points[a]), subtract(points[c], points[a])));
      };
      const double cosine = dot(side(at[0], at[1], at[2]), side(at[1], at[3], at[2]));
      const double angle = std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / M_PI;
      squares += angle * angle;
      ++count;
    }
  }
  return std::sqrt(squares / std::max(count, 1.0));
}

/** MovingLeastSquares takes finite points alone. */
std::vector<Vector3> smoothByMls(const Frame& frame, double radius) {
  std::vector<Vector3> finite, points = frame.points;
  for (const Vector3& p : points)
    if (isFinite(p)) finite.push_back(p);
  const std::vector<Vector3> smoothed = rivals::smoothByMls(finite, 2, radius).points;
  std::size_t next = 0;
  for (Vector3& p : points)
    if (isFinite(p)) p = smoothed[next++];
  return points;
}

std::vector<Vector3> smoothBySlim(const Frame& frame, double radius) {
  const auto cloud = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  for (const Vector3& p : frame.points)
    cloud->push_back(
        {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])});
  SLIMProjectionSmoother<pcl::PointXYZ> smoother;
  smoother.setInputCloud(cloud);
  smoother.setSearchRadius(radius);
  pcl::PointCloud<pcl::PointXYZ> output;
  smoother.process(output);
  std::vector<Vector3> points;
  for (const auto& p : output) points.push_back({p.x, p.y, p.z});
  return points;
}

}  // namespace

int main(int argc, char** argv) {
  std::string input, radii_text = "0.01,0.02,0.03,0.05", steps_text = "1,2,3";
  std::vector<double> radii, steps;
  OptionTable options("frame_bench", "1",
                      "Roughness of smoothed frames, beside MovingLeastSquares.");
  options.positional("FRAME.pcd", &input, "an organized cloud");
  options.text("radii", &radii_text, "A,B", "search radii, units of the frame");
  options.text("steps", &steps_text, "A,B", "keep every n-th row and column");
  if (const auto status = options.parse(argc, argv)) return *status;
  const Error error = measure::parseLists({{"radii", &radii_text, 1e-9, 1e9, false, &radii},
                                           {"steps", &steps_text, 1, 100, true, &steps}});
  if (error) {
    std::fprintf(stderr, "frame_bench: %s\n", error.message.c_str());
    return kExitUsage;
  }
  pcl::PointCloud<pcl::PointXYZ> cloud;
  if (pcl::io::loadPCDFile(input, cloud) < 0 || !cloud.isOrganized()) {
    std::fprintf(stderr, "frame_bench: '%s' is no organized .pcd; name one\n", input.c_str());
    return kExitUsage;
  }
  std::printf(
      "| step | radius | raw | MLS, order 2 | SLIM, search radius | SLIM, default |\n"
      "|---|---|---|---|---|---|\n");
  for (const double step : steps) {
    const Frame frame = thinned(cloud, static_cast<std::size_t>(step));
    const double raw = roughness(frame, frame.points);
    const double own = roughness(frame, smoothBySlim(frame, 0));
    for (const double radius : radii) {
      std::printf("| %g | %g | %.2f | %.2f | %.2f | %.2f |\n", step, radius, raw,
                  roughness(frame, smoothByMls(frame, radius)),
                  roughness(frame, smoothBySlim(frame, radius)), own);
      std::fflush(stdout);
    }
  }
  return kExitDone;
}
