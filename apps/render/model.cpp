// SPDX-License-Identifier: BSD-3-Clause
#include "render/model.h"

#include <utility>
#include <vector>

#include "pcl_slim/filters/io/splat_files.h"
#include "pcl_slim/filters/io/surface_files.h"
#include "scan/cloud_file.h"
#include "scan/mesh_input.h"

namespace pcl_slim {
namespace {

/** \brief Only surfaces and splats have balls or polynomials. */
bool hasModelFields(const PointFile& file) {
  return findField(file.cloud, "radius") >= 0 || findField(file.cloud, "c0") >= 0;
}

Error named(const std::string& path, const Error& error) {
  return {error.code, "'" + path + "': " + error.message};
}

/** \brief A model from a point file's fields; errors do not name the file yet. */
Result<Model> modelFrom(const PointFile& file) {
  Model model;
  if (holdsSplats(file)) {
    Result<SplatSet> splats = splatsFrom(file, &model.skipped);
    if (!splats) return splats.error();
    model.is_splats = true;
    model.splats = std::move(*splats);
    return model;
  }
  if (!hasModelFields(file)) {
    return Error{ErrorCode::kBadInput,
                 "neither a surface nor splats (no field 'radius' or 'c0') nor a mesh (no faces); "
                 "make one of "
                 "the scan with pcl_slim_fit or pcl_color_splat_sampling"};
  }
  Result<SLIMSurface> surface = surfaceFrom(file);
  if (!surface) return surface.error();
  model.surface = std::move(*surface);
  return model;
}

}  // namespace

std::string Model::describe() const {
  if (is_splats) return std::to_string(splats.size()) + " splats";
  if (is_mesh)
    return std::to_string(mesh.triangles.size()) + " triangles, " +
           std::to_string(mesh.vertices.size()) + " vertices";
  const std::string part = blocks_read == blocks ? ""
                                                 : ", " + std::to_string(blocks_read) + " of " +
                                                       std::to_string(blocks) + " blocks";
  return std::to_string(surface.numLeaves()) + " leaves of " + std::to_string(surface.size()) +
         " surfels" + part;
}

BoundingSpheres Model::spheres() const {
  if (is_mesh) return spheresOf(mesh.vertices, mesh.triangles);
  return is_splats ? spheresOf(splats) : spheresOf(surface);
}

bool holdsModel(const ModelFile& file) {
  const auto* points = std::get_if<PointFile>(&file);
  return points == nullptr || hasModelFields(*points);
}

Result<Model> modelOf(ModelFile file, const std::string& path) {
  Model model;
  if (auto* surface = std::get_if<SLIMSurface>(&file)) {
    model.surface = std::move(*surface);
    return model;
  }
  auto& points = std::get<PointFile>(file);
  if (!hasModelFields(points) && points.numFaces() > 0) {
    const Result<CloudFile> cloud = asCloudFile(std::move(points), path);
    if (!cloud) return cloud.error();
    model.is_mesh = true;
    model.mesh = triangleMeshOf(*cloud);
    if (Error error = checkTriangles(model.mesh)) return named(path, error);
    return model;
  }
  Result<Model> made = modelFrom(points);
  return made ? std::move(made) : named(path, made.error());
}

Result<Model> loadModel(const std::string& path) {
  Result<ModelFile> file = readModelFile(path);
  return file ? modelOf(std::move(*file), path) : file.error();
}

namespace {

/** What a picture of either kind cost. */
template <typename Counts>
void reportCounts(const Counts& counts, Report& report) {
  report.add({{"covered_pixels", counts.covered_pixels},
              {"rays_first", counts.rays_first},
              {"rays_blend", counts.rays_blend},
              {"tile_entries", counts.tile_entries}});
}

}  // namespace

void reportSurface(const Model& model, const RenderStatistics& counts, Report& report) {
  report.add({{"points", model.surface.info.num_points},
              {"surfels", model.surface.size()},
              {"leaves", model.surface.numLeaves()},
              {"levels", model.surface.numLevels()},
              {"degree", model.surface.info.degree},
              {"lambda", model.surface.info.lambda}});
  reportCounts(counts, report);
  report.add({{"closed_pixels", counts.closed_pixels},
              {"rays_bracketed", counts.rays_bracketed},
              {"skipped",
               {{"outside_frustum", counts.outside_frustum},
                {"outside_region", counts.outside_region},
                {"back_facing", counts.back_facing},
                {"below_detail", counts.below_detail},
                {"occluded_entries", counts.occluded_entries}}},
              {"coarse_surfels", counts.coarse_surfels}});
}

void reportSplats(const Model& model, const DiscRenderStatistics& counts, Report& report) {
  const std::uint64_t covered = counts.covered_pixels;
  report.add({{"splats", model.splats.size()}, {"gradient", !model.splats.gradient.empty()}});
  reportCounts(counts, report);
  report.set("overlap", covered > 0
                            ? static_cast<double>(counts.blended) / static_cast<double>(covered)
                            : 0.0);
  report.set("skipped", {{"unusable", model.skipped},
                         {"outside_frustum", counts.outside_frustum},
                         {"back_facing", counts.back_facing}});
}

void reportMesh(const Model& model, const MeshRenderStatistics& counts, Report& report) {
  report.add(
      {{"triangles", model.mesh.triangles.size()},
       {"covered_pixels", counts.covered_pixels},
       {"rays_first", counts.rays_first},
       {"skipped",
        {{"outside_frustum", counts.outside_frustum}, {"back_facing", counts.back_facing}}}});
}

void reportTraced(const Model& model, const TraceStatistics& counts, Report& report) {
  report.add({{model.is_splats ? "splats" : "leaves", counts.leaves},
              {"covered_pixels", counts.covered_pixels},
              {"rays_primary", counts.rays_primary},
              {"rays_shadow", counts.rays_shadow},
              {"rays_occlusion", counts.rays_occlusion},
              {"tested_first", counts.tested_first},
              {"tested_blend", counts.tested_blend},
              {"tested_per_ray", counts.testedPerRay()}});
}

}  // namespace pcl_slim
