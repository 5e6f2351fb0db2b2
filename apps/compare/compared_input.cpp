// SPDX-License-Identifier: BSD-3-Clause
#include "compare/compared_input.h"

#include <utility>

#include "scan/mesh_input.h"
#include "scan/surface_input.h"

namespace pcl_slim {

std::string ComparedInput::name() const {
  const std::size_t folder = path.find_last_of('/');
  return folder == std::string::npos ? path : path.substr(folder + 1);
}

double ComparedInput::independent(ScanPlaces which) const {
  return isMesh() ? 0.0 : independentPlaces(surface, which);
}

Result<DeviationReference> ComparedInput::reference(int threads) const {
  return isMesh() ? DeviationReference::make(mesh, mesh.sigma, threads)
                  : DeviationReference::make(surface, threads);
}

Result<CarrierMesh> ComparedInput::carrier(const CarrierParams& params, Progress& progress) const {
  return isMesh() ? carrierMeshOf(mesh, params) : carrierMeshOf(surface, params, &progress);
}

Error loadCompared(const std::string& path, bool as_mesh, const FitJob& job, Console& console,
                   Report& report, ComparedInput& input) {
  input.path = path;
  input.use_normals = job.use_normals || job.normal_neighbours > 0;
  ScanOrSurface read;
  if (Error error = loadScanOrSurface(path, job, console, report, read)) return error;
  if (read.surface) {
    input.kind = ComparedInput::Kind::kSurface;
    input.surface = std::move(*read.surface);
    report.set("kind", "surface");
    return {};
  }
  input.file = std::move(read.scan);
  const bool mesh = as_mesh && input.file->file.numFaces() > 0;
  report.set("kind", mesh ? "mesh" : "cloud");
  if (!mesh) return {};
  input.kind = ComparedInput::Kind::kMesh;
  input.mesh = triangleMeshOf(*input.file);
  if (Error error = checkTriangles(input.mesh))
    return {error.code, "'" + path + "': " + error.message};
  report.set("triangles", input.mesh.triangles.size());
  console.note("  " + counted(input.mesh.triangles.size(), "triangle") +
               ", exact; -faces none fits a surface to the vertices");
  return {};
}

Error fitCompared(const FitJob& job, Console& console, Report& report, ComparedInput& input) {
  if (input.kind != ComparedInput::Kind::kCloud) return {};
  return fitScan(job, *input.file, console, report, input.surface, &input.store);
}

}  // namespace pcl_slim
