// SPDX-License-Identifier: BSD-3-Clause
// Whether the data end at a point (docs/theory.md, "Borders").
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/core/aligned.h"
#include "pcl_slim/core/vector3.h"

namespace pcl_slim::detail {

/** \brief Where the data end (docs/theory.md, "Borders"). */
struct BorderConstants {
  double plane = 2.8;          ///< [spacing] points that give a point's tangent plane ...
  double plane_noise = 5.0;    ///< [RMS noise] ... or this, if it is wider
  double window = 4.0;         ///< [RMS noise] heights over the plane that count as none
  double turned_window = 2.0;  ///< [RMS noise] likewise in planes turned about the rim
  double slope = 0.2;    ///< heights of other sides' points, over distances, that are the sheet's
  double tip = 2.0;      ///< [spacing] points of other sides count there up to this distance
  double across = 16.0;  ///< [spacing] the nearest point ahead is looked for up to this
  double step = 1.6;     ///< ratio of spacings across a gap from which the larger one counts
  double partner = 2.0;  ///< [disc's radius + RMS noise] another border point is within
  std::size_t enough_blocks = 128;  ///< of a ball; they show as much as all that it meets
};

/** \brief Points around a place as columns, in local units, padded with zeros to whole vectors. */
struct NearPoints {
  AlignedVector<float> x, y, z, distance_sq;  ///< offsets from the place, and their squared length
  AlignedVector<float> own;                   ///< 1: of the place's side, 0: of another
  AlignedVector<float> block_u, block_v;      ///< directions that points block, over distances
  std::size_t count = 0, blocking = 0;        ///< points; those among them that block

  void reserve(std::size_t capacity);
};

/** \brief A stride at which of a number of things about enough are left; a power of two, so that those
 * chosen by their index are the same for all who choose among more or less of them. */
inline std::size_t strideFor(std::size_t count, std::size_t enough) {
  std::size_t stride = 1;
  while (count / (2 * stride) >= enough) stride *= 2;
  return stride;
}

/** \brief Leaves about enough of some blocks, those whose index the stride divides. Balls as wide as
 * the noise, and discs beside a dense clump, contain far more points than others. \return the stride */
std::size_t keepEnough(std::size_t enough, std::vector<std::uint32_t>& blocks);

/** \brief Which points are of the place's side, where normals part sheets. */
struct PlaceSide {
  std::array<float, 3> normal{};
  float min_dot = -2;  ///< the normal bound: of the cosine to the normal; below -1 for all points
};

/** \brief A plane through a place, which a sweep of directions is made in. */
struct SweepPlane {
  std::array<Vector3, 3> axes{};  ///< u, v and the normal
  double height = 0;              ///< of the sheet over the place
  double window = 0;              ///< heights over the sheet's that count as none
  double slope = -1;  ///< points of other sides count up to this height over their distance ...
  double tip = -1;    ///< ... or up to this distance
  double turn = 0;    ///< of the plane about v, after heights are reduced; radians
};

constexpr int kSweepDirections = 64;  ///< equally spaced

/** \brief Spacing of points about a block: the root of the area that a point has around the
 * block's middle, lowered to the 40 % quantile of nine successive blocks, as blocks at rims see less
 * area than they have. Computed at the first call, shared by threads. */
class LocalSpacing {
 public:
  /** \param[in] noise RMS distance of points from the surface, local length */
  LocalSpacing(const PointStore& store, const BorderConstants& constants, double noise);

  /** \brief About a block, local length. */
  float of(std::size_t block);
  /** \brief About one point, from the distance of its 16th neighbour; not stored. */
  float at(std::size_t point) const;

 private:
  std::size_t middleOf(std::size_t block) const;
  double guessAt(std::size_t point) const;
  float raw(std::size_t block);

  const PointStore& store_;
  const BorderConstants& constants_;
  double noise_;
  std::vector<std::atomic<float>> raw_, smooth_;  ///< 0: not yet measured
};

/** \brief What a border test has found at a stored point: 0 not tested, 1 inside, else the
 * direction away from the data, ten bits a coordinate, and two bits for whether it has a partner.
 * Threads share it, as it depends on nothing else. */
using PointBorders = std::vector<std::atomic<std::uint32_t>>;

/** \brief Whether the data end next to a point, as a property of the point alone.
 *
 * At a border a disc of the smallest hole's diameter touches the point and is empty of its sheet:
 * neighbours, projected to the tangent plane, leave an interval of the disc's directions free. It
 * is free in every plane turned about the rim, unlike at an edge or a tip of a body;
 * and another border point is close by. One per thread: it keeps its memory.
 */
class BorderTest {
 public:
  /** \param[in] noise RMS distance of points from the surface, local length
   * \param[in] hole_size diameter of the smallest hole kept, in spacings
   * \param[in] min_dot the normal bound where normals part sheets, else -2
   * \param[in] edges_end whether points of other sides count for nothing: a face ends at an edge
   * \param[in,out] borders one for each stored point */
  BorderTest(const PointStore& store, const BorderConstants& constants, double noise,
             double hole_size, float min_dot, bool edges_end, LocalSpacing& spacing,
             PointBorders& borders);

  /** \brief Whether the data end at a stored point. O(neighbours) at the point's first test, O(1)
   * then. */
  bool isBorder(std::size_t point);

 private:
  std::uint32_t flagOf(std::size_t point);
  std::uint32_t measure(std::size_t point);
  bool hasPartner(std::size_t point, std::uint32_t flag);
  void listBlocks(const Vector3& place, double reach);
  void gather(const Vector3& place, double reach);
  bool gatherEnough(const Vector3& place, double reach);
  SweepPlane findPlane(double spacing);
  bool findFree(double reach, double* middle);
  bool findFreeOfAll(const Vector3& place, const SweepPlane& plane, double reach, double spacing,
                     bool all, double* middle);
  bool isFreeTurned(SweepPlane plane, double reach, double spacing);
  double halfSpacing(const Vector3& direction, double reach);
  bool findAhead(const Vector3& direction, double spacing, Vector3* next) const;
  void gatherSheet(const Vector3& place, double reach, const SweepPlane& plane);
  double spacingAround(const Vector3& place, SweepPlane plane, const Vector3& direction,
                       double spacing);

  const PointStore& store_;
  const BorderConstants& constants_;
  double noise_, hole_size_;
  bool edges_end_;
  PlaceSide side_;  ///< of the point at hand
  LocalSpacing& spacing_;
  PointBorders& borders_;
  std::vector<std::uint32_t> blocks_, numbers_;
  NearPoints near_;
  std::vector<float> squares_;
};

namespace kernels {

/** \brief Collects the points of some blocks within a distance of a place. */
void gatherOffsets(const PointStore& store, const std::vector<std::uint32_t>& blocks,
                   const Vector3& place, double reach, const PlaceSide& side, NearPoints& points);

/** \brief Finds the directions in which points block discs that touch the place, over their
 * distances: points within reach, and not nearer than least in the plane. */
void findBlocked(const SweepPlane& plane, double reach, double least, NearPoints& points);

/** \brief For each direction of a disc's middle the inverse diameter of the widest disc that no
 * point is in. */
void sweepDirections(const NearPoints& points, std::array<float, kSweepDirections>& inverse);

}  // namespace kernels
}  // namespace pcl_slim::detail
