// SPDX-License-Identifier: BSD-3-Clause
// pcl_slim_smooth: moves a scan's points onto its SLIM surface; every other field stays.
#include <string>
#include <utility>
#include <vector>

#include "common/file_program.h"
#include "common/programs.h"
#include "pcl_slim/filters/table/projected_fields.h"
#include "pcl_slim/mesh/mesh_smoothing.h"
#include "projection/piece_stream.h"
#include "projection/projection_job.h"

namespace {

using namespace pcl_slim;

struct Settings {
  ProjectionJob job;
  bool mesh = false;         ///< smooth the scan's faces in place of its points
  bool sharp_given = false;  ///< the user chose how edges of a mesh are treated
};

OptionTable declareOptions(Settings& s) {
  OptionTable options = programOptions("pcl_slim_smooth");
  options.toggle("normals", &s.job.more_fields,
                 "also write the surface's normals and PCL's curvature; of a mesh, normals alone");
  options.toggle(
      "variation", &s.job.projection.variation,
      "with -normals: PCL's curvature, too, which is a third of the time; 0: normals alone");
  options.toggle("curvatures", &s.job.curvatures,
                 "also write k1 k2 mean_curvature gaussian_curvature of the surface");
  options.toggle("errors", &s.job.errors,
                 "also write standard errors: sigma_position along the normal, in the scan's unit, "
                 "and sigma_normal [rad]");
  options.toggle("mesh", &s.mesh,
                 "smooth the faces of a mesh, not its points; -sharp 0 or 1: round or keep all "
                 "edges, else as measured");
  declareProjection(options, s.job);
  // A mesh has its normals, and their sides, from its faces.
  options.exclusive({"mesh", "curvatures"});
  options.exclusive({"mesh", "errors"});
  for (const char* name : {"normals_as_data", "normal_error", "viewpoint", "trajectory", "frames",
                           "estimate_normals", "use_normals"}) {
    options.exclusive({"mesh", name});
  }
  return options;
}

/** Completes the settings and checks what can be checked before the input is read. */
Error finishSettings(const OptionTable& options, Settings& s) {
  s.sharp_given = options.given("sharp");
  s.job.projection.planes = s.job.more_fields;
  s.job.projection.directions = s.job.curvatures;
  s.job.projection.errors = s.job.errors;
  if (Error error = finishProjection(options, s.job)) return error;
  if (!s.mesh || !s.job.tiles.asked) return {};
  return {ErrorCode::kBadArgument, "-mesh is not possible by tiles: give -tile_points 0"};
}

/** The scan's points on the surface, with normals and curvatures where they are wanted. */
PointFile smoothed(const PointFile& file, const CloudProjection& projection,
                   const ProjectionJob& job) {
  std::vector<std::string> names = {"x", "y", "z"};
  if (job.more_fields) names.insert(names.end(), {"normal_x", "normal_y", "normal_z"});
  if (job.more_fields && job.projection.variation && !job.in_pieces)
    names.emplace_back("curvature");
  if (job.curvatures)
    names.insert(names.end(), {"k1", "k2", "mean_curvature", "gaussian_curvature"});
  if (job.errors) names.insert(names.end(), {"sigma_position", "sigma_normal"});
  return withPoints(file, withProjected(file.cloud, projection, names, job.projection.threads));
}

void reportMesh(const MeshSmoothStatistics& s, Report& report) {
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

void note(std::uint64_t count, const char* one, const char* many, Console& console) {
  if (count > 0) console.note("  " + std::to_string(count) + (count == 1 ? one : many));
}

void writeTriples(const std::vector<Vector3>& values, const char* const (&names)[3],
                  PointTable& cloud) {
  for (std::size_t a = 0; a < 3; ++a) {
    const FieldWriter field(cloud, names[a]);
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (values[i] != Vector3{}) field.set(i, values[i][a]);
    }
  }
}

/** The file to write: the scan with new x y z; its faces and every other field are kept. */
PointFile meshFile(const CloudFile& cloud, const SmoothedMesh& mesh, bool normals) {
  constexpr const char* kPosition[3] = {"x", "y", "z"};
  constexpr const char* kNormal[3] = {"normal_x", "normal_y", "normal_z"};
  // Integer coordinates cannot represent the vertices' new positions.
  PointFile made = withRealFields(cloud.file, {"x", "y", "z"}, kFloat64);
  for (std::size_t a = 0; a < 3; ++a) {
    const FieldWriter field(made.cloud, kPosition[a]);
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) field.set(i, mesh.vertices[i][a]);
  }
  if (!normals) return made;
  made = withRealFields(made, {kNormal[0], kNormal[1], kNormal[2]}, kFloat32);
  writeTriples(mesh.normals, kNormal, made.cloud);
  return made;
}

/** Smooths the scan's mesh; prints and reports it. \param[in] surface in place of a fit, or null.
 */
Result<PointFile> smoothFaces(const Settings& s, const CloudFile& scan, const SLIMSurface* surface,
                              Console& console, Report& report) {
  console.begin("Smoothing the mesh");
  MeshFaces faces;
  faces.begin = scan.file.face_begin;
  faces.corners = scan.file.face_vertices;
  MeshSmoothParams params;
  params.fit = s.job.fit.params;
  if (s.sharp_given) {
    params.edges = params.fit.sharp_features ? MeshEdges::kSharp : MeshEdges::kRounded;
  }
  SmoothedMesh mesh;
  MeshSmoothStatistics done;
  const Error error = smoothMesh(scan.view(false), faces, params, surface, mesh, &done, nullptr,
                                 &console.progress());
  if (error) return console.failed(error);
  report.time("smooth", console.seconds());
  reportMesh(done, report);
  if (surface == nullptr) report.set("lambda", done.fit.lambda);
  console.done(std::to_string(done.moved) + " vertices" + (done.sharp ? ", sharp edges kept" : ""));
  note(done.faces_left_out, " face left out", " faces left out", console);
  note(done.isolated, " vertex without faces stays", " vertices without faces stay", console);
  note(done.disagreeing_edges, " edge whose faces disagree about their side",
       " edges whose faces disagree about their side", console);
  return meshFile(scan, mesh, s.job.more_fields);
}

/** Fits, unless a surface was read, and moves the scan's points onto the surface. Points that are
 * no surface stay where they are. */
Result<PointFile> smoothPoints(const Settings& s, const CloudFile& scan, SLIMSurface& surface,
                               Console& console, Report& report) {
  const bool fits = s.job.surface.empty();
  PointStore store;
  if (fits) {
    const Error error = fitScan(s.job.fit, scan, console, report, surface, &store);
    if (error && error.code != ErrorCode::kNoSurface) return error;
    if (error) {
      console.warn(error.message + "; the points are written as they are");
      report.set("warning", error.message);
    }
  }
  const auto projection =
      projectScan(s.job, scan, surface, fits ? &store : nullptr, console, report);
  if (!projection) return projection.error();
  return smoothed(scan.file, *projection, s.job);
}

Exit run(const OptionTable& options, Settings& s) {
  const ScanFiles& files = s.job.files;
  Console console(files.quiet);
  Report report(options, files.input, s.job.fit.params.threads);

  PieceStream pieces(s.job);  // of a scan that is too large to be loaded
  if (!s.mesh) {
    if (Error error = pieces.open(console)) return Exit::usage(error);
    if (pieces.isOpen()) return pieces.run(smoothed, console, report);
  }

  const Result<CloudFile> scan = loadScan(files.input, s.job.fit, console, report);
  if (!scan) return Exit::usage(scan.error());
  const bool fits = s.job.surface.empty();
  SLIMSurface surface;
  if (!fits) {
    const CloudFile* near = s.mesh ? nullptr : &*scan;
    if (Error error = readSurface(s.job.surface, near, console, report, surface))
      return Exit::usage(error);
  }
  warnOfLeftOut(*scan, console);

  const Result<PointFile> made =
      s.mesh ? smoothFaces(s, *scan, fits ? nullptr : &surface, console, report)
             : smoothPoints(s, *scan, surface, console, report);
  if (!made) return made.error();
  return savePoints(s.job, *made, console, report);
}

}  // namespace

int main(int argc, char** argv) {
  Settings s;
  OptionTable options = declareOptions(s);
  return runFileProgram(options, argc, argv,
                        {"use a smaller scan", [&] { return finishSettings(options, s); },
                         [&] { return run(options, s); }});
}
