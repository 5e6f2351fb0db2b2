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
gatherSheetOf(const PointStore& store, const BlockList& blocks, const CoverLeaf& surfel,
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
  std::size_t count = 0;
  points.reserve(blocks.size() * PointStore::kBlock);
  BallScan(store, surfel.ball).forEach(blocks, [&](std::size_t, const Lanes& l) HWY_ATTR {
    const auto u = dot3(l.dx, l.dy, l.dz, axes[0][0], axes[0][1], axes[0][2]);
    const auto v = dot3(l.dx, l.dy, l.dz, axes[1][0], axes[1][1], axes[1][2]);
    const auto w = dot3(l.dx, l.dy, l.dz, axes[2][0], axes[2][1], axes[2][2]);
    const auto near = hn::And(l.kept, hn::Le(hn::Abs(hn::Sub(w, height(u, v))), limit));
    const LanePacking packing(d, near);
    packing.store(u, points.u.data() + count);
    packing.store(v, points.v.data() + count);
    packing.store(w, points.w.data() + count);
    count += packing.count();
  });
  points.count = count;
}

void
gatherSheet(const PointStore& store, const BlockList& blocks, const CoverLeaf& surfel,
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
gatherSheet(const PointStore& store, const BlockList& blocks, const CoverLeaf& surfel,
            SheetPoints& points)
{
  HWY_DYNAMIC_DISPATCH(gatherSheet)(store, blocks, surfel, points);
}

}  // namespace pcl_slim::detail::kernels
#endif
