// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <cstdio>

#include "ablation/cases.h"
#include "fit/accuracy.h"
#include "fit_with_constants.h"
#include "measure/clocks.h"

namespace pcl_slim::ablation {

namespace {

using measure::Scene;
using measure::Shape;

/** An exact surface under white noise. */
class ExactCase : public Case {
 public:
  ExactCase(std::string name, Shape shape, std::vector<Scene> scenes, bool normals, int threads)
      : Case(std::move(name)), shape_(shape), scenes_(std::move(scenes)), normals_(normals)
  {
    params_.threads = threads;
  }

  Result<Figures> measure(const detail::FitConstants& constants) const override
  {
    const measure::Fitter fitter = [&](const PointStore& store, const FitParams& params,
                                       SLIMSurface& surface, FitStatistics* statistics) {
      return detail::fitWithConstants(constants, store, params, surface, statistics);
    };
    Figures sum;
    const double start = measure::cpuSeconds();
    for (const Scene& scene : scenes_) {
      const auto outcome =
          measure::measureAccuracy(shape_, scene, params_, normals_, false, fitter);
      if (!outcome) return outcome.error();
      const measure::Accuracy& a = outcome->accuracy;
      sum.position += a.position * a.position;
      sum.normal += a.normal * a.normal;
      sum.curvature += a.curvature * a.curvature;
      sum.leaves += static_cast<double>(outcome->fit.leaves);
      sum.uncovered += static_cast<double>(outcome->fit.uncovered);
      sum.farthest = std::max(sum.farthest, a.worst / scene.diagonal);
    }
    const auto n = static_cast<double>(scenes_.size());
    sum.seconds = measure::cpuSeconds() - start;
    sum.position = std::sqrt(sum.position / n);
    sum.normal = std::sqrt(sum.normal / n);
    sum.curvature = std::sqrt(sum.curvature / n);
    return sum;
  }

 private:
  Shape shape_;
  std::vector<Scene> scenes_;
  bool normals_;
  FitParams params_;
};

}  // namespace

namespace {

/** A shape under one noise, with and without normals. */
void
addShape(const char* name, std::size_t points, double noise, const CaseRequest& request,
         Cases& cases)
{
  Shape shape{};
  if (!measure::parseShape(name, shape)) return;
  std::vector<Scene> scenes;
  for (int seed = 0; seed < request.seeds; ++seed)
    scenes.push_back(measure::makeScene(shape, points, noise, 0.05, 7 + seed));
  for (const bool normals : {true, false}) {
    char title[64];
    std::snprintf(title, sizeof title, "%s %g %%%s%s", name, 100 * noise, normals ? " n" : "",
                  points > request.points ? ", dense" : "");
    cases.push_back(std::make_unique<ExactCase>(title, shape, scenes, normals, request.threads));
  }
}

}  // namespace

Result<Cases>
exactCases(const CaseRequest& request)
{
  Cases cases;
  for (const char* name : {"sphere", "torus", "bumpy", "relief"}) {
    for (const double noise : {0.0, 1e-4, 1e-3, 5e-3, 1e-2})
      addShape(name, request.points, noise, request, cases);
    // Noise of many spacings fills the balls that it would take to see it.
    addShape(name, 10 * request.points, 2e-2, request, cases);
  }
  return cases;
}

}  // namespace pcl_slim::ablation
