// SPDX-License-Identifier: BSD-3-Clause
// The points of one surfel's sheet, in its own plane.
#include "trim/sheet_points.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "trim/sheet_kernel.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

#include "scan/ball_scan-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

template <int D>
void
gatherSheetOf(const PointStore& store, const BlockList& blocks, const SheetQuery& surfel,
              SheetPoints& points)
{
  const Tag d;
  const double scale = 1.0 / surfel.support_radius;
  Vec axes[3][3];
  for (int a = 0; a < 3; ++a) {
    axes[0][a] = hn::Set(d, static_cast<float>(surfel.frame.u[a] * scale));
    axes[1][a] = hn::Set(d, static_cast<float>(surfel.frame.v[a] * scale));
    axes[2][a] = hn::Set(d, static_cast<float>(surfel.frame.w[a] * scale));
  }
  const Height<D> height(surfel.c);
  const auto limit = hn::Set(d, static_cast<float>(surfel.max_residual * scale));
  const Height < D<2 ? D : 2> quadric(surfel.c);
  const auto slope = hn::Set(d, surfel.view_slope);
  const auto known_sq = hn::Set(d, surfel.known * surfel.known);
  std::size_t count = 0;
  points.reserve(blocks.size() * PointStore::kBlock);
  BallScan(store, surfel.ball).forEach(blocks, [&](std::size_t, const Lanes& l) HWY_ATTR {
    const auto u = dot3(l.dx, l.dy, l.dz, axes[0][0], axes[0][1], axes[0][2]);
    const auto v = dot3(l.dx, l.dy, l.dz, axes[1][0], axes[1][1], axes[1][2]);
    const auto w = dot3(l.dx, l.dy, l.dz, axes[2][0], axes[2][1], axes[2][2]);
    auto off = hn::Abs(hn::Sub(w, height(u, v)));
    auto most = limit;
    if (surfel.view_slope > 0.0f) {  // the polynomial ends with what it was fitted to
      const auto distance_sq = hn::MulAdd(u, u, hn::Mul(v, v));
      const auto far = hn::Gt(distance_sq, known_sq);
      off = hn::IfThenElse(far, hn::Abs(hn::Sub(w, quadric(u, v))), off);
      most = hn::IfThenElse(far, hn::MulAdd(hn::Sqrt(distance_sq), slope, limit), limit);
    }
    const auto near = hn::And(l.kept, hn::Le(off, most));
    const LanePacking packing(d, near);
    packing.store(u, points.u.data() + count);
    packing.store(v, points.v.data() + count);
    count += packing.count();
  });
  points.count = count;
}

void
gatherSheet(const PointStore& store, const BlockList& blocks, const SheetQuery& surfel,
            SheetPoints& points)
{
  forDegree(surfel.degree,
            [&](auto degree) HWY_ATTR { gatherSheetOf<degree()>(store, blocks, surfel, points); });
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_slim::detail::kernels {

HWY_EXPORT(gatherSheet);

void
gatherSheet(const PointStore& store, const BlockList& blocks, const SheetQuery& surfel,
            SheetPoints& points)
{
  HWY_DYNAMIC_DISPATCH(gatherSheet)(store, blocks, surfel, points);
}

}  // namespace pcl_slim::detail::kernels
#endif
