// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstring>

#include "io/las/las_bytes.h"
#include "io/las/las_file.h"
#include "io/las/las_plan.h"
#include "io/las/las_units.h"
#include "io/scalar_type.h"

namespace pcl_slim {

namespace {

void
putNumber(unsigned char* at, std::uint8_t type, double value)
{
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
  RecordWriter(const pcl::PCLPointCloud2& cloud, const LasPlan& plan) : cloud_(cloud), plan_(plan)
  {
    for (const LasItem& item : lasItems(plan.header.format)) {
      if (item.name == "red") red_at_ = item.offset;
    }
  }

  void write(std::size_t i, const LasUnits& units, const LasPositions& positions,
             unsigned char* record) const
  {
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
  void convert(std::size_t i, const LasConversion& conversion, unsigned char* record) const
  {
    const LasItem& item = conversion.item;
    const double value = fieldValue(cloud_, i, *conversion.field);
    if (item.bits == 0)
      putNumber(record + item.offset, item.type, value);
    else
      record[item.offset] |= static_cast<unsigned char>(static_cast<int>(value) << item.shift);
  }

  /** From blue, green, red of 8 bits to red, green, blue of 16. */
  static void writeColor(const std::uint8_t* bgr, unsigned char* record)
  {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto value = static_cast<std::uint16_t>(257 * bgr[2 - k]);
      std::memcpy(record + 2 * k, &value, sizeof(value));
    }
  }

  const pcl::PCLPointCloud2& cloud_;
  const LasPlan& plan_;
  std::size_t red_at_ = 0;
};

/** The box in the header, where it is not that of the file read to within its own scale. */
void
putBox(const LasUnits& units, std::vector<unsigned char>& bytes)
{
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
void
putCounts(const PointFile& file, const LasPlan& plan, std::vector<unsigned char>& bytes)
{
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

/** Moves the addresses of what stands behind the points. */
void
moveTail(std::uint64_t was, std::uint64_t is, const LasHeader& header,
         std::vector<unsigned char>& bytes)
{
  const auto move = [&](std::size_t at) {
    const auto address = getLas<std::uint64_t>(bytes.data() + at);
    if (address >= was) putLas(bytes, at, address - was + is);
  };
  if (header.minor >= 3 && header.header_bytes >= LasAt::kEvlrs) move(LasAt::kWaveform);
  if (header.minor >= 4 && getLas<std::uint32_t>(bytes.data() + LasAt::kNumEvlrs) > 0)
    move(LasAt::kEvlrs);
}

}  // namespace

Result<std::vector<unsigned char>>
formatLas(const PointFile& file)
{
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
