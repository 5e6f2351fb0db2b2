// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstring>

#include "io/las/las.h"
#include "io/point_formats.h"

namespace pcl_slim {

namespace {

/** What follows a format's core. */
struct Groups {
  bool gps_time, color, near_infrared, wave_packet;
};

constexpr Groups kGroups[kMostLasFormat + 1] = {
    {false, false, false, false}, {true, false, false, false}, {false, true, false, false},
    {true, true, false, false},   {true, false, false, true},  {true, true, false, true},
    {true, false, false, false},  {true, true, false, false},  {true, true, true, false},
    {true, false, false, true},   {true, true, true, true}};

/** Formats 0 to 5. */
std::vector<LasItem> oldCore() {
  return {{"intensity", kUInt16, 12},
          {"return_number", kUInt8, 14, 0, 3},
          {"number_of_returns", kUInt8, 14, 3, 3},
          {"scan_direction_flag", kUInt8, 14, 6, 1},
          {"edge_of_flight_line", kUInt8, 14, 7, 1},
          {"classification", kUInt8, 15, 0, 5},
          {"synthetic", kUInt8, 15, 5, 1},
          {"key_point", kUInt8, 15, 6, 1},
          {"withheld", kUInt8, 15, 7, 1},
          {"scan_angle_rank", kInt8, 16},
          {"user_data", kUInt8, 17},
          {"point_source_id", kUInt16, 18}};
}

/** Formats 6 to 10. */
std::vector<LasItem> newCore() {
  return {{"intensity", kUInt16, 12},
          {"return_number", kUInt8, 14, 0, 4},
          {"number_of_returns", kUInt8, 14, 4, 4},
          {"synthetic", kUInt8, 15, 0, 1},
          {"key_point", kUInt8, 15, 1, 1},
          {"withheld", kUInt8, 15, 2, 1},
          {"overlap", kUInt8, 15, 3, 1},
          {"scanner_channel", kUInt8, 15, 4, 2},
          {"scan_direction_flag", kUInt8, 15, 6, 1},
          {"edge_of_flight_line", kUInt8, 15, 7, 1},
          {"classification", kUInt8, 16},
          {"user_data", kUInt8, 17},
          {"scan_angle", kInt16, 18},
          {"point_source_id", kUInt16, 20}};
}

/** Appends values one after another. */
void append(std::vector<LasItem>& items, std::size_t& offset, std::uint8_t type,
            std::initializer_list<const char*> names) {
  for (const char* name : names) {
    items.push_back({name, type, offset});
    offset += scalarSize(type);
  }
}

/** The values, and the bytes of a record. */
std::size_t layOut(int format, std::vector<LasItem>& items) {
  const Groups& groups = kGroups[format];
  items = format < 6 ? oldCore() : newCore();
  std::size_t offset = format < 6 ? 20 : 22;
  if (groups.gps_time) append(items, offset, kFloat64, {"gps_time"});
  if (groups.color) append(items, offset, kUInt16, {"red", "green", "blue"});
  if (groups.near_infrared) append(items, offset, kUInt16, {"nir"});
  if (groups.wave_packet) {
    append(items, offset, kUInt8, {"wave_descriptor"});
    append(items, offset, kUInt64, {"wave_offset"});
    append(items, offset, kUInt32, {"wave_bytes"});
    append(items, offset, kFloat32, {"wave_location", "wave_x", "wave_y", "wave_z"});
  }
  return offset;
}

constexpr std::size_t kVlrHeaderBytes = 54;
constexpr std::size_t kExtraBytes = 192;  ///< of one record of the VLR of extra bytes
constexpr char kExtraUser[] = "LASF_Spec";
constexpr std::uint16_t kExtraId = 4;
constexpr double kMostMagnitude = 1e100;  ///< of scale and offset: coordinates stay finite
/** ScalarTypes of the data types 1 to 10 of an extra value (LAS 1.4 R15, table 25). */
constexpr std::uint8_t kExtraTypes[] = {0,      kUInt8,  kInt8,  kUInt16,  kInt16,  kUInt32,
                                        kInt32, kUInt64, kInt64, kFloat32, kFloat64};
constexpr int kScalarTypes = 10;

struct Vlr {
  std::size_t begin = 0, bytes = 0;  ///< in the file, its header of 54 bytes included
  bool holds_extras = false;
};

/** The VLRs of a head, as far as the header's bytes contain them. */
std::vector<Vlr> findVlrs(const std::vector<unsigned char>& head, const LasHeader& header) {
  std::vector<Vlr> vlrs;
  const auto count = getLas<std::uint32_t>(head.data() + LasAt::kNumVlrs);
  std::size_t at = header.header_bytes;
  for (std::uint32_t i = 0; i < count && header.points_at - at >= kVlrHeaderBytes; ++i) {
    const unsigned char* p = head.data() + at;
    const std::size_t bytes = kVlrHeaderBytes + getLas<std::uint16_t>(p + 20);
    if (bytes > header.points_at - at) break;
    const bool holds_extras = std::memcmp(p + 2, kExtraUser, sizeof(kExtraUser)) == 0 &&
                              getLas<std::uint16_t>(p + 18) == kExtraId;
    vlrs.push_back({at, bytes, holds_extras});
    at += bytes;
  }
  return vlrs;
}

std::string nameIn(const unsigned char* record) {
  const char* text = reinterpret_cast<const char*>(record + 4);
  std::string name(text, std::find(text, text + 32, '\0'));
  for (char& c : name) {
    if (static_cast<unsigned char>(c) <= ' ' || c == '\x7f') c = '_';
  }
  return name;
}

/** What a record of the VLR describes. */
LasExtra extraOf(const unsigned char* record) {
  LasExtra extra;
  const int type = record[2];
  extra.record.assign(record, record + kExtraBytes);
  extra.name = nameIn(record);
  if (type >= 1 && type <= 3 * kScalarTypes) {  // pairs and triples are of older versions
    extra.type = kExtraTypes[(type - 1) % kScalarTypes + 1];
    extra.count = static_cast<std::size_t>((type - 1) / kScalarTypes + 1);
  } else {
    extra.type = kUInt8;
    extra.count = record[3];
  }
  if (extra.name.empty()) extra.name = "extra_bytes";
  return extra;
}

/** Gives fields of one name different ones. */
void makeNamesUnique(int format, std::vector<LasExtra>& extras) {
  std::vector<std::string> taken = {"x", "y", "z"};
  for (const LasItem& item : lasItems(format)) taken.push_back(item.name);
  for (LasExtra& extra : extras) {
    const std::string name = extra.name;
    for (int k = 2; std::count(taken.begin(), taken.end(), extra.name) > 0; ++k)
      extra.name = name + "_" + std::to_string(k);
    taken.push_back(extra.name);
  }
}

/** Describes the bytes of a record behind its format's. */
void findExtras(const std::vector<unsigned char>& bytes, LasHeader& header) {
  std::size_t left = header.record_bytes - lasRecordBytes(header.format);
  for (const Vlr& vlr : findVlrs(bytes, header)) {
    if (!vlr.holds_extras || !header.extras.empty()) continue;
    const std::size_t end = vlr.begin + vlr.bytes;
    for (std::size_t at = vlr.begin + kVlrHeaderBytes; at + kExtraBytes <= end; at += kExtraBytes) {
      LasExtra extra = extraOf(bytes.data() + at);
      if (extra.bytes() > left) break;
      left -= extra.bytes();
      if (extra.count > 0) header.extras.push_back(std::move(extra));
    }
  }
  if (left > 0) header.extras.push_back({"extra_bytes", kUInt8, left, {}});
  makeNamesUnique(header.format, header.extras);
}

Error corrupted(const std::string& what) {
  return badInput("the LAS file's header is corrupted: " + what + "; copy it again");
}

/** Version, sizes and format. */
Error readSizes(const std::vector<unsigned char>& bytes, LasHeader& header) {
  const unsigned char* p = bytes.data();
  if (bytes.size() < 4 || std::memcmp(p, "LASF", 4) != 0)
    return badInput("not a LAS file: it does not start with 'LASF'; name a LAS file");
  if (bytes.size() < kOldLasHeaderBytes)
    return badInput("the LAS file is truncated inside its header; copy it again");
  header.minor = p[LasAt::kVersion + 1];
  header.header_bytes = getLas<std::uint16_t>(p + LasAt::kHeaderBytes);
  header.points_at = getLas<std::uint32_t>(p + LasAt::kPointsAt);
  header.format = p[LasAt::kFormat] & 0x7f;
  header.record_bytes = getLas<std::uint16_t>(p + LasAt::kRecordBytes);
  if (p[LasAt::kVersion] != 1 || header.minor > 4) {
    return badInput("the LAS file has version " + std::to_string(p[LasAt::kVersion]) + "." +
                    std::to_string(header.minor) + ", not 1.0 to 1.4; convert it with 'las2las'");
  }
  if (header.format > kMostLasFormat)
    return corrupted("point format " + std::to_string(header.format) + " is not 0 to 10");
  if (header.header_bytes < (header.minor < 4 ? kOldLasHeaderBytes : kLasHeaderBytes) ||
      header.points_at < header.header_bytes)
    return corrupted("its parts overlap");
  if (header.points_at > bytes.size())
    return badInput("the LAS file is truncated before its points; copy it again");
  if (header.record_bytes < lasRecordBytes(header.format)) {
    return corrupted("records of " + std::to_string(header.record_bytes) +
                     " bytes are too short for point format " + std::to_string(header.format));
  }
  return {};
}

/** Number of points, units. */
Error readUnits(const std::vector<unsigned char>& bytes, std::uint64_t size, LasHeader& header) {
  const unsigned char* p = bytes.data();
  header.points = getLas<std::uint32_t>(p + LasAt::kOldCount);
  if (header.minor == 4) {
    const auto count = getLas<std::uint64_t>(p + LasAt::kCount);
    if (count > 0) header.points = count;
  }
  const std::uint64_t there = (size - header.points_at) / header.record_bytes;
  if (header.points > there) {
    return badInput("the LAS file is truncated: " + std::to_string(there) + " of " +
                    std::to_string(header.points) + " points; copy it again");
  }
  if (header.points > 0xfffffffeu)
    return badInput("the LAS file has more than 2^32 - 2 points; split it");
  for (std::size_t a = 0; a < 3; ++a) {
    header.scale[a] = getLas<double>(p + LasAt::kScale + 8 * a);
    header.offset[a] = getLas<double>(p + LasAt::kOffset + 8 * a);
    const double s = std::abs(header.scale[a]);
    if (!(s >= 1 / kMostMagnitude && s <= kMostMagnitude) ||
        !(std::abs(header.offset[a]) <= kMostMagnitude))
      return corrupted("scale or offset of the coordinates is no usable number");
  }
  return {};
}

/** A record for a value that none describes yet. */
std::vector<unsigned char> recordOf(const LasExtra& extra) {
  std::vector<unsigned char> record(kExtraBytes, 0);
  const auto type = std::find(kExtraTypes + 1, std::end(kExtraTypes), extra.type);
  const bool scalar = extra.count == 1 && type != std::end(kExtraTypes);
  record[2] = scalar ? static_cast<unsigned char>(type - kExtraTypes) : 0;
  record[3] = scalar ? 0 : static_cast<unsigned char>(extra.bytes());
  std::copy_n(extra.name.begin(), std::min<std::size_t>(extra.name.size(), 32), record.begin() + 4);
  return record;
}

}  // namespace

std::vector<LasItem> lasItems(int format) {
  std::vector<LasItem> items;
  layOut(format, items);
  return items;
}

std::size_t lasRecordBytes(int format) {
  std::vector<LasItem> items;
  return layOut(format, items);
}

std::size_t LasExtra::bytes() const {
  return scalarSize(type) * count;
}

Result<LasHeader> parseLasHeader(const std::vector<unsigned char>& bytes, std::uint64_t size) {
  LasHeader header;
  if (Error error = readSizes(bytes, header)) return error;
  if (Error error = readUnits(bytes, size, header)) return error;
  findExtras(bytes, header);
  return header;
}

std::vector<unsigned char> newLasHead(int format) {
  std::vector<unsigned char> head(kLasHeaderBytes, 0);
  std::memcpy(head.data(), "LASF", 4);
  putLas<std::uint16_t>(head, LasAt::kGlobalEncoding, 1u << 4);  // coordinate systems as WKT
  head[LasAt::kVersion] = 1;
  head[LasAt::kVersion + 1] = 4;
  std::memcpy(head.data() + LasAt::kSystem, "OTHER", 5);
  std::memcpy(head.data() + LasAt::kSoftware, "pcl_slim", 8);
  putLas<std::uint16_t>(head, LasAt::kHeaderBytes, kLasHeaderBytes);
  putLas<std::uint32_t>(head, LasAt::kPointsAt, kLasHeaderBytes);
  head[LasAt::kFormat] = static_cast<unsigned char>(format);
  putLas(head, LasAt::kRecordBytes, static_cast<std::uint16_t>(lasRecordBytes(format)));
  for (std::size_t a = 0; a < 3; ++a) putLas(head, LasAt::kScale + 8 * a, 1.0);
  return head;
}

Result<std::vector<unsigned char>> withExtras(const std::vector<unsigned char>& head,
                                              const std::vector<LasExtra>& extras) {
  const Result<LasHeader> header = parseLasHeader(head, ~std::uint64_t{0});
  if (!header) return header.error();
  std::vector<unsigned char> made(head.begin(),
                                  head.begin() + static_cast<std::ptrdiff_t>(header->header_bytes));
  std::uint32_t count = 0;
  std::size_t end = header->header_bytes;
  for (const Vlr& vlr : findVlrs(head, *header)) {
    const auto begin = head.begin() + static_cast<std::ptrdiff_t>(vlr.begin);
    end = vlr.begin + vlr.bytes;
    if (vlr.holds_extras) continue;
    made.insert(made.end(), begin, begin + static_cast<std::ptrdiff_t>(vlr.bytes));
    ++count;
  }
  const std::size_t payload = kExtraBytes * extras.size();
  if (payload > 0xffff)
    return Error{ErrorCode::kBadArgument, "LAS holds at most 341 extra fields; write .pcd"};
  if (!extras.empty()) {
    const std::size_t at = made.size();
    made.resize(at + kVlrHeaderBytes, 0);
    std::memcpy(made.data() + at + 2, kExtraUser, sizeof(kExtraUser));
    putLas(made, at + 18, kExtraId);
    putLas(made, at + 20, static_cast<std::uint16_t>(payload));
    for (const LasExtra& extra : extras) {
      const auto record = extra.record.empty() ? recordOf(extra) : extra.record;
      made.insert(made.end(), record.begin(), record.end());
    }
    ++count;
  }
  // Bytes between the VLRs and the points are kept.
  made.insert(made.end(), head.begin() + static_cast<std::ptrdiff_t>(end),
              head.begin() + static_cast<std::ptrdiff_t>(header->points_at));
  putLas(made, LasAt::kNumVlrs, count);
  putLas(made, LasAt::kPointsAt, static_cast<std::uint32_t>(made.size()));
  return made;
}

namespace {

/** A run of bytes to copy, or bits to take out of one. */
struct Move {
  std::size_t from = 0, to = 0, bytes = 0;
  int shift = 0, bits = 0;
};

/** The fields of the cloud, and how a record fills them. A point's bytes are a multiple of 8, so
 * that coordinates can be used in place. */
std::vector<Move> layOut(const LasHeader& header, PointTable& cloud) {
  std::vector<Move> moves;
  for (const char* axis : {"x", "y", "z"}) addField(cloud, axis, kFloat64);
  for (const LasItem& item : lasItems(header.format)) {
    moves.push_back({item.offset, cloud.point_step, scalarSize(item.type), item.shift, item.bits});
    addField(cloud, item.name, item.type);
  }
  std::size_t from = lasRecordBytes(header.format);
  for (const LasExtra& extra : header.extras) {
    moves.push_back({from, cloud.point_step, extra.bytes()});
    addField(cloud, extra.name, extra.type, extra.count);
    from += extra.bytes();
  }
  cloud.point_step = (cloud.point_step + 7) / 8 * 8;
  return moves;
}

void readRecord(const unsigned char* record, const LasHeader& header,
                const std::vector<Move>& moves, std::uint8_t* point) {
  double xyz[3];
  for (std::size_t a = 0; a < 3; ++a) {
    xyz[a] = getLas<std::int32_t>(record + 4 * a) * header.scale[a] + header.offset[a];
  }
  std::memcpy(point, xyz, sizeof(xyz));
  for (const Move& move : moves) {
    if (move.bits == 0) {
      std::memcpy(point + move.to, record + move.from, move.bytes);
    } else {
      const int value = record[move.from] >> move.shift;
      point[move.to] = static_cast<std::uint8_t>(value & ((1 << move.bits) - 1));
    }
  }
}

/** Whether nothing that the header announces follows the points, but more of them do. */
Error checkEnd(const std::vector<unsigned char>& bytes, const LasHeader& header) {
  const unsigned char* p = bytes.data();
  const bool waves = header.minor >= 3 && header.header_bytes >= LasAt::kEvlrs &&
                     getLas<std::uint64_t>(p + LasAt::kWaveform) != 0;
  const bool records = header.minor >= 4 && getLas<std::uint32_t>(p + LasAt::kNumEvlrs) != 0;
  const std::uint64_t there = (bytes.size() - header.points_at) / header.record_bytes;
  if (waves || records || there == header.points) return {};
  return badInput("the LAS header announces " + std::to_string(header.points) +
                  " points, and the file has " + std::to_string(there) +
                  ": copy it again, or mend the header: lasinfo -repair");
}

}  // namespace

Result<PointFile> parseLas(const std::vector<unsigned char>& bytes) {
  const Result<LasHeader> header = parseLasHeader(bytes, bytes.size());
  if (!header) return header.error();
  if (Error error = checkEnd(bytes, *header)) return error;
  PointFile file;
  const std::vector<Move> moves = layOut(*header, file.cloud);
  const auto points = static_cast<std::size_t>(header->points);
  file.cloud.resize(points);
  const unsigned char* record = bytes.data() + header->points_at;
  std::uint8_t* point = file.cloud.data.data();
  for (std::size_t i = 0; i < points; ++i) {
    readRecord(record, *header, moves, point);
    record += header->record_bytes;
    point += file.cloud.point_step;
  }
  const auto begin = bytes.begin();
  const std::size_t end = header->points_at + points * header->record_bytes;
  file.las_head.assign(begin, begin + static_cast<std::ptrdiff_t>(header->points_at));
  file.las_tail.assign(begin + static_cast<std::ptrdiff_t>(end), bytes.end());
  file.degrees = hasDegrees(file.las_head, file.las_tail, end);
  return file;
}

}  // namespace pcl_slim
