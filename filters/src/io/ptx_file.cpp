// SPDX-License-Identifier: BSD-3-Clause
// Leica's PTX: scans in rows and columns, each with its scanner's place.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "io/ply_file.h"
#include "io/point_formats.h"
#include "io/text/text.h"

namespace pcl_slim {

namespace {

constexpr std::size_t kHeadLines = 8;  ///< place and axes, 3 numbers each; matrix, 4 lines of 4
constexpr std::size_t kMostNumbers = 7;

struct Scan {
  std::size_t columns = 0, rows = 0;
  std::array<std::array<double, 4>, 4> matrix{};  ///< row vectors: p' = p R + t
};

struct Point {
  std::array<double, 3> place{};
  float intensity = 0;
  std::array<std::uint8_t, 3> color{};
};

class PtxReader {
 public:
  explicit PtxReader(const PlainText& text)
      : scanner_(reinterpret_cast<const unsigned char*>(text.begin),
                 static_cast<std::size_t>(text.end - text.begin)) {}

  Result<PointFile> read() {
    while (nextNumbers()) {
      Scan scan;
      if (Error error = readHead(scan)) return error;
      if (Error error = readPoints(scan)) return error;
      scans_.push_back(scan);
    }
    if (bad_) return badLine("is no list of numbers");
    if (scans_.empty()) return badInput("it has no scan: name a PTX file");
    return toFile();
  }

 private:
  Error badLine(const std::string& what) const {
    return badInput("line " + std::to_string(line_) + " of the PTX file " + what +
                    "; copy it again, or mend the line");
  }

  /** The numbers of the next line that is not blank. false: there is none, or it has others. */
  bool nextNumbers() {
    std::string line;
    count_ = 0;
    while (scanner_.nextLine(line)) {
      ++line_;
      splitLine(line.data(), line.data() + line.size(), ' ', words_);
      if (words_.empty()) continue;
      bool ignored = false;
      bad_ = words_.size() > kMostNumbers;
      for (std::size_t k = 0; k < words_.size() && !bad_; ++k)
        bad_ = !parseDecimal(words_[k].begin, words_[k].end, numbers_[k], ignored);
      count_ = words_.size();
      return !bad_;
    }
    return false;
  }

  Error readCount(std::size_t& count) const {
    const double value = numbers_[0];
    if (count_ != 1 || !(value >= 0 && value < 4294967295.0 && value == std::floor(value)))
      return badLine("is no number of columns or rows, which begin a scan");
    count = static_cast<std::size_t>(value);
    return {};
  }

  Error readHead(Scan& scan) {
    if (Error error = readCount(scan.columns)) return error;
    if (!nextNumbers()) return unexpectedEnd("its head");
    if (Error error = readCount(scan.rows)) return error;
    for (std::size_t k = 0; k < kHeadLines; ++k) {
      if (!nextNumbers()) return unexpectedEnd("its head");
      const std::size_t wanted = k < 4 ? 3 : 4;
      if (count_ != wanted)
        return badLine("has " + std::to_string(count_) + " numbers where a scan's head has " +
                       std::to_string(wanted));
      if (k < 4) continue;  // the place and the axes again, before a user's own coordinates
      std::copy_n(numbers_.begin(), 4, scan.matrix[k - 4].begin());
    }
    for (const auto& row : scan.matrix) {
      for (const double value : row) {
        if (!std::isfinite(value)) return badLine("ends a matrix that is not finite");
      }
    }
    const std::size_t points = points_.size();
    if (scan.rows != 0 && scan.columns > (0xfffffffeu - points) / scan.rows)
      return badInput("the PTX file announces more than 2^32 - 2 points; split it");
    return {};
  }

  Error unexpectedEnd(const std::string& part) const {
    if (bad_) return badLine("is no list of numbers");
    return badInput("the PTX file is truncated: scan " + std::to_string(scans_.size() + 1) +
                    " ends in " + part + "; copy it again");
  }

  Error readPoints(const Scan& scan) {
    const std::size_t wanted = scan.columns * scan.rows;
    for (std::size_t i = 0; i < wanted; ++i) {
      if (!nextNumbers())
        return unexpectedEnd("point " + std::to_string(i + 1) + " of " + std::to_string(wanted));
      if (count_ == 1)
        return badLine("begins another scan before the last of " + std::to_string(wanted) +
                       " points");
      if (count_ != 3 && count_ != 4 && count_ != 6 && count_ != 7)
        return badLine("has " + std::to_string(count_) +
                       " numbers, not x y z, intensity and r g b");
      takePoint(scan);
    }
    return {};
  }

  void takePoint(const Scan& scan) {
    Point point;
    const bool missing = numbers_[0] == 0 && numbers_[1] == 0 && numbers_[2] == 0;
    for (std::size_t a = 0; a < 3; ++a) {
      double sum = scan.matrix[3][a];
      for (std::size_t b = 0; b < 3; ++b) sum += numbers_[b] * scan.matrix[b][a];
      point.place[a] = missing ? std::numeric_limits<double>::quiet_NaN() : sum;
    }
    if (count_ == 4 || count_ == 7) {
      has_intensity_ = true;
      point.intensity = static_cast<float>(numbers_[3]);
    }
    if (count_ >= 6) {
      has_color_ = true;
      for (std::size_t a = 0; a < 3; ++a) {
        const double value = numbers_[count_ - 3 + a];
        if (value > 0)
          point.color[a] = static_cast<std::uint8_t>(std::lround(std::min(value, 255.0)));
      }
    }
    points_.push_back(point);
  }

  PointFile toFile() const {
    PointFile file;
    PointTable& cloud = file.cloud;
    const bool several = scans_.size() > 1;
    for (const char* axis : {"x", "y", "z"}) addField(cloud, axis, kFloat64);
    if (several) {
      for (const char* axis : {"vp_x", "vp_y", "vp_z"}) addField(cloud, axis, kFloat64);
      addField(cloud, "frame", kUInt32);
    }
    if (has_intensity_) addField(cloud, "intensity", kFloat32);
    if (has_color_) addField(cloud, "rgb", kFloat32);
    cloud.point_step = (cloud.point_step + 7) / 8 * 8;  // coordinates are used in place
    cloud.resize(points_.size());
    std::size_t at = 0;
    for (std::size_t s = 0; s < scans_.size(); ++s) {
      const std::size_t end = at + scans_[s].columns * scans_[s].rows;
      for (; at < end; ++at) put(at, s, cloud);
    }
    if (!several) placeSensor(file);
    return file;
  }

  void put(std::size_t i, std::size_t scan, PointTable& cloud) const {
    std::uint8_t* at = cloud.data.data() + i * cloud.point_step;
    const auto write = [&at](const auto& value) {
      std::memcpy(at, &value, sizeof(value));
      at += sizeof(value);
    };
    const Point& point = points_[i];
    write(point.place);
    if (scans_.size() > 1) {
      for (std::size_t a = 0; a < 3; ++a) write(scans_[scan].matrix[3][a]);
      write(static_cast<std::uint32_t>(scan));
    }
    if (has_intensity_) write(point.intensity);
    if (has_color_)
      write(std::array<std::uint8_t, 4>{point.color[2], point.color[1], point.color[0], 0});
  }

  /** Points come column by column: those are the rows of the organised cloud. */
  void placeSensor(PointFile& file) const {
    const Scan& scan = scans_.front();
    file.cloud.width = static_cast<std::uint32_t>(scan.rows);
    file.cloud.height = static_cast<std::uint32_t>(scan.columns);
    const auto& m = scan.matrix;
    for (std::size_t a = 0; a < 3; ++a) file.sensor_origin[a] = static_cast<float>(m[3][a]);
    // Of a rotation whose rows are the axes' images: the quaternion with a positive real part.
    const double w = 0.5 * std::sqrt(std::max(0.0, 1 + m[0][0] + m[1][1] + m[2][2]));
    const auto part = [&](double square, double difference) {
      const double size = 0.5 * std::sqrt(std::max(0.0, square));
      return static_cast<float>(difference < 0 ? -size : size);
    };
    file.sensor_orientation = {static_cast<float>(w),
                               part(1 + m[0][0] - m[1][1] - m[2][2], m[1][2] - m[2][1]),
                               part(1 - m[0][0] + m[1][1] - m[2][2], m[2][0] - m[0][2]),
                               part(1 - m[0][0] - m[1][1] + m[2][2], m[0][1] - m[1][0])};
  }

  TextScanner scanner_;
  std::size_t line_ = 0, count_ = 0;
  std::array<double, kMostNumbers> numbers_{};
  std::vector<TextWord> words_;
  bool bad_ = false, has_intensity_ = false, has_color_ = false;
  std::vector<Scan> scans_;
  std::vector<Point> points_;
};

}  // namespace

Result<PointFile> parsePtx(const std::vector<unsigned char>& bytes) {
  PlainText text;
  if (Error error = decodeText(bytes, text)) return error;
  return PtxReader(text).read();
}

}  // namespace pcl_slim
