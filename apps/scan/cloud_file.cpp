// SPDX-License-Identifier: BSD-3-Clause
#include "scan/cloud_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include "pcl_slim/core/vector3.h"
#include "pcl_slim/filters/estimated_normals.h"

namespace pcl_slim {

ColorView colorsOf(const CloudFile& cloud) {
  return cloud.colorViewOf(cloud.file.cloud);
}

namespace {

/** Whether each edge is run along once in either direction. */
bool isClosed(const PointFile& mesh) {
  std::vector<std::uint64_t> edges, opposite;
  for (std::size_t f = 0; f < mesh.numFaces(); ++f) {
    const std::uint32_t begin = mesh.face_begin[f], end = mesh.face_begin[f + 1];
    for (std::uint32_t k = begin; k < end; ++k) {
      const std::uint64_t from = mesh.face_vertices[k];
      const std::uint64_t to = mesh.face_vertices[k + 1 < end ? k + 1 : begin];
      edges.push_back(from << 32 | to);
      opposite.push_back(to << 32 | from);
    }
  }
  std::sort(edges.begin(), edges.end());
  std::sort(opposite.begin(), opposite.end());
  return !edges.empty() && edges == opposite &&
         std::adjacent_find(edges.begin(), edges.end()) == edges.end();
}

/** Six times the volume that the faces enclose; below 0 where they face inwards. */
double volumeOf(const std::function<Vector3(std::uint32_t)>& position, const PointFile& mesh) {
  const Vector3 origin = position(mesh.face_vertices[0]);
  const auto corner = [&](std::uint32_t k) {
    return subtract(position(mesh.face_vertices[k]), origin);
  };
  double volume = 0.0;
  for (std::size_t f = 0; f < mesh.numFaces(); ++f) {
    const std::uint32_t begin = mesh.face_begin[f];
    for (std::uint32_t k = begin + 1; k + 1 < mesh.face_begin[f + 1]; ++k)
      volume += dot(corner(begin), cross(corner(k), corner(k + 1)));
  }
  return volume;
}

/** \brief Turns the faces of a closed mesh round if they face inwards: if every edge has two faces,
 * which run along it in opposite directions, and the volume they enclose is negative.
 * \param[in] position of a vertex \return whether it did. O(faces log faces). */
bool turnOutwards(const std::function<std::array<double, 3>(std::uint32_t)>& position,
                  PointFile& mesh) {
  if (!isClosed(mesh) || !(volumeOf(position, mesh) < 0.0)) return false;
  for (std::size_t f = 0; f < mesh.numFaces(); ++f) {
    const auto first = mesh.face_vertices.begin();
    std::reverse(first + mesh.face_begin[f], first + mesh.face_begin[f + 1]);
  }
  return true;
}

/** Sum of the faces' area vectors around each vertex, made unit; zero where there is no face. */
std::vector<float> meshNormals(const PointFile& file, const CloudView& view) {
  std::vector<std::array<double, 3>> sums(view.size);
  for (std::size_t f = 0; f < file.numFaces(); ++f) {
    const std::uint32_t* corners = file.face_vertices.data() + file.face_begin[f];
    const std::uint32_t count = file.face_begin[f + 1] - file.face_begin[f];
    if (count < 3) continue;
    const std::array<double, 3> o = view.position(corners[0]);
    std::array<double, 3> area{};
    for (std::uint32_t k = 1; k + 1 < count; ++k) {
      const std::array<double, 3> p = view.position(corners[k]), q = view.position(corners[k + 1]);
      for (std::size_t a = 0; a < 3; ++a) {
        const std::size_t b = (a + 1) % 3, c = (a + 2) % 3;
        area[a] += (p[b] - o[b]) * (q[c] - o[c]) - (p[c] - o[c]) * (q[b] - o[b]);
      }
    }
    if (!isFinite(area)) continue;
    for (std::uint32_t k = 0; k < count; ++k) {
      for (std::size_t a = 0; a < 3; ++a) sums[corners[k]][a] += area[a];
    }
  }
  std::vector<float> normals(view.size * 3, 0.0f);
  for (std::size_t i = 0; i < view.size; ++i) {
    const double length = std::hypot(sums[i][0], sums[i][1], sums[i][2]);
    if (!(length > 0.0)) continue;
    for (std::size_t a = 0; a < 3; ++a)
      normals[3 * i + a] = static_cast<float>(sums[i][a] / length);
  }
  return normals;
}

/** Takes normals of the faces where no field has them. */
void adoptMeshNormals(CloudFile& cloud) {
  if (cloud.normal_source != NormalSource::kNothing || cloud.file.numFaces() == 0) return;
  const CloudView view = cloud.view();
  cloud.turned_outwards =
      turnOutwards([&](std::uint32_t i) { return view.position(i); }, cloud.file);
  cloud.normals = meshNormals(cloud.file, view);
  cloud.normal_source = NormalSource::kMesh;
}

}  // namespace

std::array<double, 3> CloudFile::sensor() const {
  const std::array<float, 3>& at = file.sensor_origin;
  if (!isFinite(at)) return {};
  return {at[0], at[1], at[2]};
}

CloudView CloudFile::view(bool with_normals) const {
  CloudView view = viewOf(file.cloud, with_normals);
  const std::array<double, 3> at = sensor();
  // An organized cloud has its sensor even at 0, others may have none that is known.
  if (file.cloud.height > 1 || at != std::array<double, 3>{}) view.sensor = at;
  return view;
}

Result<CloudFile> loadCloudFile(const std::string& path) {
  Result<PointFile> file = loadPointFile(path);
  if (!file) return file.error();
  return asCloudFile(std::move(*file), path);
}

Result<CloudFile> asCloudFile(PointFile file, const std::string& name) {
  Result<ScanColumns> columns = ScanColumns::of(file.cloud);
  if (!columns) return badInput("'" + name + "' has no fields x y z; name a point cloud");
  CloudFile cloud;
  static_cast<ScanColumns&>(cloud) = std::move(*columns);
  cloud.file = std::move(file);
  adoptMeshNormals(cloud);
  return cloud;
}

Error estimateNormals(int k, const std::optional<std::array<double, 3>>& viewpoint, int threads,
                      CloudFile& cloud) {
  cloud.normal_source = NormalSource::kEstimated;
  return estimateNormals(cloud.view(false), k, viewpoint, threads, cloud.normals);
}

PointFile withPoints(const PointFile& file, PointTable points) {
  PointFile made;
  made.sensor_origin = file.sensor_origin;
  made.sensor_orientation = file.sensor_orientation;
  made.comments = file.comments;
  made.face_begin = file.face_begin;
  made.face_vertices = file.face_vertices;
  made.las_head = file.las_head;
  made.las_tail = file.las_tail;
  made.cloud = std::move(points);
  return made;
}

PointFile withRealFields(const PointFile& file, const std::vector<std::string>& names,
                         std::uint8_t type) {
  return withPoints(file, withRealFields(file.cloud, names, type));
}

}  // namespace pcl_slim
