// SPDX-License-Identifier: BSD-3-Clause
#include "io/vtp/vtp_file.h"

#include <vtkCellArray.h>
#include <vtkDataArray.h>
#include <vtkFieldData.h>
#include <vtkIdTypeArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkStringArray.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <set>
#include <utility>

#include "io/scalar_type.h"
#include "io/vtp/vtp_writing.h"
#include "pcl_slim/core/vector3.h"

namespace pcl_slim {

namespace {

int
vtkTypeOf(std::uint8_t type)
{
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

vtkSmartPointer<vtkDataArray>
arrayOf(const pcl::PCLPointCloud2& cloud, const Plan& plan)
{
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
std::vector<const pcl::PCLPointField*>
tripleOf(const pcl::PCLPointCloud2& cloud, const char* const (&names)[3])
{
  std::vector<const pcl::PCLPointField*> fields;
  for (const char* name : names) {
    const int i = findField(cloud, name);
    if (i >= 0 && cloud.fields[static_cast<std::size_t>(i)].count <= 1)
      fields.push_back(&cloud.fields[static_cast<std::size_t>(i)]);
  }
  if (fields.size() < 3) fields.clear();
  return fields;
}

bool
haveType(const std::vector<const pcl::PCLPointField*>& fields, std::uint8_t type)
{
  return !fields.empty() && std::all_of(fields.begin(), fields.end(),
                                        [=](const auto* f) { return f->datatype == type; });
}

Plan
planOf(const char* name, const std::vector<const pcl::PCLPointField*>& fields)
{
  return {name, fields[0]->datatype, {fields[0]->offset, fields[1]->offset, fields[2]->offset}};
}

/** Points as floats or doubles; as doubles where the fields are of another type. */
vtkSmartPointer<vtkDataArray>
coordinatesOf(const pcl::PCLPointCloud2& cloud)
{
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
  explicit Planner(const pcl::PCLPointCloud2& cloud)
      : cloud_(cloud), normals_(tripleOf(cloud, kVtpNormals))
  {
    if (!haveType(normals_, kFloat32) && !haveType(normals_, kFloat64)) normals_.clear();
  }

  Result<std::vector<Plan>> plan()
  {
    for (const pcl::PCLPointField& field : cloud_.fields) {
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
  void addField(const pcl::PCLPointField& field)
  {
    if (!normals_.empty() && isNameOf(kVtpNormals, field.name)) {
      if (&field == normals_[0]) add(planOf(kVtpNormalArray, normals_));
      return;
    }
    const bool color = isPackedColor(field) && names_.count(kVtpColorArray) == 0;
    if (color) return addColor(field);
    Plan plan{field.name, field.datatype, {}};
    for (std::size_t k = 0; k < std::max<std::size_t>(field.count, 1); ++k)
      plan.offsets.push_back(field.offset + k * scalarSize(field.datatype));
    add(std::move(plan));
  }

  /** In memory PCL's colour is blue, green, red, alpha. */
  void addColor(const pcl::PCLPointField& field)
  {
    const std::size_t at = field.offset;
    add({kVtpColorArray, kUInt8, {at + 2, at + 1, at}});
    bool alpha = field.name == "rgba";
    for (std::size_t i = 0; i < numPoints(cloud_) && !alpha; ++i)
      alpha = cloud_.data[i * cloud_.point_step + at + 3] != 0;
    if (alpha) add({kVtpAlphaArray, kUInt8, {at + 3}});
  }

  /** VTK keeps one array of a name: another one gets a longer name. */
  void add(Plan plan)
  {
    while (!names_.insert(plan.name).second) plan.name += '_';
    plans_.push_back(std::move(plan));
  }

  const pcl::PCLPointCloud2& cloud_;
  std::vector<const pcl::PCLPointField*> normals_;
  std::set<std::string> names_;
  std::vector<Plan> plans_;
};

/** The file's faces or, without any, a vertex for each point that has coordinates. */
void
addCells(const PointFile& file, vtkPolyData* data)
{
  vtkNew<vtkCellArray> cells;
  std::vector<vtkIdType> corners;
  for (std::size_t f = 0; f < file.numFaces(); ++f) {
    corners.assign(file.face_vertices.begin() + file.face_begin[f],
                   file.face_vertices.begin() + file.face_begin[f + 1]);
    cells->InsertNextCell(static_cast<vtkIdType>(corners.size()), corners.data());
  }
  if (file.numFaces() > 0) return data->SetPolys(cells);
  const vtkIdType n = data->GetNumberOfPoints();
  cells->AllocateExact(n, n);
  for (vtkIdType i = 0; i < n; ++i) {
    double p[3];
    data->GetPoint(i, p);
    if (isFinite(p)) cells->InsertNextCell(1, &i);
  }
  data->SetVerts(cells);
}

void
addArrays(const pcl::PCLPointCloud2& cloud, const std::vector<Plan>& plans, vtkPointData* data)
{
  for (const Plan& plan : plans) {
    data->AddArray(arrayOf(cloud, plan));
    const bool triple = plan.offsets.size() == 3;
    if (triple && plan.name == kVtpNormalArray) data->SetActiveNormals(kVtpNormalArray);
    if (triple && plan.name == kVtpColorArray) data->SetActiveScalars(kVtpColorArray);
  }
}

}  // namespace

Error
checkVtp(const std::string&)
{
  return {};
}

Result<std::vector<VtpColumn>>
vtpColumns(const PointFile& file)
{
  const auto plans = Planner(file.cloud).plan();
  if (!plans) return plans.error();
  std::vector<VtpColumn> columns;
  for (const Plan& plan : *plans) columns.push_back({plan.name, plan.type, plan.offsets.size()});
  return columns;
}

Error
saveVtp(const std::string& path, const PointFile& file)
{
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

}  // namespace pcl_slim
