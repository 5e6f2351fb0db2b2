// SPDX-License-Identifier: BSD-3-Clause
#include "feet/patches.h"

#include <algorithm>
#include <cmath>

#include "pcl_slim/core/parallel.h"

namespace pcl_slim::detail {

namespace {

constexpr int kMostSteps = 5;
constexpr double kConverged = 3e-3;  ///< [r] the place that follows so short a step is good enough

/** A place of a patch: coordinates and the jet of the height there, in radii. */
struct DiscPlace {
  double u = 0, v = 0;
  HeightJet jet;

  double lengthSq() const { return u * u + v * v + jet.h * jet.h; }
};

void clampToDisc(double reach, double& u, double& v) {
  const double length_sq = u * u + v * v;
  if (!(length_sq > reach * reach)) return;
  const double scale = reach / std::sqrt(length_sq);
  u *= scale;
  v *= scale;
}

DiscPlace placeAt(const LeafPatch& patch, double u, double v) {
  return {u, v, evaluateJet(patch.degree, patch.coefficients, u, v)};
}

/** Brings a place into the ball where the patch is so steep that it leaves it over the disc. */
DiscPlace insideBall(const LeafPatch& patch, const DiscPlace& at) {
  const double reach_sq = patch.reach * patch.reach;
  if (!(at.lengthSq() > reach_sq * (1 + 1e-9))) return at;
  double low = 0, high = 1;
  constexpr int kHalvings = 5;
  for (int k = 0; k < kHalvings; ++k) {
    const double share = 0.5 * (low + high);
    const double h = evaluateHeight(patch.degree, patch.coefficients, share * at.u, share * at.v);
    const double flat_sq = share * share * (at.u * at.u + at.v * at.v);
    (flat_sq + h * h > reach_sq ? high : low) = share;
  }
  return placeAt(patch, low * at.u, low * at.v);
}

/** Half the squared distance's gradient over its Hessian at a place; where that Hessian is not
 * positive definite, its part without second derivatives of the height. */
std::array<double, 2> newtonStep(const DiscPlace& at, double a, double b, double c) {
  const HeightJet& j = at.jet;
  const double off = j.h - c;
  const double gu = at.u - a + off * j.hu, gv = at.v - b + off * j.hv;
  double uu = 1 + j.hu * j.hu, uv = j.hu * j.hv, vv = 1 + j.hv * j.hv;
  const double full_uu = uu + off * j.huu, full_uv = uv + off * j.huv, full_vv = vv + off * j.hvv;
  constexpr double kDefinite =
      0.05;  // the least eigenvalue of a Hessian that is used is about this
  const double full = full_uu * full_vv - full_uv * full_uv;
  if (full > kDefinite * (full_uu + full_vv) && full_uu > 0) {
    uu = full_uu;
    uv = full_uv;
    vv = full_vv;
  }
  const double determinant = uu * vv - uv * uv;
  return {(uv * gv - vv * gu) / determinant, (uv * gu - uu * gv) / determinant};
}

/** The node inside the data and the disc that is nearest to a place of the plane. */
bool nearestInside(const LeafPatch& patch, double& u, double& v) {
  const int side = patch.trim.side;
  const double step = 2.0 / (side - 1);
  double best = Bounds::kInfinity, best_u = 0, best_v = 0;
  for (int row = 0; row < side; ++row) {
    const double y = step * row - 1;
    for (int column = 0; column < side; ++column) {
      const double x = step * column - 1;
      const double distance = (x - u) * (x - u) + (y - v) * (y - v);
      if (distance >= best || x * x + y * y > patch.reach * patch.reach) continue;
      if (!patch.trim.at(column, row)) continue;
      best = distance;
      best_u = x;
      best_v = y;
    }
  }
  u = best_u;
  v = best_v;
  return best < Bounds::kInfinity;
}

PatchFoot footAt(const LeafPatch& patch, const DiscPlace& at, const Vector3& place) {
  PatchFoot foot;
  const LocalFrame& f = patch.frame;
  const double r = patch.radius;
  foot.position =
      along(along(along(patch.center, r * at.u, f.u), r * at.v, f.v), r * at.jet.h, f.w);
  foot.normal = normalized(along(along(f.w, -at.jet.hu, f.u), -at.jet.hv, f.v));
  const Vector3 off = subtract(place, foot.position);
  foot.distance_sq = dot(off, off);
  return foot;
}

/** The box and the normals of a patch, from places on rings. */
TreeItem hullOf(const LeafPatch& patch) {
  constexpr int kDirections = 16, kRings = 3;
  // Of what is between the places: a chord of a ring is 2 % of its radius inside.
  constexpr double kMargin = 0.04;  // [r]
  constexpr double kAngle = 0.1;    // [rad]
  std::vector<PatchFoot> feet;
  for (int ring = 0; ring <= kRings; ++ring) {
    for (int k = 0; k < (ring == 0 ? 1 : kDirections); ++k) {
      const double angle = 2 * 3.14159265358979323846 * k / kDirections;
      const double s = patch.reach * ring / kRings;
      const DiscPlace at = placeAt(patch, s * std::cos(angle), s * std::sin(angle));
      feet.push_back(footAt(patch, insideBall(patch, at), {}));
    }
  }
  TreeItem item;
  for (std::size_t a = 0; a < 3; ++a) {
    item.low[a] = item.high[a] = static_cast<float>(feet[0].position[a]);
  }
  const double margin = kMargin * patch.radius;
  Vector3 sum{};
  for (const PatchFoot& foot : feet) {
    const Vector3& p = foot.position;
    item.add({p[0] - margin, p[1] - margin, p[2] - margin});
    item.add({p[0] + margin, p[1] + margin, p[2] + margin});
    sum = along(sum, 1, foot.normal);
  }
  const Vector3 axis = normalized(sum);
  double cosine = 1;
  for (const PatchFoot& foot : feet) cosine = std::min(cosine, dot(axis, foot.normal));
  const double widest = std::acos(std::max(cosine, -1.0)) + kAngle;
  if (widest >= 1.57) return item;
  for (std::size_t a = 0; a < 3; ++a) item.axis[a] = static_cast<float>(axis[a]);
  item.sine = static_cast<float>(std::sin(widest));
  return item;
}

}  // namespace

PatchIndex::PatchIndex(const SLIMSurface& surface, int threads) {
  const std::vector<std::uint32_t> leaves = surface.leaves();
  std::vector<LeafPatch> all(leaves.size());
  std::vector<TreeItem> items(leaves.size());
  parallelFor(leaves.size(), threads, 256, [&](std::size_t j, int) {
    const std::uint32_t i = leaves[j];
    all[j] = {{surface.cx[i], surface.cy[i], surface.cz[i]},
              LocalFrame(normalized({surface.nx[i], surface.ny[i], surface.nz[i]})),
              surface.radius[i],
              std::min(1.0, surface.info.cover_radius),
              surface.error[i],
              surface.degree[i],
              surface.coefficientsOf(i),
              surface.trimMap(i)};
    items[j] = hullOf(all[j]);
  });
  for (const TreeItem& item : items) {
    bounds.add({item.low[0], item.low[1], item.low[2]});
    bounds.add({item.high[0], item.high[1], item.high[2]});
  }
  tree = BoxTree(items);
  patches.reserve(all.size());
  for (const std::uint32_t j : tree.order()) patches.push_back(all[j]);
}

PatchFoot nearestOnPatch(const LeafPatch& patch, const Vector3& place) {
  const Vector3 off = scaled(subtract(place, patch.center), 1 / patch.radius);
  const double a = dot(off, patch.frame.u), b = dot(off, patch.frame.v),
               c = dot(off, patch.frame.w);
  double u = a, v = b, least = Bounds::kInfinity;
  clampToDisc(patch.reach, u, v);
  DiscPlace best;
  for (int step = 0; step < kMostSteps; ++step) {
    const DiscPlace at = placeAt(patch, u, v);
    const double height = at.jet.h - c;
    const double distance = (u - a) * (u - a) + (v - b) * (v - b) + height * height;
    const double from_u = u, from_v = v;
    if (distance < least) {
      least = distance;
      best = at;
      const auto [du, dv] = newtonStep(at, a, b, c);
      u += du;
      v += dv;
      clampToDisc(patch.reach, u, v);
    } else {  // the step was too long
      u = 0.5 * (u + best.u);
      v = 0.5 * (v + best.v);
    }
    if (std::abs(u - from_u) + std::abs(v - from_v) < kConverged) break;
  }
  best = insideBall(patch, best);
  if (patch.trim.closed() || !(outsideShare(patch.trim, best.u, best.v) > 0.5)) {
    return footAt(patch, best, place);
  }
  u = best.u;
  v = best.v;
  if (!nearestInside(patch, u, v)) return {};
  PatchFoot foot = footAt(patch, placeAt(patch, u, v), place);
  foot.border = true;
  return foot;
}

}  // namespace pcl_slim::detail
