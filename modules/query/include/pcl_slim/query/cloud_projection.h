// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "pcl_slim/cloud/cloud_view.h"
#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/cloud/side_evidence.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/core/progress.h"
#include "pcl_slim/query/projection.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim {

/** \brief Least share of points that a surface made elsewhere must support to count as the cloud's.
 */
constexpr double kLeastSharedSupport = 0.1;

/** \brief How a cloud is projected onto a surface. */
struct CloudProjectionParams {
  ProjectionParams projection;
  /// normals of points without input normal are turned towards this place, world coordinates; none:
  /// to their sensors, or the cloud's
  std::optional<std::array<double, 3>> viewpoint;
  double least_support =
      0.0;  ///< an error when fewer of the finite points are supported, in [0, 1]
};

/** \brief What happened to the selected points. */
struct CloudProjectionStatistics {
  std::uint64_t points = 0;       ///< points selected (by indices, if any; duplicates counted)
  std::uint64_t moved = 0;        ///< projected onto the surface
  std::uint64_t unsupported = 0;  ///< inside no surfel that covers them: they keep their place
  std::uint64_t non_finite = 0;   ///< a coordinate is NaN or infinite
  double rms_displacement = 0;    ///< of the moved points, cloud units
  double max_displacement = 0;    ///< likewise
};

/** \brief A point on the surface, in the cloud's coordinates and units. */
struct ProjectedPoint {
  std::array<double, 3> position{};
  std::array<float, 3> normal{};  ///< unit; the side is that of the input's normal if it has one
  float mean_curvature = 0;       ///< 1/length, positive where the surface bends away from normal
  float gaussian_curvature = 0;   ///< 1/length^2
  PrincipalFrame principal;       ///< 1/length, same sign; k1 >= k2
  StandardErrors errors;          ///< with ProjectionParams::errors
  /// l0 / (l0 + l1 + l2) of the covariance of the kVariationNeighbors projected points around, 0 to
  /// 1/3: what pcl::NormalEstimation writes as curvature
  float surface_variation = 0;
};

/** \brief A cloud projected onto a surface, read point by point in the cloud's own order and units.
 *
 * Contains no points: about 51 bytes a point, 83 with principal directions, 4 more with planes, 12 more with standard
 * errors. The
 * cloud behind the view must live as long as this object is read.
 */
class PCL_SLIM_EXPORT CloudProjection {
 public:
  CloudProjection() = default;

  /** \brief Projects every point that a view selects.
   *
   * All finite points count, also those that lack a normal among others that have one.
   * \param[in] store the store of this view if there is one already (saves building it);
   * null: one is built. \return an error for a view without a finite point, too little support, or
   * cancellation. O(points) time and memory.
   */
  static Result<CloudProjection> make(const CloudView& cloud, const SLIMSurface& surface,
                                      const CloudProjectionParams& params,
                                      Progress* progress = nullptr,
                                      const PointStore* store = nullptr);

  /** \brief The projection of a number of points none of which is finite. */
  static CloudProjection ofNothing(std::size_t points);

  /** \brief Number of selected points. */
  std::size_t size() const { return stored_.size(); }
  /** \brief Whether the i-th selected point has finite coordinates. */
  bool isFinite(std::size_t i) const { return stored_[i] != PointStore::kSkipped; }
  /** \brief Whether the i-th selected point has been moved; otherwise it keeps its place. */
  bool isSupported(std::size_t i) const {
    return isFinite(i) && projection_.supported[stored_[i]] != 0;
  }
  /** \brief Whether the i-th selected point has been moved to a place inside the surface's borders,
   * as its trim maps have them. */
  bool isInside(std::size_t i) const { return isFinite(i) && projection_.inside[stored_[i]] != 0; }
  /** \brief The i-th selected point, which must be finite. Of one that no surfel supports, the
   * place is its own and curvatures are NaN; the normal is its own too, if it has one, or with
   * ProjectionParams::planes that of its neighbours, on their side; otherwise NaN. */
  ProjectedPoint point(std::size_t i) const;
  /** \brief The surface's own unit normal at the i-th selected point, which must be supported: on
   * the surface's side, whatever the point's normal or the viewpoint. */
  std::array<float, 3> surfaceNormal(std::size_t i) const { return projection_.normal[stored_[i]]; }
  /** \brief Such a point of which nothing is known but that it is somewhere: all else is NaN. */
  static ProjectedPoint unknownPoint(const std::array<double, 3>& place);

  /** \brief Indices, in the cloud, of the finite points that no surfel supports. */
  std::vector<std::int32_t> unsupported() const;
  /** \brief Indices, in the cloud, of the points that were moved to places beyond the borders. */
  std::vector<std::int32_t> outside() const;
  /** \brief What the projection did. */
  const CloudProjectionStatistics& statistics() const { return statistics_; }
  /** \brief What it found in its input. */
  const PointStoreStatistics& inputStatistics() const { return input_statistics_; }

 private:
  /** \brief Indices, in the cloud, of the selected points for which which(i) is true. */
  template <typename Which>
  std::vector<std::int32_t> indicesOf(const Which& which) const;
  /** \brief Projects a store's points and appends them, in the first store's units. */
  Error add(const PointStore& store, const SLIMSurface& surface, Progress* progress);
  /** \brief Appends a store's points as such that no surfel supports. */
  void keep(const PointStore& store);
  /** \brief Adds finite points that the stores before left out: for lack of a normal, or as strays
   * far away. \param[in] frame the first store: those near its points; null: strays.
   * \param[out] left how many strays are still left out. */
  Error addRest(const SLIMSurface& surface, Progress* progress, const PointStore* frame,
                std::uint64_t& left);
  /** \brief A store's local position in the first store's units. */
  std::array<double, 3> toFirst(const PointStore& store, const std::array<double, 3>& local) const;
  /** \brief Finds the planes of the neighbours of all projected points. \param[in] first the first
   * store */
  void addPlanes(const PointStore& first);
  /** \brief The projected points as a store. \param[out] place of each projected point in it, or
   * PointStore::kSkipped */
  Result<PointStore> projectedStore(const PointStore& first,
                                    std::vector<std::uint32_t>& place) const;
  /** \brief Turns the planes' normals of points without support: to what evidence shows, else to
   * the side of the supported points around, else outward. */
  void turnPlanes(const PointStore& projected, const std::vector<std::uint32_t>& place);
  /** \brief The normal of a point without support. */
  std::array<float, 3> ownNormal(std::size_t i) const;
  /** \brief Counts and measures the points whose stored ones begin at first. */
  void measure(std::size_t first);

  CloudView cloud_;
  CloudProjectionParams params_;
  SideEvidence seen_;  ///< of points without normals
  Projection projection_;
  std::vector<std::uint32_t> stored_;  ///< place in projection_ of each selected point
  std::vector<char> turned_;           ///< 1: the surface's normal there faces the wrong side
  std::vector<float> variation_;       ///< with planes
  std::array<double, 3> origin_{};
  double scale_ = 1.0;
  CloudProjectionStatistics statistics_;
  PointStoreStatistics input_statistics_;
};

}  // namespace pcl_slim
