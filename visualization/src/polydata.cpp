// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/visualization/polydata.h"

#include <vtkCellArray.h>
#include <vtkDoubleArray.h>
#include <vtkFloatArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkUnsignedCharArray.h>

#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "pcl_slim/surface/surfel_color.h"

namespace pcl_slim {
namespace {

/** \brief Builds the points of some pieces, named by their indices, and their arrays. */
class PointBuilder {
 public:
  explicit PointBuilder(std::vector<std::size_t> pieces) : pieces_(std::move(pieces)) {}

  /** \brief center(i, k): coordinate k of piece i. */
  void setCenters(const std::function<double(std::size_t, std::size_t)>& center) {
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    points->SetNumberOfPoints(count());
    vtkNew<vtkCellArray> vertices;
    vertices->AllocateExact(count(), count());
    for (vtkIdType p = 0; p < count(); ++p) {
      const std::size_t i = pieces_[static_cast<std::size_t>(p)];
      points->SetPoint(p, center(i, 0), center(i, 1), center(i, 2));
      vertices->InsertNextCell(1, &p);
    }
    data_->SetPoints(points);
    data_->SetVerts(vertices);
  }

  void setNormals(const std::vector<float>& nx, const std::vector<float>& ny,
                  const std::vector<float>& nz) {
    vtkNew<vtkFloatArray> normals;
    normals->SetName("Normals");
    normals->SetNumberOfComponents(3);
    for (const std::size_t i : pieces_) normals->InsertNextTuple3(nx[i], ny[i], nz[i]);
    data_->GetPointData()->SetNormals(normals);
  }

  void add(const std::string& name, const std::function<double(std::size_t)>& value) {
    vtkNew<vtkFloatArray> array;
    array->SetName(name.c_str());
    for (const std::size_t i : pieces_) array->InsertNextValue(static_cast<float>(value(i)));
    data_->GetPointData()->AddArray(array);
  }

  void setColors(const std::vector<std::uint32_t>& rgb) {
    vtkNew<vtkUnsignedCharArray> colors;
    colors->SetName("RGB");
    colors->SetNumberOfComponents(3);
    for (const std::size_t i : pieces_) {
      colors->InsertNextTuple3((rgb[i] >> 16) & 255, (rgb[i] >> 8) & 255, rgb[i] & 255);
    }
    data_->GetPointData()->SetScalars(colors);
  }

  vtkSmartPointer<vtkPolyData> data() const { return data_; }

 private:
  vtkIdType count() const { return static_cast<vtkIdType>(pieces_.size()); }

  std::vector<std::size_t> pieces_;
  vtkSmartPointer<vtkPolyData> data_ = vtkSmartPointer<vtkPolyData>::New();
};

/** 0xRRGGBB of every surfel at its centre. */
std::vector<std::uint32_t> colorsAtCenters(const SLIMSurface& surface) {
  std::vector<std::uint32_t> rgb;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const std::uint8_t* c = surface.colors.data() + i * kColorBytes;
    std::array<std::uint8_t, 3> color = {c[0], c[1], c[2]};
    const SurfelTexture texture = surface.texture(i);
    for (std::size_t k = 0; k < 3 && !texture.empty(); ++k)
      color[k] = static_cast<std::uint8_t>(std::lround(texture.colorAt(0.0f, 0.0f)[k]));
    rgb.push_back(std::uint32_t{color[0]} << 16 | std::uint32_t{color[1]} << 8 | color[2]);
  }
  return rgb;
}

}  // namespace

vtkSmartPointer<vtkPolyData> toPolyData(const SLIMSurface& surface, bool leaves_only) {
  std::vector<std::size_t> surfels;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    if (!leaves_only || surface.isLeaf(i)) surfels.push_back(i);
  }
  PointBuilder builder(std::move(surfels));
  const SurfaceInfo& info = surface.info;
  const std::vector<float>* const centers[3] = {&surface.cx, &surface.cy, &surface.cz};
  builder.setCenters([&](std::size_t i, std::size_t k) {
    return info.origin[k] + info.scale * double{(*centers[k])[i]};
  });
  builder.setNormals(surface.nx, surface.ny, surface.nz);
  if (surface.hasColors()) builder.setColors(colorsAtCenters(surface));
  builder.add("radius", [&](std::size_t i) { return info.scale * surface.radius[i]; });
  for (int c = 0; c < surface.stride(); ++c) {
    builder.add("c" + std::to_string(c),
                [&](std::size_t i) { return surface.coefficientsOf(i)[c]; });
  }
  builder.add("degree", [&](std::size_t i) { return surface.degree[i]; });
  builder.add("level", [&](std::size_t i) { return surface.level[i]; });
  builder.add("leaf", [&](std::size_t i) { return surface.flags[i] & ~kSurfelOpen; });
  builder.add("error", [&](std::size_t i) { return info.scale * surface.error[i]; });
  builder.add("confidence", [&](std::size_t i) { return surface.effective_count[i]; });
  return builder.data();
}

vtkSmartPointer<vtkPolyData> toPolyData(const SplatSet& splats) {
  std::vector<std::size_t> all(splats.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
  PointBuilder builder(std::move(all));
  const std::vector<float>* const centers[3] = {&splats.x, &splats.y, &splats.z};
  builder.setCenters(
      [&](std::size_t i, std::size_t k) { return splats.origin[k] + double{(*centers[k])[i]}; });
  builder.setNormals(splats.nx, splats.ny, splats.nz);
  builder.setColors(splats.rgb);
  builder.add("radius", [&](std::size_t i) { return splats.radius[i]; });
  builder.add("confidence", [&](std::size_t i) { return splats.confidence[i]; });
  builder.add("curvature", [&](std::size_t i) { return splats.normal_variance[i]; });
  return builder.data();
}

}  // namespace pcl_slim
