// SPDX-License-Identifier: BSD-3-Clause
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkDataSetAttributes.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkFloatArray.h>
#include <vtkIdTypeArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkStringArray.h>
#include <vtkUnsignedCharArray.h>
#include <vtkXMLPolyDataWriter.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <set>
#include <utility>

#include "io/point_formats.h"
#include "io/vtp/vtp.h"
#include "pcl_slim/core/file_access.h"
#include "pcl_slim/core/vector3.h"

namespace pcl_slim {

namespace {

/** Keeps VTK from printing while a file is tried. */
class SilentVtk {
 public:
  SilentVtk() : display_(vtkObject::GetGlobalWarningDisplay()) {
    vtkObject::GlobalWarningDisplayOff();
  }
  ~SilentVtk() { vtkObject::SetGlobalWarningDisplay(display_); }

 private:
  int display_;
};

/** Adds an array of type Array, whose component k of tuple i is value(i, k). */
template <typename Array, typename Value>
void addArray(vtkDataSetAttributes* data, const char* name, std::size_t count, int components,
              const Value& value) {
  vtkNew<Array> array;
  array->SetName(name);
  array->SetNumberOfComponents(components);
  array->SetNumberOfTuples(static_cast<vtkIdType>(count));
  for (std::size_t i = 0; i < count; ++i) {
    for (int k = 0; k < components; ++k) {
      array->SetComponent(static_cast<vtkIdType>(i), k,
                          static_cast<double>(value(i, static_cast<std::size_t>(k))));
    }
  }
  data->AddArray(array);
}

/** Writes VTK's data as .vtp. */
Error writeVtp(const std::string& path, vtkPolyData* data) {
  const SilentVtk silent;
  vtkNew<vtkXMLPolyDataWriter> writer;
  writer->SetInputData(data);
  writer->WriteToOutputStringOn();
  if (writer->Write() == 0) {
    return {ErrorCode::kIo,
            "cannot write '" + path + "': VTK refused the data; write a .ply file instead"};
  }
  const std::string text = writer->GetOutputString();
  return writeFile(path, text.data(), text.size());
}

int vtkTypeOf(std::uint8_t type) {
  switch (type) {
    case kInt8: return VTK_TYPE_INT8;
    case kUInt8:
    case kBool: return VTK_TYPE_UINT8;
    case kInt16: return VTK_TYPE_INT16;
    case kUInt16: return VTK_TYPE_UINT16;
    case kInt32: return VTK_TYPE_INT32;
    case kUInt32: return VTK_TYPE_UINT32;
    case kFloat32: return VTK_TYPE_FLOAT32;
    case kInt64: return VTK_TYPE_INT64;
    case kUInt64: return VTK_TYPE_UINT64;
    default: return VTK_TYPE_FLOAT64;
  }
}

/** An array to write: where its components are within a point, all of one type. */
struct Plan {
  std::string name;
  std::uint8_t type;
  std::vector<std::size_t> offsets;
};

vtkSmartPointer<vtkDataArray> arrayOf(const PointTable& cloud, const Plan& plan) {
  auto array =
      vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(vtkTypeOf(plan.type)));
  array->SetName(plan.name.c_str());
  array->SetNumberOfComponents(static_cast<int>(plan.offsets.size()));
  array->SetNumberOfTuples(static_cast<vtkIdType>(numPoints(cloud)));
  const std::size_t size = scalarSize(plan.type);
  auto* to = static_cast<std::uint8_t*>(array->GetVoidPointer(0));
  for (std::size_t i = 0; i < numPoints(cloud); ++i) {
    const std::uint8_t* point = cloud.data.data() + i * cloud.point_step;
    for (const std::size_t offset : plan.offsets) {
      std::memcpy(to, point + offset, size);
      to += size;
    }
  }
  return array;
}

/** Three fields of one value each; empty where one is missing or has several. */
std::vector<const PointField*> tripleOf(const PointTable& cloud, const char* const (&names)[3]) {
  std::vector<const PointField*> fields;
  for (const char* name : names) {
    const int i = findField(cloud, name);
    if (i >= 0 && cloud.fields[static_cast<std::size_t>(i)].count <= 1)
      fields.push_back(&cloud.fields[static_cast<std::size_t>(i)]);
  }
  if (fields.size() < 3) fields.clear();
  return fields;
}

bool haveType(const std::vector<const PointField*>& fields, std::uint8_t type) {
  return !fields.empty() && std::all_of(fields.begin(), fields.end(),
                                        [=](const auto* f) { return f->datatype == type; });
}

Plan planOf(const char* name, const std::vector<const PointField*>& fields) {
  return {name, fields[0]->datatype, {fields[0]->offset, fields[1]->offset, fields[2]->offset}};
}

/** Points as floats or doubles; as doubles where the fields are of another type. */
vtkSmartPointer<vtkDataArray> coordinatesOf(const PointTable& cloud) {
  const auto fields = tripleOf(cloud, kVtpCoordinates);
  for (const std::uint8_t type : {kFloat32, kFloat64}) {
    if (haveType(fields, type)) return arrayOf(cloud, planOf("Points", fields));
  }
  auto array = vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(VTK_DOUBLE));
  array->SetNumberOfComponents(3);
  array->SetNumberOfTuples(static_cast<vtkIdType>(numPoints(cloud)));
  auto* to = static_cast<double*>(array->GetVoidPointer(0));
  for (std::size_t i = 0; i < 3 * numPoints(cloud); ++i)
    to[i] = fieldValue(cloud, i / 3, *fields[i % 3]);
  return array;
}

/** What becomes of a cloud's fields other than its coordinates, in their order. */
class Planner {
 public:
  explicit Planner(const PointTable& cloud)
      : cloud_(cloud), normals_(tripleOf(cloud, kVtpNormals)) {
    if (!haveType(normals_, kFloat32) && !haveType(normals_, kFloat64)) normals_.clear();
    if (!normals_.empty()) names_.insert(kVtpNormalArray);
    const auto color = std::find_if(cloud.fields.begin(), cloud.fields.end(), isPackedColor);
    if (color == cloud.fields.end()) return;
    color_ = &*color;
    names_.insert({kVtpColorArray, kVtpAlphaArray});
  }

  Result<std::vector<Plan>> plan() {
    for (const PointField& field : cloud_.fields) {
      if (isNameOf(kVtpCoordinates, field.name)) continue;
      if (scalarSize(field.datatype) == 0) {
        return Error{ErrorCode::kBadArgument, "VTP has no type for the field '" + field.name +
                                                  "'; write a PCD file instead"};
      }
      addField(field);
    }
    return std::move(plans_);
  }

 private:
  void addField(const PointField& field) {
    if (!normals_.empty() && isNameOf(kVtpNormals, field.name)) {
      if (&field == normals_[0]) plans_.push_back(planOf(kVtpNormalArray, normals_));
      return;
    }
    if (&field == color_) return addColor(field);
    Plan plan{field.name, field.datatype, {}};
    for (std::size_t k = 0; k < std::max<std::size_t>(field.count, 1); ++k)
      plan.offsets.push_back(field.offset + k * scalarSize(field.datatype));
    add(std::move(plan));
  }

  /** In memory PCL's colour is blue, green, red, alpha. */
  void addColor(const PointField& field) {
    const std::size_t at = field.offset;
    plans_.push_back({kVtpColorArray, kUInt8, {at + 2, at + 1, at}});
    bool alpha = field.name == "rgba";
    for (std::size_t i = 0; i < numPoints(cloud_) && !alpha; ++i)
      alpha = cloud_.data[i * cloud_.point_step + at + 3] != 0;
    if (alpha) plans_.push_back({kVtpAlphaArray, kUInt8, {at + 3}});
  }

  /** VTK keeps one array of a name: another one gets a longer name. Those of normals and colours
   * are taken, wherever these are: readers find them by name. */
  void add(Plan plan) {
    while (!names_.insert(plan.name).second) plan.name += '_';
    plans_.push_back(std::move(plan));
  }

  const PointTable& cloud_;
  std::vector<const PointField*> normals_;
  const PointField* color_ = nullptr;  ///< the field that VTK shows as colours
  std::set<std::string> names_;
  std::vector<Plan> plans_;
};

/** The file's faces or, without any, a vertex for each point that has coordinates. Faces of fewer than
 * three corners are none to VTK, whose writer ends the program at them. */
void addCells(const PointFile& file, vtkPolyData* data) {
  vtkNew<vtkCellArray> cells;
  std::vector<vtkIdType> corners;
  for (std::size_t f = 0; f < file.numFaces(); ++f) {
    corners.assign(file.face_vertices.begin() + file.face_begin[f],
                   file.face_vertices.begin() + file.face_begin[f + 1]);
    if (corners.size() >= 3)
      cells->InsertNextCell(static_cast<vtkIdType>(corners.size()), corners.data());
  }
  if (cells->GetNumberOfCells() > 0) return data->SetPolys(cells);
  const vtkIdType n = data->GetNumberOfPoints();
  cells->AllocateExact(n, n);
  for (vtkIdType i = 0; i < n; ++i) {
    double p[3];
    data->GetPoint(i, p);
    if (isFinite(p)) cells->InsertNextCell(1, &i);
  }
  data->SetVerts(cells);
}

void addArrays(const PointTable& cloud, const std::vector<Plan>& plans, vtkPointData* data) {
  for (const Plan& plan : plans) {
    data->AddArray(arrayOf(cloud, plan));
    const bool triple = plan.offsets.size() == 3;
    if (triple && plan.name == kVtpNormalArray) data->SetActiveNormals(kVtpNormalArray);
    if (triple && plan.name == kVtpColorArray) data->SetActiveScalars(kVtpColorArray);
  }
}

}  // namespace

Error checkVtp(const std::string&) {
  return {};
}

Result<std::vector<VtpColumn>> vtpColumns(const PointFile& file) {
  const auto plans = Planner(file.cloud).plan();
  if (!plans) return plans.error();
  std::vector<VtpColumn> columns;
  for (const Plan& plan : *plans) columns.push_back({plan.name, plan.type, plan.offsets.size()});
  return columns;
}

Error saveVtp(const std::string& path, const PointFile& file) {
  if (tripleOf(file.cloud, kVtpCoordinates).empty())
    return {ErrorCode::kBadArgument, "points without x y z are no VTP; write a PCD file instead"};
  const auto plans = Planner(file.cloud).plan();
  if (!plans) return plans.error();
  vtkNew<vtkPolyData> data;
  vtkNew<vtkPoints> points;
  points->SetData(coordinatesOf(file.cloud));
  data->SetPoints(points);
  addCells(file, data);
  addArrays(file.cloud, *plans, data->GetPointData());
  vtkNew<vtkStringArray> comments;
  comments->SetName(kVtpCommentArray);
  for (const std::string& comment : file.comments) comments->InsertNextValue(comment);
  data->GetFieldData()->AddArray(comments);
  return writeVtp(path, data);
}

namespace {

void addVertexData(const TriangleMesh& mesh, vtkPointData* data) {
  addArray<vtkFloatArray>(data, "Normals", mesh.normals.size(), 3,
                          [&](std::size_t i, std::size_t k) { return mesh.normals[i][k]; });
  data->SetActiveNormals("Normals");
  addArray<vtkFloatArray>(data, "k1", mesh.k1.size(), 1,
                          [&](std::size_t i, std::size_t) { return mesh.k1[i]; });
  addArray<vtkFloatArray>(data, "k2", mesh.k2.size(), 1,
                          [&](std::size_t i, std::size_t) { return mesh.k2[i]; });
  if (!mesh.sigma.empty()) {
    addArray<vtkFloatArray>(data, "sigma_position", mesh.sigma.size(), 1,
                            [&](std::size_t i, std::size_t) { return mesh.sigma[i]; });
  }
  if (mesh.colors.empty()) return;
  addArray<vtkUnsignedCharArray>(data, "RGB", mesh.colors.size(), 3,
                                 [&](std::size_t i, std::size_t k) { return mesh.colors[i][k]; });
  data->SetActiveScalars("RGB");
}

}  // namespace

Error saveMeshVtp(const std::string& path, const TriangleMesh& mesh, bool narrow) {
  vtkNew<vtkPolyData> data;
  vtkNew<vtkPoints> points;
  if (!narrow) points->SetDataTypeToDouble();
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

namespace {

void addPointData(const CrestLines& lines, vtkDataSetAttributes* data) {
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

void addCellData(const CrestLines& lines, vtkDataSetAttributes* data) {
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

Error saveCrestVtp(const std::string& path, const CrestLines& lines) {
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
