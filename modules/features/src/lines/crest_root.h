// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lines/crest_field.h"

namespace pcl_slim::detail {

/** A parabola through the values at -1, 0 and 1; a straight line where an outer one is not known. */
struct Parabola {
  double at0 = 0, slope = 0, bend = 0;

  Parabola() = default;
  Parabola(double before, double middle, double after)
      : at0(middle), slope(0.5 * (after - before)), bend(0.5 * (after + before) - middle)
  {
  }
  double operator()(double x) const { return at0 + x * (slope + x * bend); }
  double slopeAt(double x) const { return slope + 2 * bend * x; }
  /** The root between two places of different sign. */
  double rootBetween(double low, double high) const;
};

/** Three samples side by side across a line, and where between them k is largest along t. */
class CrossSection {
 public:
  CrossSection(const CrestSample* samples, const Vector3& across);

  /** Whether dk/dt passes zero, falling along t, between two samples. */
  bool hasRoot() const { return has_root_; }
  /** In units of the samples' distance, within [-1, 1]. */
  double root() const { return root_; }
  /** A Newton step from the middle; false where it goes nowhere. */
  bool newton(double& step) const;
  /** Position, frame and curvatures at the root; its fall per sample. */
  CrestVertex vertex() const;

 private:
  void search(int from);
  double between(double before, double middle, double after) const;
  Vector3 between(Vector3 CrestSample::*what) const;

  const CrestSample* samples_;
  double sense_ = 1;  ///< +1 where t points along across, else -1
  bool complete_ = false, has_root_ = false;
  double root_ = 0;
  Parabola e_;
};

}  // namespace pcl_slim::detail
