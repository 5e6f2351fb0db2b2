// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "borders/charts.h"
#include "pcl_slim/cloud/cloud_view.h"

/** \brief Surfaces with borders that are known exactly; lengths in mean spacings of the points. */
namespace pcl_slim::borders {

/** \brief A hole in a sheet. */
struct Hole {
  Flat centre{};
  Flat half{};         ///< half sides of a rectangle; a disc has its radius in both
  bool round = true;   ///< else a rectangle along the chart's coordinates
  bool notch = false;  ///< of a rectangle: cuts into a border from below and has no loop of its own
  bool cap = false;    ///< round in space, and not in the chart

  /** \brief Its diameter, or the lesser side. */
  double size() const;
};

/** \brief A part of a chart's surface. */
struct Sheet {
  ChartPointer chart;
  Flat low{}, high{};         ///< box of the part; in a closed chart as wide as its period
  std::vector<Flat> outline;  ///< corners of the outer border; empty: the box
  std::vector<Hole> holes;
  bool whole = false;  ///< without an outer border, as a sphere

  bool isBand() const;  ///< whether it goes all around: two outer borders, below and above
  /** \brief Whether a place is inside of the outer border and in no hole. O(holes). */
  bool contains(const Flat& at) const;
  bool isInOutline(const Flat& at) const;
  /** \brief Whether a hole contains a place once it is wider by some spacings all around. */
  bool isInHole(const Hole& hole, const Flat& at, double wider = 0.0) const;
  /** \brief Length of the borders, without holes that may be closed. */
  double borderLength() const;
};

/** \brief Holes from this diameter on must be kept; smaller ones may be closed. */
constexpr double kKeptHole = 6.0;

/** \brief How a scene's points are spread. */
enum class Sampling {
  kRandom,    ///< evenly, each on its own
  kJittered,  ///< on a grid of the chart, each moved by up to .3 each way
  kMoving,    ///< as a scanner sees a tunnel that moves along its middle: half as dense at the ends
  kProfiles   ///< on lines around, 1.6 apart, .625 apart on a line
};

struct OpenScene {
  std::string name;
  std::vector<Sheet> sheets;
  Sampling sampling = Sampling::kRandom;
  double turned = 0.0;  ///< radians about (1, 2, 3), all of it
  double sigma = 0.0;   ///< of the points' noise, isotropic

  std::vector<Vector3> points;
  std::vector<float> normals;  ///< true ones

  /** \brief Makes the points and normals, one point a unit of area. */
  void sample(double noise, std::uint64_t seed);
  CloudView view(bool with_normals) const;

  /** \brief From where the scene was turned to, to the charts; and back. */
  Vector3 toCharts(const Vector3& place) const { return rotated(place, -turned); }
  Vector3 fromCharts(const Vector3& place) const { return rotated(place, turned); }

  double borderLength() const;
  /** \brief Spacing where points are sparsest. */
  double widestSpacing() const {
    return sampling == Sampling::kMoving ? 1.42 : sampling == Sampling::kProfiles ? 1.6 : 1.0;
  }
  /** \brief Borders that a mesh must have, and those that it may have. */
  std::array<std::size_t, 2> loops() const;

 private:
  Vector3 rotated(const Vector3& place, double angle) const;
};

/** \brief Scenes without points: all, or those whose names begin with a word of the list; none if
 * no name begins with one of them. */
std::vector<OpenScene> openScenes(const std::string& words);

}  // namespace pcl_slim::borders
