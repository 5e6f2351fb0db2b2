// SPDX-License-Identifier: BSD-3-Clause
// pcl_slim_mesh: triangulates the SLIM surface of a scan.
#include <algorithm>
#include <cmath>
#include <optional>

#include "common/file_program.h"
#include "common/program.h"
#include "common/programs.h"
#include "pcl_slim/filters/io/mesh_files.h"
#include "pcl_slim/filters/mesh_colors.h"
#include "pcl_slim/mesh/mesh_extraction.h"
#include "pcl_slim/query/surface_probe.h"
#include "scan/fit_job.h"
#include "scan/paint_job.h"
#include "scan/scan_files.h"
#include "scan/small_components.h"
#include "scan/surface_input.h"

namespace {

using namespace pcl_slim;

constexpr std::uint64_t kMany = 1000000000000000000u;
constexpr double kLeastHole = 2, kUsualHole = 5;  ///< spacings that a fit may and does keep

struct Settings {
  ScanFiles files;
  std::string surface;
  FitJob job;
  MeshParams mesh;
  double tolerance_noise = 0;
  bool errors = false;        ///< vertices get standard errors
  std::optional<bool> color;  ///< not given: where there are colours
  std::string paint;          ///< another cloud whose colours the mesh gets, or none
};

void declareMeshOptions(OptionTable& options, Settings& s) {
  options.number("tol", &s.mesh.tolerance, 0, 1e12,
                 "largest distance between mesh and surface, in units of the scan",
                 "a quarter of the noise, at least 1e-4 of the box diagonal");
  options.number("tol_noise", &s.tolerance_noise, 0, 1e6,
                 "the same in standard deviations of the noise", "off");
  options.integer("max_triangles", &s.mesh.max_triangles, 0, kMany,
                  "collapse edges until there are no more; 0: no limit");
  options.toggle("trim", &s.mesh.trim, "end the mesh where the scan ends, and keep its holes");
  options.number("hole", &s.mesh.hole_size, 0, 1e6,
                 "diameter of the smallest hole kept, in spacings of the points");
  options.toggle("watertight", &s.mesh.watertight,
                 "close every border of the mesh, so that it is a body");
  declareComponentOption(options, s.mesh.min_component_points);
  options.integer("relax", &s.mesh.relax, 0, 100, "rounds that make triangles more even");
  options.toggle("color", &s.color,
                 "colour the vertices from the scan's points or, without a scan, from the surface",
                 "where there are colours");
  options.toggle("errors", &s.errors,
                 "write each vertex's standard error along its normal, sigma_position: .ply, .vtp");
  declarePaintOption(options, s.paint);
  options.exclusive({"tol", "tol_noise"});
  options.exclusive({"color", "colors"});
}

OptionTable declareOptions(Settings& s) {
  OptionTable options = programOptions("pcl_slim_mesh");
  options.input("IN.pcd|.ply|.slim|.vtp", &s.files.input,
                "the scan, or a surface made by pcl_slim_fit");
  options.output("OUT.ply|.obj|.stl|.glb|.vtp", &s.files.output, "the mesh", ".ply");
  declareMeshOptions(options, s);
  declareSurfaceOrFit(options, s.surface, s.job);
  declareReport(options, s.files);
  return options;
}

/** Completes the settings and checks what can be checked before the input is read. */
Error finishSettings(Settings& s) {
  s.job.params.trim = s.mesh.trim;
  if (s.mesh.hole_size > 0) {
    s.job.params.hole_size = std::clamp(s.mesh.hole_size, kLeastHole, kUsualHole);
  }
  if (Error error = finishFitOptions(s.job)) return error;
  if (Error error = checkMeshExtension(s.files.output)) return error;
  const std::string extension = lowerExtension(s.files.output);
  if (s.errors && extension != ".ply" && extension != ".vtp") {
    return {ErrorCode::kBadArgument, "-errors is a number for each vertex, which " + extension +
                                         " does not store: name a .ply or .vtp file"};
  }
  if (Error error = checkPlaces(filesRead(s.job, {s.files.input, s.surface, s.paint}),
                                {s.files.output, s.files.json}))
    return error;
  s.mesh.threads = s.job.params.threads;
  return s.mesh.validate();
}

/** What a mesh is made from: the surface is the input itself or -surface; none: to be fitted. */
struct Input : ScanOrSurface {
  std::optional<CloudFile> paint;  ///< another cloud with the colours of the mesh
};

Error loadInput(const Settings& s, Console& console, Report& report, Input& input) {
  if (Error error = loadScanOrSurface(s.files.input, s.job, console, report, input)) return error;
  if (input.scan) {
    if (s.color == true && colorsOf(*input.scan).bgr == nullptr) {
      return badInput("'" + s.files.input +
                      "' has no colours (rgb, rgba or red green blue); leave -color out");
    }
    return s.surface.empty() ? Error{}
                             : loadGiven(s.surface, console, report, input.surface.emplace());
  }
  if (!s.surface.empty()) {
    return {ErrorCode::kBadArgument,
            "'" + s.files.input + "' is a surface itself: leave -surface out, or name a scan"};
  }
  if (s.color != true || input.surface->hasColors()) return {};
  return {ErrorCode::kBadArgument,
          "the surface has no colours: name its scan, with -surface " + s.files.input};
}

void reportMesh(const MeshStatistics& m, Report& report) {
  const MeshCensus& c = m.census;
  report.add({{"triangles", c.triangles},
              {"vertices", c.vertices},
              {"components", c.components},
              {"border_edges", c.border_edges},
              {"nonmanifold", c.nonmanifold_edges + c.nonmanifold_vertices},
              {"euler", c.euler},
              {"collapsed", m.collapsed},
              {"dropped", m.dropped},
              {"dropped_components", m.dropped_components + m.left_out.components},
              {"dropped_points", m.left_out.points},
              {"closed_holes", m.closed_holes},
              {"closed_area", m.closed_area},
              {"area", m.area},
              {"border_loops", m.border_loops},
              {"sheet_ends", m.sheet_ends},
              {"longest_loop", m.longest_loop},
              {"widest_hole", m.widest_hole},
              {"edge_vertices", m.edge_vertices},
              {"corner_vertices", m.corner_vertices},
              {"unprojected", m.unprojected},
              {"tolerance", m.tolerance},
              {"cells", m.cells},
              {"corners", m.corners},
              {"split_cells", m.split_cells}});
}

/** What would close the loops that a mesh still has. */
std::string remedyOf(const MeshStatistics& m) {
  if (m.border_loops == m.sheet_ends) return "ends of sheets, no hole: -watertight 1 closes them";
  const auto size = static_cast<long long>(std::floor(m.widest_hole)) + 1;
  return "widest hole " + numberText(m.widest_hole, 3) + " spacings: -hole " +
         std::to_string(size) + " closes holes, -watertight 1 all";
}

/** "closed, 1 component", what was closed, what stays open and was left out. */
void noteMesh(const MeshStatistics& m, Console& console) {
  const MeshCensus& c = m.census;
  const std::string border = m.border_loops == 0
                                 ? "closed"
                                 : "open, " + counted(m.border_loops, "border loop") + " of " +
                                       counted(c.border_edges, "edge");
  console.note("  " + border + ", " + counted(c.components, "component"));
  if (m.closed_holes > 0) {
    console.note("  closed: " + counted(m.closed_holes, "border loop") + " by " +
                 numberText(100 * m.closed_area / m.area, 2) + " % of the area");
  }
  if (m.border_loops > 0) console.note("  " + remedyOf(m));
  if (m.left_out.components > 0)
    console.note("  " + leftOutText(m.left_out.components, m.left_out.points));
  if (m.dropped_components > 0) {
    console.note("  left out: " + counted(m.dropped_components, "small component") + " of " +
                 counted(m.dropped, "triangle") + "; -min_component 0 keeps them");
  }
}

/** \param[in] sharp the surface whose sharp edges the mesh shall have, or null. */
Error triangulate(const Settings& s, const SLIMSurface& surface, const SLIMSurface* sharp,
                  Console& console, Report& report, TriangleMesh& mesh) {
  console.begin("Meshing");
  MeshParams params = s.mesh;
  params.sharp = sharp;
  if (s.tolerance_noise > 0) {
    const double noise = std::sqrt(std::max(0.0, surface.info.lambda)) * surface.info.diagonal;
    params.tolerance = s.tolerance_noise * noise * surface.info.scale;
  }
  MeshStatistics statistics;
  if (Error error = extractMesh(surface, params, mesh, &statistics, &console.progress()))
    return console.failed(error);
  report.time("mesh", console.seconds());
  report.time("mesh_tree", statistics.seconds_tree);
  report.time("mesh_contour", statistics.seconds_contour);
  report.time("mesh_vertices", statistics.seconds_vertices);
  report.time("mesh_trim", statistics.seconds_trim);
  if (sharp != nullptr) report.time("mesh_sharpen", statistics.seconds_sharpen);
  reportMesh(statistics, report);
  console.done(counted(mesh.triangles.size(), "triangle"));
  noteMesh(statistics, console);
  return {};
}

/** Whether the mesh gets the edges of a second, sharp fit: that needs the scan and its normals. */
bool isSharpened(const Settings& s, const std::optional<CloudFile>& scan) {
  return s.job.params.sharp_features && scan &&
         (s.job.use_normals || s.job.normal_neighbours > 0) &&
         scan->normal_source != NormalSource::kNothing;
}

/** The fit whose sharp edges the mesh gets; the report is about the other one. */
Error fitSharp(const Settings& s, const CloudFile& scan, Console& console, const Report& report,
               SLIMSurface& surface) {
  FitJob job = s.job;
  job.params.trim = false;
  Report unread(report);
  return fitScan(job, scan, console, unread, surface);
}

/** The fit that the mesh is made of. */
Error fitSmooth(const Settings& s, const CloudFile& scan, bool sharpened, Console& console,
                Report& report, SLIMSurface& surface) {
  FitJob job = s.job;
  job.params.sharp_features = job.params.sharp_features && !sharpened;
  job.color = !s.paint.empty();  // where that cloud has no points, the mesh has the scan's colours
  return fitScan(job, scan, console, report, surface);
}

/** Gives the surface the colours of another cloud. */
Exit paint(const Settings& s, Console& console, Report& report, Input& input) {
  if (!input.paint) return {};
  const Error error = paintSurface(*input.paint, s.mesh.threads, console, report, *input.surface);
  return error.code == ErrorCode::kBadInput ? Exit::usage(error) : Exit(error);
}

/** Colours of the scan's points or, where these have none, of the surface. */
Error colorMesh(const Settings& s, const Input& input, TriangleMesh& mesh) {
  if (s.color == false) return {};
  if (input.paint) {
    mesh.colors = surfaceColors(*input.surface, mesh.vertices, mesh.normals, s.mesh.threads);
    return {};
  }
  const ColorView colors = input.scan ? colorsOf(*input.scan) : ColorView();
  if (colors.bgr) return colorFromPoints(input.scan->view(false), colors, s.mesh.threads, mesh);
  mesh.colors = surfaceColors(*input.surface, mesh.vertices, mesh.normals, s.mesh.threads);
  return {};
}

void addErrors(const SLIMSurface& surface, int threads, TriangleMesh& mesh) {
  for (const StandardErrors& e : surfaceErrors(surface, mesh.vertices, mesh.normals, threads))
    mesh.sigma.push_back(e.position);
}

Exit run(const OptionTable& options, Settings& s) {
  Console console(s.files.quiet);
  Report report(options, s.files.input, s.mesh.threads);

  Input input;
  if (Error error = loadInput(s, console, report, input)) return Exit::usage(error);
  if (!s.paint.empty()) {
    Result<CloudFile> loaded = loadPaint(s.paint, console, report);
    if (!loaded) return Exit::usage(loaded.error());
    input.paint = std::move(*loaded);
  }

  SLIMSurface sharp;
  const bool sharpened = isSharpened(s, input.scan);
  if (sharpened) {
    if (Error error = fitSharp(s, *input.scan, console, report, sharp)) return error;
  }
  if (!input.surface) {
    SLIMSurface& fitted = input.surface.emplace();
    if (Error error = fitSmooth(s, *input.scan, sharpened, console, report, fitted)) return error;
  }
  if (Exit painted = paint(s, console, report, input); painted.status != kExitDone) return painted;

  TriangleMesh mesh;
  if (Error error =
          triangulate(s, *input.surface, sharpened ? &sharp : nullptr, console, report, mesh))
    return error;
  if (Error error = colorMesh(s, input, mesh)) return error;
  if (s.errors) addErrors(*input.surface, s.mesh.threads, mesh);
  if (lowerExtension(s.files.output) == ".stl" && floatErrorOf(mesh) > 1e-2) {
    console.warn(
        "pcl_slim_mesh: .stl holds floats, too coarse for these coordinates; .ply and .vtp "
        "keep them");
  }
  return saveOutput(
      s.files.output, s.files.json, [&] { return saveMesh(s.files.output, mesh); },
      counted(mesh.triangles.size(), "triangle"), console, report);
}

}  // namespace

int main(int argc, char** argv) {
  Settings s;
  OptionTable options = declareOptions(s);
  return runFileProgram(
      options, argc, argv,
      {"use a smaller scan", [&] { return finishSettings(s); }, [&] { return run(options, s); }});
}
