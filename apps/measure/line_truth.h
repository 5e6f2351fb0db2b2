// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "measure/jet.h"
#include "measure/scenes.h"
#include "pcl_slim/core/vector3.h"

/** \brief Exact crest lines of analytic surfaces, by brute force: what traced lines are measured against. */
namespace pcl_slim::measure {

/** \brief A closed surface: a map from the unit square and the implicit function it is the zero set of. */
struct LineSurface {
  std::function<Vector3(double u, double v)> map;
  std::function<Jet(const Jet& x, const Jet& y, const Jet& z)> implicit;  ///< > 0 outside
};

/** \brief Surface by name: ellipsoid (axes 1, .8, .5), bumpy, mix (a sphere of wide bumps and fine waves), box
 * (x^10 + y^10 + z^10 = 1), wtorus (a torus with waves of 4 % on its tube), sphere, torus. \return false for another name. */
bool
parseLineSurface(const std::string& name, LineSurface& surface);

/** \brief Area, by a grid. */
double
areaOf(const LineSurface& surface);

/** \brief count points evenly spread over the area, fixed by seed; noise as in makeScene(). */
Scene
sampleSurface(const LineSurface& surface, std::size_t count, double noise, double normal_noise,
              std::uint64_t seed);

/** \brief One kind's curvature where a parameter pair lies: k and its direction and derivative along it. */
struct ExactCrest {
  Vector3 position{}, normal{}, t{};
  double k = 0, other = 0, e = 0;
};

/** \param[in] ravine k is -k2 then, and everything else turned with it. */
ExactCrest
exactCrest(const LineSurface& surface, double u, double v, bool ravine);

/** \brief A piece of a line. */
using Segment = std::array<Vector3, 2>;

/** \brief Pieces of all ridges (or ravines), however weak, from a grid of so many cells a side. */
std::vector<Segment>
exactLines(const LineSurface& surface, bool ravine, std::size_t cells);

/** \brief Segments, found by place. */
class SegmentIndex {
 public:
  /** \param[in] reach the greatest distance that will be asked for. */
  SegmentIndex(std::vector<Segment> segments, double reach);
  ~SegmentIndex();
  SegmentIndex(SegmentIndex&&) noexcept;

  /** \brief Distance to the nearest segment, or reach where none is nearer. */
  double distance(const Vector3& p) const;
  double totalLength() const;
  const std::vector<Segment>& segments() const;

 private:
  struct Cells;
  std::vector<Segment> segments_;
  double reach_;
  std::unique_ptr<Cells> cells_;
};

/** \brief How found lines and true ones agree, lengths in the scene's units. */
struct LineScore {
  double found_length = 0, true_length = 0;
  double rms = 0;  ///< distance from the truth of the found length within 3 spacings, in spacings
  double found1 = 0, found3 = 0;  ///< share of true length with a line within 1, 3 spacings
  double off1 = 0, off3 = 0;      ///< share of found length farther than that from the truth
};

/** \brief Compares lines of one kind or, summed over both, of two.
 * \param[in] found,truth a list of segments each kind. */
LineScore
scoreLines(const std::vector<std::vector<Segment>>& found,
           const std::vector<std::vector<Segment>>& truth, double spacing);

}  // namespace pcl_slim::measure
