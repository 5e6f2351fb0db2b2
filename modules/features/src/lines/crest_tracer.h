// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "lines/crest_field.h"
#include "lines/crest_seeds.h"
#include "lines/crest_stepper.h"
#include "pcl_slim/core/vector3.h"

namespace pcl_slim::detail {

/** Places with a number and a reach each, found from any place within their reach.
 *
 * Each is listed in every cell that its reach meets, so that looking up opens one cell. Cells are found
 * by hashing their place and never listed: the order of the table cannot reach a result. */
class PlaceGrid {
 public:
  static constexpr std::int64_t kNothing = -1;

  /** \param[in] width of a cell, a few times the usual reach: wider ones are met by fewer entries and
   * list more. */
  explicit PlaceGrid(double width) : inverse_(1.0 / width), slots_(1024) {}

  void clear();
  /** \param[in] number 0 or more. */
  void add(const Vector3& place, double reach, std::int64_t number);

  /** The nearest of those that have a place within a share of their reach and that accept(number) agrees
   * to; ties go to the one added first. \return its number, or kNothing. \param[in] share at most 1. */
  template <typename Accept>
  std::int64_t nearest(const Vector3& place, double share, const Accept& accept) const
  {
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

  bool holds(const Vector3& place, double share) const
  {
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
  /** \param[in] sigma the noise's deviation, at least the store's precision, local units;
   * mean_radius of the leaves. */
  CrestTracer(const ProbeIndex& index, CrestType type, const CrestParams& params, double sigma,
              bool analytic, double mean_radius);

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
  double sigma_, mean_radius_;
  double seed_radius_ = 0;  ///< of the leaves at the seed being followed
  PlaceGrid traced_;        ///< vertices of all lines so far, numbered in order
  PlaceGrid refused_;       ///< seeds that were tried already
  PlaceGrid own_;           ///< vertices of the line being traced, numbered from kMiddle both ways
  std::vector<CrestVertex> vertices_;
  std::vector<TracedLine> lines_;
  CrestStatistics statistics_;
};

}  // namespace pcl_slim::detail
