// SPDX-License-Identifier: BSD-3-Clause
#include "io/vtp_file.h"

#include <vtkCellArray.h>
#include <vtkFieldData.h>
#include <vtkFloatArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkStringArray.h>
#include <vtkXMLPolyDataReader.h>
#include <vtkXMLPolyDataWriter.h>

#include <cstring>

#include "io/scalar_type.h"
#include "pcl_slim/core/file_access.h"

namespace pcl_slim {

namespace {

constexpr const char* kMetadataArray = "pcl_slim";
const char* const kCoordinates[3] = {"x", "y", "z"};
const char* const kNormals[3] = {"normal_x", "normal_y", "normal_z"};

/** Keeps VTK from printing while a file is tried. */
class SilentVtk {
 public:
  SilentVtk() : display_(vtkObject::GetGlobalWarningDisplay())
  {
    vtkObject::GlobalWarningDisplayOff();
  }
  ~SilentVtk() { vtkObject::SetGlobalWarningDisplay(display_); }

 private:
  int display_;
};

bool
isOneOf(const std::string& name, const char* const (&names)[3])
{
  return name == names[0] || name == names[1] || name == names[2];
}

/** An array of one component for each field named. */
vtkSmartPointer<vtkFloatArray>
gatherArray(const pcl::PCLPointCloud2& cloud, const char* name,
            const std::vector<std::size_t>& fields)
{
  auto array = vtkSmartPointer<vtkFloatArray>::New();
  array->SetName(name);
  array->SetNumberOfComponents(static_cast<int>(fields.size()));
  array->SetNumberOfTuples(static_cast<vtkIdType>(numPoints(cloud)));
  for (std::size_t i = 0; i < numPoints(cloud); ++i) {
    for (std::size_t k = 0; k < fields.size(); ++k) {
      array->SetComponent(static_cast<vtkIdType>(i), static_cast<int>(k),
                          fieldValue(cloud, i, cloud.fields[fields[k]]));
    }
  }
  return array;
}

std::vector<std::size_t>
indicesOf(const pcl::PCLPointCloud2& cloud, const char* const (&names)[3])
{
  std::vector<std::size_t> indices;
  for (const char* name : names) {
    const int i = findField(cloud, name);
    if (i >= 0) indices.push_back(static_cast<std::size_t>(i));
  }
  return indices;
}

void
fillPolyData(const PointFile& file, vtkPolyData* data)
{
  const pcl::PCLPointCloud2& cloud = file.cloud;
  const auto n = static_cast<vtkIdType>(numPoints(cloud));
  vtkNew<vtkPoints> points;
  points->SetData(gatherArray(cloud, "Points", indicesOf(cloud, kCoordinates)));
  data->SetPoints(points);
  vtkNew<vtkCellArray> vertices;
  vertices->AllocateExact(n, n);
  for (vtkIdType i = 0; i < n; ++i) vertices->InsertNextCell(1, &i);
  data->SetVerts(vertices);
  data->GetPointData()->SetNormals(gatherArray(cloud, "Normals", indicesOf(cloud, kNormals)));
  for (std::size_t f = 0; f < cloud.fields.size(); ++f) {
    const std::string& name = cloud.fields[f].name;
    if (isOneOf(name, kCoordinates) || isOneOf(name, kNormals)) continue;
    data->GetPointData()->AddArray(gatherArray(cloud, name.c_str(), {f}));
  }
  vtkNew<vtkStringArray> metadata;
  metadata->SetName(kMetadataArray);
  for (const std::string& comment : file.comments) metadata->InsertNextValue(comment);
  data->GetFieldData()->AddArray(metadata);
}

/** Appends a float field, its values taken from one component of an array. */
void
addColumn(const std::string& name, vtkDataArray* array, int component,
          std::vector<std::vector<float>>& columns, pcl::PCLPointCloud2& cloud)
{
  addField(cloud, name, kFloat32);
  std::vector<float> column(static_cast<std::size_t>(array->GetNumberOfTuples()));
  for (std::size_t i = 0; i < column.size(); ++i) {
    column[i] = static_cast<float>(array->GetComponent(static_cast<vtkIdType>(i), component));
  }
  columns.push_back(std::move(column));
}

/** Fields in the order saveVtp found them: coordinates, normals, then the other scalars. */
void
readFields(vtkPolyData* data, pcl::PCLPointCloud2& cloud)
{
  std::vector<std::vector<float>> columns;
  const auto n = static_cast<std::size_t>(data->GetNumberOfPoints());
  for (int k = 0; k < 3; ++k)
    addColumn(kCoordinates[k], data->GetPoints()->GetData(), k, columns, cloud);
  vtkDataArray* normals = data->GetPointData()->GetNormals();
  if (!normals) normals = data->GetPointData()->GetArray("Normals");
  if (normals && normals->GetNumberOfComponents() == 3) {
    for (int k = 0; k < 3; ++k) addColumn(kNormals[k], normals, k, columns, cloud);
  }
  for (int a = 0; a < data->GetPointData()->GetNumberOfArrays(); ++a) {
    vtkDataArray* array = data->GetPointData()->GetArray(a);
    if (!array || array == normals || !array->GetName() || array->GetNumberOfComponents() != 1)
      continue;
    addColumn(array->GetName(), array, 0, columns, cloud);
  }
  cloud.width = static_cast<pcl::uindex_t>(n);
  cloud.height = 1;
  cloud.row_step = cloud.point_step * cloud.width;
  cloud.data.resize(n * cloud.point_step);
  for (std::size_t f = 0; f < columns.size(); ++f) {
    for (std::size_t i = 0; i < n; ++i) {
      std::memcpy(cloud.data.data() + i * cloud.point_step + f * sizeof(float), &columns[f][i],
                  sizeof(float));
    }
  }
}

}  // namespace

Error
checkVtp(const std::string&)
{
  return {};
}

Error
saveVtp(const std::string& path, const PointFile& file)
{
  const SilentVtk silent;
  vtkNew<vtkPolyData> data;
  fillPolyData(file, data);
  vtkNew<vtkXMLPolyDataWriter> writer;
  writer->SetInputData(data);
  writer->WriteToOutputStringOn();
  if (writer->Write() == 0) {
    return {ErrorCode::kIo,
            "cannot write '" + path + "': VTK refused the data; write a .pcd file instead"};
  }
  const std::string text = writer->GetOutputString();
  return writeFile(path, text.data(), text.size());
}

Result<PointFile>
loadVtp(const std::string& path)
{
  const Result<std::vector<unsigned char>> bytes = readFile(path);
  if (!bytes) return bytes.error();
  const std::string text(bytes->begin(), bytes->end());
  const auto bad = [&path](const char* what) {
    return Error{ErrorCode::kBadInput, "'" + path + "': " + what};
  };
  if (text.find("<VTKFile") == std::string::npos || text.find("PolyData") == std::string::npos) {
    return bad("not a VTK PolyData file; name a .vtp file written by saveSurface");
  }
  if (text.find("</VTKFile>") == std::string::npos) {
    return bad("the VTP file is truncated; copy it again");
  }
  const SilentVtk silent;
  vtkNew<vtkXMLPolyDataReader> reader;
  reader->ReadFromInputStringOn();
  reader->SetInputString(text);
  reader->Update();
  vtkPolyData* data = reader->GetOutput();
  if (reader->GetErrorCode() != 0 || !data || !data->GetPoints()) {
    return bad("the VTP file is corrupted: VTK cannot read it; write it again");
  }
  PointFile file;
  readFields(data, file.cloud);
  if (auto* metadata =
          vtkStringArray::SafeDownCast(data->GetFieldData()->GetAbstractArray(kMetadataArray))) {
    for (vtkIdType i = 0; i < metadata->GetNumberOfValues(); ++i) {
      file.comments.push_back(metadata->GetValue(i));
    }
  }
  return file;
}

}  // namespace pcl_slim
