// SPDX-License-Identifier: BSD-3-Clause
// splat_truth: how far splats are from exact points, and how far their normals turn from those.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "common/options.h"
#include "pcl_slim/cloud/knn.h"
#include "pcl_slim/core/vector3.h"
#include "scan/cloud_file.h"

namespace {

using namespace pcl_slim;

/** Appends a file's points and normals. */
Error append(const std::string& path, std::vector<Vector3>& points, std::vector<float>& normals) {
  const auto file = loadCloudFile(path);
  if (!file) return file.error();
  if (file->normal_source == NormalSource::kNothing) {
    return {ErrorCode::kBadInput, "'" + path + "' has no normals; name a cloud with them"};
  }
  const auto store = PointStore::build(file->view());
  if (!store) return store.error();
  for (std::size_t i = 0; i < store->size(); ++i) {
    points.push_back(along(store->origin(), store->scale(), store->position(i)));
    for (const float x : store->normal(i)) normals.push_back(x);
  }
  return {};
}

Error compare(const std::string& splats, const std::string& truth) {
  std::vector<Vector3> points;
  std::vector<float> normals;
  if (Error error = append(splats, points, normals)) return error;
  const std::size_t count = points.size();
  if (Error error = append(truth, points, normals)) return error;
  CloudView view;
  view.xyz = points.data();
  view.xyz_stride = sizeof(Vector3);
  view.scalar = CloudView::Scalar::kDouble;
  view.size = points.size();
  view.normal = normals.data();
  view.normal_stride = 3 * sizeof(float);
  const auto store = PointStore::build(view);
  if (!store) return store.error();
  NeighborSearch search(*store);
  std::vector<std::uint32_t> found;
  std::vector<float> squared;
  double square = 0;
  std::vector<double> angles;
  for (std::size_t i = 0; i < store->size(); ++i) {
    if (store->orderOfStore()[i] >= count) continue;
    search.nearest(i, 64, found, squared);
    const auto exact = std::find_if(found.begin(), found.end(), [&](std::uint32_t j) {
      return store->orderOfStore()[j] >= count;
    });
    if (exact == found.end()) continue;
    const auto a = store->normal(i), b = store->normal(*exact);
    const Vector3 n = {b[0], b[1], b[2]};
    const double height = dot(subtract(store->position(i), store->position(*exact)), n);
    square += height * height;
    const double cosine = std::min(1.0, std::abs(dot(Vector3{a[0], a[1], a[2]}, n)));
    angles.push_back(std::acos(cosine) * 180 / M_PI);
  }
  std::sort(angles.begin(), angles.end());
  std::printf(
      "%zu splats: RMS distance %.3e of the diagonal, normals off by %.2f degrees (median), "
      "%.2f (95th percentile)\n",
      count, std::sqrt(square / static_cast<double>(angles.size())) / store->diagonal(),
      angles[angles.size() / 2], angles[angles.size() * 19 / 20]);
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  std::string splats, truth;
  OptionTable options("splat_truth", "1", "Distance of splats from exact points.");
  options.positional("SPLATS", &splats, "splats with normals");
  options.positional("TRUTH", &truth, "dense exact points with normals");
  if (const auto status = options.parse(argc, argv)) return *status;
  if (const Error error = compare(splats, truth)) {
    std::fprintf(stderr, "splat_truth: %s\n", error.message.c_str());
    return kExitFailed;
  }
  return kExitDone;
}
