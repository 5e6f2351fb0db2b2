// SPDX-License-Identifier: BSD-3-Clause
// A program as a user of the package would write it: fits a sphere, packs it, renders it.
#include <cmath>
#include <cstdio>
#include <memory>
#include <vector>

#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/fit/fit.h"
#include "pcl_slim/render/camera.h"
#include "pcl_slim/render/surface_renderer.h"
#include "pcl_slim/surface/surface_io.h"
#include "pcl_slim/version.h"

#if PCL_SLIM_VERSION_NUMBER < 100
#error "written for 0.1.0"
#endif

#ifdef CONSUMER_USES_FILTERS
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include "pcl_slim/filters/slim_fit.h"
#endif

#ifdef CONSUMER_USES_VISUALIZATION
#include <vtkPolyData.h>

#include "pcl_slim/visualization/polydata.h"
#include "pcl_slim/visualization/slim_mapper.h"
#endif

namespace {

/** Points of the unit sphere, evenly spread along a spiral. */
std::vector<float> spherePoints(int count) {
  std::vector<float> xyz;
  for (int i = 0; i < count; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / count;
    const double angle = 2.399963229728653 * i;
    const double ring = std::sqrt(1.0 - z * z);
    for (const double value : {ring * std::cos(angle), ring * std::sin(angle), z}) {
      xyz.push_back(static_cast<float>(value));
    }
  }
  return xyz;
}

int fail(const char* what, const pcl_slim::Error& error) {
  std::printf("%s: %s\n", what, error.message.c_str());
  return 1;
}

#ifdef CONSUMER_USES_FILTERS
/** The same fit through the PCL door; the number of surfels, or 0. */
std::size_t fitWithPCL(const std::vector<float>& xyz) {
  pcl::PointCloud<pcl::PointXYZ>::Ptr cloud(new pcl::PointCloud<pcl::PointXYZ>);
  for (std::size_t i = 0; i < xyz.size(); i += 3) {
    cloud->push_back(pcl::PointXYZ(xyz[i], xyz[i + 1], xyz[i + 2]));
  }
  pcl_slim::SLIMFit<pcl::PointXYZ> fit;
  fit.setInputCloud(cloud);
  pcl_slim::SLIMSurface surface;
  return fit.fit(surface) ? surface.size() : 0;
}
#endif

}  // namespace

int main() {
  const std::vector<float> xyz = spherePoints(4000);
  pcl_slim::CloudView view;
  view.xyz = xyz.data();
  view.xyz_stride = 3 * sizeof(float);
  view.size = xyz.size() / 3;

  const auto store = pcl_slim::PointStore::build(view);
  if (!store) return fail("build", store.error());
  pcl_slim::SLIMSurface surface;
  if (const auto error = pcl_slim::fitSurface(*store, {}, surface)) return fail("fit", error);

  const auto bytes = pcl_slim::encodeSlim(surface);
  const auto again = pcl_slim::decodeSlim(bytes.data(), bytes.size());
  if (!again) return fail("decode", again.error());

  const pcl_slim::ImageSize size{64, 48};
  const auto camera = pcl_slim::fitCamera(pcl_slim::spheresOf(*again), {}, size);
  pcl_slim::GBuffer buffer;
  if (const auto error = pcl_slim::renderSurface(*again, camera, {}, buffer)) {
    return fail("render", error);
  }
  std::printf("%zu surfels, %zu pixels\n", surface.size(), buffer.numCovered());
  // A sphere fills more than a third of a 4:3 picture that it was framed in.
  bool good = surface.size() > 0 && buffer.numCovered() > 64 * 48 / 3;
#ifdef CONSUMER_USES_FILTERS
  const std::size_t surfels = fitWithPCL(xyz);
  std::printf("%zu surfels through PCL\n", surfels);
  good = good && surfels == surface.size();
#endif
#ifdef CONSUMER_USES_VISUALIZATION
  vtkNew<pcl_slim::SLIMMapper> mapper;
  good = good && mapper->setSurface(std::make_shared<pcl_slim::SLIMSurface>(surface));
  const auto points = static_cast<std::size_t>(pcl_slim::toPolyData(surface)->GetNumberOfPoints());
  std::printf("%zu points for VTK\n", points);
  good = good && points == surface.size();
#endif
  return good ? 0 : 1;
}
