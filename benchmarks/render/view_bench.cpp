// SPDX-License-Identifier: BSD-3-Clause
// A scan in one PCLVisualizer window: its points, a Poisson mesh of them and its SLIM surface, each
// drawn while the camera turns. Needs an X server.
#include <pcl/PolygonMesh.h>
#include <pcl/point_types.h>
#include <pcl/surface/poisson.h>
#include <pcl/visualization/pcl_visualizer.h>
#include <vtkCamera.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkRendererCollection.h>

#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "common/options.h"
#include "pcl_slim/query/projection.h"
#include "pcl_slim/visualization/pcl_visualizer.h"
#include "pcl_slim/visualization/slim_mapper.h"
#include "scan/fit_job.h"
#include "support/lab/bench.h"

using namespace pcl_slim;
using measure::cpuSeconds;
using measure::wallSeconds;
using pcl::visualization::PCLVisualizer;

namespace {

struct Settings {
  std::string scan;
  int size = 800, frames = 24, depth = 9;
  double lod = 0.0;
  FitJob fit;
};

/** \brief What is drawn: points with the normals of their surface, a mesh and the surface. */
struct Models {
  pcl::PointCloud<pcl::PointNormal>::Ptr points{new pcl::PointCloud<pcl::PointNormal>};
  pcl::PolygonMesh mesh;
  SLIMSurface surface;
  double fit_seconds = 0.0, mesh_seconds = 0.0;
};

/** \brief The scan's points with the normals of their projections. */
Error addNormals(const PointStore& store, Models& models) {
  Projection projection;
  if (Error error = projectPoints(store, models.surface, {}, projection)) return error;
  for (std::size_t i = 0; i < store.size(); ++i) {
    pcl::PointNormal p;
    for (int k = 0; k < 3; ++k) {
      const auto a = static_cast<std::size_t>(k);
      p.getVector3fMap()[k] =
          static_cast<float>(store.origin()[a] + store.scale() * projection.position[i][a]);
      p.getNormalVector3fMap()[k] = static_cast<float>(projection.normal[i][a]);
    }
    models.points->push_back(p);
  }
  return {};
}

Error makeModels(const OptionTable& options, const Settings& s, Models& models) {
  Console console(true);
  Report report(options, s.scan, s.fit.params.threads);
  const Result<CloudFile> cloud = loadScan(s.scan, s.fit, console, report);
  if (!cloud) return cloud.error();
  PointStore store;
  double start = wallSeconds();
  if (Error error = fitScan(s.fit, *cloud, console, report, models.surface, &store)) return error;
  models.fit_seconds = wallSeconds() - start;
  if (Error error = addNormals(store, models)) return error;
  start = wallSeconds();
  pcl::Poisson<pcl::PointNormal> poisson;
  poisson.setDepth(s.depth);
  poisson.setInputCloud(models.points);
  poisson.reconstruct(models.mesh);
  models.mesh_seconds = wallSeconds() - start;
  return {};
}

/** \brief Medians of a frame's time over one turn of the camera. */
void timeTurn(PCLVisualizer& viewer, int frames, const char* name) {
  vtkRenderWindow* window = viewer.getRenderWindow();
  vtkRenderer* renderer = viewer.getRendererCollection()->GetFirstRenderer();
  renderer->ResetCamera();
  renderer->GetActiveCamera()->Zoom(1.4);
  std::vector<double> wall, cpu;
  for (int i = -2; i < frames; ++i) {
    renderer->GetActiveCamera()->Azimuth(360.0 / frames);
    renderer->ResetCameraClippingRange();
    const double start = wallSeconds(), cpu_start = cpuSeconds();
    window->Render();
    window->WaitForCompletion();
    if (i < 0) continue;
    wall.push_back(1e3 * (wallSeconds() - start));
    cpu.push_back(1e3 * (cpuSeconds() - cpu_start));
  }
  std::printf("| %s | %.0f | %.0f |\n", name, measure::median(wall), measure::median(cpu));
  std::fflush(stdout);
}

void timeSurface(PCLVisualizer& viewer, const Settings& s, int frames, RayBackend backend,
                 DisplayMode mode, const char* name) {
  SLIMMapper* mapper = getSLIMMapper(viewer);
  mapper->setBackend(backend);
  mapper->setLevelOfDetail(s.lod);
  setSLIMSurfaceMode(viewer, mode);
  timeTurn(viewer, frames, name);
}

void timeModels(const Settings& s, const Models& models) {
  PCLVisualizer viewer("view_bench");
  viewer.setSize(s.size, s.size);
  viewer.setShowFPS(false);
  std::printf("| drawn | ms a frame | of all threads |\n|---|---|---|\n");
  viewer.addPointCloud<pcl::PointNormal>(models.points, "points");
  timeTurn(viewer, s.frames, "points, 1 pixel");
  viewer.setPointCloudRenderingProperties(pcl::visualization::PCL_VISUALIZER_POINT_SIZE, 3,
                                          "points");
  timeTurn(viewer, s.frames, "points, 3 pixels");
  viewer.removePointCloud("points");
  viewer.addPolygonMesh(models.mesh, "mesh");
  timeTurn(viewer, s.frames, "Poisson mesh");
  viewer.removePolygonMesh("mesh");
  addSLIMSurface(viewer, models.surface);
  timeSurface(viewer, s, s.frames, RayBackend::kCPU, DisplayMode::kShaded, "SLIM surface, CPU");
  timeSurface(viewer, s, s.frames, RayBackend::kCPU, DisplayMode::kMean,
              "the same, mean curvature");
  // A processor's OpenGL takes seconds for what a graphics card takes milliseconds for.
  timeSurface(viewer, s, 3, RayBackend::kOpenGL, DisplayMode::kShaded, "SLIM surface, OpenGL");
}

Exit run(const OptionTable& options, Settings& s) {
  if (Error error = finishFitOptions(s.fit)) return Exit::usage(error);
  Models models;
  if (Error error = makeModels(options, s, models)) return error;
  std::printf(
      "%s: %zu points; %zu leaves of degree %d, fitted in %.1f s; %zu triangles, Poisson of "
      "depth %d in %.1f s\n\n",
      s.scan.c_str(), models.points->size(), models.surface.numLeaves(), models.surface.info.degree,
      models.fit_seconds, models.mesh.polygons.size(), s.depth, models.mesh_seconds);
  timeModels(s, models);
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  Settings s;
  OptionTable table("view_bench", "", "Frame times in a PCLVisualizer: points, mesh and surface.");
  table.positional("SCAN.pcd|.ply", &s.scan, "a scan");
  table.integer("size", &s.size, 64, 4096, "pixels a side");
  table.integer("frames", &s.frames, 1, 10000, "frames of a turn");
  table.integer("depth", &s.depth, 4, 12, "of Poisson's octree");
  table.number("lod", &s.lod, 0.0, 1024.0, "level of detail in pixels");
  declareFitOptions(table, s.fit);
  declareTrimOptions(table, s.fit);
  return runProgram(table, argc, argv, "give a smaller scan", [&] { return run(table, s); });
}
