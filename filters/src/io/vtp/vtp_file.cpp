// SPDX-License-Identifier: BSD-3-Clause
#include "io/vtp/vtp_file.h"

#include <vtkCellArray.h>
#include <vtkFieldData.h>
#include <vtkFloatArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkStringArray.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnsignedIntArray.h>
#include <vtkXMLPolyDataWriter.h>

#include <array>
#include <cstring>
#include <utility>

#include "io/scalar_type.h"
#include "io/vtp/vtp_data.h"
#include "pcl_slim/core/file_access.h"

namespace pcl_slim {

namespace {

constexpr const char* kMetadataArray = "pcl_slim";
constexpr const char* kColorArray = "RGB";  ///< three bytes in place of the field rgb
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

/** An array of one component for each field named; whole where the first field's numbers are. */
vtkSmartPointer<vtkDataArray>
gatherArray(const pcl::PCLPointCloud2& cloud, const char* name,
            const std::vector<std::size_t>& fields)
{
  vtkSmartPointer<vtkDataArray> array = vtkSmartPointer<vtkFloatArray>::New();
  if (!fields.empty() && cloud.fields[fields[0]].datatype == kUInt32) {
    array = vtkSmartPointer<vtkUnsignedIntArray>::New();
  }
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

/** Red, green and blue of a field that packs them into four bytes. */
vtkSmartPointer<vtkDataArray>
colorArray(const pcl::PCLPointCloud2& cloud, const pcl::PCLPointField& field)
{
  auto array = vtkSmartPointer<vtkUnsignedCharArray>::New();
  array->SetName(kColorArray);
  array->SetNumberOfComponents(3);
  array->SetNumberOfTuples(static_cast<vtkIdType>(numPoints(cloud)));
  for (std::size_t i = 0; i < numPoints(cloud); ++i) {
    const std::uint8_t* bgr = cloud.data.data() + i * cloud.point_step + field.offset;
    for (int k = 0; k < 3; ++k) array->SetTypedComponent(static_cast<vtkIdType>(i), k, bgr[2 - k]);
  }
  return array;
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
    const bool color = name == "rgb" && scalarSize(cloud.fields[f].datatype) == 4;
    data->GetPointData()->AddArray(color ? colorArray(cloud, cloud.fields[f])
                                         : gatherArray(cloud, name.c_str(), {f}));
    if (color) data->GetPointData()->SetActiveScalars(kColorArray);
  }
  vtkNew<vtkStringArray> metadata;
  metadata->SetName(kMetadataArray);
  for (const std::string& comment : file.comments) metadata->InsertNextValue(comment);
  data->GetFieldData()->AddArray(metadata);
}

/** A field's values, each as the four bytes of its type. */
using Column = std::vector<std::array<std::uint8_t, 4>>;

template <typename T>
std::array<std::uint8_t, 4>
bytesOf(T value)
{
  std::array<std::uint8_t, 4> bytes;
  static_assert(sizeof(value) == sizeof(bytes));
  std::memcpy(bytes.data(), &value, sizeof(value));
  return bytes;
}

/** Appends a field of floats, or of whole numbers where the array holds bits (all that 32 of them can
 * say, which a float cannot), its values taken from one component of an array. */
void
addColumn(const std::string& name, std::uint8_t type, const std::vector<double>& values,
          std::size_t components, std::size_t component, pcl::PCLPointCloud2& cloud,
          std::vector<Column>& columns)
{
  const bool whole = type == kUInt32;
  addField(cloud, name, whole ? kUInt32 : kFloat32);
  Column column(values.size() / components);
  for (std::size_t i = 0; i < column.size(); ++i) {
    const double value = values[i * components + component];
    column[i] =
        whole ? bytesOf(static_cast<std::uint32_t>(value)) : bytesOf(static_cast<float>(value));
  }
  columns.push_back(std::move(column));
}

/** Appends the colours of an array of bytes, packed. */
Error
addColors(const VtpMarkup& markup, const VtpArray& array, pcl::PCLPointCloud2& cloud,
          std::vector<Column>& columns)
{
  const auto values = readVtpNumbers(markup, array, 3 * markup.points);
  if (!values) return values.error();
  addField(cloud, "rgb", kFloat32);
  Column column(markup.points);
  for (std::size_t i = 0; i < column.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k)
      column[i][2 - k] = static_cast<std::uint8_t>((*values)[3 * i + k]);
  }
  columns.push_back(std::move(column));
  return {};
}

/** Appends the three fields of a vector array, or one of a scalar. */
Error
addArray(const VtpMarkup& markup, const VtpArray& array, const char* const* names,
         pcl::PCLPointCloud2& cloud, std::vector<Column>& columns)
{
  const auto values = readVtpNumbers(markup, array, markup.points * array.components);
  if (!values) return values.error();
  for (std::size_t k = 0; k < array.components; ++k) {
    addColumn(names ? names[k] : array.name, array.type, *values, array.components, k, cloud,
              columns);
  }
  return {};
}

const VtpArray*
findArray(const VtpMarkup& markup, const char* section, const std::string& name)
{
  for (const VtpArray& array : markup.arrays) {
    if (array.section == section && (name.empty() || array.name == name)) return &array;
  }
  return nullptr;
}

/** Fields in the order saveVtp found them: coordinates, normals, then the other scalars. */
Error
readFields(const VtpMarkup& markup, pcl::PCLPointCloud2& cloud)
{
  std::vector<Column> columns;
  const VtpArray* const points = findArray(markup, "Points", "");
  if (points == nullptr || points->components != 3) {
    return {ErrorCode::kBadInput, "the VTP file holds no points; name one that saveSurface wrote"};
  }
  if (Error error = addArray(markup, *points, kCoordinates, cloud, columns)) return error;
  const VtpArray* const normals =
      findArray(markup, "PointData", markup.normals.empty() ? "Normals" : markup.normals);
  if (normals != nullptr && normals->components == 3) {
    if (Error error = addArray(markup, *normals, kNormals, cloud, columns)) return error;
  }
  for (const VtpArray& array : markup.arrays) {
    if (array.section == "PointData" && array.name == kColorArray && array.type == kUInt8 &&
        array.components == 3) {
      if (Error error = addColors(markup, array, cloud, columns)) return error;
    }
    const bool scalar = array.section == "PointData" && array.components == 1 && array.type != 0;
    if (!scalar || array.name.empty()) continue;
    if (Error error = addArray(markup, array, nullptr, cloud, columns)) return error;
  }
  const std::size_t n = markup.points;
  cloud.width = static_cast<pcl::uindex_t>(n);
  cloud.height = 1;
  cloud.row_step = cloud.point_step * cloud.width;
  cloud.data.resize(n * cloud.point_step);
  for (std::size_t f = 0; f < columns.size(); ++f) {
    for (std::size_t i = 0; i < n; ++i) {
      std::memcpy(cloud.data.data() + i * cloud.point_step + 4 * f, columns[f][i].data(), 4);
    }
  }
  return {};
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
  const auto prefixed = [&path](const Error& error) {
    return Error{error.code, "'" + path + "': " + error.message};
  };
  const auto markup = parseVtpMarkup({reinterpret_cast<const char*>(bytes->data()), bytes->size()});
  if (!markup) return prefixed(markup.error());
  PointFile file;
  if (Error error = readFields(*markup, file.cloud)) return prefixed(error);
  const VtpArray* const metadata = findArray(*markup, "FieldData", kMetadataArray);
  if (metadata != nullptr && metadata->type == 0) {
    auto lines = readVtpStrings(*markup, *metadata);
    if (!lines) return prefixed(lines.error());
    file.comments = std::move(*lines);
  }
  return file;
}

}  // namespace pcl_slim
