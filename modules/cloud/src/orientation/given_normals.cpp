// SPDX-License-Identifier: BSD-3-Clause
// Given normals that contradict each other (docs/sides.md, "Which side is out").
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "pcl_slim/cloud/detail/signed_graph.h"
#include "pcl_slim/cloud/knn.h"
#include "pcl_slim/cloud/side_evidence.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/core/vector3.h"

namespace pcl_slim {

using namespace detail;

namespace {

constexpr std::size_t kNeighbors = 8;  ///< of a point, itself not counted

SidePatch patchOf(const PointStore& store, std::size_t i) {
  const std::array<float, 3> n = store.normal(i);
  return {store.position(i), normalized({n[0], n[1], n[2]}), 1};
}

std::vector<SidePatch> patchesOf(const PointStore& store) {
  std::vector<SidePatch> patches(store.size());
  for (std::size_t i = 0; i < patches.size(); ++i) patches[i] = patchOf(store, i);
  return patches;
}

/** Edges from every point to its nearest ones. */
std::vector<SignedEdge> edgesOf(const PointStore& store, const std::vector<SidePatch>& patches,
                                int threads) {
  constexpr std::size_t kTask = 4096;
  std::vector<std::vector<SignedEdge>> parts((store.size() + kTask - 1) / kTask);
  parallelFor(parts.size(), threads, 1, [&](std::size_t t, int) {
    NeighborSearch search(store);
    std::vector<std::uint32_t> near;
    for (std::size_t i = t * kTask; i < std::min(store.size(), (t + 1) * kTask); ++i) {
      search.nearestSet(i, kNeighbors + 1, near);
      for (const std::uint32_t j : near) {
        if (j != i) parts[t].push_back(edgeBetween(patches, static_cast<std::uint32_t>(i), j));
      }
    }
  });
  std::vector<SignedEdge> edges;
  for (auto& part : parts) {
    edges.insert(edges.end(), part.begin(), part.end());
    std::vector<SignedEdge>().swap(part);
  }
  return edges;
}

/** Cosines of the normals and the points' beams, where these are known. */
std::vector<double> votesOfBeams(const PointStore& store, const SideEvidence& seen,
                                 const std::vector<SidePatch>& patches) {
  std::vector<double> votes;
  if (seen.source == SideSource::kNone) return votes;
  Vector3 eye{};
  if (seen.eye) eye = scaled(subtract(*seen.eye, store.origin()), 1 / store.scale());
  votes.resize(patches.size());
  for (std::size_t i = 0; i < votes.size(); ++i) {
    const Vector3 beam = subtract(seen.eye ? eye : store.sensor(i), patches[i].center);
    const double range = length(beam);
    votes[i] = range > 0 ? kBeamWeight * dot(beam, patches[i].normal) / range : 0;
  }
  return votes;
}

}  // namespace

NormalAgreement measureNormals(const PointStore& store) {
  constexpr std::size_t kPlaces = 1024, kOneOf = 8;
  if (!store.hasNormals()) return {};
  NeighborSearch search(store);
  std::vector<std::uint32_t> near;
  Opposition opposition;
  double pairs = 0, cosines = 0;
  const std::size_t places = std::min(kPlaces, 1 + store.size() / kOneOf);
  for (std::size_t k = 0; k < places; ++k) {
    const std::size_t i = k * store.size() / places;
    search.nearestSet(i, kNeighbors + 1, near);
    const SidePatch own = patchOf(store, i);
    for (const std::uint32_t j : near) {
      if (j == i) continue;
      const SidePatch other = patchOf(store, j);
      opposition.add(own, other);
      cosines += std::abs(dot(own.normal, other.normal));
      ++pairs;
    }
  }
  if (!(pairs > 0)) return {};
  return {opposition.all() / pairs, opposition.contradictions() / pairs, cosines / pairs};
}

NormalAgreement settleNormals(const std::optional<std::array<double, 3>>& viewpoint, int threads,
                              PointStore& store) {
  constexpr double kLeft = 0.5;  // largest share of the contradictions that turning may leave
  const NormalAgreement given = measureNormals(store);
  if (!given.contradicts()) return {};
  if (!given.hasAxes()) {
    store.dropNormals();
    return given;
  }
  const std::vector<SidePatch> patches = patchesOf(store);
  const std::vector<double> votes =
      votesOfBeams(store, findSensorEvidence(store, viewpoint), patches);
  const std::vector<signed char> signs =
      signsOfGiven(patches, edgesOf(store, patches, resolveThreads(threads)), votes);
  store.turnNormals(signs);
  if (measureNormals(store).contradicted < kLeft * given.contradicted) return given;
  store.turnNormals(signs);
  return {};
}

void faceNormals(const CloudView& cloud, const std::optional<std::array<double, 3>>& viewpoint,
                 int threads, std::vector<float>& normals) {
  CloudView view = cloud;
  view.normal = normals.data();
  view.normal_stride = 3 * sizeof(float);
  const Result<PointStore> store = PointStore::build(view, threads);
  if (!store || !store->hasNormals()) return;
  const std::vector<SidePatch> patches = patchesOf(*store);
  const std::vector<double> votes =
      votesOfBeams(*store, findSensorEvidence(*store, viewpoint), patches);
  std::vector<signed char> signs;
  if (votes.empty())
    signs = signsOutward(patches, edgesOf(*store, patches, resolveThreads(threads)));
  for (const double vote : votes) signs.push_back(vote < 0 ? -1 : 1);
  const std::vector<std::uint32_t> stored = store->storeOfInput();
  for (std::size_t i = 0; i < stored.size(); ++i) {
    if (stored[i] == PointStore::kSkipped) continue;
    float* n = &normals[3 * view.inputIndex(i)];
    const double along = dot({n[0], n[1], n[2]}, patches[stored[i]].normal);
    for (std::size_t a = 0; a < 3 && along * signs[stored[i]] < 0; ++a) n[a] = -n[a];
  }
}

}  // namespace pcl_slim
