// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pcl_slim/core/vector3.h"
#include "support/lab/scenes.h"

/** \brief Exact crest lines of analytic surfaces, by brute force: what traced lines are measured
 * against. */
namespace pcl_slim::measure {

/** \brief A number with its first and second derivatives by x, y, z: formulas give gradients and
 * Hessians by themselves. */
struct Jet {
  double value = 0;
  std::array<double, 3> g{};
  std::array<double, 6> h{};  ///< xx xy xz yy yz zz

  Jet() = default;
  Jet(double constant) : value(constant) {}

  /** \brief The coordinate along an axis. */
  static Jet variable(double value, std::size_t axis) {
    Jet jet(value);
    jet.g[axis] = 1.0;
    return jet;
  }
};

/** \brief f(a, b) from f and its derivatives there: fa fb faa fab fbb. */
inline Jet applied(const Jet& a, const Jet& b, double f, const std::array<double, 5>& d) {
  Jet r(f);
  for (std::size_t i = 0, k = 0; i < 3; ++i) {
    r.g[i] = d[0] * a.g[i] + d[1] * b.g[i];
    for (std::size_t j = i; j < 3; ++j, ++k) {
      r.h[k] = d[0] * a.h[k] + d[1] * b.h[k] + d[2] * a.g[i] * a.g[j] + d[4] * b.g[i] * b.g[j] +
               d[3] * (a.g[i] * b.g[j] + a.g[j] * b.g[i]);
    }
  }
  return r;
}

inline Jet applied(const Jet& a, double f, double first, double second) {
  return applied(a, Jet(), f, {first, 0, second, 0, 0});
}

inline Jet operator+(const Jet& a, const Jet& b) {
  return applied(a, b, a.value + b.value, {1, 1, 0, 0, 0});
}

inline Jet operator-(const Jet& a, const Jet& b) {
  return applied(a, b, a.value - b.value, {1, -1, 0, 0, 0});
}

inline Jet operator*(const Jet& a, const Jet& b) {
  return applied(a, b, a.value * b.value, {b.value, a.value, 0, 1, 0});
}

inline Jet sin(const Jet& a) {
  return applied(a, std::sin(a.value), std::cos(a.value), -std::sin(a.value));
}

inline Jet cos(const Jet& a) {
  return applied(a, std::cos(a.value), -std::sin(a.value), -std::cos(a.value));
}

inline Jet pow(const Jet& a, double n) {
  return applied(a, std::pow(a.value, n), n * std::pow(a.value, n - 1),
                 n * (n - 1) * std::pow(a.value, n - 2));
}

inline Jet sqrt(const Jet& a) {
  const double root = std::sqrt(a.value);
  return applied(a, root, 0.5 / root, -0.25 / (root * a.value));
}

inline Jet atan2(const Jet& y, const Jet& x) {
  const double s = x.value * x.value + y.value * y.value, s2 = s * s;
  const double xy = 2 * x.value * y.value, diff = y.value * y.value - x.value * x.value;
  return applied(y, x, std::atan2(y.value, x.value),
                 {x.value / s, -y.value / s, -xy / s2, diff / s2, xy / s2});
}

/** \brief A closed surface: a map from the unit square and the implicit function it is the zero set
 * of. */
struct LineSurface {
  std::function<Vector3(double u, double v)> map;
  std::function<Jet(const Jet& x, const Jet& y, const Jet& z)> implicit;  ///< > 0 outside
};

/** \brief Surface by name: ellipsoid (axes 1, .8, .5), bumpy, mix (a sphere of wide bumps and fine
 * waves), box (x^10 + y^10 + z^10 = 1), wtorus (a torus with waves of 4 % on its tube), sphere,
 * torus. \return false for another name. */
bool parseLineSurface(const std::string& name, LineSurface& surface);

/** \brief Area, by a grid. */
double areaOf(const LineSurface& surface);

/** \brief count points evenly spread over the area, fixed by seed; noise as in makeScene(). */
Scene sampleSurface(const LineSurface& surface, std::size_t count, double noise,
                    double normal_noise, std::uint64_t seed);

/** \brief One kind's curvature at a pair of parameters: k, its direction and its derivative along
 * it. */
struct ExactCrest {
  Vector3 position{}, normal{}, t{};
  double k = 0, other = 0, e = 0;
};

/** \param[in] ravine k is -k2 then, and everything else turned with it. */
ExactCrest exactCrest(const LineSurface& surface, double u, double v, bool ravine);

/** \brief A piece of a line. */
using Segment = std::array<Vector3, 2>;

/** \brief Pieces of all ridges (or ravines), however weak, from a grid with a given number of cells
 * a side. */
std::vector<Segment> exactLines(const LineSurface& surface, bool ravine, std::size_t cells);

/** \brief Evenly spread points of a cube with sharp edges about the origin, with the faces' normals;
 * noise as in makeScene(). */
Scene sampleCube(double half_edge, std::size_t count, double noise, std::uint64_t seed);

/** \brief Its twelve edges, each in pieces. */
std::vector<Segment> cubeEdges(double half_edge, int pieces);

/** \brief Segments, found by place. */
class SegmentIndex {
 public:
  /** \param[in] reach the greatest distance of any query. */
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
LineScore scoreLines(const std::vector<std::vector<Segment>>& found,
                     const std::vector<std::vector<Segment>>& truth, double spacing);

}  // namespace pcl_slim::measure
