// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstring>
#include <limits>
#include <utility>

#include "io/scalar_type.h"
#include "io/vtp/vtp_data.h"
#include "io/vtp/vtp_file.h"
#include "io/vtp/vtp_names.h"

namespace pcl_slim {

namespace {

constexpr std::size_t kMost =
    4294967294u;  ///< points, or bytes of one, that PCL's clouds can count

const VtpArray*
findArray(const VtpMarkup& markup, const char* section, const std::string& name)
{
  for (const VtpArray& array : markup.arrays) {
    if (array.section == section && (name.empty() || array.name == name)) return &array;
  }
  return nullptr;
}

/** An array of three bytes a point, or of one, by name. */
const VtpArray*
findBytes(const VtpMarkup& markup, const char* name, std::size_t components)
{
  const VtpArray* array = findArray(markup, "PointData", name);
  const bool fits = array && array->type == kUInt8 && array->components == components;
  return fits ? array : nullptr;
}

/** Brings the arrays of a file into the fields of a cloud. */
class FieldReader {
 public:
  FieldReader(const VtpMarkup& markup, PointFile& file) : markup_(markup), file_(file)
  {
    const VtpArray* const normals =
        findArray(markup, "PointData", markup.normals.empty() ? kVtpNormalArray : markup.normals);
    if (normals && normals->components == 3 && normals->type != 0) normals_ = normals;
    colors_ = findBytes(markup, kVtpColorArray, 3);
    if (colors_) alpha_ = findBytes(markup, kVtpAlphaArray, 1);
  }

  /** \brief Coordinates first, then the arrays of the points in their order. */
  Error read()
  {
    points_ = findArray(markup_, "Points", "");
    if (points_ == nullptr || points_->components != 3 || points_->type == 0)
      return badInput("the VTP file holds no points; name one that does");
    addTriple(kVtpCoordinates, *points_);
    for (const VtpArray& array : markup_.arrays) {
      if (array.section == "PointData") declare(array);
    }
    return fill();
  }

 private:
  /** Where an array goes within a point: values of one type next to each other. */
  struct Column {
    const VtpArray* array;
    std::size_t offset;
  };

  void addTriple(const char* const (&names)[3], const VtpArray& array)
  {
    columns_.push_back({&array, file_.cloud.point_step});
    for (const char* name : names) addField(file_.cloud, name, array.type);
  }

  void declare(const VtpArray& array)
  {
    if (array.type == 0 || array.name.empty()) {
      file_.left_out.push_back("array '" + array.name + "'");
    } else if (&array == normals_) {
      addTriple(kVtpNormals, array);
    } else if (&array == colors_) {
      columns_.push_back({&array, file_.cloud.point_step});
      addField(file_.cloud, alpha_ ? "rgba" : "rgb", alpha_ ? kUInt32 : kFloat32);
    } else if (&array == alpha_) {
      columns_.push_back({&array, 0});
    } else {
      columns_.push_back({&array, file_.cloud.point_step});
      addField(file_.cloud, array.name, array.type, array.components);
    }
  }

  /** Reads all arrays before memory is taken for the points that the file announces. */
  Error fill()
  {
    const std::size_t n = markup_.points;
    std::size_t step = 0;
    std::vector<std::vector<std::uint8_t>> values;
    for (const Column& column : columns_) {
      auto bytes = readVtpValues(markup_, *column.array, n * column.array->components);
      if (!bytes) return bytes.error();
      values.push_back(std::move(*bytes));
      step += bytesOf(*column.array);
    }
    if (std::max(n, step) > kMost)
      return badInput("the VTP file has 2^32 - 1 points, or bytes of a point, or more; divide it");
    pcl::PCLPointCloud2& cloud = file_.cloud;
    cloud.width = static_cast<pcl::uindex_t>(n);
    cloud.height = 1;
    cloud.row_step = static_cast<pcl::uindex_t>(cloud.point_step * n);
    cloud.data.resize(n * cloud.point_step);
    for (std::size_t k = 0; k < columns_.size(); ++k) scatter(columns_[k], values[k]);
    return {};
  }

  void scatter(const Column& column, const std::vector<std::uint8_t>& values)
  {
    pcl::PCLPointCloud2& cloud = file_.cloud;
    const std::size_t tuple = bytesOf(*column.array);
    const bool alpha = column.array == alpha_, color = column.array == colors_;
    const std::size_t offset = alpha ? colorOffset() + 3 : column.offset;
    for (std::size_t i = 0; i < markup_.points; ++i) {
      const std::uint8_t* from = values.data() + i * tuple;
      std::uint8_t* to = cloud.data.data() + i * cloud.point_step + offset;
      if (color)
        std::reverse_copy(from, from + 3, to);
      else
        std::memcpy(to, from, tuple);
    }
  }

  static std::size_t bytesOf(const VtpArray& array)
  {
    return array.components * scalarSize(array.type);
  }

  std::size_t colorOffset() const
  {
    const auto is_color = [this](const Column& column) { return column.array == colors_; };
    return std::find_if(columns_.begin(), columns_.end(), is_color)->offset;
  }

  const VtpMarkup& markup_;
  PointFile& file_;
  const VtpArray *points_ = nullptr, *normals_ = nullptr, *colors_ = nullptr, *alpha_ = nullptr;
  std::vector<Column> columns_;
};

/** Whole numbers of an array. */
Result<std::vector<std::uint64_t>>
readCounts(const VtpMarkup& markup, const VtpArray* array, std::size_t count)
{
  if (array == nullptr || (array->type != kInt64 && array->type != kInt32))
    return badInput("the VTP file has faces without whole numbers; write it again");
  const auto bytes = readVtpValues(markup, *array, count);
  if (!bytes) return bytes.error();
  std::vector<std::uint64_t> values(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double value = readScalar(bytes->data() + i * scalarSize(array->type), array->type);
    if (!(value >= 0 && value <= std::numeric_limits<std::uint32_t>::max()))
      return badInput("the VTP file's faces have a number out of range; write it again");
    values[i] = static_cast<std::uint64_t>(value);
  }
  return values;
}

Error
readFaces(const VtpMarkup& markup, PointFile& file)
{
  if (markup.polygons == 0) return {};
  const auto ends = readCounts(markup, findArray(markup, "Polys", "offsets"), markup.polygons);
  if (!ends) return ends.error();
  const auto corners = readCounts(markup, findArray(markup, "Polys", "connectivity"), ends->back());
  if (!corners) return corners.error();
  const bool sorted = std::is_sorted(ends->begin(), ends->end());
  if (!sorted || *std::max_element(corners->begin(), corners->end()) >= markup.points)
    return badInput("the VTP file's faces name vertices that it does not have; write it again");
  file.face_begin.assign(1, 0);
  file.face_begin.insert(file.face_begin.end(), ends->begin(), ends->end());
  file.face_vertices.assign(corners->begin(), corners->end());
  return {};
}

}  // namespace

Result<PointFile>
parseVtp(const std::vector<unsigned char>& bytes)
{
  const auto markup = parseVtpMarkup({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  if (!markup) return markup.error();
  PointFile file;
  file.left_out = markup->left_out;
  if (Error error = FieldReader(*markup, file).read()) return error;
  if (Error error = readFaces(*markup, file)) return error;
  const VtpArray* const comments = findArray(*markup, "FieldData", kVtpCommentArray);
  if (comments != nullptr && comments->type == 0) {
    auto lines = readVtpStrings(*markup, *comments);
    if (!lines) return lines.error();
    file.comments = std::move(*lines);
  }
  return file;
}

}  // namespace pcl_slim
