// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <random>

#include "ablation/cases.h"
#include "fit_with_constants.h"
#include "measure/clocks.h"
#include "pcl_slim/query/projection.h"

namespace pcl_slim::ablation {

namespace {

constexpr double kDegreesPerRadian = 57.29577951308232;

/** Waves above the unit square, in one sheet or more; points may thin out along x. */
struct Sheets {
  const char* name;
  double amplitude, wave_number, noise;
  int sheets = 1;
  double apart = 0;     ///< of sheets
  double thinning = 0;  ///< density falls like exp(-thinning x)
  double outliers = 0;  ///< share of points scattered by .1 about the surface
  bool robust = false;
};

constexpr Sheets kSheets[] = {
    {"fine waves, noise", 0.004, 60, 0.0012},
    {"fine waves", 0.004, 60, 0},
    {"two sheets", 0.05, 4, 0.002, 2, 0.04},
    {"density 1000:1", 0.05, 8, 0.001, 1, 0, 6.9},
    {"outliers, robust", 0.05, 8, 0.001, 1, 0, 0, 0.1, true},
};

struct Cloud {
  PointStore store;
  std::vector<double> base;       ///< height of each input point's sheet
  std::vector<std::uint8_t> out;  ///< whether it is an outlier
};

double
height(const Sheets& s, double x, double y)
{
  return s.amplitude * std::sin(s.wave_number * x) * std::sin(s.wave_number * y);
}

double
sampleX(const Sheets& s, double u)
{
  if (s.thinning <= 0) return u;
  return -std::log(1 - u * (1 - std::exp(-s.thinning))) / s.thinning;
}

Result<Cloud>
makeCloud(const Sheets& s, std::size_t count, int seed)
{
  std::mt19937_64 rng(static_cast<std::uint64_t>(seed));
  std::uniform_real_distribution<double> unit(0, 1);
  std::normal_distribution<double> gauss;
  Cloud cloud;
  std::vector<double> points;
  for (std::size_t i = 0; i < count; ++i) {
    const double x = sampleX(s, unit(rng)), y = unit(rng);
    cloud.base.push_back(s.apart * static_cast<double>(i % static_cast<std::size_t>(s.sheets)));
    cloud.out.push_back(unit(rng) < s.outliers);
    const double sigma = cloud.out.back() ? 0.1 : s.noise;
    const double z = cloud.base.back() + height(s, x, y);
    for (const double value : {x, y, z}) points.push_back(value + sigma * gauss(rng));
  }
  CloudView view;
  view.xyz = points.data();
  view.scalar = CloudView::Scalar::kDouble;
  view.xyz_stride = 3 * sizeof(double);
  view.size = count;
  auto store = PointStore::build(view, 1);
  if (!store) return store.error();
  cloud.store = std::move(*store);
  return cloud;
}

class HeightCase : public Case {
 public:
  HeightCase(const Sheets& sheets, std::vector<Cloud> clouds, int threads)
      : Case(sheets.name), sheets_(sheets), clouds_(std::move(clouds))
  {
    params_.robust = sheets.robust;
    params_.threads = threads;
  }

  Result<Figures> measure(const detail::FitConstants& constants) const override
  {
    Figures figures;
    double position = 0, normal = 0, count = 0;
    for (const Cloud& cloud : clouds_) {
      SLIMSurface surface;
      FitStatistics statistics;
      const double start = measure::cpuSeconds();
      if (Error error =
              detail::fitWithConstants(constants, cloud.store, params_, surface, &statistics)) {
        return error;
      }
      figures.seconds += measure::cpuSeconds() - start;
      figures.leaves += static_cast<double>(statistics.leaves);
      figures.uncovered += static_cast<double>(statistics.uncovered);
      Projection projection;
      ProjectionParams params;
      params.threads = params_.threads;
      if (Error error = projectPoints(cloud.store, surface, params, projection)) return error;
      compare(cloud, projection, position, normal, count);
    }
    figures.position = std::sqrt(position / count);
    figures.normal = kDegreesPerRadian * std::sqrt(normal / count);
    return figures;
  }

 private:
  /** Sums squared distances and angles of points whose sheet is theirs, away from the rim. */
  void compare(const Cloud& cloud, const Projection& projection, double& position, double& normal,
               double& count) const
  {
    const PointStore& store = cloud.store;
    for (std::size_t i = 0; i < store.size(); ++i) {
      const std::uint32_t input = store.orderOfStore()[i];
      if (cloud.out[input]) continue;
      std::array<double, 3> p{};
      for (std::size_t a = 0; a < 3; ++a)
        p[a] = store.origin()[a] + store.scale() * projection.position[i][a];
      if (std::min({p[0], 1 - p[0], p[1], 1 - p[1]}) < 0.02) continue;
      const double k = sheets_.wave_number;
      const double gx = sheets_.amplitude * k * std::cos(k * p[0]) * std::sin(k * p[1]);
      const double gy = sheets_.amplitude * k * std::sin(k * p[0]) * std::cos(k * p[1]);
      const double secant = std::sqrt(1 + gx * gx + gy * gy);
      const double d = (p[2] - cloud.base[input] - height(sheets_, p[0], p[1])) / secant;
      const auto& n = projection.normal[i];
      const double cosine = std::abs(n[2] - n[0] * gx - n[1] * gy) / secant;
      position += d * d;
      normal += std::pow(std::acos(std::min(1.0, cosine)), 2);
      ++count;
    }
  }

  Sheets sheets_;
  std::vector<Cloud> clouds_;
  FitParams params_;
};

}  // namespace

Result<Cases>
heightCases(const CaseRequest& request)
{
  Cases cases;
  for (const Sheets& sheets : kSheets) {
    std::vector<Cloud> clouds;
    for (int seed = 0; seed < request.seeds; ++seed) {
      auto cloud = makeCloud(sheets, request.points, 7 + seed);
      if (!cloud) return cloud.error();
      clouds.push_back(std::move(*cloud));
    }
    cases.push_back(std::make_unique<HeightCase>(sheets, std::move(clouds), request.threads));
  }
  return cases;
}

}  // namespace pcl_slim::ablation
