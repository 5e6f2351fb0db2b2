// SPDX-License-Identifier: BSD-3-Clause
#include "projection/projection_job.h"

#include <nlohmann/json.hpp>
#include <utility>

#include "pcl_slim/filters/io/surface_files.h"
#include "pcl_slim/mesh/mesh_smoothing.h"

namespace pcl_slim {

void reportProjection(const CloudProjectionStatistics& statistics, Report& report) {
  report.add({{"moved", statistics.moved},
              {"unsupported", statistics.unsupported},
              {"non_finite", statistics.non_finite},
              {"rms_displacement", statistics.rms_displacement},
              {"max_displacement", statistics.max_displacement}});
}

namespace {

/** How a program smooths a scan that has faces. */
struct MeshJob {
  MeshSmoothParams params;
  const SLIMSurface* surface = nullptr;  ///< in place of a fit
  bool normals = false;                  ///< also write the smooth mesh's normals at the vertices
};

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

PointFile meshFile(const MeshJob& job, const CloudFile& cloud, const SmoothedMesh& mesh) {
  constexpr const char* kPosition[3] = {"x", "y", "z"};
  constexpr const char* kNormal[3] = {"normal_x", "normal_y", "normal_z"};
  // Integer coordinates cannot represent the vertices' new positions.
  PointFile made = withRealFields(cloud.file, {"x", "y", "z"}, kFloat64);
  for (std::size_t a = 0; a < 3; ++a) {
    const FieldWriter field(made.cloud, kPosition[a]);
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) field.set(i, mesh.vertices[i][a]);
  }
  if (!job.normals) return made;
  made = withRealFields(made, {kNormal[0], kNormal[1], kNormal[2]}, kFloat32);
  writeTriples(mesh.normals, kNormal, made.cloud);
  return made;
}

/** Smooths the mesh in a file; prints and reports it. \return the file to write: the same with new
 * x y z, and faces and every other field kept. */
Result<PointFile> smoothMeshFile(const MeshJob& job, const CloudFile& cloud, Console& console,
                                 Report& report) {
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

/** Checks the options that can be checked before the input is read. */
Error checkJob(ProjectionJob& job) {
  if (Error error = finishFitOptions(job.fit)) return error;
  if (Error error = checkPointExtension(job.files.output, true)) return error;
  return checkPlaces(filesRead(job.fit, {job.files.input, job.surface}),
                     {job.files.output, job.files.json});
}

/** Reads a surface, or of one in blocks what some points need. \param[in] cloud null: nothing of
 * such a one */
Error readSurface(const ProjectionJob& job, const CloudFile* cloud, BlockSurface& blocks,
                  Console& console, Report& report, SLIMSurface& surface) {
  const std::string& path = job.surface;
  console.begin("Loading " + path);
  Result<SLIMSurface> loaded = SLIMSurface();
  if (job.mesh || !blocks.open(path)) {
    loaded = loadSurface(path);
  } else if (cloud == nullptr) {
    loaded = blocks.load(blocks.none());
  } else {
    blocks.setMostBytes(memoryLeft());
    loaded = blocks.load(blocks.partOf(cloud->view()));
  }
  if (!loaded) return console.failed(loaded.error());
  surface = std::move(*loaded);
  report.time("surface", console.seconds());
  reportSurface(path, surface, report);
  console.done(blocks.isOpen() && cloud == nullptr ? counted(blocks.count(), "block")
                                                   : std::to_string(surface.size()) + " surfels");
  if (blocks.isOpen() && cloud != nullptr) blocks.reportBlocks(console, report);
  return {};
}

/** Brings the scan onto the surface. \param[in] store the scan's, or null. */
Result<CloudProjection> projectScan(const ProjectionJob& job, const CloudFile& cloud,
                                    const SLIMSurface& surface, const PointStore* store,
                                    Console& console, Report& report) {
  console.begin("Projecting");
  CloudProjectionParams params;
  params.projection = job.projection;
  params.projection.threads = job.fit.params.threads;
  params.projection.sharp_features = job.fit.params.sharp_features;
  params.projection.paper_mode = surface.info.paper_mode;
  params.viewpoint = job.fit.params.viewpoint;
  if (!job.surface.empty()) params.least_support = kLeastSharedSupport;
  const bool with_normals = job.fit.use_normals || job.fit.normal_neighbours > 0;
  auto projection =
      CloudProjection::make(cloud.view(with_normals), surface, params, &console.progress(), store);
  if (!projection) return console.failed(projection.error());
  report.time("project", console.seconds());
  reportProjection(projection->statistics(), report);
  console.done(std::to_string(projection->statistics().moved) + " points");
  if (const auto count = projection->statistics().unsupported; count > 0) {
    console.note("  " + std::to_string(count) + (count == 1 ? " point" : " points") +
                 " without support");
  }
  return projection;
}

/** Fits, unless a surface was read, and projects. */
Result<CloudProjection> fitAndProject(const ProjectionProgram& program, const ProjectionJob& job,
                                      const CloudFile& cloud, SLIMSurface& surface,
                                      Console& console, Report& report) {
  if (!job.surface.empty()) return projectScan(job, cloud, surface, nullptr, console, report);
  PointStore store;
  const Error error = fitScan(job.fit, cloud, console, report, surface, &store);
  if (error && !(program.keeps_scan && error.code == ErrorCode::kNoSurface)) return error;
  if (error) {
    console.warn(error.message + "; the points are written as they are");
    report.json()["warning"] = error.message;
  }
  if (console.interrupted()) return Error{ErrorCode::kCancelled, "stopped; nothing is written"};
  return projectScan(job, cloud, surface, &store, console, report);
}

/** Smooths the mesh. \param[in] sharp_given whether the user chose how edges are treated. */
Result<PointFile> smoothMesh(const ProjectionJob& job, bool normals, bool sharp_given,
                             const SLIMSurface& surface, const CloudFile& cloud, Console& console,
                             Report& report) {
  MeshJob mesh;
  mesh.params.fit = job.fit.params;
  if (sharp_given) {
    mesh.params.edges = job.fit.params.sharp_features ? MeshEdges::kSharp : MeshEdges::kRounded;
  }
  if (!job.surface.empty()) mesh.surface = &surface;
  mesh.normals = normals;
  return smoothMeshFile(mesh, cloud, console, report);
}

OptionTable declareOptions(const ProjectionProgram& program, ProjectionJob& job, TileRequest& tiles,
                           bool& chosen) {
  OptionTable options(program.name, program.version, program.summary);
  options.positional("IN", &job.files.input, kScanHelp);
  options.positional("OUT.pcd|.ply|.las|.vtp", &job.files.output,
                     "the same points, with every field kept");
  options.toggle(program.switch_name, &chosen, program.switch_help);
  if (program.meshes) {
    options.toggle("mesh", &job.mesh,
                   "smooth the faces of a mesh, not its points; -sharp 0 or 1: round or keep all "
                   "edges, else as measured");
  }
  declareSurfaceOrFit(options, job.surface, job.fit);
  declareTileOptions(options, tiles);
  declareReport(options, job.files);
  // A mesh has its normals, and their sides, from its faces.
  for (const char* name : {"normals_as_data", "normal_error", "viewpoint", "trajectory", "frames",
                           "estimate_normals", "use_normals"}) {
    if (program.meshes) options.exclusive({"mesh", name});
  }
  return options;
}

}  // namespace

int runProjectionProgram(const ProjectionProgram& program, ProjectionJob& job, int argc,
                         const char* const* argv, const MakeOutput& make_output) {
  bool chosen = false;
  PieceJob pieces(job, make_output, chosen);
  OptionTable options = declareOptions(program, job, pieces.tiles(), chosen);
  SLIMSurface surface;
  PointFile made;
  ScanSteps steps;
  steps.check = [&] {
    job.projection.curvature = chosen;
    return checkJob(job);
  };
  steps.load = [&](const CloudFile* cloud, Console& console, Report& report) {
    if (job.surface.empty()) return Error();
    return readSurface(job, cloud, pieces.blocks(), console, report, surface);
  };
  steps.work = [&](const CloudFile* scan, Console& console, Report& report, ScanResult& result) {
    const CloudFile& cloud = *scan;
    for (const std::string& name : cloud.file.left_out) {
      console.warn(name + " of the scan is not written: the output holds its points and faces");
    }
    if (job.mesh) {
      auto mesh = smoothMesh(job, chosen, options.given("sharp"), surface, cloud, console, report);
      if (!mesh) return mesh.error();
      made = std::move(*mesh);
    } else {
      const auto projection = fitAndProject(program, job, cloud, surface, console, report);
      if (!projection) return projection.error();
      made = make_output(cloud.file, *projection, chosen, job.fit.params.threads);
    }
    const bool sensor = made.hasSensorPose();
    noteWhatIsNotKept(job.files.output, made.cloud.height > 1, sensor, console);
    result.save = [&] { return savePointFile(job.files.output, made); };
    result.detail = std::to_string(numPoints(made.cloud)) + " points";
    return Error();
  };
  steps.open = [&](Console& console) {
    pieces.tiles().asked = options.given("tile_points");
    return pieces.open(console);
  };
  steps.stream = [&](auto&... stage) { return pieces.run(surface, stage...); };
  return runScanProgram(options, argc, argv, job.files, job.fit, job.fit.params.threads, steps);
}

}  // namespace pcl_slim
