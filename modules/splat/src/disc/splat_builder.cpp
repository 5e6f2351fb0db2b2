// SPDX-License-Identifier: BSD-3-Clause
// Step 3 of docs/color_octree_splat_sampler.md: each leaf becomes a disc; its section "Radius".
#include "disc/splat_builder.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pcl_slim/core/parallel.h"

namespace pcl_slim::detail {

namespace {

constexpr std::size_t kSpacingCells = 1024;  ///< cells that tell the middle spacing
constexpr double kSpacings = 6.0;            ///< middle spacings in the widest
constexpr double kNoiseSlack = 2.0;  ///< times the variance of noisy normals that is not bend
constexpr double kFollowed = 2.0;    ///< gradients hold so much farther than there were points

}  // namespace

SplatBuilder::SplatBuilder(const OctreeCloud& cloud, const OctreeSource& source,
                           const SplatParams& params, const SampleNoise& noise, std::size_t slices)
    : cloud_(cloud),
      source_(source),
      params_(params),
      color_noise_(noise.color),
      normal_noise_(noise.normal),
      slices_(slices)
{
  if (params.radius == RadiusRule::kNeighbors) disc_of_.resize(source.cloud.count());
}

void
SplatBuilder::add(std::size_t slice, const PointWindow& window, const CellBatch& batch)
{
  Slice out;  // not in its place yet, beside those that other threads write to
  out.rows.reserve(batch.size());
  const std::vector<DiscNormal> normals = discNormals(window, batch);
  for (std::size_t c = 0; c < batch.size(); ++c) {
    const OctreeCell& cell = batch.cells[c];
    const CellSums& sums = batch.sums[c];
    DiscNormal normal = normals[c];
    Row row = rowOf(window, cell, sums, normal);
    note(slice, window, cell, out);
    out.rows.push_back(row);
    out.single_points += cell.end - cell.begin == 1;
    out.without_normal += !(sums.normals() > 0.0);
    if (params_.color == SplatColor::kGradient) {
      out.gradients.push_back(gradientOf(window, cell, sums, normal));
    }
  }
  slices_[slice] = std::move(out);
}

/** Remembers which disc each point of a cell belongs to, where radii are found by that. */
void
SplatBuilder::note(std::size_t slice, const PointWindow& window, const OctreeCell& cell,
                   const Slice& out)
{
  for (std::size_t i = cell.begin; i < cell.end && !disc_of_.empty(); ++i) {
    disc_of_[window.order(i)] = {static_cast<std::uint32_t>(slice),
                                 static_cast<std::uint32_t>(out.rows.size())};
  }
}

/** A cell's disc. normal becomes the kept point's own in paper mode. */
SplatBuilder::Row
SplatBuilder::rowOf(const PointWindow& window, const OctreeCell& cell, const CellSums& sums,
                    DiscNormal& normal) const
{
  Row row;
  for (std::size_t a = 0; a < 3; ++a) {
    row.center[a] = static_cast<float>(sums.position[a] / sums.count);
  }
  std::array<float, 3> cube{};
  const bool corner = params_.radius == RadiusRule::kCorner;
  if (params_.paper_mode || corner) cube = cubeCenter(window, cell);
  const DiscReach reach = discReach(window, cell, params_.paper_mode ? cube : row.center);
  if (params_.paper_mode) takePoint(window, reach.nearest, row, normal);
  for (std::size_t a = 0; a < 3; ++a) row.normal[a] = static_cast<float>(normal.normal[a]);
  row.reach = reach.farthest;
  if (corner) {
    row.reach =
        static_cast<float>(cornerRadius({row.center[0], row.center[1], row.center[2]},
                                        {cube[0], cube[1], cube[2]}, cloud_.edge(cell.shift)));
  }
  row.spacing = cell.spacing;
  if (!(row.spacing > 0)) row.spacing = static_cast<float>(spacingAround(cloud_, window, cell));
  row.confidence = static_cast<float>(sums.count);
  row.normal_variance = static_cast<float>(normal.variance);
  const std::size_t input = source_.cloud.inputIndex(window.order(reach.nearest));
  row.rgb = colorOf(sums, input);
  row.kept = static_cast<std::uint32_t>(input);
  return row;
}

std::array<float, 3>
SplatBuilder::cubeCenter(const PointWindow& window, const OctreeCell& cell) const
{
  const auto center = cloud_.center(window.position(cell.begin), cell.shift);
  return {static_cast<float>(center[0]), static_cast<float>(center[1]),
          static_cast<float>(center[2])};
}

/** Paper mode: the disc stands where the kept point does, with its normal if it has one. */
void
SplatBuilder::takePoint(const PointWindow& window, std::size_t point, Row& row, DiscNormal& normal)
{
  row.center = window.position(point);
  const auto own = window.normal(point);
  const float sq = own[0] * own[0] + own[1] * own[1] + own[2] * own[2];
  for (std::size_t a = 0; a < 3 && sq > 0.5f; ++a) normal.normal[a] = own[a];
}

SplatSet::Gradient
SplatBuilder::gradientOf(const PointWindow& window, const OctreeCell& cell, const CellSums& sums,
                         const DiscNormal& normal) const
{
  if (!source_.colors.bgr) return {};
  return discGradient(window, cell, sums, normal.normal, source_.table, color_noise_,
                      cloud_.cell());
}

std::uint32_t
SplatBuilder::colorOf(const CellSums& sums, std::size_t input) const
{
  if (!source_.colors.bgr) return 0xffffffu;
  if (params_.color == SplatColor::kOwn || sums.count < 2) {
    const unsigned char* bgr =
        static_cast<const unsigned char*>(source_.colors.bgr) + input * source_.colors.stride;
    return static_cast<std::uint32_t>(bgr[2] << 16 | bgr[1] << 8 | bgr[0]);
  }
  float lab[3];
  for (int a = 0; a < 3; ++a) lab[a] = static_cast<float>(sums.lab[a] / sums.count);
  const auto rgb = source_.table.rgb(lab);
  return static_cast<std::uint32_t>(rgb[0] << 16 | rgb[1] << 8 | rgb[2]);
}

void
SplatBuilder::count(SplatStatistics& statistics) const
{
  for (const Slice& slice : slices_) {
    statistics.splats += slice.rows.size();
    statistics.single_points += slice.single_points;
    statistics.without_normal += slice.without_normal;
  }
}

/** Widest spacing by some thousand cells, which tell the middle as well as all. */
double
SplatBuilder::widest() const
{
  std::size_t total = 0, number = 0;
  for (const Slice& slice : slices_) total += slice.rows.size();
  const std::size_t stride = std::max<std::size_t>(1, total / kSpacingCells);
  std::vector<CellSpacing> cells;
  for (const Slice& slice : slices_) {
    const std::size_t skip = (stride - number % stride) % stride;
    for (std::size_t r = skip; r < slice.rows.size(); r += stride) {
      cells.push_back(
          {slice.rows[r].spacing, static_cast<std::uint32_t>(slice.rows[r].confidence)});
    }
    number += slice.rows.size();
  }
  return widestSpacing(cells);
}

std::vector<float>
SplatBuilder::neighborRadiiOf(const PointStore& store, double widest) const
{
  std::vector<std::uint32_t> first(1, 0), disc_of(disc_of_.size());
  std::vector<std::array<float, 3>> centers;
  for (const Slice& slice : slices_) {
    for (const Row& row : slice.rows) centers.push_back(row.center);
    first.push_back(static_cast<std::uint32_t>(centers.size()));
  }
  for (std::size_t i = 0; i < disc_of.size(); ++i)
    disc_of[i] = first[disc_of_[i][0]] + disc_of_[i][1];
  return neighborRadii(cloud_, centers, disc_of, store, widest, params_.threads);
}

/** Radius of a disc in root cells. */
double
SplatBuilder::radiusOf(const Row& row, double widest) const
{
  if (params_.radius != RadiusRule::kDensity) return row.reach;
  const double bend = std::sqrt(std::max(0.0, row.normal_variance - kNoiseSlack * normal_noise_));
  return densityRadius(row.reach, row.confidence, bend, row.spacing, widest);
}

/** Writes one disc in world units. */
void
SplatBuilder::write(const Row& row, double radius, std::size_t i, SplatSet& splats) const
{
  const auto cell = static_cast<float>(cloud_.cell());
  splats.x[i] = row.center[0] * cell;
  splats.y[i] = row.center[1] * cell;
  splats.z[i] = row.center[2] * cell;
  splats.nx[i] = row.normal[0];
  splats.ny[i] = row.normal[1];
  splats.nz[i] = row.normal[2];
  splats.radius[i] = static_cast<float>(radius * cloud_.cell());
  splats.rgb[i] = row.rgb;
  splats.confidence[i] = row.confidence;
  splats.normal_variance[i] = row.normal_variance;
  splats.kept[i] = row.kept;
}

void
SplatBuilder::finish(const PointStore* store, SplatSet& splats, SplatStatistics& statistics)
{
  count(statistics);
  const double widest_spacing = widest();
  statistics.spacing = widest_spacing / kSpacings * cloud_.cell();
  std::vector<float> radii;
  if (store && params_.radius == RadiusRule::kNeighbors)
    radii = neighborRadiiOf(*store, widest_spacing);
  std::vector<std::size_t> first(1, 0);
  for (const Slice& slice : slices_) first.push_back(first.back() + slice.rows.size());
  splats.origin = cloud_.frame().origin;
  splats.resize(first.back(), params_.color == SplatColor::kGradient);
  parallelFor(slices_.size(), params_.threads, 8, [&](std::size_t s, int) {
    for (std::size_t r = 0; r < slices_[s].rows.size(); ++r) {
      const Row& row = slices_[s].rows[r];
      const std::size_t i = first[s] + r;
      const double radius = radii.empty() ? radiusOf(row, widest_spacing) : radii[i];
      write(row, radius, i, splats);
      if (splats.gradient.empty()) continue;
      splats.gradient[i] = slices_[s].gradients[r];
      const auto held = static_cast<float>(std::min(1.0, kFollowed * row.reach / radius));
      for (float& value : splats.gradient[i]) value *= held;
    }
  });
}

}  // namespace pcl_slim::detail
