// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "amphora.h"
#include "common/file_program.h"
#include "common/options.h"
#include "common/program.h"
#include "common/programs.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/core/file_access.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/core/random.h"

// pcl_slim_demo_scan: a coloured object as a laser scanner sees it, to try the other programs on.

namespace pcl_slim::demo {

namespace {

/** \brief Settings of a simulated scan. */
struct ScanParams {
  std::uint64_t points = 200000;  ///< points wanted; organized: pixels, hit or not
  double noise = 0.001;  ///< std. deviation at medium range, share of the object's diagonal
  std::uint64_t seed = 1;
  double dent = 0.0;       ///< depth of a dent in the belly [m]
  bool organized = false;  ///< one station's grid with NaN where nothing was hit
  int threads = 0;         ///< 0: all cores; never changes the result
};

/** \brief A coloured cloud: x y z per point, metres, and packed 0x00RRGGBB. */
struct Scan {
  std::uint32_t width = 0, height = 1;
  std::vector<float> xyz;
  std::vector<std::uint32_t> rgb;
  std::array<float, 3> sensor{};  ///< where an organized scan was made from; 0 for several places
};

constexpr double kMediumRange = 1.2;  ///< metres
constexpr double kMaxStepAngle = 0.05;

/** \brief A tripod around the object. */
struct Station {
  double azimuth_degrees, range, height;
};
constexpr Station kStations[] = {
    {-65.0, 1.00, 0.52}, {28.0, 1.35, 0.36}, {122.0, 1.15, 0.70}, {205.0, 1.60, 0.20}};

/** \brief Counter-based random bits (of SplitMix64): a value per ray and purpose, whatever
 * the order in which rays are shot. */
std::uint64_t randomBits(std::uint64_t seed, std::uint64_t ray, std::uint64_t purpose) {
  return mixBits(
      mixBits(seed * SplitMix::kStep + ray * 0xd1342543de82ef95u + purpose * 0xaf251af3b0f025b5u));
}

/** \brief Uniform in (0, 1). */
double uniform(std::uint64_t seed, std::uint64_t ray, std::uint64_t purpose) {
  return (static_cast<double>(randomBits(seed, ray, purpose) >> 12) + 0.5) * 0x1.0p-52;
}

double gaussian(std::uint64_t seed, std::uint64_t ray, std::uint64_t purpose) {
  const double a = uniform(seed, ray, purpose), b = uniform(seed, ray, purpose + 1);
  return std::sqrt(-2.0 * std::log(a)) * std::cos(2.0 * M_PI * b);
}

/** \brief One station's grid of rays. */
struct Grid {
  Point eye, forward, right, up;
  double step = 0.0;  ///< radians between neighbours
  int columns = 0, rows = 0;
  std::uint64_t first_ray = 0;  ///< number of its first ray among all stations'

  Grid(const Station& station, double step_angle, std::uint64_t first)
      : step(step_angle), first_ray(first) {
    const double a = station.azimuth_degrees * M_PI / 180.0;
    eye = {station.range * std::cos(a), station.range * std::sin(a), station.height};
    const double dz = Amphora::kCenter[2] - station.height,
                 distance = std::hypot(station.range, dz);
    forward = {-eye[0] / distance, -eye[1] / distance, dz / distance};
    right = {-std::sin(a), std::cos(a), 0.0};
    up = {right[1] * forward[2] - right[2] * forward[1],
          right[2] * forward[0] - right[0] * forward[2],
          right[0] * forward[1] - right[1] * forward[0]};
    const double half = std::asin(Amphora::kReach / distance);
    columns = rows = std::max(1, static_cast<int>(std::ceil(2.0 * half / step)));
  }

  std::uint64_t numRays() const {
    return static_cast<std::uint64_t>(columns) * static_cast<std::uint64_t>(rows);
  }

  Point direction(double column, double row) const {
    const double a = (column - 0.5 * (columns - 1)) * step, b = (0.5 * (rows - 1) - row) * step;
    Point d;
    for (std::size_t k = 0; k < 3; ++k) {
      d[k] =
          std::cos(b) * (std::cos(a) * forward[k] + std::sin(a) * right[k]) + std::sin(b) * up[k];
    }
    return d;
  }
};

/** \brief Range to the first surface along a ray, or a negative number. */
double march(const Amphora& object, const Point& eye, const Point& d) {
  double along = 0.0, offset_sq = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double c = Amphora::kCenter[k] - eye[k];
    along += c * d[k];
    offset_sq += c * c;
  }
  const double half_sq = Amphora::kReach * Amphora::kReach - (offset_sq - along * along);
  if (half_sq < 0.0) return -1.0;
  const double half = std::sqrt(half_sq), end = along + half;
  double t = along - half;
  for (int i = 0; i < 400 && t < end; ++i) {
    const double distance =
        object.distance({eye[0] + t * d[0], eye[1] + t * d[1], eye[2] + t * d[2]});
    if (distance < 2e-5) return t;
    t += 0.7 * distance;
  }
  return -1.0;
}

struct Hit {
  bool valid = false;
  std::array<float, 3> position{};
  std::uint32_t rgb = 0;
};

std::uint32_t packColor(const std::array<double, 3>& color, double light) {
  std::uint32_t packed = 0;
  for (const double channel : color) {
    const double value = std::clamp(channel * light, 0.0, 1.0);
    packed = (packed << 8) | static_cast<std::uint32_t>(std::lround(255.0 * value));
  }
  return packed;
}

/** \brief What the scanner reports for one ray. */
Hit measure(const Amphora& object, const Grid& grid, int column, int row,
            const ScanParams& params) {
  const std::uint64_t ray =
      grid.first_ray + static_cast<std::uint64_t>(row) * static_cast<std::uint64_t>(grid.columns) +
      static_cast<std::uint64_t>(column);
  // Tripod heads do not turn in perfect steps.
  const double jitter = params.organized ? 0.0 : 0.3;
  const Point d = grid.direction(column + jitter * (uniform(params.seed, ray, 0) - 0.5),
                                 row + jitter * (uniform(params.seed, ray, 1) - 0.5));
  const double range = march(object, grid.eye, d);
  if (range < 0.0) return {};
  Point p;
  for (std::size_t k = 0; k < 3; ++k) p[k] = grid.eye[k] + range * d[k];
  const Point n = object.normal(p);
  const double facing = -(n[0] * d[0] + n[1] * d[1] + n[2] * d[2]);
  const auto color = object.color(p);
  const double brightness = (color[0] + color[1] + color[2]) / 3.0;
  const double returned =
      std::clamp((facing - 0.06) / 0.2, 0.0, 1.0) * (0.75 + 0.25 * std::min(1.0, 2.0 * brightness));
  if (uniform(params.seed, ray, 2) > returned) return {};

  const double sigma = params.noise * Amphora::kDiagonal * (range / kMediumRange) *
                       (0.7 + 0.3 / std::max(0.2, facing));
  const double shift = sigma * gaussian(params.seed, ray, 3);
  Hit hit;
  hit.valid = true;
  for (std::size_t k = 0; k < 3; ++k) hit.position[k] = static_cast<float>(p[k] + shift * d[k]);
  hit.rgb = packColor(color, 0.97 + 0.02 * gaussian(params.seed, ray, 5));
  return hit;
}

/** \brief All rays of all grids, in order of ray number. */
std::vector<Hit> shoot(const Amphora& object, const std::vector<Grid>& grids,
                       const ScanParams& params) {
  std::vector<Hit> hits;
  for (const Grid& grid : grids) {
    const std::size_t base = hits.size();
    hits.resize(base + grid.numRays());
    parallelFor(static_cast<std::size_t>(grid.rows), resolveThreads(params.threads), 4,
                [&](std::size_t row, int) {
                  for (int column = 0; column < grid.columns; ++column) {
                    hits[base + row * static_cast<std::size_t>(grid.columns) +
                         static_cast<std::size_t>(column)] =
                        measure(object, grid, column, static_cast<int>(row), params);
                  }
                });
  }
  return hits;
}

std::vector<Grid> makeGrids(double step) {
  std::vector<Grid> grids;
  std::uint64_t rays = 0;
  for (const Station& station : kStations) {
    grids.emplace_back(station, step, rays);
    rays += grids.back().numRays();
  }
  return grids;
}

std::uint64_t countValid(const std::vector<Hit>& hits) {
  return static_cast<std::uint64_t>(
      std::count_if(hits.begin(), hits.end(), [](const Hit& h) { return h.valid; }));
}

/** \brief Drops hits, chosen at random, until no more than count are left. */
void thin(std::vector<Hit>& hits, std::uint64_t count, std::uint64_t seed) {
  std::vector<std::pair<std::uint64_t, std::uint64_t>> ranked;  // (random, ray)
  for (std::uint64_t ray = 0; ray < hits.size(); ++ray) {
    if (hits[ray].valid) ranked.emplace_back(randomBits(seed, ray, 7), ray);
  }
  if (ranked.size() <= count) return;
  const auto cut = ranked.begin() + static_cast<std::ptrdiff_t>(count);
  std::nth_element(ranked.begin(), cut, ranked.end());
  for (auto it = cut; it != ranked.end(); ++it) hits[it->second].valid = false;
}

Scan scanStations(const Amphora& object, const ScanParams& params) {
  const double wanted = static_cast<double>(std::max<std::uint64_t>(1, params.points));
  double step = 0.006;
  const auto sample = static_cast<double>(countValid(shoot(object, makeGrids(step), params)));
  step = std::min(kMaxStepAngle, step * std::sqrt(sample / (1.02 * wanted)));
  std::vector<Hit> hits = shoot(object, makeGrids(step), params);
  while (countValid(hits) < params.points) {
    step *= 0.98;
    hits = shoot(object, makeGrids(step), params);
  }
  thin(hits, params.points, params.seed);
  Scan scan;
  for (const Hit& hit : hits) {
    if (!hit.valid) continue;
    scan.xyz.insert(scan.xyz.end(), hit.position.begin(), hit.position.end());
    scan.rgb.push_back(hit.rgb);
  }
  scan.width = static_cast<std::uint32_t>(scan.rgb.size());
  return scan;
}

Scan scanOrganized(const Amphora& object, const ScanParams& params) {
  const double side = std::sqrt(static_cast<double>(std::max<std::uint64_t>(1, params.points)));
  const Grid whole(kStations[0], 1.0, 0);
  const double angle =
      2.0 * std::asin(Amphora::kReach /
                      std::hypot(kStations[0].range, kStations[0].height - Amphora::kCenter[2]));
  const std::vector<Grid> grid{Grid(kStations[0], angle / std::floor(side) * (1.0 + 1e-12), 0)};
  const std::vector<Hit> hits = shoot(object, grid, params);
  Scan scan;
  scan.width = static_cast<std::uint32_t>(grid[0].columns);
  scan.height = static_cast<std::uint32_t>(grid[0].rows);
  for (std::size_t a = 0; a < 3; ++a) scan.sensor[a] = static_cast<float>(grid[0].eye[a]);
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  for (const Hit& hit : hits) {
    for (const float value : hit.position) scan.xyz.push_back(hit.valid ? value : kNaN);
    scan.rgb.push_back(hit.rgb);
  }
  return scan;
}

/** \brief Scans the amphora as a laser scanner on four tripods would.
 *
 * Each station shoots rays on a grid of equal angles; the first surface along a ray is measured,
 * so parts hidden from every station stay empty, and nearer stations see finer. Noise is along
 * the ray and grows with range and obliquity; grazing and dark hits are often lost. Exactly the
 * number of points requested, the same for any number of threads.
 */
Scan scanAmphora(const ScanParams& params) {
  const Amphora object(params.dent);
  return params.organized ? scanOrganized(object, params) : scanStations(object, params);
}

/** \brief The bytes of a binary PCD file with fields x y z rgb. */
std::vector<unsigned char> encodePcd(const Scan& scan) {
  char viewpoint[64];
  std::snprintf(viewpoint, sizeof(viewpoint), "%.9g %.9g %.9g", scan.sensor[0], scan.sensor[1],
                scan.sensor[2]);
  const std::string header =
      "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z rgb\n"
      "SIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 1\nWIDTH " +
      std::to_string(scan.width) + "\nHEIGHT " + std::to_string(scan.height) + "\nVIEWPOINT " +
      viewpoint + " 1 0 0 0\nPOINTS " + std::to_string(scan.rgb.size()) + "\nDATA binary\n";
  std::vector<unsigned char> bytes(header.begin(), header.end());
  const std::size_t start = bytes.size();
  bytes.resize(start + 16 * scan.rgb.size());
  for (std::size_t i = 0; i < scan.rgb.size(); ++i) {
    std::memcpy(bytes.data() + start + 16 * i, scan.xyz.data() + 3 * i, 12);
    std::memcpy(bytes.data() + start + 16 * i + 12, &scan.rgb[i], 4);
  }
  return bytes;
}

}  // namespace

}  // namespace pcl_slim::demo

using namespace pcl_slim;

namespace {

constexpr double kBytesOfPoint = 32;  ///< in the scan and in its file

struct Settings {
  demo::ScanParams scan;
  std::string output, json;
  bool quiet = false;
};

OptionTable declareOptions(Settings& s) {
  OptionTable options = programOptions("pcl_slim_demo_scan");
  options.output("OUT.pcd", &s.output, "binary PCD with fields x y z rgb", ".pcd");
  options.integer("points", &s.scan.points, 100, 50000000, "points (organized: pixels)");
  options.number("noise", &s.scan.noise, 0.0, 0.1,
                 "noise at medium range, share of the object's diagonal");
  options.number("dent", &s.scan.dent, 0.0, 0.01,
                 "depth of a dent of 6 cm in the belly, in metres: a change for pcl_slim_compare");
  options.integer("seed", &s.scan.seed, 0, 1000000000000, "start of the random numbers");
  options.toggle("organized", &s.scan.organized, "one tripod's grid, NaN where nothing was hit");
  options.integer("threads", &s.scan.threads, 0, 1024, "threads, 0: all cores");
  declareMemoryLimit(options);
  options.text("json", &s.json, "FILE", "write a report", FileUse::kWritten);
  options.toggle("quiet", &s.quiet, "print nothing");
  return options;
}

Error checkSettings(const Settings& s) {
  if (lowerExtension(s.output) != ".pcd")
    return {ErrorCode::kBadArgument, "the scan '" + s.output + "' must be named .pcd"};
  if (Error error = checkPlaces({}, {s.output, s.json})) return error;
  return checkMemory(kBytesOfPoint * static_cast<double>(s.scan.points), "such a scan");
}

Exit run(const OptionTable& options, const Settings& s) {
  Console console(s.quiet);
  Report report(options, "", s.scan.threads);
  console.begin("Scanning an amphora");
  const demo::Scan scan = demo::scanAmphora(s.scan);
  report.time("scan", console.seconds());
  report.add({{"points", scan.rgb.size()}, {"noise", s.scan.noise}, {"seed", s.scan.seed}});
  console.done(std::to_string(scan.width) + " x " + std::to_string(scan.height) + " points");

  const auto bytes = demo::encodePcd(scan);
  return saveOutput(
      s.output, s.json, [&] { return writeFile(s.output, bytes.data(), bytes.size()); },
      std::to_string(bytes.size()) + " bytes", console, report);
}

}  // namespace

int main(int argc, char** argv) {
  Settings s;
  OptionTable options = declareOptions(s);
  return runFileProgram(
      options, argc, argv,
      {"ask for fewer points", [&] { return checkSettings(s); }, [&] { return run(options, s); }});
}
