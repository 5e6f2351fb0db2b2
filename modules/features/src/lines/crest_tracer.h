// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pcl_slim/core/vector3.h"
#include "pcl_slim/features/crest_lines.h"
#include "pcl_slim/query/surface_probe.h"

namespace pcl_slim::detail {

/** A place on the surface that a line of some type passes. */
struct CrestSeed {
  Vector3 position;  ///< the surface's local units
  Vector3 normal, t;
  double k;  ///< of the line's own curvature, 1/local length
};

/** The curvature whose maxima make lines of one type, everything written as for ridges. */
struct CrestSide {
  double k, other;
  std::array<float, 3> t;
  double e;  ///< dk/dt
};

/** \param[in] turned whether the normal must be taken the other way round: ridges are ravines then.
 */
inline CrestSide crestSide(const PrincipalFrame& frame, CrestType type, bool turned) {
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
  double radius = 0, equivalent_count = 0;
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
      : probe_(index), type_(type), analytic_(analytic) {}

  /** Leaves found for earlier places no longer count. */
  void restart(double radius);

  /** Samples at up to three places nearby, in one request. */
  void sample(const Vector3* centers, std::size_t count, const CrestAxes& axes,
              CrestSample* samples);

  /** Samples at a seed, a tenth of a radius off it along t and as far across, and the seed's
   * prominence, in one request. */
  void sampleSeed(CrestVertex& seed, CrestSample (&samples)[3]);

  /** Samples of a row, or of two in one request: at place - span across, place and place + span
   * across. Those of the second are not known where they would have needed a request of their own.
   */
  void sampleAcross(const CrestRow* rows, std::size_t count, const CrestAxes& axes,
                    CrestSample* samples);

  /** Differences of k over a shorter span would be dominated by noise. */
  double leastSpan(const CrestAxes& axes) const { return analytic_ ? 0.0 : axes.reach; }

  /** How far differences of k should reach about a vertex. */
  static double reachAt(const CrestVertex& vertex);

  /** k less the mean of k at half a radius to both sides along t; for up to eight vertices. */
  void findProminence(CrestVertex* vertices, std::size_t count);

  ProbeScale scaleAt(const Vector3& position, const Vector3& side) {
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

/** Finds vertices of a line one after the other: roots of dk/dt across it. */
class CrestStepper {
 public:
  /** \param[in] step distance of vertices in radii. */
  CrestStepper(CrestField& field, double step) : field_(field), step_(step) {}

  /** Moves a seed onto its line. \param[in] samples as CrestField::sampleSeed gave them. */
  bool start(const CrestVertex& seed, const CrestSample (&samples)[3], CrestVertex& vertex);

  /** The vertex a step ahead of a line's last, or a shorter step; false where there is none. */
  bool advance(const std::vector<CrestVertex>& line, CrestVertex& next);

  /** The row sampled ahead is of another line. */
  void forget() { ahead_.known = false; }

 private:
  /** Where a root is searched: first at this offset from the middle of the row, then where that
   * shows it. */
  struct Search {
    CrestRow row;
    double at = 0;     ///< off the row's middle
    double reach = 0;  ///< roots count up to about this distance from there
    Vector3 stride{};  ///< to the row of the step after this one; zero: none
    Vector3 stride_across{};
  };
  /** The row of the step after the last one, sampled with it. */
  struct Ahead {
    bool known = false;
    CrestRow row;
    CrestSample samples[3];
  };

  bool correct(const Search& search, const CrestAxes& axes, CrestVertex& vertex);
  bool step(const std::vector<CrestVertex>& line, double size, CrestVertex& next);
  bool useAhead(const CrestVertex& from, CrestVertex& next);
  bool finish(const CrestVertex& from, CrestVertex& next);
  bool complete(CrestVertex& vertex);

  CrestField& field_;
  double step_;
  Ahead ahead_;
};

/** Places with a number and a reach each, found from any place within their reach.
 *
 * Each is listed in every cell that its reach meets, so that looking up opens one cell. Cells are
 * found by hashing their place and never listed: the order of the table cannot reach a result. */
class PlaceGrid {
 public:
  static constexpr std::int64_t kNothing = -1;

  /** \param[in] width of a cell, a few times the usual reach: wider ones are met by fewer entries
   * and list more. */
  explicit PlaceGrid(double width) : inverse_(1.0 / width), slots_(1024) {}

  void clear();
  /** \param[in] number 0 or more. */
  void add(const Vector3& place, double reach, std::int64_t number);

  /** The nearest of those that have a place within a share of their reach and that accept(number)
   * agrees to; ties go to the one added first. \return its number, or kNothing. \param[in] share at
   * most 1. */
  template <typename Accept>
  std::int64_t nearest(const Vector3& place, double share, const Accept& accept) const {
    std::int64_t cell[3];
    cellOf(place, cell);
    double least_sq = 0;
    std::uint32_t found = kNone;
    for (std::uint32_t at = headOf(keyOf(cell)); at != kNone; at = links_[at].next) {
      const Entry& entry = entries_[links_[at].entry];
      const Vector3 off = subtract(entry.place, place);
      const double d_sq = dot(off, off);
      if (d_sq >= share * share * entry.reach_sq || !accept(entry.number)) continue;
      // Links run from the last entry to the first.
      if (found == kNone || d_sq <= least_sq) {
        least_sq = d_sq;
        found = links_[at].entry;
      }
    }
    return found == kNone ? kNothing : entries_[found].number;
  }

  bool holds(const Vector3& place, double share) const {
    return nearest(place, share, [](std::int64_t) { return true; }) != kNothing;
  }

 private:
  static constexpr std::uint32_t kNone = 0xffffffffu;

  struct Entry {
    Vector3 place;
    double reach_sq;
    std::int64_t number;
  };
  struct Link {
    std::uint32_t entry, next;
  };
  struct Slot {
    std::uint64_t key = 0;
    std::uint32_t head = kNone, age = 0;  ///< of an age other than the grid's: empty
  };

  void cellOf(const Vector3& place, std::int64_t (&cell)[3]) const;
  static std::uint64_t keyOf(const std::int64_t (&cell)[3]);
  std::size_t slotOf(std::uint64_t key) const;
  std::uint32_t headOf(std::uint64_t key) const;
  void grow();

  double inverse_;
  std::vector<Slot> slots_;  ///< a power of two, at most half of them used
  std::uint32_t age_ = 1;
  std::size_t used_ = 0;
  std::vector<Entry> entries_;
  std::vector<Link> links_;
};

/** A line as traced, before anything is left out. */
struct TracedLine {
  std::vector<CrestVertex> vertices;
  bool closed = false;
};

/** Follows the lines of one type from its seeds. */
class CrestTracer {
 public:
  /** \param[in] mean_radius of the leaves, local units. */
  CrestTracer(const ProbeIndex& index, CrestType type, const CrestParams& params,
              const CurvatureNoise& noise, bool analytic, double mean_radius);

  /** Traces the line through a seed, unless one is there already or noise explains it. */
  void follow(const CrestSeed& seed);

  const std::vector<TracedLine>& lines() const { return lines_; }
  /** Seeds, ends and requests so far. */
  CrestStatistics statistics() const;

 private:
  enum class End { kGoesOn, kClosed, kJoined, kLost, kFaded };

  bool refuse(const CrestSeed& seed, std::uint64_t& counter);
  double reachOf(double radius) const;
  bool begin(const CrestSeed& seed, const ProbeScale& scale, CrestVertex& first);
  End walk(std::vector<CrestVertex>& line, bool forward);
  End advance(std::vector<CrestVertex>& line, std::int64_t number);
  bool faded(std::vector<CrestVertex>& line, std::size_t begin);
  void measure(std::vector<CrestVertex>& line, std::size_t begin, std::size_t end);
  void count(End end);
  void keep(std::vector<CrestVertex> forward, const std::vector<CrestVertex>& backward,
            bool closed);

  CrestParams params_;
  CrestField field_;
  CrestStepper stepper_;
  CurvatureNoise noise_;
  double mean_radius_;
  double seed_radius_ = 0;  ///< of the leaves at the seed being followed
  PlaceGrid traced_;        ///< vertices of all lines so far, numbered in order
  PlaceGrid refused_;       ///< seeds that were tried already
  PlaceGrid own_;           ///< vertices of the line being traced, numbered from kMiddle both ways
  std::vector<CrestVertex> vertices_;
  std::vector<TracedLine> lines_;
  CrestStatistics statistics_;
};

}  // namespace pcl_slim::detail
