// SPDX-License-Identifier: BSD-3-Clause
// Sides of patches where nothing but the shape decides (docs/sides.md, "Which side is out").
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "pcl_slim/cloud/detail/signed_graph.h"

namespace pcl_slim::detail {

double agreementOf(const SidePatch& p, const SidePatch& q) {
  const Vector3 between = subtract(q.center, p.center);
  const double distance = length(between), cosine = dot(p.normal, q.normal);
  if (!(distance > 0)) return cosine;
  const double across = dot(p.normal, between) / distance * (dot(q.normal, between) / distance);
  return (cosine - 2 * across) * (1 - std::abs(across));
}

SignedEdge edgeBetween(const std::vector<SidePatch>& patches, std::uint32_t a, std::uint32_t b) {
  constexpr double kAcross = 0.75;  // least product of the cosines of patches above one another
  const SidePatch &p = patches[a], &q = patches[b];
  const Vector3 between = subtract(q.center, p.center);
  const double product = dot(p.normal, between) * dot(q.normal, between);
  return {a, b, agreementOf(p, q), std::abs(product) > kAcross * dot(between, between)};
}

namespace {

/// Least length of the mean normal of an open sheet; that of a closed body is 0.
constexpr double kSheet = 0.6;
/// Least |flux| that decides [its upper bound], of a body and of a sheet: a valley is no body, and its
/// ground is seen from above.
constexpr double kBodyFlux = 0.05, kSheetFlux = 0.2;
/// Upwards, and not along planes that are frequent in scans: sheets of one plane turn alike.
constexpr Vector3 kUpwards{0.2, 0.45, 0.87};

/** Moments of a connected part. */
struct Part {
  double weight = 0;
  double flux = 0;       ///< sum over the patches of weight (center - mean) . n
  double reach = 0;      ///< upper bound of the flux: sum of weight |center - mean|
  double thickness = 0;  ///< sum over the edges between sheets of the signed gap; < 0: they face
  Vector3 sum{};         ///< weighted sum of the centres
  Vector3 normal{};      ///< and of the normals

  bool turned() const {
    const bool sheet = length(normal) > kSheet * weight;
    if (std::abs(flux) > (sheet ? kSheetFlux : kBodyFlux) * reach) return flux < 0;
    if (!sheet && thickness != 0) return thickness < 0;
    return dot(normal, kUpwards) < 0;
  }
};

}  // namespace

void turnOutward(const std::vector<SidePatch>& patches, const std::vector<SignedEdge>& edges,
                 SignedParts& found) {
  std::vector<Part> parts(patches.size());
  for (std::size_t i = 0; i < patches.size(); ++i) {
    Part& part = parts[found.part[i]];
    part.weight += patches[i].weight;
    part.sum = along(part.sum, patches[i].weight, patches[i].center);
  }
  for (std::size_t i = 0; i < patches.size(); ++i) {
    Part& part = parts[found.part[i]];
    const Vector3 away = along(patches[i].center, -1 / part.weight, part.sum);
    const double weight = found.signs[i] * patches[i].weight;
    part.flux += weight * dot(away, patches[i].normal);
    part.reach += patches[i].weight * length(away);
    part.normal = along(part.normal, weight, patches[i].normal);
  }
  for (const SignedEdge& e : edges) {
    if (!e.apart || found.part[e.a] != found.part[e.b]) continue;
    const Vector3 behind = subtract(patches[e.a].center, patches[e.b].center);
    parts[found.part[e.a]].thickness += found.signs[e.a] * dot(behind, patches[e.a].normal);
  }
  for (std::size_t i = 0; i < patches.size(); ++i) {
    if (parts[found.part[i]].turned()) found.signs[i] = static_cast<signed char>(-found.signs[i]);
  }
}

std::vector<signed char> signsOutward(const std::vector<SidePatch>& patches,
                                      const std::vector<SignedEdge>& edges) {
  SignedParts found = contractSigned(patches.size(), edges);
  turnOutward(patches, edges, found);
  return std::move(found.signs);
}

}  // namespace pcl_slim::detail
