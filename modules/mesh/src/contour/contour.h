// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/mesh/detail/mesh_topology.h"
#include "pcl_slim/query/surface_probe.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim::detail {

/** A surface with what all steps of an extraction need to evaluate it. */
struct ProbeField {
  const ProbeIndex& index;
  double margin;  ///< how far around sixteen places leaves are looked for ahead, local units
  int threads;
};

/** Calls body(probe, first, count) for each sixteen of some places, which are in Morton order. Runs
 * of them that share the leaves found begin at fixed places: results are the same for any number of
 * threads. */
template <typename Body>
void forProbeBlocks(const ProbeField& field, std::size_t places, const Body& body) {
  constexpr std::size_t kBlock = SurfaceProbe::kMost, kRun = 64 * kBlock;
  std::vector<std::unique_ptr<SurfaceProbe>> probes(static_cast<std::size_t>(field.threads));
  parallelFor((places + kRun - 1) / kRun, field.threads, 1, [&](std::size_t run, int thread) {
    auto& probe = probes[static_cast<std::size_t>(thread)];
    if (!probe) probe = std::make_unique<SurfaceProbe>(field.index);
    probe->restart(field.margin);
    const std::size_t end = std::min(places, (run + 1) * kRun);
    for (std::size_t first = run * kRun; first < end; first += kBlock) {
      body(*probe, first, std::min(kBlock, end - first));
    }
  });
}

/** Where the borders in a trim map are: how many nodes differ from the next one, up to each row and
 * column. Nodes far from the leaf's centre are left out, as other leaves know the border there
 * better. */
class BorderTable {
 public:
  BorderTable() = default;
  explicit BorderTable(const TrimMap& map);

  bool empty() const { return side_ == 0; }
  /** Whether there is a border in a rectangle of the leaf's (u, v) plane. O(1).
   * \param[in] at its middle \param[in] reach half its sides, both in radii */
  bool any(const double (&at)[2], const double (&reach)[2]) const;

 private:
  int side_ = 0;
  std::vector<std::uint16_t> counts_;
};

/** A leaf of the surface as the octree sees it, local units. */
struct LeafShape {
  std::array<float, 3> center;
  std::array<float, 3> u, v, w;
  float radius;
  float cell_size;        ///< cells on its sheet are to be no wider ...
  float least;            ///< ... unless their halves would be narrower than this
  float border_size = 0;  ///< cells near a border are to be no wider than this
  int degree;
  const float* c;
  BorderTable borders;  ///< empty where the leaf is closed, or borders do not matter
};

/** The leaves of a surface with the cells' sizes that keep a mesh within a tolerance (local units):
 * sqrt(4 tolerance / k) for the largest curvature k, a Frobenius norm, on the leaf, and at most .6
 * of its radius; and no less than least_spacings spacings of its points. With `trim`, cells at the
 * borders of trim maps are no wider than three of a map's nodes, however flat the leaf is. */
std::vector<LeafShape> shapesOf(const SLIMSurface& surface, double tolerance, double least_spacings,
                                bool trim, int threads);

/** Whether a border of an open leaf passes a cell, or passes it by at less than half its width: so
 * cells grow with the distance from a border, and no long edge crosses one. O(1). */
bool isNearBorder(const LeafShape& leaf, const Vector3& middle, double size);

/** The width of a cell such that cells of that width times powers of two, none wider than the
 * leaves on it allow, are as few as possible. O(shapes). */
double thriftyCellSize(const std::vector<LeafShape>& shapes);

/** A cell by its lowest corner, in units of the finest cells that a tree may have. */
struct CellPlace {
  std::uint32_t low[3] = {0, 0, 0};
  std::uint32_t depth = 0;
};

/** A cell that is not divided, or a node above some. */
struct CellNode {
  std::uint32_t first_child = 0;  ///< of eight, x highest; 0: not divided
  std::uint32_t cell = 0;         ///< number among the cells not divided, in Morton order
  bool near = false;              ///< a leaf's sheet passes it, or may
  bool fresh = false;             ///< made by the last split(), or above such
};

/** An octree over the leaves of a surface. */
class CellTree {
 public:
  static constexpr std::uint32_t kMostDepth = 20;  ///< corners have twenty bits and a half

  /** Divides cells until none is wider than the leaves on it allow. \return an error where there
   * would be too many. O(cells times leaves near each); the same for any number of threads. */
  Error build(const std::vector<LeafShape>& shapes, int threads);

  static constexpr std::uint32_t kDivided = 0xffffffffu;

  /** Divides more cells, by their numbers. \return of each cell its number from now on, or
   * kDivided. */
  std::vector<std::uint32_t> split(const std::vector<std::uint32_t>& cells);

  const std::vector<CellNode>& nodes() const { return nodes_; }
  /** Cells not divided, in Morton order. */
  const std::vector<CellPlace>& cells() const { return cells_; }
  std::uint64_t numNear() const;

  static std::uint32_t width(std::uint32_t depth) { return 1u << (kMostDepth - depth); }
  double size(std::uint32_t depth) const { return unit_ * width(depth); }
  Vector3 corner(const std::uint32_t (&place)[3]) const {
    return {low_[0] + unit_ * place[0], low_[1] + unit_ * place[1], low_[2] + unit_ * place[2]};
  }
  static CellPlace child(const CellPlace& parent, unsigned int octant);

 private:
  void place(const std::vector<LeafShape>& shapes);
  void number();

  Vector3 low_{};
  double unit_ = 0;  ///< width of the finest cells
  std::vector<CellNode> nodes_;
  std::vector<CellPlace> cells_;
};

/** An edge of an octree's cells that no finer cell divides. */
struct CellEdge {
  /** The cells around it, counter-clockwise as seen from the edge's upper end; a coarse cell whose
   * face contains the edge is listed twice. */
  std::uint32_t cell[4];
  std::uint32_t low[3];  ///< its lower end
  std::uint8_t axis;
  std::uint8_t depth;  ///< of cells as wide as the edge is long
};

/** All such edges with a cell about them that a sheet passes, in a fixed order. O(nodes).
 * \param[in] fresh_only only those of cells that the last split() has made. O(those and nodes
 * above). */
std::vector<CellEdge> cellEdges(const CellTree& tree, bool fresh_only = false);

/** Signed distances at corners of cells, evaluated once each and kept while cells are divided. */
class CornerValues {
 public:
  explicit CornerValues(const ProbeField& field) : field_(field) {}

  /** Evaluates the ends of edges where that is not done yet. \return of each edge its lower and
   * upper end, as places in values() until the next call. O(corners), and a probe's time for each
   * new corner. */
  std::vector<std::array<std::uint32_t, 2>> evaluate(const CellTree& tree,
                                                     const std::vector<CellEdge>& edges);

  const std::vector<SheetDistance>& values() const { return values_; }

 private:
  void merge(const CellTree& tree, const std::vector<std::uint64_t>& keys);

  const ProbeField& field_;
  std::vector<std::uint64_t> keys_;  ///< Morton codes of corners, ascending
  std::vector<SheetDistance> values_;
};

/** Where the surface crosses an edge of the cells. */
struct EdgeCrossing {
  std::uint32_t cell[4];  ///< as of the edge, counter-clockwise as seen from the normal's side
  Vector3 position, normal;
  float size;  ///< of the edge
};

/** Appends the edges at whose ends the surface's distance has different signs, but for jumps from
 * one sheet to another. Ends whose normals oppose each other are turned to agree first where the
 * surface is not oriented. O(edges). */
void findCrossings(const CellTree& tree, const std::vector<CellEdge>& edges,
                   const std::vector<std::array<std::uint32_t, 2>>& ends,
                   const std::vector<SheetDistance>& values, bool oriented,
                   std::vector<EdgeCrossing>& crossings);

/** One vertex for each sheet of surface in a cell, before it is put onto the surface. */
struct SheetVertices {
  std::vector<std::array<std::uint32_t, 4>> of_crossing;  ///< in the cells around each crossing
  std::vector<std::uint32_t> cell;                        ///< of each vertex, ascending
  std::vector<Vector3> position;                          ///< mean of its crossings
  std::vector<Vector3> normal;                            ///< mean, unit
  std::vector<float> size;                                ///< least edge that it crosses
};

/** Crossings on the border of the face between two cells are linked in pairs, by curves of the
 * surface in that face; crossings linked in a cell are of one sheet there. So each edge of the
 * mesh, a curve in a face, borders two faces of the mesh, its crossings, unless a sheet ends there.
 * O(crossings). */
SheetVertices findSheetVertices(const std::vector<EdgeCrossing>& crossings, bool oriented,
                                int threads);

/** The cells of vertices on edges that more than two faces share, ascending. O(faces log faces). */
std::vector<std::uint32_t> crowdedCells(const SheetVertices& vertices, int threads);

/** The faces around crossings as triangles. Quadrilaterals are cut along the diagonal whose
 * triangles face their vertices' normals best; along the shorter one where both do well. O(faces).
 */
std::vector<Triangle> cutIntoTriangles(const std::vector<std::array<std::uint32_t, 4>>& faces,
                                       const std::vector<Vector3>& positions,
                                       const std::vector<Vector3>& normals);

}  // namespace pcl_slim::detail
