// SPDX-License-Identifier: BSD-3-Clause
#include "io/vtp/crest_vtp.h"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkFloatArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>

#include "io/vtp/vtp_writing.h"

namespace pcl_slim {

namespace {

void
addPointData(const CrestLines& lines, vtkDataSetAttributes* data)
{
  const auto vectors = [&](const char* name, const std::vector<std::array<float, 3>>& values) {
    addArray<vtkFloatArray>(data, name, values.size(), 3,
                            [&](std::size_t i, std::size_t k) { return values[i][k]; });
  };
  const auto scalars = [&](const char* name, const std::vector<float>& values) {
    addArray<vtkFloatArray>(data, name, values.size(), 1,
                            [&](std::size_t i, std::size_t) { return values[i]; });
  };
  vectors("Normals", lines.normal);
  vectors("tangent", lines.tangent);
  scalars("k1", lines.k1);
  scalars("k2", lines.k2);
  scalars("prominence", lines.prominence);
  scalars("significance", lines.significance);
  scalars("radius", lines.radius);
}

void
addCellData(const CrestLines& lines, vtkDataSetAttributes* data)
{
  const auto scalars = [&](const char* name, const auto& values) {
    addArray<vtkDoubleArray>(data, name, values.size(), 1, [&](std::size_t i, std::size_t) {
      return static_cast<double>(values[i]);
    });
  };
  scalars("type", lines.type);
  scalars("closed", lines.closed);
  scalars("length", lines.length);
  scalars("strength", lines.strength);
  scalars("significance", lines.mean_significance);
}

}  // namespace

Error
saveCrestVtp(const std::string& path, const CrestLines& lines)
{
  vtkNew<vtkPolyData> data;
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (const auto& p : lines.position) points->InsertNextPoint(p[0], p[1], p[2]);
  data->SetPoints(points);
  vtkNew<vtkCellArray> cells;
  for (std::size_t line = 0; line < lines.numLines(); ++line) {
    const auto path_of_line = pathOf(lines, line);
    cells->InsertNextCell(static_cast<int>(path_of_line.size()));
    for (const std::uint32_t v : path_of_line) cells->InsertCellPoint(static_cast<vtkIdType>(v));
  }
  data->SetLines(cells);
  addPointData(lines, data->GetPointData());
  addCellData(lines, data->GetCellData());
  return writeVtp(path, data);
}

}  // namespace pcl_slim
