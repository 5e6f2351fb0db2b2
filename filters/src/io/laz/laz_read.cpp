// SPDX-License-Identifier: BSD-3-Clause
// LAZ by LASzip's library, which decompresses points one by one; the header and its records are copied.
#include <algorithm>
#include <cstdint>
#include <cstring>
#include <istream>
#include <limits>
#include <streambuf>

#include "io/las/las.h"
#include "io/laz/laz.h"

// After all others: it has a using directive.
#include <laszip/laszip_api.h>

namespace pcl_slim {

namespace {

using Bytes = std::vector<unsigned char>;

constexpr unsigned char kCompressed = 0xc0;  ///< bits of the point format
constexpr std::size_t kVlrHead = 54, kEvlrHead = 60;
constexpr int kFirstNew = 6;  ///< point format with the newer core

/** Bytes in memory as a stream that can seek. */
class MemoryBuffer : public std::streambuf {
 public:
  explicit MemoryBuffer(const Bytes& bytes) {
    char* begin = const_cast<char*>(reinterpret_cast<const char*>(bytes.data()));  // never written
    setg(begin, begin, begin + bytes.size());
  }

 protected:
  pos_type seekoff(off_type offset, std::ios_base::seekdir from, std::ios_base::openmode) override {
    const off_type size = egptr() - eback();
    const off_type base = from == std::ios_base::beg   ? 0
                          : from == std::ios_base::cur ? gptr() - eback()
                                                       : size;
    if (base + offset < 0 || base + offset > size) return pos_type(off_type(-1));
    setg(eback(), eback() + base + offset, egptr());
    return pos_type(base + offset);
  }
  pos_type seekpos(pos_type at, std::ios_base::openmode mode) override {
    return seekoff(off_type(at), std::ios_base::beg, mode);
  }
};

Error damaged(const std::string& what) {
  return badInput("the LAZ file is damaged: " + what + "; copy it again");
}

/** Whether a record belongs to the compression alone. */
bool isOfCompression(const unsigned char* record) {
  const auto isOf = [record](const char* user) {
    return std::memcmp(record + 2, user, std::strlen(user) + 1) == 0;
  };
  return isOf("laszip encoded") || isOf("copc");
}

/** LASzip's reader of one file. */
class Unpacker {
 public:
  explicit Unpacker(const Bytes& bytes) : bytes_(bytes), buffer_(bytes), stream_(&buffer_) {}
  ~Unpacker() {
    if (reader_ == nullptr) return;
    laszip_close_reader(reader_);
    laszip_destroy(reader_);
  }
  Unpacker(const Unpacker&) = delete;
  Unpacker& operator=(const Unpacker&) = delete;

  Result<Bytes> run() {
    if (Error error = takeHead()) return error;
    if (Error error = open()) return error;
    if (Error error = takePoints()) return error;
    takeTail();
    return std::move(out_);
  }

 private:
  template <typename T>
  T get(std::size_t at) const {
    return getLas<T>(bytes_.data() + at);
  }

  Error failed() const {
    laszip_CHAR* text = nullptr;
    laszip_get_error(reader_, &text);
    return damaged(std::string("LASzip reports '") + (text != nullptr ? text : "an error") + "'");
  }

  /** Header and records, with the uncompressed format. */
  Error takeHead() {
    const std::size_t size = bytes_.size();
    if (size < kOldLasHeaderBytes || std::memcmp(bytes_.data(), "LASF", 4) != 0)
      return damaged("it does not start with a LAS header");
    const std::size_t header = get<std::uint16_t>(LasAt::kHeaderBytes);
    const std::size_t points_at = get<std::uint32_t>(LasAt::kPointsAt);
    const unsigned char minor = bytes_[LasAt::kVersion + 1];
    format_ = bytes_[LasAt::kFormat] & ~kCompressed;
    record_bytes_ = get<std::uint16_t>(LasAt::kRecordBytes);
    if (header < (minor < 4 ? kOldLasHeaderBytes : kLasHeaderBytes) || points_at < header ||
        points_at > size || format_ > kMostLasFormat || record_bytes_ < lasRecordBytes(format_))
      return damaged("its header contradicts itself");
    count_ = get<std::uint32_t>(LasAt::kOldCount);
    if (minor >= 4 && get<std::uint64_t>(LasAt::kCount) > 0)
      count_ = get<std::uint64_t>(LasAt::kCount);
    const auto begin = bytes_.begin();
    out_.assign(begin, begin + static_cast<std::ptrdiff_t>(header));
    std::size_t at = header;
    std::uint32_t kept = 0;
    for (auto left = get<std::uint32_t>(LasAt::kNumVlrs); left > 0 && points_at - at >= kVlrHead;
         --left) {
      const std::size_t record = kVlrHead + get<std::uint16_t>(at + 20);
      if (record > points_at - at) return damaged("a record ends behind its points");
      if (!isOfCompression(bytes_.data() + at)) {
        append(at, record);
        ++kept;
      }
      at += record;
    }
    append(at, points_at - at);
    out_[LasAt::kFormat] = static_cast<unsigned char>(format_);
    putLas(out_, LasAt::kNumVlrs, kept);
    putLas(out_, LasAt::kPointsAt, static_cast<std::uint32_t>(out_.size()));
    return {};
  }

  void append(std::size_t at, std::size_t size) {
    const auto begin = bytes_.begin() + static_cast<std::ptrdiff_t>(at);
    out_.insert(out_.end(), begin, begin + static_cast<std::ptrdiff_t>(size));
  }

  Error open() {
    laszip_BOOL compressed = 0;
    if (laszip_create(&reader_) != 0) {
      reader_ = nullptr;
      return {ErrorCode::kIo, "LASzip cannot be started: free some memory"};
    }
    if (laszip_open_reader_stream(reader_, stream_, &compressed) != 0) return failed();
    return laszip_get_point_pointer(reader_, &point_) != 0 ? failed() : Error();
  }

  Error takePoints() {
    if (count_ > std::numeric_limits<std::uint32_t>::max() - 1)
      return badInput("the LAZ file has more than 2^32 - 2 points; split it");
    for (std::uint64_t i = 0; i < count_; ++i) {
      if (laszip_read_point(reader_) != 0) return failed();
      takePoint();
    }
    return {};
  }

  template <typename T>
  void put(T value) {
    const auto* raw = reinterpret_cast<const unsigned char*>(&value);
    out_.insert(out_.end(), raw, raw + sizeof(value));
  }

  void put(int value) = delete;  // bits are put as bytes

  void putByte(unsigned int value) { out_.push_back(static_cast<unsigned char>(value)); }

  void takePoint() {
    const laszip_point& p = *point_;
    const std::size_t begin = out_.size();
    for (const laszip_I32 place : {p.X, p.Y, p.Z}) put<std::int32_t>(place);
    put<std::uint16_t>(p.intensity);
    if (format_ < kFirstNew)
      putOldCore(p);
    else
      putNewCore(p);
    const bool has_time = format_ >= kFirstNew || format_ == 1 || (format_ >= 3 && format_ <= 5);
    const bool has_color = format_ == 2 || format_ == 3 || format_ == 5 || format_ == 7 ||
                           format_ == 8 || format_ == 10;
    const bool has_infrared = format_ == 8 || format_ == 10;
    const bool has_wave = format_ == 4 || format_ == 5 || format_ >= 9;
    if (has_time) put<double>(p.gps_time);
    for (int c = 0; c < (has_infrared ? 4 : has_color ? 3 : 0); ++c) put<std::uint16_t>(p.rgb[c]);
    if (has_wave) out_.insert(out_.end(), std::begin(p.wave_packet), std::end(p.wave_packet));
    const std::size_t extra = record_bytes_ - (out_.size() - begin);
    const auto there = static_cast<std::size_t>(std::max<laszip_I32>(p.num_extra_bytes, 0));
    if (p.extra_bytes != nullptr)
      out_.insert(out_.end(), p.extra_bytes, p.extra_bytes + std::min(extra, there));
    out_.resize(begin + record_bytes_, 0);
  }

  void putOldCore(const laszip_point& p) {
    putByte(p.return_number | p.number_of_returns << 3u | p.scan_direction_flag << 6u |
            p.edge_of_flight_line << 7u);
    putByte(p.classification | p.synthetic_flag << 5u | p.keypoint_flag << 6u |
            p.withheld_flag << 7u);
    put<std::int8_t>(p.scan_angle_rank);
    put<std::uint8_t>(p.user_data);
    put<std::uint16_t>(p.point_source_ID);
  }

  void putNewCore(const laszip_point& p) {
    putByte(p.extended_return_number | p.extended_number_of_returns << 4u);
    putByte(p.extended_classification_flags | p.extended_scanner_channel << 4u |
            p.scan_direction_flag << 6u | p.edge_of_flight_line << 7u);
    put<std::uint8_t>(p.extended_classification);
    put<std::uint8_t>(p.user_data);
    put<std::int16_t>(p.extended_scan_angle);
    put<std::uint16_t>(p.point_source_ID);
  }

  /** Records behind the points, whose places the header has. */
  void takeTail() {
    const bool waves = out_[LasAt::kVersion + 1] >= 3 &&
                       get<std::uint16_t>(LasAt::kHeaderBytes) > LasAt::kWaveform + 7;
    const std::uint64_t wave_at = waves ? get<std::uint64_t>(LasAt::kWaveform) : 0;
    std::uint64_t new_wave = 0;
    if (out_[LasAt::kVersion + 1] >= 4) {
      std::uint64_t at = get<std::uint64_t>(LasAt::kEvlrs);
      std::uint32_t kept = 0;
      const std::uint64_t begin = out_.size();
      for (auto left = get<std::uint32_t>(LasAt::kNumEvlrs); left > 0; --left) {
        if (at > bytes_.size() || bytes_.size() - at < kEvlrHead) break;
        const std::uint64_t content = get<std::uint64_t>(at + 20);
        if (content > bytes_.size() - at - kEvlrHead) break;
        if (!isOfCompression(bytes_.data() + at)) {
          if (at == wave_at) new_wave = out_.size();
          append(at, kEvlrHead + content);
          ++kept;
        }
        at += kEvlrHead + content;
      }
      putLas<std::uint64_t>(out_, LasAt::kEvlrs, kept > 0 ? begin : 0);
      putLas(out_, LasAt::kNumEvlrs, kept);
    } else if (wave_at > 0 && wave_at < bytes_.size()) {
      new_wave = out_.size();
      append(wave_at, bytes_.size() - wave_at);
    }
    if (waves) putLas(out_, LasAt::kWaveform, new_wave);
  }

  const Bytes& bytes_;
  MemoryBuffer buffer_;
  std::istream stream_;
  laszip_POINTER reader_ = nullptr;
  laszip_point* point_ = nullptr;
  int format_ = 0;
  std::size_t record_bytes_ = 0;
  std::uint64_t count_ = 0;
  Bytes out_;
};

}  // namespace

Error checkLaz(const std::string&) {
  return {};
}

Result<Bytes> unpackLaz(const Bytes& bytes) {
  const bool plain = bytes.size() > LasAt::kFormat && (bytes[LasAt::kFormat] & kCompressed) == 0;
  if (plain) return bytes;  // a LAS file of another name
  return Unpacker(bytes).run();
}

}  // namespace pcl_slim
