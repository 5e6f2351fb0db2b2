// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>

#include "io/las/las.h"
#include "io/point_formats.h"
#include "pcl_slim/filters/io/point_file.h"

namespace pcl_slim {

namespace {

/** Coordinates of points as doubles. */
class LasPositions {
 public:
  /** \param[in] cloud must have x y z and outlive this object. */
  explicit LasPositions(const PointTable& cloud);

  double at(std::size_t point, std::size_t axis) const;
  std::size_t size() const { return size_; }

 private:
  const PointTable& cloud_;
  std::array<const PointField*, 3> fields_{};
  std::size_t size_ = 0;
};

/** How coordinates become whole numbers of 32 bits. */
struct LasUnits {
  std::array<double, 3> scale{}, offset{};
  std::array<double, 3> low{}, high{};  ///< box of the points
  bool exact = true;                    ///< every coordinate comes back bit by bit

  std::int32_t code(double value, std::size_t axis) const;
};

constexpr double kMostCode = 2147483647.0;
constexpr int kMostRefinement = 6;  ///< decimals; a scan's own are not far above its noise

/** Whether the units bring a coordinate back bit by bit. */
bool isExact(const LasUnits& units, double value, std::size_t a) {
  const double code = std::round((value - units.offset[a]) / units.scale[a]);
  return code >= -kMostCode - 1 && code <= kMostCode &&
         code * units.scale[a] + units.offset[a] == value;
}

/** Units of the cloud's own: decimal, a billionth of its extent. */
void chooseUnits(LasUnits& units) {
  for (std::size_t a = 0; a < 3; ++a) {
    const double extent = std::max(units.high[a] - units.low[a], 1e-6 * std::abs(units.high[a]));
    units.scale[a] = extent > 0 ? std::pow(10.0, std::ceil(std::log10(extent)) - 9) : 1e-9;
    const double grid = 1e6 * units.scale[a];
    units.offset[a] = std::round(0.5 * (units.low[a] + units.high[a]) / grid) * grid;
  }
}

/** The file's scales over the largest power of ten that lets every coordinate fit; none fits:
 * false. */
bool refineUnits(LasUnits& units) {
  double room = std::numeric_limits<double>::infinity();
  for (std::size_t a = 0; a < 3; ++a) {
    const double reach = std::max(std::abs(units.low[a] - units.offset[a]),
                                  std::abs(units.high[a] - units.offset[a]));
    room = std::min(room, kMostCode * std::abs(units.scale[a]) / reach);
  }
  if (!(room >= 1)) return false;
  int decimals = 0;
  while (decimals < kMostRefinement && room >= std::pow(10.0, decimals + 1)) ++decimals;
  for (double& scale : units.scale) scale /= std::pow(10.0, decimals);
  return true;
}

LasPositions::LasPositions(const PointTable& cloud) : cloud_(cloud), size_(numPoints(cloud)) {
  const char* const names[3] = {"x", "y", "z"};
  for (std::size_t a = 0; a < 3; ++a)
    fields_[a] = &cloud.fields[static_cast<std::size_t>(findField(cloud, names[a]))];
}

double LasPositions::at(std::size_t point, std::size_t axis) const {
  return fieldValue(cloud_, point, *fields_[axis]);
}

std::int32_t LasUnits::code(double value, std::size_t axis) const {
  const double code = std::round((value - offset[axis]) / scale[axis]);
  return static_cast<std::int32_t>(std::clamp(code, -kMostCode - 1, kMostCode));
}

/** The units of a file, or finer ones where its own cannot represent the coordinates, as after
 * smoothing: its scale over a power of ten, up to 10^6, as far as 32 bits reach. \param[in] given
 * the file's header, or null for units of the cloud's own. \return an error for coordinates that
 * are not finite. */
Result<LasUnits> lasUnits(const LasPositions& positions, const LasHeader* given) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  LasUnits units;
  units.low.fill(positions.size() > 0 ? kInfinity : 0.0);
  units.high.fill(positions.size() > 0 ? -kInfinity : 0.0);
  if (given) {
    units.scale = given->scale;
    units.offset = given->offset;
  }
  units.exact = given != nullptr;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    for (std::size_t a = 0; a < 3; ++a) {
      const double value = positions.at(i, a);
      if (!std::isfinite(value) || std::abs(value) > 1e99) {
        return Error{ErrorCode::kBadInput,
                     "point " + std::to_string(i) +
                         " has no coordinates that LAS can hold: NaN, infinite or beyond 1e99; "
                         "remove it, or write .pcd"};
      }
      units.low[a] = std::min(units.low[a], value);
      units.high[a] = std::max(units.high[a], value);
      units.exact = units.exact && isExact(units, value, a);
    }
  }
  if (!units.exact && !(given && refineUnits(units))) chooseUnits(units);
  return units;
}

/** A value of the record that takes a field's bytes as they are. */
struct LasCopy {
  std::size_t from = 0, to = 0, bytes = 0;
  int shift = 0, bits = 0;  ///< of a byte that several values share
};

/** A value of the record that takes a field's number in another type. */
struct LasConversion {
  const PointField* field = nullptr;
  LasItem item;
};

/** Which value of a point record each field of a cloud becomes. */
struct LasPlan {
  std::vector<unsigned char> head;  ///< the file's bytes before its points
  LasHeader header;                 ///< of that head
  std::size_t record_bytes = 0;
  std::vector<LasCopy> copies;
  std::vector<LasConversion> conversions;
  const PointField* packed_color = nullptr;  ///< bytes that red, green and blue come from
  bool single_returns = false;               ///< for points without fields of returns
};

/** A field of the cloud, or an element of one, that becomes an extra value. */
struct ExtraSource {
  LasExtra extra;
  std::size_t from = 0;
};

std::size_t countOf(const PointField& field) {
  return std::max<std::size_t>(field.count, 1);
}

const PointField* fieldNamed(const PointTable& cloud, const std::string& name) {
  const int i = findField(cloud, name);
  return i < 0 ? nullptr : &cloud.fields[static_cast<std::size_t>(i)];
}

/** Whether every point's number is one that the item can have. */
bool fitsItem(const PointTable& cloud, const PointField& field, const LasItem& item) {
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

  Result<LasPlan> plan() {
    for (const char* axis : {"x", "y", "z"}) {
      const PointField* field = fieldNamed(cloud_, axis);
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
  const PointField* packedColor() const {
    for (const char* name : {"rgb", "rgba"}) {
      const PointField* field = fieldNamed(cloud_, name);
      if (field && scalarSize(field->datatype) == 4 && countOf(*field) == 1) return field;
    }
    return nullptr;
  }

  Error takeHead() {
    const bool colored = packedColor() != nullptr || fieldNamed(cloud_, "red") != nullptr;
    plan_.head = file_.las_head.empty() ? newLasHead(colored ? 7 : 6) : file_.las_head;
    Result<LasHeader> header = parseLasHeader(plan_.head, ~std::uint64_t{0});
    if (!header) return header.error();
    plan_.header = std::move(*header);
    return {};
  }

  void takeItem(const LasItem& item) {
    const PointField* field = fieldNamed(cloud_, item.name);
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
  void takeColor() {
    const PointField* packed = packedColor();
    if (!packed || fieldNamed(cloud_, "red")) return;
    for (const LasItem& item : lasItems(plan_.header.format)) {
      if (item.name == "red") plan_.packed_color = packed;
    }
    if (plan_.packed_color && packed->name == "rgb") used_.push_back(packed);
  }

  /** The extra value that the file read has for a field, or null. */
  const LasExtra* describedExtra(const PointField& field) const {
    for (const LasExtra& extra : plan_.header.extras) {
      if (extra.name == field.name && extra.type == field.datatype && extra.count == countOf(field))
        return &extra;
    }
    return nullptr;
  }

  std::vector<ExtraSource> extraSources() const {
    std::vector<ExtraSource> sources;
    for (const PointField& field : cloud_.fields) {
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

  bool sameAsRead(const std::vector<LasExtra>& extras) const {
    const auto same = [](const LasExtra& a, const LasExtra& b) {
      return a.name == b.name && a.type == b.type && a.count == b.count;
    };
    const std::vector<LasExtra>& read = plan_.header.extras;
    return std::equal(extras.begin(), extras.end(), read.begin(), read.end(), same);
  }

  /** Names of values that the format has, which extra ones cannot take. */
  static Error checkExtra(const LasExtra& extra, int format) {
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

  Error takeExtras() {
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
  const PointTable& cloud_;
  LasPlan plan_;
  std::vector<const PointField*> used_;
};

/** Plans the file: fields of a value's name and type become that value, others extra bytes that a
 * VLR describes. \return an error for fields that do not fit. The cloud must outlive the plan. */
Result<LasPlan> planLas(const PointFile& file) {
  return Planner(file).plan();
}

void putNumber(unsigned char* at, std::uint8_t type, double value) {
  const auto put = [at](auto number) { std::memcpy(at, &number, sizeof(number)); };
  switch (type) {
    case kUInt8: return put(static_cast<std::uint8_t>(value));
    case kInt8: return put(static_cast<std::int8_t>(value));
    case kUInt16: return put(static_cast<std::uint16_t>(value));
    case kInt16: return put(static_cast<std::int16_t>(value));
    case kUInt32: return put(static_cast<std::uint32_t>(value));
    case kUInt64: return put(static_cast<std::uint64_t>(value));
    default: return put(value);
  }
}

/** Writes the records. */
class RecordWriter {
 public:
  RecordWriter(const PointTable& cloud, const LasPlan& plan) : cloud_(cloud), plan_(plan) {
    for (const LasItem& item : lasItems(plan.header.format)) {
      if (item.name == "red") red_at_ = item.offset;
    }
  }

  void write(std::size_t i, const LasUnits& units, const LasPositions& positions,
             unsigned char* record) const {
    for (std::size_t a = 0; a < 3; ++a) {
      const std::int32_t code = units.code(positions.at(i, a), a);
      std::memcpy(record + 4 * a, &code, sizeof(code));
    }
    if (plan_.single_returns) record[14] = 0x11;  // the first of one
    const std::uint8_t* point = cloud_.data.data() + i * cloud_.point_step;
    for (const LasCopy& copy : plan_.copies) {
      if (copy.bits == 0) {
        std::memcpy(record + copy.to, point + copy.from, copy.bytes);
      } else {
        record[copy.to] |= static_cast<unsigned char>(point[copy.from] << copy.shift);
      }
    }
    for (const LasConversion& conversion : plan_.conversions) convert(i, conversion, record);
    if (plan_.packed_color) writeColor(point + plan_.packed_color->offset, record + red_at_);
  }

 private:
  void convert(std::size_t i, const LasConversion& conversion, unsigned char* record) const {
    const LasItem& item = conversion.item;
    const double value = fieldValue(cloud_, i, *conversion.field);
    if (item.bits == 0)
      putNumber(record + item.offset, item.type, value);
    else
      record[item.offset] |= static_cast<unsigned char>(static_cast<int>(value) << item.shift);
  }

  /** From blue, green, red of 8 bits to red, green, blue of 16. */
  static void writeColor(const std::uint8_t* bgr, unsigned char* record) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto value = static_cast<std::uint16_t>(257 * bgr[2 - k]);
      std::memcpy(record + 2 * k, &value, sizeof(value));
    }
  }

  const PointTable& cloud_;
  const LasPlan& plan_;
  std::size_t red_at_ = 0;
};

/** The box in the header, where it is not that of the file read to within its own scale. */
void putBox(const LasUnits& units, std::vector<unsigned char>& bytes) {
  for (std::size_t a = 0; a < 3; ++a) {
    const double ends[2] = {units.high[a], units.low[a]};
    for (std::size_t k = 0; k < 2; ++k) {
      const std::size_t at = LasAt::kBox + 16 * a + 8 * k;
      const double is = getLas<double>(bytes.data() + at);
      const bool same = units.exact && std::abs(is - ends[k]) <= std::abs(units.scale[a]);
      if (!same) putLas(bytes, at, ends[k]);
    }
  }
}

/** Counts of all points and of those of each return, where the file read had other ones. */
void putCounts(const PointFile& file, const LasPlan& plan, std::vector<unsigned char>& bytes) {
  const std::size_t n = numPoints(file.cloud);
  if (n == plan.header.points && !file.las_head.empty()) return;
  std::uint64_t returns[15] = {};
  const int field = findField(file.cloud, "return_number");
  for (std::size_t i = 0; i < n; ++i) {
    const double number =
        field < 0 ? 1.0
                  : fieldValue(file.cloud, i, file.cloud.fields[static_cast<std::size_t>(field)]);
    if (number >= 1.0 && number <= 15.0) ++returns[static_cast<std::size_t>(number) - 1];
  }
  const bool old = plan.header.format < 6;  // the counts of 32 bits are for those formats alone
  putLas(bytes, LasAt::kOldCount, static_cast<std::uint32_t>(old ? n : 0));
  for (std::size_t k = 0; k < 5; ++k)
    putLas(bytes, LasAt::kOldReturns + 4 * k, static_cast<std::uint32_t>(old ? returns[k] : 0));
  if (plan.header.minor < 4) return;
  putLas(bytes, LasAt::kCount, static_cast<std::uint64_t>(n));
  for (std::size_t k = 0; k < 15; ++k) putLas(bytes, LasAt::kReturns + 8 * k, returns[k]);
}

/** Moves the addresses of what follows the points. */
void moveTail(std::uint64_t was, std::uint64_t is, const LasHeader& header,
              std::vector<unsigned char>& bytes) {
  const auto move = [&](std::size_t at) {
    const auto address = getLas<std::uint64_t>(bytes.data() + at);
    if (address >= was) putLas(bytes, at, address - was + is);
  };
  if (header.minor >= 3 && header.header_bytes >= LasAt::kEvlrs) move(LasAt::kWaveform);
  if (header.minor >= 4 && getLas<std::uint32_t>(bytes.data() + LasAt::kNumEvlrs) > 0)
    move(LasAt::kEvlrs);
}

}  // namespace

Result<std::vector<unsigned char>> formatLas(const PointFile& file) {
  const Result<LasPlan> plan = planLas(file);
  if (!plan) return plan.error();
  const LasPositions positions(file.cloud);
  const Result<LasUnits> units =
      lasUnits(positions, file.las_head.empty() ? nullptr : &plan->header);
  if (!units) return units.error();

  std::vector<unsigned char> bytes = plan->head;
  const std::size_t begin = bytes.size(), n = positions.size();
  bytes.resize(begin + n * plan->record_bytes, 0);
  const RecordWriter writer(file.cloud, *plan);
  for (std::size_t i = 0; i < n; ++i)
    writer.write(i, *units, positions, bytes.data() + begin + i * plan->record_bytes);
  putLas(bytes, LasAt::kRecordBytes, static_cast<std::uint16_t>(plan->record_bytes));
  for (std::size_t a = 0; a < 3 && !units->exact; ++a) {
    putLas(bytes, LasAt::kScale + 8 * a, units->scale[a]);
    putLas(bytes, LasAt::kOffset + 8 * a, units->offset[a]);
  }
  putBox(*units, bytes);
  putCounts(file, *plan, bytes);
  if (!file.las_tail.empty()) {
    const LasHeader& header = plan->header;
    moveTail(header.points_at + header.points * header.record_bytes, bytes.size(), header, bytes);
    bytes.insert(bytes.end(), file.las_tail.begin(), file.las_tail.end());
  }
  return bytes;
}

}  // namespace pcl_slim
