// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/query/surface_samples.h"

#include <algorithm>
#include <cmath>

#include "pcl_slim/core/parallel.h"
#include "pcl_slim/query/projection.h"
#include "pcl_slim/query/surface_colors.h"
#include "sampling/poisson_set.h"

namespace pcl_slim {

using namespace detail;

namespace {

constexpr double kStep = 0.5;         ///< of the spacing: nodes that candidates stand on
constexpr double kReach = 0.5;        ///< of a ball's radius; see ProjectionParams
constexpr double kMostNodes = 4e8;    ///< candidates that memory is spent on
constexpr double kFirstCount = 4000;  ///< samples of the first trial for a count
constexpr double kSurplus = 1.03;     ///< samples over the count, at most, that are thinned
constexpr int kMostTrials = 12;
constexpr std::size_t kRun = 64;  ///< surfels a thread takes at a time; no result depends on it

/** Half the width of a leaf's (u, v) square that is sampled, in radii: beyond its cover other leaves
 * sample. */
double
halfWidth(const SurfaceInfo& info)
{
  return std::min(1.0, 1.1 * info.cover_radius);
}

/** Nodes along a side of the square of leaf i; one of three is its centre. */
std::int64_t
sideOf(const SLIMSurface& surface, std::size_t i, double step)
{
  const double steps = 2 * halfWidth(surface.info) * surface.radius[i] / step;
  return std::max<std::int64_t>(3, static_cast<std::int64_t>(steps) + 2);
}

/** Candidates of one leaf, in world coordinates. \param[in] step local length */
void
appendNodes(const SLIMSurface& surface, std::size_t i, double step, std::vector<double>& xyz)
{
  const LocalFrame frame({surface.nx[i], surface.ny[i], surface.nz[i]});
  const double r = surface.radius[i], reach = halfWidth(surface.info);
  const double center[3] = {surface.cx[i], surface.cy[i], surface.cz[i]};
  const TrimMap map = surface.trimMap(i);
  const std::int64_t side = sideOf(surface, i, step);
  const double pitch = 2 * reach / static_cast<double>(side - 1);
  for (std::int64_t k = 0; k < side * side; ++k) {
    const double u = pitch * static_cast<double>(k % side) - reach;
    const double v = pitch * static_cast<double>(k / side) - reach;
    if (u * u + v * v > reach * reach) continue;
    if (surface.isOpen(i) && outsideShare(map, u, v) > 0.5) continue;
    const double h = evaluateHeight(surface.degree[i], surface.coefficientsOf(i), u, v);
    if (!(u * u + v * v + h * h < 1.0)) continue;
    for (std::size_t a = 0; a < 3; ++a) {
      const double local = center[a] + r * (u * frame.u[a] + v * frame.v[a] + h * frame.w[a]);
      xyz.push_back(surface.info.origin[a] + surface.info.scale * local);
    }
  }
}

Error
checkNodes(const SLIMSurface& surface, double step)
{
  double nodes = 0;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const double side = 2 * halfWidth(surface.info) * surface.radius[i] / step + 3;
    if (surface.isLeaf(i)) nodes += side * side;
  }
  if (nodes < kMostNodes) return {};
  return {ErrorCode::kBadArgument, "so dense a sampling takes too much memory: raise the spacing"};
}

/** Candidates on the blended surface, inside its borders. */
struct Candidates {
  SidedPoints points;
  std::vector<std::array<float, 2>> curvature;
};

Error
makeCandidates(const SLIMSurface& surface, double spacing, int threads, Progress* progress,
               Candidates& made)
{
  const double step = kStep * spacing / surface.info.scale;
  if (Error error = checkNodes(surface, step)) return error;
  std::vector<std::vector<double>> runs((surface.size() + kRun - 1) / kRun);
  parallelFor(runs.size(), threads, 1, [&](std::size_t run, int) {
    for (std::size_t i = run * kRun; i < std::min(surface.size(), (run + 1) * kRun); ++i) {
      if (surface.isLeaf(i)) appendNodes(surface, i, step, runs[run]);
    }
  });
  std::vector<double> xyz;
  for (const auto& run : runs) xyz.insert(xyz.end(), run.begin(), run.end());
  CloudView view;
  view.xyz = xyz.data();
  view.xyz_stride = 3 * sizeof(double);
  view.scalar = CloudView::Scalar::kDouble;
  view.size = xyz.size() / 3;
  const Result<PointStore> store = PointStore::build(view, threads);
  if (!store) return store.error();
  ProjectionParams params;
  params.curvature = true;
  params.reach = kReach;
  params.paper_mode = surface.info.paper_mode;
  params.threads = threads;
  Projection projection;
  if (Error error = projectPoints(*store, surface, params, projection, progress)) return error;
  made = Candidates();
  made.points.oriented = surface.info.oriented;
  const double scale = store->scale();
  for (std::size_t i = 0; i < store->size(); ++i) {
    if (!projection.supported[i] || !projection.inside[i]) continue;
    std::array<double, 3> world;
    for (std::size_t a = 0; a < 3; ++a)
      world[a] = store->origin()[a] + scale * projection.position[i][a];
    made.points.position.push_back(world);
    made.points.normal.push_back(projection.normal[i]);
    const auto& [mean, gaussian] = projection.curvature[i];
    made.curvature.push_back(
        {static_cast<float>(mean / scale), static_cast<float>(gaussian / scale / scale)});
  }
  return {};
}

/** A spacing that gives about so many samples, from the area of the leaves. */
double
guessSpacing(const SLIMSurface& surface, double count)
{
  double area = 0;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    if (surface.isLeaf(i)) area += surface.radius[i] * double{surface.radius[i]};
  }
  return surface.info.scale * std::sqrt(area / count);
}

void
take(const Candidates& candidates, const std::vector<std::uint32_t>& set, double spacing,
     SurfaceSamples& samples)
{
  samples.spacing = spacing;
  samples.candidates = candidates.curvature.size();
  for (const std::uint32_t i : set) {
    samples.position.push_back(candidates.points.position[i]);
    samples.normal.push_back(candidates.points.normal[i]);
    samples.curvature.push_back(candidates.curvature[i]);
  }
}

Error
sampleSpacing(const SLIMSurface& surface, const SurfaceSampleParams& params, int threads,
              Progress* progress, SurfaceSamples& samples)
{
  Candidates candidates;
  if (Error error = makeCandidates(surface, params.spacing, threads, progress, candidates))
    return error;
  take(candidates, poissonSet(candidates.points, params.spacing, params.seed, threads),
       params.spacing, samples);
  return {};
}

/** Tries spacings until a few more samples than asked for come out, and thins those. */
Error
sampleCount(const SLIMSurface& surface, const SurfaceSampleParams& params, int threads,
            Progress* progress, SurfaceSamples& samples)
{
  const auto wanted = static_cast<double>(params.count);
  const double aim = 0.5 * (1.0 + kSurplus) * wanted + 0.5;
  double spacing = guessSpacing(surface, std::min(wanted, kFirstCount));
  for (int trial = 0; trial < kMostTrials; ++trial) {
    Candidates candidates;
    if (Error error = makeCandidates(surface, spacing, threads, progress, candidates)) return error;
    std::vector<std::uint32_t> set = poissonSet(candidates.points, spacing, params.seed, threads);
    const auto found = static_cast<double>(set.size());
    const bool close = found <= kSurplus * wanted + 1 || trial + 1 == kMostTrials;
    if (found >= wanted && close) {
      thinSet(candidates.points, spacing, params.count, set);
      take(candidates, set, spacing, samples);
      return {};
    }
    spacing *= std::sqrt(std::max(found, 0.25) / aim);
  }
  return {ErrorCode::kBadArgument, "the surface has no place for so few samples: give a spacing"};
}

}  // namespace

Error
SurfaceSampleParams::validate() const
{
  const auto bad = [](const char* text) { return Error{ErrorCode::kBadArgument, text}; };
  if (!(spacing >= 0) || !std::isfinite(spacing))
    return bad("the spacing of samples must be positive (0: by their number)");
  if ((spacing > 0) == (count > 0)) return bad("give a spacing or a number of samples");
  if (count > 100000000) return bad("more than 100 million samples are not made at once");
  return checkThreads(threads);
}

Error
sampleSurface(const SLIMSurface& surface, const SurfaceSampleParams& params,
              SurfaceSamples& samples, Progress* progress)
{
  samples = SurfaceSamples();
  if (Error error = params.validate()) return error;
  if (Error error = surface.validate()) return error;
  if (surface.numLeaves() == 0) return badInput("the surface has no leaves: fit one");
  const int threads = resolveThreads(params.threads);
  const auto make = params.count > 0 ? sampleCount : sampleSpacing;
  if (Error error = make(surface, params, threads, progress, samples)) return error;
  samples.color = surfaceColors(surface, samples.position, samples.normal, threads);
  return {};
}

}  // namespace pcl_slim
