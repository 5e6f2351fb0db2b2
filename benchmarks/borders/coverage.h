// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "borders/open_scenes.h"
#include "pcl_slim/mesh/triangle_mesh.h"
#include "pcl_slim/render/ray_tracer.h"

namespace pcl_slim::borders {

/** \brief What a mesh or a picture covers beside what it should; areas in squared spacings. */
struct Coverage {
  double beyond = 0.0;      ///< covered where there is no surface
  double missing = 0.0;     ///< surface that is not covered
  double deepest = 0.0;     ///< distance in it to what is covered, at most; spacings
  double truth = 0.0;       ///< surface
  std::size_t kept = 0;     ///< holes of 6 spacings and more that are open by half at least
  std::size_t to_keep = 0;  ///< such holes
};

/** \brief A sheet's chart in cells, each a quarter of a spacing wide, with a margin around. */
class CoverageGrid {
 public:
  explicit CoverageGrid(const Sheet& sheet);

  /** \brief Marks the cells whose middles are in a triangle of the chart.
   * \return false if all of the triangle is outside of the grid. */
  bool cover(std::array<Flat, 3> corners);

  /** \brief Marks the cells, four at a time, at whose middle a ray along the normal meets the
   * surface within a distance. */
  void cover(const RayTracer& tracer, const OpenScene& scene, double reach);

  void clear();
  void addTo(Coverage& sum) const;

 private:
  static constexpr double kCell = 0.25, kMargin = 8.0;
  static constexpr int kStep = 2;                                  ///< a ray covers 2 x 2 cells
  enum : std::int32_t { kOutside = -2, kAny = -1, kSurface = 0 };  ///< above: a hole's number

  Flat middle(int column, int row) const;
  std::int64_t cellAt(int column, int row) const;
  double deepestMissing() const;
  void label();
  void labelHole(std::int32_t number);

  const Sheet& sheet_;
  Flat low_{};
  int columns_ = 0, rows_ = 0;
  double cell_u_ = kCell;             ///< cells fit a period
  std::vector<std::int32_t> labels_;  ///< of cells
  std::vector<std::uint8_t> covered_;
};

/** \brief The charts of a scene in cells: what is covered of them. */
class SceneCoverage {
 public:
  explicit SceneCoverage(const OpenScene& scene);

  /** \brief By a mesh. What is farther than 1.5 spacings and two deviations of the noise from the
   * surface is beyond it. */
  Coverage ofMesh(const TriangleMesh& mesh);

  /** \brief In pictures, seen along the normals. */
  Coverage ofPicture(const RayTracer& tracer);

 private:
  static constexpr double kPart = 1.5;  ///< longest edge of parts of triangles

  double reach() const { return 1.5 + 2.0 * scene_.sigma; }
  Coverage sum() const;

  const OpenScene& scene_;
  std::vector<CoverageGrid> grids_;
};

}  // namespace pcl_slim::borders
