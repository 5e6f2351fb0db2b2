// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/filters/slim_mesh_smoother.h"

#include <cstring>
#include <utility>

#include "pcl_slim/filters/io/point_file.h"

namespace pcl_slim {

namespace {

/** Three fields of a cloud, of type float or double. */
class RealTriple {
 public:
  RealTriple(const pcl::PCLPointCloud2& cloud, const char* const (&names)[3]) {
    for (const char* name : names) {
      const int i = findField(cloud, name);
      if (i < 0) return;
      const pcl::PCLPointField& field = cloud.fields[static_cast<std::size_t>(i)];
      const bool is_double = field.datatype == pcl::PCLPointField::FLOAT64;
      if (!is_double && field.datatype != pcl::PCLPointField::FLOAT32) return;
      fields_.push_back({field.offset, is_double});
    }
  }

  bool found() const { return fields_.size() == 3; }

  Vector3 read(const pcl::PCLPointCloud2& cloud, std::size_t i) const {
    Vector3 value{};
    for (std::size_t a = 0; a < 3; ++a) {
      const auto* at = cloud.data.data() + i * cloud.point_step + fields_[a].offset;
      float single = 0;
      if (fields_[a].is_double) {
        std::memcpy(&value[a], at, sizeof(double));
        continue;
      }
      std::memcpy(&single, at, sizeof(single));
      value[a] = single;
    }
    return value;
  }

  void write(const Vector3& value, std::size_t i, pcl::PCLPointCloud2& cloud) const {
    for (std::size_t a = 0; a < 3; ++a) {
      auto* at = cloud.data.data() + i * cloud.point_step + fields_[a].offset;
      const auto single = static_cast<float>(value[a]);
      if (fields_[a].is_double)
        std::memcpy(at, &value[a], sizeof(double));
      else
        std::memcpy(at, &single, sizeof(single));
    }
  }

 private:
  struct Place {
    std::size_t offset;
    bool is_double;
  };
  std::vector<Place> fields_;
};

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

Error checkCloud(const pcl::PCLPointCloud2& cloud, const RealTriple& xyz) {
  if (numPoints(cloud) == 0) {
    return {ErrorCode::kBadInput, "the input mesh has no vertices; give one that has"};
  }
  if (!xyz.found()) {
    return {ErrorCode::kBadInput,
            "the input mesh has no fields x y z of type float or double; give it such"};
  }
  if (cloud.data.size() < numPoints(cloud) * cloud.point_step) {
    return {ErrorCode::kBadInput, "the input mesh has less data than vertices; make it again"};
  }
  return {};
}

constexpr const char* kPosition[3] = {"x", "y", "z"};
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
  if (Error error = checkCloud(input->cloud, xyz)) return error;
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
