// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/stream/record_source.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <vector>

#include "source/file_reader.h"
#include "source/text_pass.h"

namespace pcl_slim {

using namespace detail;

namespace {

constexpr std::size_t kPieceBytes = 3 << 20;

/** Whether three numbers of a type stand side by side, as a CloudView wants them. */
bool
inPlace(const std::array<RecordLayout::Field, 3>& fields, ScalarType type)
{
  const std::size_t bytes = scalarSize(type);
  return fields[0].type == type && fields[1].type == type && fields[2].type == type &&
         fields[1].offset == fields[0].offset + bytes &&
         fields[2].offset == fields[1].offset + bytes;
}

/** Brings a piece's records into the form of a CloudView; records that have it already stay. */
class RecordConverter {
 public:
  explicit RecordConverter(const RecordLayout& layout) : layout_(layout)
  {
    const bool native = !layout.big_endian;
    floats_ = native && inPlace(layout.position, kFloat32);
    doubles_ = native && inPlace(layout.position, kFloat64);
    normals_ = native && layout.normal && inPlace(*layout.normal, kFloat32);
  }

  CloudView view(const unsigned char* records, std::size_t count)
  {
    CloudView view;
    view.size = count;
    view.sensor = layout_.sensor;
    if (floats_ || doubles_) {
      view.xyz = records + layout_.position[0].offset;
      view.xyz_stride = layout_.step;
      view.scalar = floats_ ? CloudView::Scalar::kFloat : CloudView::Scalar::kDouble;
    } else {
      convert(records, count, layout_.position, xyz_);
      view.xyz = xyz_.data();
      view.xyz_stride = 3 * sizeof(double);
      view.scalar = CloudView::Scalar::kDouble;
    }
    if (normals_) {
      view.normal = records + (*layout_.normal)[0].offset;
      view.normal_stride = layout_.step;
    } else if (layout_.normal) {
      convert(records, count, *layout_.normal, normal_);
      view.normal = normal_.data();
      view.normal_stride = 3 * sizeof(float);
    }
    return view;
  }

 private:
  template <typename T>
  void convert(const unsigned char* records, std::size_t count,
               const std::array<RecordLayout::Field, 3>& fields, std::vector<T>& out) const
  {
    out.resize(3 * count);
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t a = 0; a < 3; ++a) {
        const std::size_t bytes = scalarSize(fields[a].type);
        unsigned char value[8];
        std::memcpy(value, records + i * layout_.step + fields[a].offset, bytes);
        if (layout_.big_endian) std::reverse(value, value + bytes);
        out[3 * i + a] = static_cast<T>(readScalar(value, fields[a].type));
      }
    }
  }

  const RecordLayout& layout_;
  bool floats_, doubles_, normals_;
  std::vector<double> xyz_;
  std::vector<float> normal_;
};

}  // namespace

RecordSource::RecordSource(RecordLayout layout, std::uint64_t share, std::uint64_t shares)
    : layout_(std::move(layout))
{
  const std::uint64_t whole = layout_.count / shares, rest = layout_.count % shares;
  first_ = share * whole + std::min(share, rest);
  end_ = first_ + whole + (share < rest ? 1 : 0);
}

CloudView::Scalar
RecordSource::scalar() const
{
  const auto small = [](const RecordLayout::Field& field) {
    return scalarSize(field.type) <= 2 || field.type == kFloat32;
  };
  const auto& p = layout_.position;
  const bool floats = small(p[0]) && small(p[1]) && small(p[2]);
  return floats ? CloudView::Scalar::kFloat : CloudView::Scalar::kDouble;
}

Error
RecordSource::pass(const Visit& visit)
{
  FileReader file;
  if (Error error = file.open(layout_.path)) return error;
  if (layout_.text) return passText(layout_, first_, end_, file, visit);
  const std::size_t piece = std::max<std::size_t>(1, kPieceBytes / layout_.step);
  std::vector<unsigned char> records(piece * layout_.step);
  RecordConverter converter(layout_);
  for (std::uint64_t first = first_; first < end_; first += piece) {
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(piece, end_ - first));
    const std::uint64_t at = layout_.begin + first * layout_.step;
    if (Error error = file.readAll(at, records.data(), count * layout_.step)) return error;
    if (Error error = visit(converter.view(records.data(), count))) return error;
  }
  return {};
}

}  // namespace pcl_slim
