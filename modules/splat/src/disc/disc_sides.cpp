// SPDX-License-Identifier: BSD-3-Clause
// The sides of discs where no point shows them (docs/sides.md, "Which side is out").
#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "disc/splat_builder.h"
#include "pcl_slim/cloud/detail/signed_graph.h"
#include "pcl_slim/cloud/knn.h"
#include "pcl_slim/core/parallel.h"

namespace pcl_slim::detail {

namespace {

constexpr std::size_t kNeighbors = 8;

std::vector<SidePatch> patchesOf(const SplatSet& splats) {
  std::vector<SidePatch> patches(splats.size());
  for (std::size_t i = 0; i < patches.size(); ++i) {
    const double radius = splats.radius[i];
    patches[i] = {{splats.x[i], splats.y[i], splats.z[i]},
                  {splats.nx[i], splats.ny[i], splats.nz[i]},
                  radius * radius};
  }
  return patches;
}

/** Edges from every disc to its nearest ones. */
std::vector<SignedEdge> edgesOf(const std::vector<SidePatch>& patches, int threads) {
  CloudView view;
  view.xyz = patches.front().center.data();
  view.xyz_stride = sizeof(SidePatch);
  view.scalar = CloudView::Scalar::kDouble;
  view.size = patches.size();
  const Result<PointStore> store = PointStore::build(view, threads);
  if (!store) return {};
  const auto& order = store->orderOfStore();
  constexpr std::size_t kTask = 4096;
  std::vector<std::vector<SignedEdge>> parts((store->size() + kTask - 1) / kTask);
  parallelFor(parts.size(), threads, 1, [&](std::size_t t, int) {
    NeighborSearch search(*store);
    std::vector<std::uint32_t> near;
    for (std::size_t i = t * kTask; i < std::min(store->size(), (t + 1) * kTask); ++i) {
      search.nearestSet(i, kNeighbors + 1, near);
      for (const std::uint32_t j : near) {
        if (j != i) parts[t].push_back(edgeBetween(patches, order[i], order[j]));
      }
    }
  });
  std::vector<SignedEdge> edges;
  for (const auto& part : parts) edges.insert(edges.end(), part.begin(), part.end());
  return edges;
}

/** Signs by the beams from an eye, in world coordinates. */
std::vector<signed char> signsByEye(const Vector3& eye, const SplatSet& splats) {
  const Vector3 from = subtract(eye, splats.origin);
  std::vector<signed char> signs(splats.size());
  for (std::size_t i = 0; i < signs.size(); ++i) {
    const Vector3 beam = subtract(from, {splats.x[i], splats.y[i], splats.z[i]});
    signs[i] = dot(beam, {splats.nx[i], splats.ny[i], splats.nz[i]}) < 0 ? -1 : 1;
  }
  return signs;
}

void turn(const std::vector<signed char>& signs, SplatSet& splats) {
  for (std::size_t i = 0; i < signs.size(); ++i) {
    if (signs[i] > 0) continue;
    splats.nx[i] = -splats.nx[i];
    splats.ny[i] = -splats.ny[i];
    splats.nz[i] = -splats.nz[i];
  }
}

/** Whether discs seem to contradict each other, as those of coarse cells may also by chance. */
bool mayContradict(const std::vector<SidePatch>& patches, const std::vector<SignedEdge>& edges) {
  Opposition opposition;
  for (const SignedEdge& e : edges) opposition.add(patches[e.a], patches[e.b]);
  const auto pairs = static_cast<double>(std::max<std::size_t>(1, edges.size()));
  NormalAgreement normals;
  normals.opposed = opposition.all() / pairs;
  normals.contradicted = opposition.contradictions() / pairs;
  return normals.contradicts();
}

}  // namespace

NormalAgreement settleDiscSides(const SideEvidence& evidence, const CloudView& cloud,
                                bool keep_given, int threads, SplatSet& splats) {
  const bool given = evidence.source == SideSource::kNormals;
  if (splats.empty() || evidence.source == SideSource::kSensors || (given && keep_given)) return {};
  if (evidence.eye) {
    turn(signsByEye(*evidence.eye, splats), splats);
    return {};
  }
  const std::vector<SidePatch> patches = patchesOf(splats);
  const std::vector<SignedEdge> edges = edgesOf(patches, resolveThreads(threads));
  if (!given) {
    turn(signsOutward(patches, edges), splats);
    return {};
  }
  if (!mayContradict(patches, edges)) return {};
  const Result<PointStore> store = PointStore::build(cloud, threads);
  if (!store) return {};
  const NormalAgreement normals = measureNormals(*store);
  if (!normals.contradicts()) return {};
  turn(signsOfGiven(patches, edges, {}), splats);
  return normals;
}

}  // namespace pcl_slim::detail
