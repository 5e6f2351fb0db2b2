// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <memory>

#include "pcl_slim/core/vector3.h"

namespace pcl_slim::borders {

/** \brief A place in a chart: lengths along the surface where the chart bends and does not stretch.
 */
using Flat = std::array<double, 2>;

/** \brief Where a place is beside a chart's surface. */
struct ChartFoot {
  Flat at{};
  double height = 0.0;  ///< along the normal
};

/** \brief A surface without end by two coordinates, the lengths in spacings. */
class Chart {
 public:
  virtual ~Chart() = default;
  virtual Vector3 place(const Flat& at) const = 0;
  virtual Vector3 normal(const Flat& at) const = 0;  ///< unit
  virtual ChartFoot foot(const Vector3& place) const = 0;
  /** \brief Area of the surface over that in the chart. */
  virtual double stretch(const Flat&) const { return 1.0; }
  virtual double mostStretch() const { return 1.0; }
  /** \brief After which the first coordinate repeats; 0: never. */
  virtual double period() const { return 0.0; }
};

using ChartPointer = std::shared_ptr<const Chart>;

/** \brief The plane z = height, which faces up or, with side -1, down. */
ChartPointer planeChart(double height = 0.0, double side = 1.0);
/** \brief z = 8 sin(x / 16) cos(y / 20). */
ChartPointer wavyChart();
/** \brief About the z axis: around it, along it. side -1 faces the axis. */
ChartPointer cylinderChart(double radius, double side = 1.0);
/** \brief A tube bent about the z axis: around its middle line of radius bend, along it. */
ChartPointer elbowChart(double radius, double bend);
/** \brief Two half planes that meet in the x axis at an inner angle: along it, across. */
ChartPointer wedgeChart(double angle);
/** \brief Four walls about the z axis, seen from within: around from a corner on, up. */
ChartPointer roomChart(double width, double depth);
/** \brief Around the z axis, up from the equator. */
ChartPointer sphereChart(double radius);

}  // namespace pcl_slim::borders
