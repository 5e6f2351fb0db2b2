// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/filters/slim_mesh_smoother.h"

#include <utility>

#include "pcl_slim/filters/io/point_file.h"
#include "polygon_mesh.h"

namespace pcl_slim {

namespace {

/** Indices that are no vertices stay none: the module names them. */
MeshFaces facesOf(const pcl::PolygonMesh& mesh) {
  MeshFaces faces;
  std::vector<std::uint32_t> corners;
  for (const pcl::Vertices& polygon : mesh.polygons) {
    corners.assign(polygon.vertices.begin(), polygon.vertices.end());
    faces.add(corners.data(), corners.size());
  }
  return faces;
}

constexpr const char* kNormal[3] = {"normal_x", "normal_y", "normal_z"};

}  // namespace

bool SLIMMeshSmoother::process(pcl::PolygonMesh& output) {
  clearResults();
  mesh_statistics_ = {};
  fitted_surface_.reset();
  pcl::PolygonMesh made;  // apart, because output may be the input
  const CancellableRun cancellable(control_.progress);
  const bool done = guarded("the smoothing", "smooth a smaller mesh", [&] { return smooth(made); });
  if (!done) {
    made = pcl::PolygonMesh();
    fitted_surface_.reset();
  }
  output = std::move(made);
  return done;
}

Error SLIMMeshSmoother::smooth(pcl::PolygonMesh& made) {
  const auto input = input_;
  const SurfaceConstPtr given = given_surface_;
  if (!input) return {ErrorCode::kBadInput, "no input mesh is set; call setInputMesh()"};
  const RealTriple xyz(input->cloud, kPosition), normal(input->cloud, kNormal);
  if (Error error = checkVertices(input->cloud, xyz, "the input mesh")) return error;
  std::vector<Vector3> vertices(numPoints(input->cloud));
  for (std::size_t i = 0; i < vertices.size(); ++i) vertices[i] = xyz.read(input->cloud, i);
  CloudView view;
  view.xyz = vertices.data();
  view.xyz_stride = sizeof(Vector3);
  view.scalar = CloudView::Scalar::kDouble;
  view.size = vertices.size();
  MeshSmoothParams params;
  params.fit = params_;
  params.edges = edges_;
  SmoothedMesh smoothed;
  auto fitted = std::make_shared<SLIMSurface>();
  Error error = smoothMesh(view, facesOf(*input), params, given.get(), smoothed, &mesh_statistics_,
                           fitted.get(), &control_.progress);
  statistics_ = mesh_statistics_.fit;
  if (error) return error;
  if (!given) fitted_surface_ = fitted;
  made = *input;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    if (smoothed.vertices[i] != vertices[i]) xyz.write(smoothed.vertices[i], i, made.cloud);
    const bool has_normal = smoothed.normals[i] != Vector3{};
    if (compute_normals_ && normal.found() && has_normal) {
      normal.write(smoothed.normals[i], i, made.cloud);
    }
  }
  return {};
}

}  // namespace pcl_slim
