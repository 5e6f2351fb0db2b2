// SPDX-License-Identifier: BSD-3-Clause
// Stored points in a ball, group by group of vector lanes. Highway compiles a kernel file once per
// instruction set, so the guard toggles.
#if defined(PCL_SLIM_BALL_SCAN_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PCL_SLIM_BALL_SCAN_INL
#undef PCL_SLIM_BALL_SCAN_INL
#else
#define PCL_SLIM_BALL_SCAN_INL
#endif

#include "hwy/cache_control.h"
#include "pcl_slim/surface/detail/kernel_math-inl.h"
#include "scan/ball_kernels.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/** Offsets of one group of lanes from a centre, and which of them are in the ball and within its
 * normal bound. */
struct Lanes {
  Vec dx, dy, dz, d_sq;
  Mask in_ball, kept;
};

/** Walks the stored points of some blocks, those of a ball and within its normal bound. */
class BallScan {
 public:
  BallScan(const PointStore& store, const BallQuery& query)
      : store_(store), query_(query), radius_sq_(set(query.radius * query.radius)) {
    bounded_ = query.bound_normal != nullptr;
    for (int a = 0; a < 3; ++a) bound_[a] = bounded_ ? query.bound_normal[a] : 0.0f;
  }

  /** Calls body(first point index, lanes) for every group of lanes that meets the ball. */
  template <typename Body>
  HWY_INLINE void forEach(const BlockList& blocks, const Body& body) const {
    forEachOf(
        blocks, [](std::uint32_t) { return true; }, body);
  }

  /** Likewise in those blocks that are wanted. */
  template <typename Wanted, typename Body>
  HWY_INLINE void forEachOf(const BlockList& blocks, const Wanted& wanted, const Body& body) const {
    const Tag d;
    for (std::size_t k = 0; k < blocks.size(); ++k) {
      const std::uint32_t b = blocks[k];
      if (k + kAhead < blocks.size() && blocks[k + kAhead] != b + kAhead) {
        prefetch(blocks[k + kAhead]);
      }
      if (!wanted(b)) continue;
      const auto sx = set(store_.blockOriginX()[b] - query_.center[0]);
      const auto sy = set(store_.blockOriginY()[b] - query_.center[1]);
      const auto sz = set(store_.blockOriginZ()[b] - query_.center[2]);
      const std::size_t end = (b + std::size_t{1}) * PointStore::kBlock;
      for (std::size_t i = b * PointStore::kBlock; i < end; i += hn::Lanes(d)) {
        Lanes lanes;
        lanes.dx = Load(d, store_.x() + i) + sx;
        lanes.dy = Load(d, store_.y() + i) + sy;
        lanes.dz = Load(d, store_.z() + i) + sz;
        lanes.d_sq = dot3(lanes.dx, lanes.dy, lanes.dz, lanes.dx, lanes.dy, lanes.dz);
        lanes.in_ball = lanes.d_sq < radius_sq_;
        if (AllFalse(d, lanes.in_ball)) continue;
        lanes.kept = lanes.in_ball;
        if (bounded_) {
          const auto cosine =
              dot3(Load(d, store_.nx() + i), Load(d, store_.ny() + i), Load(d, store_.nz() + i),
                   set(bound_[0]), set(bound_[1]), set(bound_[2]));
          lanes.kept = And(lanes.in_ball, cosine > set(query_.min_dot));
        }
        body(i, lanes);
      }
    }
  }

 private:
  static constexpr std::size_t kAhead = 4;  ///< blocks between a prefetch and its use; no result
                                            ///< depends on it

  /** Blocks out of line are not fetched ahead by themselves. */
  HWY_INLINE void prefetch(std::uint32_t b) const {
    const std::size_t i = b * PointStore::kBlock;
    for (const float* column : {store_.x(), store_.y(), store_.z()}) hwy::Prefetch(column + i);
    if (!bounded_) return;
    for (const float* column : {store_.nx(), store_.ny(), store_.nz()}) hwy::Prefetch(column + i);
  }

  const PointStore& store_;
  const BallQuery& query_;
  bool bounded_;
  float bound_[3];
  Vec radius_sq_;
};

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
