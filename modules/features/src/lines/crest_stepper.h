// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "lines/crest_field.h"

namespace pcl_slim::detail {

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
  /** Where a root is searched: first at this offset from the middle of the row, then where that shows it. */
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

}  // namespace pcl_slim::detail
