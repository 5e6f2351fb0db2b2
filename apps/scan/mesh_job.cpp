// SPDX-License-Identifier: BSD-3-Clause
#include "scan/mesh_job.h"

#include "common/program.h"
#include "scan/cloud_fields.h"

namespace pcl_slim {

namespace {

void
reportMesh(const MeshSmoothStatistics& s, Report& report)
{
  report.add({{"faces", s.faces},
              {"faces_left_out", s.faces_left_out},
              {"faces_unsupported", s.faces_unsupported},
              {"disagreeing_edges", s.disagreeing_edges},
              {"nonmanifold_edges", s.nonmanifold_edges},
              {"moved", s.moved},
              {"isolated", s.isolated},
              {"non_finite", s.non_finite},
              {"held", s.held},
              {"sharp", s.sharp},
              {"sharp_share", s.sharp_share},
              {"noise", s.noise},
              {"leaves", s.fit.leaves},
              {"rms_displacement", s.rms_displacement},
              {"max_displacement", s.max_displacement}});
}

void
note(std::uint64_t count, const char* one, const char* many, Console& console)
{
  if (count > 0) console.note("  " + std::to_string(count) + (count == 1 ? one : many));
}

void
writeTriples(const std::vector<Vector3>& values, const char* const (&names)[3],
             pcl::PCLPointCloud2& cloud)
{
  for (std::size_t a = 0; a < 3; ++a) {
    const FieldWriter field(cloud, names[a]);
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (values[i] != Vector3{}) field.set(i, values[i][a]);
    }
  }
}

PointFile
meshFile(const MeshJob& job, const CloudFile& cloud, const SmoothedMesh& mesh)
{
  constexpr const char* kPosition[3] = {"x", "y", "z"};
  constexpr const char* kNormal[3] = {"normal_x", "normal_y", "normal_z"};
  // Whole-number coordinates cannot hold where the vertices go.
  PointFile made = withRealFields(cloud.file, {"x", "y", "z"}, pcl::PCLPointField::FLOAT64);
  for (std::size_t a = 0; a < 3; ++a) {
    const FieldWriter field(made.cloud, kPosition[a]);
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) field.set(i, mesh.vertices[i][a]);
  }
  if (!job.normals) return made;
  made = withRealFields(made, {kNormal[0], kNormal[1], kNormal[2]}, pcl::PCLPointField::FLOAT32);
  writeTriples(mesh.normals, kNormal, made.cloud);
  return made;
}

}  // namespace

Result<PointFile>
smoothMeshFile(const MeshJob& job, const CloudFile& cloud, Console& console, Report& report)
{
  console.begin("Smoothing the mesh");
  MeshFaces faces;
  faces.begin = cloud.file.face_begin;
  faces.corners = cloud.file.face_vertices;
  SmoothedMesh mesh;
  MeshSmoothStatistics s;
  const Error error = smoothMesh(cloud.view(false), faces, job.params, job.surface, mesh, &s,
                                 nullptr, &console.progress());
  if (error) return console.failed(error);
  report.time("smooth", console.seconds());
  reportMesh(s, report);
  if (job.surface == nullptr) report.json()["lambda"] = s.fit.lambda;
  console.done(std::to_string(s.moved) + " vertices" + (s.sharp ? ", sharp edges kept" : ""));
  note(s.faces_left_out, " face left out", " faces left out", console);
  note(s.isolated, " vertex without faces stays", " vertices without faces stay", console);
  note(s.disagreeing_edges, " edge whose faces disagree about their side",
       " edges whose faces disagree about their side", console);
  return meshFile(job, cloud, mesh);
}

}  // namespace pcl_slim
