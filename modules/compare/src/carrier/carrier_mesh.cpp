// SPDX-License-Identifier: BSD-3-Clause
// Short-edged triangles of a surface or a mesh, as places with their areas.
#include "pcl_slim/compare/carrier_mesh.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "carrier/split_edges.h"
#include "pcl_slim/cloud/cloud_view.h"
#include "pcl_slim/compare/triangle_index.h"
#include "pcl_slim/core/order_statistics.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/mesh/mesh_extraction.h"
#include "pcl_slim/query/cloud_projection.h"
#include "pcl_slim/query/leaf_noise.h"

namespace pcl_slim {

using namespace detail;
namespace {

/** Area of a vertex over the square of the longest edge: divided edges are between half of it and
 * all of it, and an even triangulation with edges e has .87 e^2 a vertex. */
constexpr double kAreaOfVertex = 0.45;
constexpr double kEdgeSpacings = 2.0;  ///< the longest edge by default [spacings of the points]

/** The longest edge with which an area gets no more places than are allowed. */
double edgeFor(double area, std::uint64_t most_places) {
  return std::sqrt(area / (kAreaOfVertex * static_cast<double>(most_places)));
}

Error noArea() {
  return {ErrorCode::kBadInput, "the mesh has no triangle with an area; give one that has"};
}

/** Divides long edges and fills what follows from the triangles alone. */
Error complete(CarrierMesh& made) {
  if (!(made.longest_edge > 0.0) || !std::isfinite(made.longest_edge)) return noArea();
  splitLongEdges(made.longest_edge, made.mesh);
  Result<DeviationCarrier> carrier = carrierOf(made.mesh);
  if (!carrier) return carrier.error();
  made.carrier = std::move(*carrier);
  return {};
}

/** The vertices as a cloud that is projected. */
CloudView viewOf(const TriangleMesh& mesh) {
  CloudView view;
  view.xyz = mesh.vertices.data();
  view.xyz_stride = sizeof(mesh.vertices[0]);
  view.scalar = CloudView::Scalar::kDouble;
  view.normal = mesh.normals.data();
  view.normal_stride = sizeof(mesh.normals[0]);
  view.size = mesh.vertices.size();
  return view;
}

/** Unit normals of vertices: the sum of the triangles' area vectors around each; zero where that
 * is. */
std::vector<std::array<float, 3>> normalsOf(const TriangleMesh& mesh) {
  std::vector<Vector3> sums(mesh.vertices.size());
  for (const auto& t : mesh.triangles) {
    const Vector3& a = mesh.vertices[t[0]];
    const Vector3 area = cross(subtract(mesh.vertices[t[1]], a), subtract(mesh.vertices[t[2]], a));
    if (!isFinite(area)) continue;
    for (const std::uint32_t v : t) sums[v] = along(sums[v], 1.0, area);
  }
  std::vector<std::array<float, 3>> normals(sums.size());
  for (std::size_t v = 0; v < sums.size(); ++v) {
    const Vector3 unit = normalized(sums[v]);
    for (std::size_t a = 0; a < 3; ++a) normals[v][a] = static_cast<float>(unit[a]);
  }
  return normals;
}

}  // namespace

Error CarrierParams::validate() const {
  const auto bad = [](const char* what) { return Error{ErrorCode::kBadArgument, what}; };
  if (!(longest_edge >= 0.0 && std::isfinite(longest_edge)))
    return bad("the longest edge must be a finite length of 0 or more");
  if (most_places < 3) return bad("the number of places must be 3 or more");
  if (!(min_component_points >= 0.0))
    return bad("the least number of points of a component must be 0 or more");
  return checkThreads(threads);
}

double longestEdgeFor(const SLIMSurface& surface) {
  std::vector<double> spacings;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    if (surface.isLeaf(i)) spacings.push_back(leafSpacing(surface, i));
  }
  return spacings.empty() ? 0 : kEdgeSpacings * surface.info.scale * median(spacings);
}

Result<CarrierMesh> carrierMeshOf(const SLIMSurface& surface, const CarrierParams& params,
                                  Progress* progress) {
  if (Error error = params.validate()) return error;
  MeshParams extraction;
  extraction.hole_size = 0.0;  // what closes a hole is no part of the object that was measured
  extraction.min_component_points = params.min_component_points;
  extraction.threads = params.threads;
  CarrierMesh made;
  if (Error error = extractMesh(surface, extraction, made.mesh, nullptr, progress)) return error;
  made.area = areaOf(made.mesh);
  const double points = std::max(1.0, static_cast<double>(surface.info.num_points));
  made.longest_edge = params.longest_edge > 0.0 ? params.longest_edge
                                                : kEdgeSpacings * std::sqrt(made.area / points);
  made.longest_edge = std::max(made.longest_edge, edgeFor(made.area, params.most_places));
  if (Error error = complete(made)) return error;

  // Middles of edges are beside the surface by up to the mesh's tolerance, which may be more than
  // the surface's own error.
  const CloudView view = viewOf(made.mesh);
  CloudProjectionParams projecting;
  projecting.projection.threads = params.threads;
  projecting.projection.errors = true;
  const Result<CloudProjection> projection =
      CloudProjection::make(view, surface, projecting, progress);
  if (!projection) return projection.error();
  made.places = placesOf(view, *projection, surface, ScanPlaces::kMoved, params.threads);
  made.mesh.vertices = made.places.positions;
  for (std::size_t i = 0; i < made.places.size(); ++i) {
    if (projection->isSupported(i))
      made.mesh.normals[i] = made.places.normals[i];
    else
      made.places.normals[i] = made.mesh.normals[i];
  }
  return made;
}

Result<CarrierMesh> carrierMeshOf(const TriangleMesh& mesh, const CarrierParams& params) {
  if (Error error = params.validate()) return error;
  // It joins corners of one place, which meshes of STL files have many of.
  const Result<TriangleIndex> index = TriangleIndex::make(mesh, params.threads);
  if (!index) return index.error();
  CarrierMesh made;
  made.mesh.vertices = mesh.vertices;
  made.mesh.triangles = mesh.triangles;
  if (mesh.sigma.size() == mesh.vertices.size()) made.mesh.sigma = mesh.sigma;
  made.area = areaOf(mesh);
  made.longest_edge = std::max(params.longest_edge, edgeFor(made.area, params.most_places));
  if (Error error = complete(made)) return error;
  made.places.positions = made.mesh.vertices;
  made.places.normals = made.mesh.normals = normalsOf(made.mesh);
  made.places.sigma = made.mesh.sigma;
  made.places.oriented = index->statistics().oriented();
  return made;
}

}  // namespace pcl_slim
