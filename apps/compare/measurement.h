// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/program.h"
#include "compare/compared_input.h"
#include "pcl_slim/compare/alignment.h"
#include "pcl_slim/compare/carrier_mesh.h"
#include "pcl_slim/compare/deviation.h"
#include "pcl_slim/compare/deviation_summary.h"
#include "pcl_slim/compare/place_columns.h"
#include "pcl_slim/compare/registration.h"
#include "pcl_slim/core/error.h"

namespace pcl_slim {

/** \brief Where deviations are measured. */
enum class MeasuredAt : unsigned char {
  kSurface,    ///< evenly over A: over its fitted surface, or its triangles
  kPoints,     ///< at A's points or vertices
  kReference,  ///< evenly over B
};

/** \brief What decides how A is compared with B. */
struct ComparisonJob {
  MeasuredAt at = MeasuredAt::kSurface;
  ScanPlaces points = ScanPlaces::kMoved;  ///< places of a cloud's points
  bool align = false;
  DeviationParams deviation;
  CarrierParams carrier;
};

/** \brief A compared with B. World coordinates are B's; A's are moved into them by motion. */
class Comparison {
 public:
  /** \brief Both must outlive this object. */
  Comparison(const ComparisonJob& job, const ComparedInput& a, const ComparedInput& b)
      : job_(job), a_(a), b_(b) {}

  /** \brief Prepares both, estimates what motion remains between them, applies it where the job
   * says so, and measures. Prints and reports what was done. */
  Error run(Console& console, Report& report);

  /** \brief Deviations of A's points, or of a mesh's vertices, in their order; of a surface, of the
   * places of its carrier. */
  Result<Deviations> atPoints(Console& console);

  /** \brief Of the object that the places are on, before any motion: A, or at the reference B. */
  const CarrierMesh& carrier() const { return *carrier_; }
  const ComparedInput& measuredObject() const {
    return job_.at == MeasuredAt::kReference ? b_ : a_;
  }
  const ComparedInput& otherObject() const { return job_.at == MeasuredAt::kReference ? a_ : b_; }
  /** \brief Where deviations were measured, before any motion, and each one's share of the area. */
  const PlaceColumns& places() const { return places_; }
  const DeviationCarrier& shares() const { return shares_; }
  const Deviations& deviations() const { return deviations_; }
  MeasuredAt measuredAt() const { return job_.at; }
  /** \brief Whether the places are the carrier's vertices. */
  bool isAtCarrier() const { return job_.at != MeasuredAt::kPoints; }
  /** \brief Standard errors of the points of the last atPoints() [world units]; empty: exact. */
  const std::vector<float>& pointSigma() const { return point_places_.sigma; }
  /** \brief Positions of A's points as they were compared, without the motion. */
  const PlaceColumns& pointPlaces() const { return point_places_; }

  const Registration& registration() const { return alignment_.registration; }
  /** \brief Takes A's coordinates to B's; no motion unless it is applied. */
  const RigidMotion& motion() const { return alignment_.motion; }
  /** \brief Why places have no counterpart: numbers of them by FootState. */
  std::vector<std::uint64_t> states() const;

 private:
  Error prepare(Console& console, Report& report);
  Error align(Console& console, Report& report);
  Error measure(Console& console, Report& report);
  Error makePoints(Console& console);
  Error makeShares();

  const ComparisonJob& job_;
  const ComparedInput &a_, &b_;
  std::optional<DeviationReference> to_a_, to_b_;
  std::optional<CarrierMesh> carrier_;
  PlaceColumns places_, point_places_;
  DeviationCarrier shares_;
  Deviations deviations_;
  Alignment alignment_;
};

}  // namespace pcl_slim
