// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "octree/octree.h"
#include "pcl_slim/cloud/side_evidence.h"
#include "pcl_slim/splat/splat_sampling.h"
#include "pcl_slim/splat/splat_set.h"

namespace pcl_slim::detail {

/** The disc's normal from a cell's points. */
struct DiscNormal {
  std::array<double, 3> normal;
  double variance;  ///< 1 - share of the normals' common line, in [0, 2/3]; 0 without normals
};

/** Makes a disc of each cell while its points are at hand, and the splats of all discs at the end.
 *
 * Cells come in slices; slices from any thread at any time. */
class SplatBuilder {
 public:
  SplatBuilder(const OctreeCloud& cloud, const OctreeSource& source, const SplatParams& params,
               const SampleNoise& noise, std::size_t slices);

  /** All cells of a slice; their points are in the window. */
  void add(std::size_t slice, const PointWindow& window, const CellBatch& batch);

  /** Writes splats in the order of slices and cells. store: for RadiusRule::kNeighbors, else null;
   * the same points. */
  void finish(const PointStore* store, SplatSet& splats, SplatStatistics& statistics);

 private:
  /** One disc; lengths in root cells. */
  struct Row {
    std::array<float, 3> center, normal;
    float reach;    ///< radius where the rule knows it already, else to the farthest point
    float spacing;  ///< 0: unknown
    float confidence, normal_variance;
    std::uint32_t rgb, kept;
  };

  struct Slice {
    std::vector<Row> rows;
    std::vector<SplatSet::Gradient> gradients;
    std::uint64_t single_points = 0, without_normal = 0;
  };

  Row rowOf(const PointWindow& window, const OctreeCell& cell, const CellSums& sums,
            DiscNormal& normal) const;
  std::array<float, 3> cubeCenter(const PointWindow& window, const OctreeCell& cell) const;
  static void takePoint(const PointWindow& window, std::size_t point, Row& row, DiscNormal& normal);
  void note(std::size_t slice, const PointWindow& window, const OctreeCell& cell, const Slice& out);
  SplatSet::Gradient gradientOf(const PointWindow& window, const OctreeCell& cell,
                                const CellSums& sums, const DiscNormal& normal) const;
  std::uint32_t colorOf(const CellSums& sums, std::size_t input) const;
  void count(SplatStatistics& statistics) const;
  double widest() const;
  std::vector<float> neighborRadiiOf(const PointStore& store, double widest) const;
  double radiusOf(const Row& row, double widest) const;
  void write(const Row& row, double radius, std::size_t i, SplatSet& splats) const;

  const OctreeCloud& cloud_;
  const OctreeSource& source_;
  const SplatParams& params_;
  double color_noise_, normal_noise_;
  std::vector<Slice> slices_;
  std::vector<std::array<std::uint32_t, 2>> disc_of_;  ///< slice and row of each point, by order
};

/** Normals from the principal axes of about k neighbours of each point, facing what the evidence
 * shows or, if it shows nothing, one place in the middle of the cloud; three floats for each point of
 * the view, zero for those not selected or not finite. store: the same points.
 *
 * Neighbours are those in a ball whose radius follows the local density, for 16 points of Morton
 * order together; where it has fewer than .6 k or more than 1.7 k, the k nearest. */
std::vector<float> estimateNormals(const PointStore& store, const CloudView& cloud, int neighbors,
                                   const SideEvidence& evidence, int threads);

/** Turns discs to the eye of the evidence. Where nothing shows which side is out, neighbours agree and
 * each connected part faces outward, as a surface of the same points does. Those of given normals
 * turn where these contradict each other, unless they are to be kept. O(discs log discs), and once
 * O(points log points) where discs seem to contradict each other. \param[in] cloud the points
 * \return how far its normals contradict each other, if discs turned for it. */
NormalAgreement settleDiscSides(const SideEvidence& evidence, const CloudView& cloud,
                                bool keep_given, int threads, SplatSet& splats);

}  // namespace pcl_slim::detail
