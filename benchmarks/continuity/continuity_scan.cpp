// SPDX-License-Identifier: BSD-3-Clause
#include "continuity/continuity_scan.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>
#include <random>

#include "scan/cloud_file.h"
#include "sensor/sensor_rows.h"

namespace pcl_slim::continuity {

namespace {

void keep(const std::vector<std::size_t>& kept, Scan& scan) {
  Scan result = scan;
  result.points.clear();
  result.row.clear();
  result.column.clear();
  for (const std::size_t i : kept) {
    result.points.push_back(scan.points[i]);
    if (scan.row.empty()) continue;
    result.row.push_back(scan.row[i]);
    result.column.push_back(scan.column[i]);
  }
  scan = std::move(result);
}

/** The points inside the middle part of an image, this share of its width and height. */
std::vector<std::size_t> window(const Scan& scan, double share) {
  const auto inside = [share](std::uint32_t at, std::uint32_t last) {
    return std::abs(2.0 * at - last) <= share * last;
  };
  const std::uint32_t rows = *std::max_element(scan.row.begin(), scan.row.end());
  const std::uint32_t columns = *std::max_element(scan.column.begin(), scan.column.end());
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    if (inside(scan.row[i], rows) && inside(scan.column[i], columns)) kept.push_back(i);
  }
  return kept;
}

Points pointsOf(const measure::SensorScan& scan) {
  Points points;
  for (std::size_t i = 0; i < scan.size(); ++i)
    points.push_back(Eigen::Map<const Eigen::Vector3f>(&scan.points[3 * i]).cast<double>());
  return points;
}

}  // namespace

Eigen::AlignedBox3d Scan::box() const {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& p : points) box.extend(p);
  return box;
}

Result<Scan> loadScan(const std::string& path) {
  const auto file = loadCloudFile(path);
  if (!file) return file.error();
  const CloudView view = file->view(false);
  Scan scan;
  scan.name = std::filesystem::path(path).stem().string();
  scan.floats = !file->double_precision;
  if (view.sensor) scan.sensor = Eigen::Map<const Eigen::Vector3d>(view.sensor->data());
  const std::uint32_t width = file->file.cloud.width;
  for (std::size_t i = 0; i < view.size; ++i) {
    const char* at = static_cast<const char*>(view.xyz) + i * view.xyz_stride;
    const Eigen::Vector3d p =
        scan.floats ? Eigen::Map<const Eigen::Vector3f>(reinterpret_cast<const float*>(at))
                          .cast<double>()
                          .eval()
                    : Eigen::Map<const Eigen::Vector3d>(reinterpret_cast<const double*>(at)).eval();
    if (!p.allFinite()) continue;
    scan.points.push_back(p);
    if (file->file.cloud.height < 2) continue;
    scan.row.push_back(static_cast<std::uint32_t>(i / width));
    scan.column.push_back(static_cast<std::uint32_t>(i % width));
  }
  return scan;
}

std::vector<Scan> generatedScans(const std::string& part, std::uint64_t seed) {
  std::vector<Scan> scans;
  for (const measure::SensorRow& row : measure::sensorRows(part)) {
    Scan scan;
    scan.name = row.name;
    const measure::SensorScan first = row.scan(seed);
    scan.points = pointsOf(first);
    if (first.one_sensor) scan.camera = Eigen::Map<const Eigen::Vector3d>(first.sensor.data());
    scan.second = pointsOf(row.scan(seed + 1));
    scans.push_back(std::move(scan));
  }
  return scans;
}

void reduce(std::size_t most, std::uint64_t seed, Scan& scan) {
  if (scan.points.size() <= most) return;
  std::vector<std::size_t> kept;
  if (scan.row.empty()) {
    std::vector<std::size_t> all(scan.points.size());
    std::iota(all.begin(), all.end(), 0);
    std::mt19937_64 rng(seed);
    std::sample(all.begin(), all.end(), std::back_inserter(kept), most, rng);
  } else {
    double low = 0, high = 1;
    for (int step = 0; step < 20; ++step) {
      const double middle = (low + high) / 2;
      (window(scan, middle).size() > most ? high : low) = middle;
    }
    kept = window(scan, low);
  }
  keep(kept, scan);
}

Result<measure::SmoothedPoints> smooth(const Points& points, bool floats,
                                       const std::optional<Eigen::Vector3d>& sensor,
                                       const PointOrigins& origins, const FitParams& params) {
  std::vector<Eigen::Vector3f> rounded;
  CloudView view;
  view.xyz = points.data();
  view.scalar = CloudView::Scalar::kDouble;
  view.xyz_stride = sizeof(Eigen::Vector3d);
  view.size = points.size();
  if (floats) {
    for (const Eigen::Vector3d& p : points) rounded.emplace_back(p.cast<float>());
    view.xyz = rounded.data();
    view.scalar = CloudView::Scalar::kFloat;
    view.xyz_stride = sizeof(Eigen::Vector3f);
  }
  if (sensor) view.sensor = {sensor->x(), sensor->y(), sensor->z()};
  if (!origins.sensors.empty()) {
    view.sensors = origins.sensors.data();
    view.sensors_stride = sizeof(Eigen::Vector3d);
  }
  if (!origins.frames.empty()) view.frame_numbers = origins.frames.data();
  return measure::smoothPoints(view, params);
}

}  // namespace pcl_slim::continuity
