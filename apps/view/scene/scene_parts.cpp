// SPDX-License-Identifier: BSD-3-Clause
#include "view/scene/scene_parts.h"

#include <vtkActor.h>
#include <vtkCellArray.h>
#include <vtkDataArray.h>
#include <vtkFloatArray.h>
#include <vtkLookupTable.h>
#include <vtkNew.h>
#include <vtkOpenGLSphereMapper.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "pcl_slim/core/vector3.h"
#include "pcl_slim/render/color_map.h"
#include "pcl_slim/visualization/polydata.h"
#include "view/scene/point_spheres.h"

namespace pcl_slim {
namespace {

/** \brief Lines from each point along its normal, as long as half its radius. */
vtkSmartPointer<vtkActor>
linesAlongNormals(vtkPolyData* pieces)
{
  vtkDataArray* normals = pieces->GetPointData()->GetNormals();
  vtkDataArray* radii = pieces->GetPointData()->GetArray("radius");
  vtkNew<vtkPoints> ends;
  ends->SetDataTypeToDouble();
  vtkNew<vtkCellArray> lines;
  for (vtkIdType i = 0; i < pieces->GetNumberOfPoints(); ++i) {
    double from[3], n[3];
    pieces->GetPoint(i, from);
    normals->GetTuple(i, n);
    const double size = 0.5 * radii->GetTuple1(i);
    const vtkIdType a = ends->InsertNextPoint(from);
    const vtkIdType b =
        ends->InsertNextPoint(from[0] + size * n[0], from[1] + size * n[1], from[2] + size * n[2]);
    lines->InsertNextCell({a, b});
  }
  vtkNew<vtkPolyData> data;
  data->SetPoints(ends);
  data->SetLines(lines);
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(data);
  auto actor = vtkSmartPointer<vtkActor>::New();
  actor->SetMapper(mapper);
  actor->GetProperty()->SetColor(0.10, 0.25, 0.55);
  actor->GetProperty()->SetLighting(false);
  return actor;
}

/** \brief The table of sizeColor() over the radii's 2nd to 98th percentile, by the logarithm. */
vtkSmartPointer<vtkLookupTable>
sizeTable(vtkDataArray* radii)
{
  std::vector<double> sorted;
  for (vtkIdType i = 0; i < radii->GetNumberOfTuples(); ++i) sorted.push_back(radii->GetTuple1(i));
  std::sort(sorted.begin(), sorted.end());
  const auto at = [&](double share) {
    return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
  };
  auto table = vtkSmartPointer<vtkLookupTable>::New();
  table->SetNumberOfTableValues(256);
  for (int i = 0; i < 256; ++i) {
    const Color color = sizeColor(i / 255.0);
    table->SetTableValue(i, color[0], color[1], color[2]);
  }
  table->SetScaleToLog10();
  table->SetTableRange(at(0.02), std::max(at(0.98), 1.0001 * at(0.02)));
  return table;
}

}  // namespace

vtkSmartPointer<vtkActor>
makePoints(const CloudView& points, const ColorView& colors)
{
  vtkNew<vtkPoints> positions;
  positions->SetDataTypeToDouble();
  vtkNew<vtkCellArray> vertices;
  vtkNew<vtkUnsignedCharArray> rgb;
  rgb->SetNumberOfComponents(3);
  for (std::size_t i = 0; i < points.count(); ++i) {
    const std::size_t input = points.inputIndex(i);
    const std::array<double, 3> p = points.position(input);
    if (!isFinite(p)) continue;
    const vtkIdType id = positions->InsertNextPoint(p.data());
    vertices->InsertNextCell(1, &id);
    if (!colors.bgr) continue;
    const auto* bgr = static_cast<const unsigned char*>(colors.bgr) + input * colors.stride;
    rgb->InsertNextTuple3(bgr[2], bgr[1], bgr[0]);
  }
  vtkNew<vtkPolyData> data;
  data->SetPoints(positions);
  data->SetVerts(vertices);
  if (colors.bgr) data->GetPointData()->SetScalars(rgb);
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(data);
  auto actor = vtkSmartPointer<vtkActor>::New();
  actor->SetMapper(mapper);
  actor->GetProperty()->SetColor(0.23, 0.25, 0.29);
  actor->GetProperty()->SetPointSize(2.0f);
  actor->GetProperty()->SetLighting(false);
  return actor;
}

vtkSmartPointer<vtkActor>
makeBalls(const SLIMSurface& surface)
{
  const vtkSmartPointer<vtkPolyData> leaves = toPolyData(surface, true);
  vtkDataArray* radii = leaves->GetPointData()->GetArray("radius");
  vtkNew<vtkFloatArray> reach;
  reach->SetName("reach");
  for (vtkIdType i = 0; i < radii->GetNumberOfTuples(); ++i) {
    reach->InsertNextValue(static_cast<float>(surface.info.cover_radius * radii->GetTuple1(i)));
  }
  leaves->GetPointData()->AddArray(reach);
  leaves->GetPointData()->SetActiveScalars("radius");
  vtkNew<vtkOpenGLSphereMapper> mapper;
  mapper->SetInputData(leaves);
  mapper->SetScaleArray("reach");
  mapper->SetScalarModeToUsePointData();
  auto actor = vtkSmartPointer<vtkActor>::New();
  actor->SetMapper(mapper);
  if (radii->GetNumberOfTuples() == 0) return actor;
  const vtkSmartPointer<vtkLookupTable> table = sizeTable(radii);
  mapper->SetLookupTable(table);
  mapper->SetUseLookupTableScalarRange(true);
  actor->GetProperty()->SetAmbient(0.3);
  actor->GetProperty()->SetDiffuse(0.8);
  return actor;
}

vtkSmartPointer<vtkActor>
makeNormals(const SLIMSurface& surface)
{
  return linesAlongNormals(toPolyData(surface, true));
}

vtkSmartPointer<vtkActor>
makeNormals(const SplatSet& splats)
{
  return linesAlongNormals(toPolyData(splats));
}

}  // namespace pcl_slim
