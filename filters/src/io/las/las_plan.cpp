// SPDX-License-Identifier: BSD-3-Clause
#include "io/las/las_plan.h"

#include <algorithm>
#include <cmath>

#include "io/scalar_type.h"

namespace pcl_slim {

namespace {

/** A field of the cloud, or an element of one, that becomes an extra value. */
struct ExtraSource {
  LasExtra extra;
  std::size_t from = 0;
};

std::size_t
countOf(const pcl::PCLPointField& field)
{
  return std::max<std::size_t>(field.count, 1);
}

const pcl::PCLPointField*
fieldNamed(const pcl::PCLPointCloud2& cloud, const std::string& name)
{
  const int i = findField(cloud, name);
  return i < 0 ? nullptr : &cloud.fields[static_cast<std::size_t>(i)];
}

/** Whether every point's number is one that the item can have. */
bool
fitsItem(const pcl::PCLPointCloud2& cloud, const pcl::PCLPointField& field, const LasItem& item)
{
  if (countOf(field) != 1) return false;
  if (item.type == kFloat32 || item.type == kFloat64) return item.type == kFloat64;
  const bool is_signed = item.type == kInt8 || item.type == kInt16;
  const int bits = item.bits > 0 ? item.bits : static_cast<int>(8 * scalarSize(item.type));
  const double low = is_signed ? -std::ldexp(1.0, bits - 1) : 0.0;
  const double high = std::ldexp(1.0, is_signed ? bits - 1 : bits);
  for (std::size_t i = 0; i < numPoints(cloud); ++i) {
    const double value = fieldValue(cloud, i, field);
    if (!(value >= low && value < high && value == std::floor(value))) return false;
  }
  return true;
}

class Planner {
 public:
  explicit Planner(const PointFile& file) : file_(file), cloud_(file.cloud) {}

  Result<LasPlan> plan()
  {
    for (const char* axis : {"x", "y", "z"}) {
      const pcl::PCLPointField* field = fieldNamed(cloud_, axis);
      if (!field) return badInput("these points have no fields x y z; LAS needs them");
      used_.push_back(field);
    }
    if (Error error = takeHead()) return error;
    for (const LasItem& item : lasItems(plan_.header.format)) takeItem(item);
    takeColor();
    if (Error error = takeExtras()) return error;
    return std::move(plan_);
  }

 private:
  const pcl::PCLPointField* packedColor() const
  {
    for (const char* name : {"rgb", "rgba"}) {
      const pcl::PCLPointField* field = fieldNamed(cloud_, name);
      if (field && scalarSize(field->datatype) == 4 && countOf(*field) == 1) return field;
    }
    return nullptr;
  }

  Error takeHead()
  {
    const bool colored = packedColor() != nullptr || fieldNamed(cloud_, "red") != nullptr;
    plan_.head = file_.las_head.empty() ? newLasHead(colored ? 7 : 6) : file_.las_head;
    Result<LasHeader> header = parseLasHeader(plan_.head, ~std::uint64_t{0});
    if (!header) return header.error();
    plan_.header = std::move(*header);
    return {};
  }

  void takeItem(const LasItem& item)
  {
    const pcl::PCLPointField* field = fieldNamed(cloud_, item.name);
    if (item.name == "return_number") plan_.single_returns = !field && file_.las_head.empty();
    if (!field) return;
    if (field->datatype == item.type && countOf(*field) == 1 &&
        (item.bits == 0 || fitsItem(cloud_, *field, item))) {
      plan_.copies.push_back(
          {field->offset, item.offset, scalarSize(item.type), item.shift, item.bits});
      used_.push_back(field);
    } else if (fitsItem(cloud_, *field, item)) {
      plan_.conversions.push_back({field, item});
      used_.push_back(field);
    }
  }

  /** Colours of 8 bits that PCL packs into one field. */
  void takeColor()
  {
    const pcl::PCLPointField* packed = packedColor();
    if (!packed || fieldNamed(cloud_, "red")) return;
    for (const LasItem& item : lasItems(plan_.header.format)) {
      if (item.name == "red") plan_.packed_color = packed;
    }
    if (plan_.packed_color && packed->name == "rgb") used_.push_back(packed);
  }

  /** The extra value that the file read has for a field, or null. */
  const LasExtra* describedExtra(const pcl::PCLPointField& field) const
  {
    for (const LasExtra& extra : plan_.header.extras) {
      if (extra.name == field.name && extra.type == field.datatype && extra.count == countOf(field))
        return &extra;
    }
    return nullptr;
  }

  std::vector<ExtraSource> extraSources() const
  {
    std::vector<ExtraSource> sources;
    for (const pcl::PCLPointField& field : cloud_.fields) {
      if (std::count(used_.begin(), used_.end(), &field) > 0) continue;
      if (const LasExtra* extra = describedExtra(field)) {
        sources.push_back({*extra, field.offset});
        continue;
      }
      const std::uint8_t type = field.datatype == kBool ? std::uint8_t{kUInt8} : field.datatype;
      for (std::size_t k = 0; k < countOf(field); ++k) {
        const std::string suffix = countOf(field) > 1 ? "_" + std::to_string(k) : "";
        sources.push_back(
            {{field.name + suffix, type, 1, {}}, field.offset + k * scalarSize(type)});
      }
    }
    return sources;
  }

  bool sameAsRead(const std::vector<LasExtra>& extras) const
  {
    const auto same = [](const LasExtra& a, const LasExtra& b) {
      return a.name == b.name && a.type == b.type && a.count == b.count;
    };
    const std::vector<LasExtra>& read = plan_.header.extras;
    return std::equal(extras.begin(), extras.end(), read.begin(), read.end(), same);
  }

  /** Names of values that the format has, which extra ones cannot take. */
  static Error checkExtra(const LasExtra& extra, int format)
  {
    for (const LasItem& item : lasItems(format)) {
      if (item.name == extra.name) {
        return {ErrorCode::kBadInput, "the field '" + extra.name +
                                          "' has numbers that LAS cannot hold; rename it, or write "
                                          ".pcd"};
      }
    }
    if (extra.name.size() <= 32 && (extra.bytes() <= 255 || !extra.record.empty())) return {};
    return {ErrorCode::kBadInput,
            "the field '" + extra.name.substr(0, 60) +
                "' has a name of more than 32 letters, or more than 255 bytes, "
                "which LAS cannot hold; write .pcd"};
  }

  Error takeExtras()
  {
    std::vector<LasExtra> extras;
    std::size_t to = lasRecordBytes(plan_.header.format);
    for (ExtraSource& source : extraSources()) {
      plan_.copies.push_back({source.from, to, source.extra.bytes()});
      to += source.extra.bytes();
      extras.push_back(std::move(source.extra));
    }
    if (to > 0xffff)
      return {ErrorCode::kBadInput,
              "a point has more than 65535 bytes, the most of LAS; write .pcd"};
    plan_.record_bytes = to;
    if (sameAsRead(extras)) return {};
    for (const LasExtra& extra : extras) {
      if (Error error = checkExtra(extra, plan_.header.format)) return error;
    }
    Result<std::vector<unsigned char>> head = withExtras(plan_.head, extras);
    if (!head) return head.error();
    plan_.head = std::move(*head);
    return {};
  }

  const PointFile& file_;
  const pcl::PCLPointCloud2& cloud_;
  LasPlan plan_;
  std::vector<const pcl::PCLPointField*> used_;
};

}  // namespace

Result<LasPlan>
planLas(const PointFile& file)
{
  return Planner(file).plan();
}

}  // namespace pcl_slim
