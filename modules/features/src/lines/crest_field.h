// SPDX-License-Identifier: BSD-3-Clause
#include <array>

#pragma once

#include "pcl_slim/core/vector3.h"
#include "pcl_slim/features/crest_lines.h"
#include "pcl_slim/query/surface_probe.h"

namespace pcl_slim::detail {

/** The curvature whose maxima make lines of one type, everything written as for ridges. */
struct CrestSide {
  double k, other;
  std::array<float, 3> t;
  double e;  ///< dk/dt
};

/** \param[in] turned whether the normal must be taken the other way round: ridges are ravines then. */
inline CrestSide
crestSide(const PrincipalFrame& frame, CrestType type, bool turned)
{
  if ((type == CrestType::kRidge) != turned) {
    return {frame.k1, frame.k2, frame.direction1, frame.extremality1};
  }
  return {-static_cast<double>(frame.k2), -static_cast<double>(frame.k1), frame.direction2,
          -static_cast<double>(frame.extremality2)};
}

/** The frame of a place that samples nearby are aligned to. */
struct CrestAxes {
  Vector3 normal{}, t{};
  double radius = 0;  ///< of the leaves
  double reach = 0;   ///< of differences of k, to both sides
};

/** The line's curvature at a place: that of ridges, or of ravines with its signs turned. */
struct CrestSample {
  bool known = false;
  Vector3 position{}, normal{}, t{};
  double k = 0, other = 0;
  double e = 0;  ///< dk/dt
};

/** Three samples side by side, span apart. */
struct CrestRow {
  Vector3 place{}, across{};
  double span = 0;
};

/** A vertex of a line being traced, in the surface's local units. */
struct CrestVertex {
  Vector3 position{}, normal{}, t{};
  Vector3 ahead{};  ///< unit, along the line
  double k = 0, other = 0;
  double radius = 0, effective_count = 0;
  double fall = 0;   ///< of dk/dt across the line, per length; 0: not known
  double reach = 0;  ///< of differences of k about it
  double prominence = 0, significance = 0;

  CrestAxes axes() const { return {normal, t, radius, reach}; }
};

/** The field whose zeros are lines of one type. */
class CrestField {
 public:
  static constexpr std::size_t kMostVertices = 8;

  /** \param[in] analytic take dk/dt from third derivatives rather than from differences of k. */
  CrestField(const ProbeIndex& index, CrestType type, bool analytic)
      : probe_(index), type_(type), analytic_(analytic)
  {
  }

  /** Leaves found for earlier places no longer count. */
  void restart(double radius);

  /** Samples at up to three places nearby, in one request. */
  void sample(const Vector3* centers, std::size_t count, const CrestAxes& axes,
              CrestSample* samples);

  /** Samples at a seed, a tenth of a radius off it along t and as far across, and the seed's prominence, in
   * one request. */
  void sampleSeed(CrestVertex& seed, CrestSample (&samples)[3]);

  /** Samples of a row, or of two in one request: at place - span across, place and place + span across.
   * Those of the second are not known where they would have needed a request of their own. */
  void sampleAcross(const CrestRow* rows, std::size_t count, const CrestAxes& axes,
                    CrestSample* samples);

  /** Differences of k over a shorter span would be dominated by noise. */
  double leastSpan(const CrestAxes& axes) const { return analytic_ ? 0.0 : axes.reach; }

  /** How far differences of k should reach about a vertex. */
  static double reachAt(const CrestVertex& vertex);

  /** k less the mean of k at half a radius to both sides along t; for up to eight vertices. */
  void findProminence(CrestVertex* vertices, std::size_t count);

  ProbeScale scaleAt(const Vector3& position, const Vector3& side)
  {
    return probe_.scaleAt(position, side);
  }
  std::uint64_t numRequests() const { return probe_.numRequests(); }
  bool isAnalytic() const { return analytic_; }

 private:
  void interpret(const ProbeSample& from, const CrestAxes& axes, CrestSample& sample) const;
  double difference(const ProbeSample* around, const CrestAxes& axes, const CrestSample& sample,
                    bool& known) const;
  void sampleInRows(const CrestRow* rows, std::size_t count, const CrestAxes& axes,
                    CrestSample* samples);
  static void twist(const CrestRow* rows, const CrestAxes& axes, CrestSample* samples);
  void interpretRow(const ProbeSample* middle, const ProbeSample* outer, const CrestRow& row,
                    const CrestAxes& axes, CrestSample* samples) const;
  double prominenceOf(const CrestVertex& v, const ProbeSample* aside) const;
  void placeAside(const CrestVertex& v, Vector3* places) const;
  bool lookAside(const CrestVertex* vertices, ProbeRequest request, ProbeSample* found);
  void walkAside(const CrestVertex* vertices, ProbeRequest request, ProbeSample* found);
  double kOf(const ProbeSample& from, const Vector3& normal) const;

  SurfaceProbe probe_;
  CrestType type_;
  bool analytic_;
};

}  // namespace pcl_slim::detail
