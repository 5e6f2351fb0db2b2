// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pcl_slim/core/vector3.h"
#include "pcl_slim/fit/fit.h"
#include "pcl_slim/mesh/triangle_mesh.h"
#include "pcl_slim/query/cloud_projection.h"
#include "pcl_slim/splat/splat_set.h"
#include "rivals/point_tree.h"

/** \brief What faces the right way, of all that the library makes of a scan. */
namespace pcl_slim::sides {

/** \brief The sides of a scan. Points, sensors and normals must outlive it. */
class Truth {
 public:
  /** \param[in] points all finite
   * \param[in] normals true, of each point; zero: its side is not judged; or none
   * \param[in] sensors one place, one for each point, or none: then the side is that of normals */
  Truth(const std::vector<Vector3>& points, const std::vector<Vector3>& normals,
        const std::vector<Vector3>& sensors);

  bool known() const { return !sensors_.empty() || !normals_.empty(); }

  /** \brief Cosine between a normal at a place and the direction to the sensor of the nearest point
   * or, without sensors, that point's true normal. 0 if the side is not judged: nothing is known, or
   * the normal is more than 60 degrees off the true line, as at edges and in noise. */
  double cosine(const Vector3& place, const Vector3& normal) const;
  /** \brief The same of a point. */
  double cosineOf(std::size_t point, const Vector3& place, const Vector3& normal) const;

 private:
  const std::vector<Vector3>& normals_;
  const std::vector<Vector3>& sensors_;
  std::optional<rivals::PointTree> tree_;  ///< where the nearest point matters
};

/** \brief Weight of what faces the right way, and of all that is judged. */
struct Share {
  double right = 0, judged = 0;

  void add(double cosine, double weight) {
    if (cosine == 0) return;
    judged += weight;
    if (cosine > 0) right += weight;
  }
  /** \brief In percent; NAN of nothing. */
  double percent() const { return 100 * right / judged; }
};

/** \brief Leaves by the area of their balls' great circles. */
Share facingLeaves(const SLIMSurface& surface, const Truth& truth);

/** \brief Supported points, each against its own side. \param[in] kept indices of the truth's
 * points in the projected cloud */
Share facingPoints(const CloudProjection& projection, const std::vector<std::size_t>& kept,
                   const Truth& truth);

/** \brief Splats by the number of points behind them. */
Share facingSplats(const SplatSet& splats, const Truth& truth);

/** \brief Triangles by area. */
struct MeshSides {
  Share all;
  double wrong_components =
      0;  ///< % of the area, in components more than half of which face wrongly
};

MeshSides facingMesh(const TriangleMesh& mesh, const Truth& truth);

}  // namespace pcl_slim::sides
