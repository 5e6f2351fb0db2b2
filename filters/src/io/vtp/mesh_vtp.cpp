// SPDX-License-Identifier: BSD-3-Clause
#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkUnsignedCharArray.h>

#include "io/triangles/mesh_formats.h"
#include "io/vtp/vtp_writing.h"

namespace pcl_slim {

namespace {

void
addVertexData(const TriangleMesh& mesh, vtkPointData* data)
{
  addArray<vtkFloatArray>(data, "Normals", mesh.normals.size(), 3,
                          [&](std::size_t i, std::size_t k) { return mesh.normals[i][k]; });
  data->SetActiveNormals("Normals");
  addArray<vtkFloatArray>(data, "k1", mesh.k1.size(), 1,
                          [&](std::size_t i, std::size_t) { return mesh.k1[i]; });
  addArray<vtkFloatArray>(data, "k2", mesh.k2.size(), 1,
                          [&](std::size_t i, std::size_t) { return mesh.k2[i]; });
  if (mesh.colors.empty()) return;
  addArray<vtkUnsignedCharArray>(data, "RGB", mesh.colors.size(), 3,
                                 [&](std::size_t i, std::size_t k) { return mesh.colors[i][k]; });
  data->SetActiveScalars("RGB");
}

}  // namespace

Error
saveMeshVtp(const std::string& path, const TriangleMesh& mesh)
{
  vtkNew<vtkPolyData> data;
  vtkNew<vtkPoints> points;
  if (!floatsSuffice(mesh)) points->SetDataTypeToDouble();
  for (const Vector3& p : mesh.vertices) points->InsertNextPoint(p.data());
  data->SetPoints(points);
  vtkNew<vtkCellArray> cells;
  for (const auto& t : mesh.triangles) {
    const vtkIdType corners[3] = {static_cast<vtkIdType>(t[0]), static_cast<vtkIdType>(t[1]),
                                  static_cast<vtkIdType>(t[2])};
    cells->InsertNextCell(3, corners);
  }
  data->SetPolys(cells);
  addVertexData(mesh, data->GetPointData());
  return writeVtp(path, data);
}

}  // namespace pcl_slim
