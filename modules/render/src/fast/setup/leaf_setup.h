// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "camera/camera_rays.h"
#include "pcl_slim/core/aligned.h"
#include "pcl_slim/render/detail/frame_constants.h"
#include "pcl_slim/render/render_params.h"
#include "pcl_slim/surface/detail/trim_tables.h"
#include "pcl_slim/surface/polynomial.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim::detail {

/** \brief How f changes along every ray in the ball of pass 1. */
enum class LeafTurn : std::uint8_t {
  kEither,  ///< not known
  kFalls,   ///< it falls: the leaf is seen from the front, and a ray has one root at most
  kRises    ///< it rises: the leaf is seen from behind
};

/** \brief A surfel as one frame's rays meet it, in coordinates of its own; set up once a frame.
 *
 * Let z_c be the depth of the centre, X and Y the offset of a ray from it at that depth and
 * s = (z - z_c) / r, all in radii. With eps = r / z_c (0 if parallel) and sigma = s / (1 + eps s)
 * a ray's point is, in radii from the centre and in the camera's axes,
 *     (X + x_c sigma, Y + y_c sigma, sigma) / m,    m = 1 - eps sigma,
 * so that F = m^n f / r, n the degree, is a polynomial of degree n in X, Y and sigma together. Its
 * coefficients follow the record: sum_i sigma^i A_i(X, Y) with A_i of degree n - i, A_0 first, each
 * in the order of height polynomials. Then follow, of a quadratic, the second derivatives of f
 * (camera's axes, Symmetric3's order), else the polynomials h_u, h_v, h_uu, h_uv, h_vv in that
 * order.
 */
struct FrameLeaf {
  float x, y;       ///< pixel of the centre
  float per_pixel;  ///< change of X by a pixel
  float eps, xc, yc;
  float depth, inverse_depth;  ///< z_c and its reciprocal (1 if parallel)
  float radius, inverse_radius;
  float beta, inverse_beta;  ///< d sigma / dD
  float nearest;             ///< no ray meets the ball at a depth value below
  float variance_weight;
  float u[3], v[3], w[3];               ///< the surfel's frame in the camera's axes
  float uc, vc;                         ///< u . (x_c, y_c, 1) and v . (x_c, y_c, 1)
  float blend_x, blend_y, blend_reach;  ///< pixels: a circle around the ball's picture
  float first_x, first_y, first_reach;  ///< the same of the ball of pass 1
  float strip_x, strip_y;               ///< a direction in the picture, and between which
  float strip_low, strip_high;  ///< pixels from the centre: the surface in that ball is within
  float inverse_cover_sq;       ///< of the radius in which it covers; 0: wherever it counts
  std::uint32_t surfel;
  std::uint16_t degree;  ///< of the polynomials here, 2 to 4; kNearLeaf: none, too near
  LeafTurn turn;

  TrimTable trim;    ///< where the surfel has data
  float trim_scale;  ///< of the ball here, in the surfel's radii, which its trim map counts in

  const float* form() const { return reinterpret_cast<const float*>(this + 1); }
  float* form() { return reinterpret_cast<float*>(this + 1); }
  const float* derivatives() const { return form() + formSize(degree); }

  /** \brief Coefficients of F: 10, 20, 35 for degree 2, 3, 4. */
  static constexpr int formSize(int n) { return (n + 1) * (n + 2) * (n + 3) / 6; }
  /** \brief Floats of the derivatives. */
  static constexpr int derivativeSize(int n) {
    return n == 2 ? 6 : 2 * numCoefficients(n - 1) + 3 * numCoefficients(n - 2);
  }
};

constexpr std::uint16_t kNearLeaf = 0;

/** \brief Bytes from one record to the next for surfels of a degree: whole cache lines. */
constexpr std::size_t leafStride(int degree) {
  const int floats = FrameLeaf::formSize(degree) + FrameLeaf::derivativeSize(degree);
  const std::size_t bytes = sizeof(FrameLeaf) + sizeof(float) * static_cast<std::size_t>(floats);
  return (bytes + 63) / 64 * 64;
}

/** \brief Which surfels of a hierarchy represent a surface in a picture, and with what share of
 * their weight (Ohtake, Belyaev, Alexa 2005, section 3.2).
 *
 * A surfel whose size (DetailSizes) is seen smaller than lod pixels replaces its descendants; from
 * there to one and a half times that size it fades out and they fade in, so that nothing pops when
 * the camera moves: its share is coarse(own size) (1 - coarse(size of its parent)). As sizes never
 * grow from level to level, older ancestors are then large enough to be out of it.
 */
struct DetailRule {
  static constexpr auto kFade = static_cast<float>(kDetailFade);
  static constexpr auto kMeets = static_cast<float>(kDetailMeets);

  float lod = 0.0f;  ///< pixels; 0: leaves alone represent the surface

  bool active() const { return lod > 0.0f; }
};

constexpr std::uint32_t kClusterSize = 64;  ///< leaves looked at together

/** \brief Neighbouring leaves: a sphere around their balls and a cone around their gradients. */
struct LeafCluster {
  float center[3];
  float radius;
  float axis[3];
  float cone;      ///< half angle in radians; pi and more: the gradients have no side in common
  float smallest;  ///< of own_size
  float largest;   ///< of parent_size
  std::uint32_t begin, end;  ///< leaves, in the clusters' order
};

/** \brief Whether a ball or cluster may be seen, and if not, why. */
enum class Visibility : std::uint8_t {
  kVisible,
  kOutside,
  kCutAway,  ///< outside of a half space
  kBackFacing,
  kTooSmall,  ///< a coarser surfel replaces it
  kTooLarge,  ///< its descendants replace it
};
constexpr int kVisibilities = 6;

/** \brief Which surfels of a surface are clustered. */
enum class ClusteredSurfels : std::uint8_t { kLeaves, kInternal };

/** \brief What a frame looks for. */
struct VisibilityRules {
  bool front_only;  ///< leave out back-facing surfels
  DetailRule detail;
  const std::vector<HalfSpace>& cuts;  ///< local coordinates, unit normals
};

/** \brief A surface's leaves, or its internal surfels level by level, along a space-filling curve,
 * in clusters that a frame sees or leaves out as a whole.
 *
 * There is no tree over the clusters: of a million leaves, looking at every one of them takes .2
 * ms. Columns are padded to whole clusters. Built once per surface: O(surfels log surfels + links).
 */
class LeafClusters {
 public:
  LeafClusters(const SLIMSurface& surface, int threads,
               ClusteredSurfels which = ClusteredSurfels::kLeaves);

  std::size_t size() const { return surfel.size(); }

  /** \brief Appends the clusters that may be seen, in order, and adds the surfels of the others to
   * the counts, by reason. */
  void findVisible(const FrameView& view, const VisibilityRules& rules,
                   std::vector<std::uint32_t>& visible, std::uint64_t* hidden) const;

  const LeafCluster& cluster(std::uint32_t c) const { return clusters_[c]; }

  std::vector<std::uint32_t> surfel;     ///< of the surface
  AlignedVector<float> x, y, z, radius;  ///< the ball
  AlignedVector<float> nx, ny, nz;       ///< the normal
  AlignedVector<float> sine;  ///< of the largest angle between normal and gradient in the ball
  AlignedVector<float> variance_weight;
  AlignedVector<float> own_size, parent_size;  ///< DetailSizes

 private:
  void sortSurfels(const SLIMSurface& surface, std::vector<std::uint32_t> surfels, int threads);
  void fillColumns(const SLIMSurface& surface);
  void fillSizes(const SLIMSurface& surface);
  LeafCluster enclose(std::uint32_t begin, std::uint32_t end) const;

  std::vector<LeafCluster> clusters_;
};

/** \brief Radii in which a frame looks at its leaves, as shares of the balls'. */
struct BallShares {
  float first;  ///< alpha of pass 1
  float blend;  ///< beyond, a leaf's weight does not count
};

/** \brief Surfels of one degree, as columns, to be set up side by side. */
struct LeafBatch {
  static constexpr std::size_t kSize = 16;

  alignas(64) float x[kSize], y[kSize], z[kSize], radius[kSize];
  alignas(64) float nx[kSize], ny[kSize], nz[kSize], variance_weight[kSize];
  alignas(64) float c[kMaxCoefficients][kSize];
  float inverse_cover_sq[kSize];
  std::uint32_t surfel[kSize];
  FrameLeaf* target[kSize];
  std::size_t count = 0;
};

namespace kernels {

/** \brief Visibility of one cluster's surfels. Errs on the visible side.
 * \param[out] visibility by surfel
 * \param[out] shares of the weight, above 0 of every visible one; room for whole vectors */
void cullLeaves(const LeafClusters& leaves, std::uint32_t begin, std::uint32_t end,
                const FrameView& view, const VisibilityRules& rules, Visibility* visibility,
                float* shares);

/** \brief Writes the frame's records of a batch. Surfels too near to the camera for a polynomial
 * along its rays get kNearLeaf. \param[in] degree 2 to 4; missing coefficients are 0 */
void setUpLeaves(const LeafBatch& batch, int degree, const FrameView& view,
                 const BallShares& shares);

}  // namespace kernels

/** \brief How large a surfel's ball is taken, and in what share of it the surfel covers. */
struct BallShape {
  float scale = 1.0f;
  float inverse_cover_sq = 0.0f;  ///< 0: wherever it counts
};

/** \brief Surfels sorted into batches of one degree, set up as they fill. */
class BatchFiller {
 public:
  BatchFiller(const SLIMSurface& surface, const FrameView& view, const BallShares& shares)
      : surface_(surface), view_(view), shares_(shares) {}

  /** \param[in] weight factor of its blending weight */
  void add(std::uint32_t s, float weight, const BallShape& shape, FrameLeaf* target) {
    const int degree = std::max<int>(2, surface_.degree[s]);
    LeafBatch& batch = batches_[degree - 2];
    const std::size_t lane = batch.count++;
    batch.x[lane] = surface_.cx[s];
    batch.y[lane] = surface_.cy[s];
    batch.z[lane] = surface_.cz[s];
    batch.radius[lane] = shape.scale * surface_.radius[s];
    batch.nx[lane] = surface_.nx[s];
    batch.ny[lane] = surface_.ny[s];
    batch.nz[lane] = surface_.nz[s];
    batch.variance_weight[lane] = weight;
    batch.inverse_cover_sq[lane] = shape.inverse_cover_sq;
    batch.surfel[lane] = s;
    batch.target[lane] = target;
    const float* c = surface_.coefficientsOf(s);
    const int known = numCoefficients(surface_.degree[s]), all = numCoefficients(degree);
    float power = 1.0f / shape.scale;  // of a radius that large, at height 0
    for (int n = 0, k = 0; k < all; ++n, power *= shape.scale) {
      for (int j = 0; j <= n; ++j, ++k) batch.c[k][lane] = k < known ? power * c[k] : 0.0f;
    }
    if (batch.count == LeafBatch::kSize) flush(degree);
  }

  void flushAll() {
    for (int degree = 2; degree <= kMaxDegree; ++degree) flush(degree);
  }

 private:
  void flush(int degree) {
    LeafBatch& batch = batches_[degree - 2];
    if (batch.count == 0) return;
    // Lanes to spare repeat the first one: any surfel will do, but numbers must be there.
    for (std::size_t lane = batch.count; lane < LeafBatch::kSize; ++lane) {
      for (float* column : {batch.x, batch.y, batch.z, batch.radius, batch.nx, batch.ny, batch.nz,
                            batch.variance_weight}) {
        column[lane] = column[0];
      }
      for (int k = 0; k < numCoefficients(degree); ++k) batch.c[k][lane] = batch.c[k][0];
    }
    kernels::setUpLeaves(batch, degree, view_, shares_);
    batch.count = 0;
  }

  const SLIMSurface& surface_;
  const FrameView& view_;
  const BallShares& shares_;
  LeafBatch batches_[3];
};

}  // namespace pcl_slim::detail
