// SPDX-License-Identifier: BSD-3-Clause
// pcl_slim_mesh: triangulates the SLIM surface of a scan.
#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "common/program.h"
#include "pcl_slim/filters/io/mesh_files.h"
#include "pcl_slim/filters/io/surface_files.h"
#include "pcl_slim/filters/mesh_colors.h"
#include "pcl_slim/mesh/mesh_extraction.h"
#include "pcl_slim/query/surface_probe.h"
#include "scan/fit_job.h"
#include "scan/scan_program.h"

namespace {

using namespace pcl_slim;

constexpr std::uint64_t kMany = 1000000000000000000u;
constexpr double kLeastHole = 2, kUsualHole = 4;  ///< spacings that a fit may and does keep

struct Settings {
  ScanFiles files;
  std::string surface;
  FitJob job;
  MeshParams mesh;
  double tolerance_noise = 0;
  std::optional<bool> color;  ///< not given: where there are colours
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
  options.number("min_component", &s.mesh.min_component_points, 0, 1e12,
                 "leave out pieces on which fewer points lie; 0: keep all");
  options.integer("relax", &s.mesh.relax, 0, 100, "rounds that make triangles more even");
  options.toggle("color", &s.color,
                 "colour the vertices from the scan's points or, without a scan, from the surface",
                 "where there are colours");
  options.exclusive({"tol", "tol_noise"});
}

OptionTable declareOptions(Settings& s) {
  OptionTable options("pcl_slim_mesh", PCL_SLIM_VERSION,
                      "Makes a triangle mesh of a scan's SLIM surface.");
  options.positional("IN.pcd|.ply|.slim|.vtp", &s.files.input,
                     "the scan, or a surface made by pcl_slim_fit");
  options.positional("OUT.ply|.obj|.stl|.glb|.vtp", &s.files.output, "the mesh");
  declareMeshOptions(options, s);
  declareSurfaceOrFit(options, s.surface, s.job);
  declareReport(options, s.files);
  return options;
}

/** Checks the options that can be checked before the input is read. */
Error checkSettings(Settings& s) {
  s.job.params.trim = s.mesh.trim;
  if (s.mesh.hole_size > 0) {
    s.job.params.hole_size = std::clamp(s.mesh.hole_size, kLeastHole, kUsualHole);
  }
  if (Error error = finishFitOptions(s.job)) return error;
  if (Error error = checkMeshExtension(s.files.output)) return error;
  if (Error error =
          checkPlaces(filesRead(s.job, {s.files.input, s.surface}), {s.files.output, s.files.json}))
    return error;
  s.mesh.threads = s.job.params.threads;
  return s.mesh.validate();
}

/** The surface used in place of a fit: the input itself, or the one given with it. */
struct Given {
  SLIMSurface surface;
  bool is_input = false, any = false;
};

/** \param[in] cloud the input's points; null for a .slim. */
Error loadGiven(const Settings& s, const CloudFile* cloud, Console& console, Report& report,
                Given& given) {
  given.is_input = holdsSurface(s.files.input, cloud);
  given.any = given.is_input || !s.surface.empty();
  if (!given.is_input) {
    if (s.color == true && colorsOf(*cloud).bgr == nullptr) {
      return badInput("'" + s.files.input +
                      "' has no colours (rgb, rgba or red green blue); leave -color out");
    }
    return given.any ? loadGiven(s.surface, console, report, given.surface) : Error{};
  }
  if (!s.surface.empty()) {
    return {ErrorCode::kBadArgument,
            "'" + s.files.input + "' is a surface itself: leave -surface out, or name a scan"};
  }
  if (Error error = loadGiven(s.files.input, console, report, given.surface)) return error;
  if (s.color != true || given.surface.hasColors()) return {};
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
              {"dropped_components", m.dropped_components},
              {"closed_holes", m.closed_holes},
              {"edge_vertices", m.edge_vertices},
              {"corner_vertices", m.corner_vertices},
              {"unprojected", m.unprojected},
              {"tolerance", m.tolerance},
              {"cells", m.cells},
              {"corners", m.corners},
              {"split_cells", m.split_cells}});
}

/** "closed, 1 component" and what was left out. */
void noteMesh(const MeshStatistics& m, Console& console) {
  const MeshCensus& c = m.census;
  const std::string border =
      c.border_edges == 0 ? "closed" : "open, " + counted(c.border_edges, "border edge");
  console.note("  " + border + ", " + counted(c.components, "component"));
  if (m.dropped_components > 0) {
    console.note("  left out: " + counted(m.dropped_components, "small component") + " of " +
                 counted(m.dropped, "triangle"));
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
bool isSharpened(const Settings& s, const CloudFile* scan) {
  return s.job.params.sharp_features && scan != nullptr &&
         (s.job.use_normals || s.job.normal_neighbours > 0) &&
         scan->normal_source != NormalSource::kNothing;
}

/** \param[in] scan null: the input is a surface. */
Error makeMesh(const Settings& s, const Given& given, const CloudFile* scan, Console& console,
               Report& report, TriangleMesh& mesh) {
  SLIMSurface fitted, sharp;
  const bool sharpened = isSharpened(s, scan);
  if (sharpened) {
    FitJob job = s.job;
    job.params.trim = false;
    Report unread(report);
    if (Error error = fitScan(job, *scan, console, unread, sharp)) return error;
  }
  if (!given.any && !console.interrupted()) {
    FitJob job = s.job;
    job.params.sharp_features = job.params.sharp_features && !sharpened;
    if (Error error = fitScan(job, *scan, console, report, fitted)) return error;
  }
  if (console.interrupted()) return {};
  const SLIMSurface& surface = given.any ? given.surface : fitted;
  if (Error error = triangulate(s, surface, sharpened ? &sharp : nullptr, console, report, mesh))
    return error;
  if (s.color == false) return {};
  const ColorView colors = scan != nullptr ? colorsOf(*scan) : ColorView();
  if (colors.bgr) return colorFromPoints(scan->view(false), colors, s.mesh.threads, mesh);
  mesh.colors = surfaceColors(surface, mesh.vertices, mesh.normals, s.mesh.threads);
  return {};
}

Error work(const Settings& s, const Given& given, const CloudFile* cloud, Console& console,
           Report& report, ScanResult& result) {
  const auto mesh = std::make_shared<TriangleMesh>();
  const CloudFile* scan = given.is_input ? nullptr : cloud;
  if (Error error = makeMesh(s, given, scan, console, report, *mesh)) return error;
  if (lowerExtension(s.files.output) == ".stl" && floatErrorOf(*mesh) > 1e-2) {
    console.warn(
        "pcl_slim_mesh: .stl holds floats, too coarse for these coordinates; .ply and .vtp "
        "keep them");
  }
  result.save = [&s, mesh] { return saveMesh(s.files.output, *mesh); };
  result.detail = counted(mesh->triangles.size(), "triangle");
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  Settings s;
  OptionTable options = declareOptions(s);
  Given given;
  const ScanSteps steps = {
      [&] { return checkSettings(s); },
      [&](auto&&... stage) { return loadGiven(s, stage..., given); },
      [&](auto&&... stage) { return work(s, given, stage...); },
      [&](Console&) -> Result<bool> { return holdsSurface(s.files.input, nullptr); },
      {}};
  return runScanProgram(options, argc, argv, s.files, s.job, s.mesh.threads, steps);
}
