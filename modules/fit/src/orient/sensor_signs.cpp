// SPDX-License-Identifier: BSD-3-Clause
#include "orient/sensor_signs.h"

#include <algorithm>
#include <cmath>

#include "pcl_slim/core/parallel.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/surface/polynomial.h"

namespace pcl_slim::detail {

namespace {

/** Votes on a leaf's side: of the points on its sheet, and of all in its ball. */
struct Votes {
  double sheet = 0, all = 0;

  double result() const { return sheet != 0 ? sheet : all; }
};

/** One leaf at hand. */
class LeafVote {
 public:
  LeafVote(const SLIMSurface& s, std::uint32_t i, double sheet)
      : center_{s.cx[i], s.cy[i], s.cz[i]},
        frame_({s.nx[i], s.ny[i], s.nz[i]}),
        radius_(s.radius[i]),
        reach_(sheet * s.error[i]),
        degree_(s.degree[i]),
        coefficients_(s.coefficientsOf(i))
  {
  }

  void add(const PointStore& store, std::size_t point, Votes& votes) const
  {
    const Vector3 p = store.position(point), d = subtract(p, center_);
    const double near = 1 - dot(d, d) / (radius_ * radius_);
    const Vector3 ray = subtract(store.sensor(point), p);
    const double range = length(ray);
    if (!(near > 0) || !(range > 0)) return;
    const HeightJet jet =
        evaluateJet(degree_, coefficients_, dot(d, frame_.u) / radius_, dot(d, frame_.v) / radius_);
    const Vector3 normal = along(along(frame_.w, -jet.hu, frame_.u), -jet.hv, frame_.v);
    const double vote = near * near * dot(ray, normal) / (range * length(normal));
    votes.all += vote;
    if (std::abs(dot(d, frame_.w) - radius_ * jet.h) <= reach_) votes.sheet += vote;
  }

 private:
  Vector3 center_;
  LocalFrame frame_;
  double radius_, reach_;
  int degree_;
  const float* coefficients_;
};

}  // namespace

std::vector<signed char>
sensorSigns(const SLIMSurface& surface, const PointStore& store,
            const std::vector<std::uint32_t>& leaves, const OrientConstants& constants, int threads)
{
  std::vector<signed char> signs(surface.size(), 1);
  parallelFor(leaves.size(), threads, 64, [&](std::size_t k, int) {
    thread_local std::vector<std::uint32_t> blocks;
    const std::uint32_t i = leaves[k];
    const float center[3] = {surface.cx[i], surface.cy[i], surface.cz[i]};
    blocks.clear();
    store.tree().blocksInBall(center, surface.radius[i], blocks);
    const LeafVote leaf(surface, i, constants.sheet);
    Votes votes;
    for (const std::uint32_t b : blocks) {
      const std::size_t begin = b * PointStore::kBlock;
      const std::size_t end = std::min(store.size(), begin + PointStore::kBlock);
      for (std::size_t point = begin; point < end; ++point) leaf.add(store, point, votes);
    }
    if (votes.result() < 0) signs[i] = -1;
  });
  return signs;
}

}  // namespace pcl_slim::detail
