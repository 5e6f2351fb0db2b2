// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/visualization/pcl_visualizer.h"

#include <pcl/visualization/pcl_visualizer.h>
#include <vtkActor.h>
#include <vtkProperty.h>
#include <vtkRendererCollection.h>
#include <vtkScalarBarActor.h>

#include <cmath>

#include "pcl_slim/visualization/scalar_bar.h"
#include "pcl_slim/visualization/slim_mapper.h"
#include "pcl_slim/visualization/splat_mapper.h"
#include "pcl_slim/visualization/studio.h"

namespace pcl_slim {
namespace {

using pcl::visualization::PCLVisualizer;

/** \brief Runs body for the renderers of a viewport, all if it is 0. */
template <typename Body>
void forEachRenderer(PCLVisualizer& viewer, int viewport, const Body& body) {
  auto renderers = viewer.getRendererCollection();
  renderers->InitTraversal();
  int number = 0;
  while (vtkRenderer* renderer = renderers->GetNextItem()) {
    if (viewport == 0 || viewport == number) body(renderer);
    ++number;
  }
}

void addShape(PCLVisualizer& viewer, vtkProp* shape, const std::string& id, int viewport) {
  forEachRenderer(viewer, viewport, [&](vtkRenderer* renderer) { renderer->AddViewProp(shape); });
  (*viewer.getShapeActorMap())[id] = shape;
}

vtkActor* actorOf(PCLVisualizer& viewer, const std::string& id) {
  const auto map = viewer.getShapeActorMap();
  const auto found = map->find(id);
  return found == map->end() ? nullptr : vtkActor::SafeDownCast(found->second);
}

template <typename Mapper>
Mapper* mapperOf(PCLVisualizer& viewer, const std::string& id) {
  vtkActor* actor = actorOf(viewer, id);
  return actor ? Mapper::SafeDownCast(actor->GetMapper()) : nullptr;
}

std::string barId(const std::string& id) {
  return id + " scalar bar";
}

vtkSmartPointer<vtkActor> actorWith(GBufferMapper* mapper) {
  auto actor = vtkSmartPointer<vtkActor>::New();
  actor->SetMapper(mapper);
  mapper->setLight(ObjectLight::kStudio);
  setClayLook(actor->GetProperty());
  return actor;
}

template <typename Mapper>
bool removeShapeOf(PCLVisualizer& viewer, const std::string& id) {
  if (!mapperOf<Mapper>(viewer, id)) return false;
  if (viewer.contains(barId(id))) viewer.removeShape(barId(id));
  return viewer.removeShape(id);
}

}  // namespace

bool addSLIMSurface(PCLVisualizer& viewer, const SLIMSurface& surface, const std::string& id,
                    int viewport) {
  if (viewer.contains(id)) return false;
  vtkNew<SLIMMapper> mapper;
  if (!mapper->setSurface(std::make_shared<SLIMSurface>(surface))) return false;
  addShape(viewer, actorWith(mapper), id, viewport);
  return true;
}

bool updateSLIMSurface(PCLVisualizer& viewer, const SLIMSurface& surface, const std::string& id) {
  SLIMMapper* mapper = getSLIMMapper(viewer, id);
  return mapper && mapper->setSurface(std::make_shared<SLIMSurface>(surface));
}

bool removeSLIMSurface(PCLVisualizer& viewer, const std::string& id) {
  return removeShapeOf<SLIMMapper>(viewer, id);
}

SLIMMapper* getSLIMMapper(PCLVisualizer& viewer, const std::string& id) {
  return mapperOf<SLIMMapper>(viewer, id);
}

bool setSLIMSurfaceMode(PCLVisualizer& viewer, DisplayMode mode, double range,
                        const std::string& id) {
  SLIMMapper* mapper = getSLIMMapper(viewer, id);
  if (!mapper || !mapper->setMode(mode)) return false;
  mapper->setRange(range);
  const bool has_bar = viewer.contains(barId(id));
  if (has_bar) viewer.removeShape(barId(id));
  if (!showsNumbers(mode)) return true;
  const auto bar = makeScalarBar(*mapper);
  forEachRenderer(viewer, 0, [&](vtkRenderer* renderer) {
    if (!renderer->HasViewProp(actorOf(viewer, id))) return;
    contrastWith(renderer, bar);
    renderer->AddViewProp(bar);
  });
  (*viewer.getShapeActorMap())[barId(id)] = bar;
  return true;
}

bool addSplats(PCLVisualizer& viewer, const SplatSet& splats, const std::string& id, int viewport) {
  if (viewer.contains(id)) return false;
  vtkNew<SplatMapper> mapper;
  if (!mapper->setSplats(std::make_shared<SplatSet>(splats))) return false;
  mapper->setMode(DisplayMode::kColor);
  addShape(viewer, actorWith(mapper), id, viewport);
  return true;
}

bool addSplats(PCLVisualizer& viewer, const pcl::PointCloud<pcl::PointSurfel>& splats,
               const std::string& id, int viewport) {
  return addSplats(viewer, splatsFrom(splats), id, viewport);
}

bool updateSplats(PCLVisualizer& viewer, const SplatSet& splats, const std::string& id) {
  SplatMapper* mapper = getSplatMapper(viewer, id);
  return mapper && mapper->setSplats(std::make_shared<SplatSet>(splats));
}

bool updateSplats(PCLVisualizer& viewer, const pcl::PointCloud<pcl::PointSurfel>& splats,
                  const std::string& id) {
  return updateSplats(viewer, splatsFrom(splats), id);
}

bool removeSplats(PCLVisualizer& viewer, const std::string& id) {
  return removeShapeOf<SplatMapper>(viewer, id);
}

SplatMapper* getSplatMapper(PCLVisualizer& viewer, const std::string& id) {
  return mapperOf<SplatMapper>(viewer, id);
}

SplatSet splatsFrom(const pcl::PointCloud<pcl::PointSurfel>& cloud) {
  SplatSet splats;
  splats.resize(cloud.size(), false);
  std::size_t n = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const pcl::PointSurfel& p = cloud[i];
    const float norm = std::hypot(p.normal_x, p.normal_y, p.normal_z);
    const float values = p.x + p.y + p.z + norm + p.radius;
    if (!std::isfinite(values) || !(norm > 0.0f) || p.radius < 0.0f) continue;
    splats.x[n] = p.x;
    splats.y[n] = p.y;
    splats.z[n] = p.z;
    splats.nx[n] = p.normal_x / norm;
    splats.ny[n] = p.normal_y / norm;
    splats.nz[n] = p.normal_z / norm;
    splats.radius[n] = p.radius;
    splats.rgb[n] = p.rgba & 0xffffffu;
    splats.confidence[n] = p.confidence;
    splats.normal_variance[n] = p.curvature;
    splats.kept[n] = static_cast<std::uint32_t>(i);
    ++n;
  }
  splats.resize(n, false);
  return splats;
}

}  // namespace pcl_slim
