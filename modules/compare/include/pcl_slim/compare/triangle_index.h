// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/core/progress.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/mesh/triangle_mesh.h"

namespace pcl_slim {

/** \brief The part of a triangle that a foot is on. */
enum class TrianglePart : std::uint8_t { kFace, kEdge, kVertex };

/** \brief The place of a triangle mesh that is nearest to a place in space. */
struct TriangleFoot {
  static constexpr std::uint32_t kNone = 0xffffffffu;

  std::uint32_t triangle = kNone;  ///< in the mesh; kNone: no triangle is within the bound
  TrianglePart part = TrianglePart::kFace;
  bool border = false;              ///< on an edge of one triangle, or on an end of such an edge
  double distance = 0;              ///< signed; positive on the side of normal
  Vector3 position{};               ///< world coordinates
  Vector3 normal{};                 ///< unit, angle-weighted on edges and vertices
  std::array<double, 3> weights{};  ///< barycentric, of the triangle's three corners

  bool found() const { return triangle != kNone; }
};

/** \brief What a TriangleIndex found in its mesh. */
struct TriangleIndexStatistics {
  std::uint64_t triangles = 0;     ///< of the mesh
  std::uint64_t dropped = 0;       ///< a corner is not finite, or two corners are one place
  std::uint64_t flat = 0;          ///< three corners on a line: they have no normal of their own
  std::uint64_t vertices = 0;      ///< different places of corners
  std::uint64_t border_edges = 0;  ///< edges of one triangle
  std::uint64_t nonmanifold_edges = 0;  ///< edges of more than two triangles
  std::uint64_t turned_edges = 0;       ///< run in the same direction by both of their triangles
  double volume = 0;  ///< signed, world units; positive where normals point outwards

  /** \brief Whether the mesh has an inside, so that the sign of a distance means in or out. */
  bool closed() const { return border_edges == 0 && nonmanifold_edges == 0 && turned_edges == 0; }
  /** \brief Whether neighbouring triangles are turned to the same side. */
  bool oriented() const { return turned_edges == 0 && triangles > dropped + flat; }
};

/** \brief Exact nearest places on a triangle mesh.
 *
 * Distances are those to the triangles, in double precision relative to the middle of the mesh, so
 * that coordinates of surveys lose nothing. Their signs are those of angle-weighted pseudo-normals:
 * the sum of both triangles' normals on an edge, the sum of normals times angles on a vertex, which
 * is right everywhere about a closed mesh (Baerentzen and Aanaes, Signed distance computation using
 * the angle weighted pseudonormal, TVCG 2005). For that purpose corners of equal coordinates count
 * as one vertex, as those of STL files must. Triangles with three corners on a line count as places,
 * and pass on the normals of their neighbours.
 *
 * A tree of boxes, eight children a node, made by the surface area heuristic (Wald, On fast
 * construction of SAH-based bounding volume hierarchies, 2007): O(T log T) time and some 250 bytes a
 * triangle. A search is O(log T) for places near the mesh. The mesh is copied. Searches may run in
 * any number of threads. */
class PCL_SLIM_EXPORT TriangleIndex {
 public:
  /** \return an error for a mesh without a triangle that has a place, an invalid mesh, or
   * cancellation. */
  static Result<TriangleIndex> make(const TriangleMesh& mesh, int threads = 0,
                                    Progress* progress = nullptr);
  TriangleIndex(TriangleIndex&&) noexcept;
  TriangleIndex& operator=(TriangleIndex&&) noexcept;
  ~TriangleIndex();

  const TriangleIndexStatistics& statistics() const;
  /** \brief The box around the triangles, world coordinates. */
  const Bounds& bounds() const;
  std::size_t memoryBytes() const;

  /** \brief The nearest place.
   * \param[in] place world coordinates, finite \param[in] most_distance farther places are not
   * found \param[in] side not null: of triangles that face as this direction does, cosine > 0
   * \param[in] hint a triangle that is probably near, as a neighbour's foot is; kNone: none. It
   * shortens the search and changes the result only among places that are equally near. */
  TriangleFoot nearest(const Vector3& place, double most_distance = Bounds::kInfinity,
                       const Vector3* side = nullptr,
                       std::uint32_t hint = TriangleFoot::kNone) const;

  /** \brief The nearest place of each of some places, which are treated in Morton order.
   * \param[in] sides empty, or a direction for each place, as above. A place that is not finite has
   * no foot. Same result for any number of threads. */
  std::vector<TriangleFoot> nearest(const std::vector<Vector3>& places,
                                    double most_distance = Bounds::kInfinity,
                                    const std::vector<Vector3>& sides = {}, int threads = 0) const;

 private:
  struct Data;
  explicit TriangleIndex(std::unique_ptr<Data> data);
  std::unique_ptr<Data> data_;
};

}  // namespace pcl_slim
