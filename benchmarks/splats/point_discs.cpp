// SPDX-License-Identifier: BSD-3-Clause
// point_discs: draws a scan's points as discs in the planes of their nearest neighbours, so that
// pictures show the points themselves and their noise, before and after smoothing.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "common/options.h"
#include "pcl_slim/cloud/knn.h"
#include "pcl_slim/filters/io/splat_files.h"
#include "scan/cloud_file.h"

namespace {

using namespace pcl_slim;

constexpr std::uint32_t kGrey = 0xc9c4bb;
constexpr double kOverlap =
    1.1;  // radius over spacing: discs leave no gaps where spacing varies little
constexpr float kLargest = 3.0f;  // lone points: radius over the median one at most

/** Discs of the points that have k neighbours; normals are the view's. \param[in] given the radius
 * of all; 0: by the neighbours */
Result<SplatSet> discsOf(const CloudView& view, std::size_t k, double given) {
  const Result<PointStore> store = PointStore::build(view);
  if (!store) return store.error();
  SplatSet discs;
  discs.origin = store->origin();
  discs.resize(store->size(), false);
  NeighborSearch search(*store);
  std::vector<std::uint32_t> neighbours;
  std::vector<float> squared;
  for (std::size_t i = 0; i < store->size(); ++i) {
    const auto p = store->position(i);
    const auto n = store->normal(i);
    search.nearest(i, k + 1, neighbours, squared);
    const double spacing = std::sqrt(squared.back() * M_PI / static_cast<double>(k));
    discs.x[i] = static_cast<float>(store->scale() * p[0]);
    discs.y[i] = static_cast<float>(store->scale() * p[1]);
    discs.z[i] = static_cast<float>(store->scale() * p[2]);
    discs.nx[i] = n[0];
    discs.ny[i] = n[1];
    discs.nz[i] = n[2];
    discs.radius[i] = static_cast<float>(kOverlap * store->scale() * spacing);
    discs.rgb[i] = kGrey;
    discs.confidence[i] = 1;
    discs.kept[i] = store->orderOfStore()[i];
  }
  std::vector<float> radii = discs.radius;
  const auto median = radii.begin() + static_cast<std::ptrdiff_t>(radii.size() / 2);
  std::nth_element(radii.begin(), median, radii.end());
  for (float& radius : discs.radius) {
    radius = given > 0 ? static_cast<float>(given) : std::min(radius, kLargest * *median);
  }
  return discs;
}

int fail(const Error& error) {
  std::fprintf(stderr, "point_discs: %s\n", error.message.c_str());
  return kExitFailed;
}

}  // namespace

int main(int argc, char** argv) {
  std::string input, output;
  std::optional<std::array<double, 3>> viewpoint;
  int neighbours = 10;
  double radius = 0;
  OptionTable options("point_discs", "1", "Draws each point of a scan as a grey disc.");
  options.positional("IN.pcd|.ply", &input, "the scan");
  options.positional("OUT.pcd|.ply", &output, "discs for pcl_slim_render");
  options.integer("k", &neighbours, 3, 1000, "neighbours that give a disc its plane and size");
  options.number("radius", &radius, 0, 1e30, "radius of all discs, units of the scan",
                 "by the neighbours");
  options.numbers("viewpoint", &viewpoint, "X,Y,Z", "discs face this point; default the sensor's");
  if (const auto status = options.parse(argc, argv)) return *status;
  Result<CloudFile> scan = loadCloudFile(input);
  if (!scan) return fail(scan.error());
  if (const Error error = estimateNormals(neighbours, viewpoint, 0, *scan)) return fail(error);
  const Result<SplatSet> discs =
      discsOf(scan->view(), static_cast<std::size_t>(neighbours), radius);
  if (!discs) return fail(discs.error());
  if (const Error error = savePointFile(output, toPointFile(*discs, splatShift(*discs)))) {
    return fail(error);
  }
  return kExitDone;
}
