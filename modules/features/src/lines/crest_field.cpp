// SPDX-License-Identifier: BSD-3-Clause
#include "lines/crest_tracer.h"

#include <algorithm>
#include <cmath>

namespace pcl_slim::detail {

namespace {

constexpr double kDifference = 0.1;     ///< half width of the stencil for dk/ds [radii]
constexpr double kWide = 0.15;          ///< the widest, on broad crests [radii]
constexpr double kShareOfCrest = 0.21;  ///< half width over the breadth of a crest
constexpr double kInRow = 0.7;   ///< least cosine between t and the section for sampling in a row
constexpr double kMargin = 0.6;  ///< leaves are searched this far ahead [radii]
constexpr double kHalfStep = 0.5 * LineSignificance::kAside;  ///< half the way there [radii]

}  // namespace

void CrestField::restart(double radius) {
  probe_.restart(kMargin * radius);
}

double CrestField::kOf(const ProbeSample& from, const Vector3& normal) const {
  return crestSide(from.frame, type_, dot(from.normal, normal) < 0).k;
}

void CrestField::interpret(const ProbeSample& from, const CrestAxes& axes,
                           CrestSample& sample) const {
  sample.known = from.supported;
  if (!from.supported) return;
  const bool turned = dot(from.normal, axes.normal) < 0;
  const CrestSide side = crestSide(from.frame, type_, turned);
  sample.position = from.position;
  sample.normal = scaled(from.normal, turned ? -1.0 : 1.0);
  sample.t = {side.t[0], side.t[1], side.t[2]};
  sample.e = side.e;
  if (dot(sample.t, axes.t) < 0) {
    sample.t = scaled(sample.t, -1.0);
    sample.e = -sample.e;
  }
  sample.k = side.k;
  sample.other = side.other;
}

double CrestField::difference(const ProbeSample* around, const CrestAxes& axes,
                              const CrestSample& sample, bool& known) const {
  for (std::size_t i = 0; i < 4; ++i) known = known && around[i].supported;
  if (!known) return 0;
  const double reach = 2 * axes.reach;
  const Vector3 b = cross(axes.normal, axes.t);
  const double along_t = (kOf(around[0], axes.normal) - kOf(around[1], axes.normal)) / reach;
  const double along_b = (kOf(around[2], axes.normal) - kOf(around[3], axes.normal)) / reach;
  return dot(sample.t, axes.t) * along_t + dot(sample.t, b) * along_b;
}

void CrestField::sample(const Vector3* centers, std::size_t count, const CrestAxes& axes,
                        CrestSample* samples) {
  Vector3 positions[SurfaceProbe::kMost];
  ProbeSample found[SurfaceProbe::kMost];
  std::copy(centers, centers + count, positions);
  ProbeRequest request;
  request.positions = positions;
  request.count = request.with_directions = count;
  request.extremality = analytic_;
  request.side = axes.normal;
  if (!analytic_) {
    const double reach = axes.reach;
    const Vector3 b = cross(axes.normal, axes.t);
    for (std::size_t i = 0; i < count; ++i) {
      Vector3* const around = positions + count + 4 * i;
      around[0] = along(centers[i], reach, axes.t);
      around[1] = along(centers[i], -reach, axes.t);
      around[2] = along(centers[i], reach, b);
      around[3] = along(centers[i], -reach, b);
    }
    request.count = 5 * count;
  }
  probe_.evaluate(request, found);
  for (std::size_t i = 0; i < count; ++i) {
    interpret(found[i], axes, samples[i]);
    if (analytic_ || !samples[i].known) continue;
    samples[i].e = difference(found + count + 4 * i, axes, samples[i], samples[i].known);
  }
}

void CrestField::sampleSeed(CrestVertex& seed, CrestSample (&samples)[3]) {
  // The three and what their differences of k take, in steps along t and across it.
  constexpr int kGrid[10][2] = {{0, 0}, {1, 0}, {0, 1},  {-1, 0}, {0, -1},
                                {2, 0}, {1, 1}, {1, -1}, {-1, 1}, {0, 2}};
  constexpr int kSides[3][4] = {{1, 3, 2, 4}, {5, 0, 6, 7}, {6, 8, 9, 0}};
  const CrestAxes axes = seed.axes();
  const double reach = axes.reach;
  const Vector3 b = cross(axes.normal, axes.t);
  const std::size_t count = analytic_ ? 3 : 10;
  Vector3 positions[SurfaceProbe::kMost];
  for (std::size_t i = 0; i < count; ++i) {
    positions[i] = along(along(seed.position, kGrid[i][0] * reach, axes.t), kGrid[i][1] * reach, b);
  }
  placeAside(seed, positions + count);
  ProbeSample found[SurfaceProbe::kMost];
  ProbeRequest request;
  request.positions = positions;
  request.count = count + 2;
  request.with_directions = 3;
  request.extremality = analytic_;
  request.side = axes.normal;
  probe_.evaluate(request, found);
  for (std::size_t i = 0; i < 3; ++i) {
    interpret(found[i], axes, samples[i]);
    if (analytic_) continue;
    ProbeSample around[4];
    for (std::size_t j = 0; j < 4; ++j) around[j] = found[kSides[i][j]];
    samples[i].e = difference(around, axes, samples[i], samples[i].known);
  }
  if (found[count].supported && found[count + 1].supported) {
    seed.prominence = prominenceOf(seed, found + count);
  } else {
    findProminence(&seed, 1);
  }
}

/** A wider stencil averages noise, but blurs asymmetric crests. The breadth of a crest is the
 * distance at which k would be 0 if its section were a parabola. */
double CrestField::reachAt(const CrestVertex& vertex) {
  const double least = kDifference * vertex.radius;
  if (!(vertex.fall > 0 && vertex.k > 0)) return least;
  const double broad = std::sqrt(2 * vertex.k / vertex.fall);
  return std::clamp(kShareOfCrest * broad, least, kWide * vertex.radius);
}

void CrestField::sampleAcross(const CrestRow* rows, std::size_t count, const CrestAxes& axes,
                              CrestSample* samples) {
  for (std::size_t i = 0; i < 3 * count; ++i) samples[i].known = false;
  const CrestRow& row = rows[0];
  if (!analytic_ && std::abs(dot(axes.t, row.across)) > kInRow) {
    sampleInRows(rows, count, axes, samples);
    if (samples[0].known) return;
  }
  const Vector3 centers[3] = {along(row.place, -row.span, row.across), row.place,
                              along(row.place, row.span, row.across)};
  sample(centers, 3, axes, samples);
}

/** Where lines run across t, as most do, neighbours in the row share their stencils: seven places
 * replace fifteen. dk/ds along the line is taken from the middle. */
void CrestField::sampleInRows(const CrestRow* rows, std::size_t count, const CrestAxes& axes,
                              CrestSample* samples) {
  const double reach = axes.reach;
  Vector3 positions[SurfaceProbe::kMost];
  for (std::size_t i = 0; i < count; ++i) {
    const CrestRow& row = rows[i];
    const Vector3 b = cross(axes.normal, row.across);
    Vector3 *const middle = positions + 3 * i, *const outer = positions + 3 * count + 4 * i;
    for (int j = 0; j < 3; ++j) middle[j] = along(row.place, (j - 1) * row.span, row.across);
    outer[0] = along(row.place, -2 * row.span, row.across);
    outer[1] = along(row.place, 2 * row.span, row.across);
    outer[2] = along(row.place, -reach, b);
    outer[3] = along(row.place, reach, b);
  }
  ProbeSample found[SurfaceProbe::kMost];
  ProbeRequest request;
  request.positions = positions;
  request.count = 7 * count;
  request.with_directions = 3 * count;
  request.side = axes.normal;
  probe_.evaluate(request, found);
  for (std::size_t i = 0; i < count; ++i) {
    interpretRow(found + 3 * i, found + 3 * count + 4 * i, rows[i], axes, samples + 3 * i);
  }
  if (count == 2) twist(rows, axes, samples);
}

/** Corrects dk/ds at both ends of a row by the mixed derivative, estimated from the next row. */
void CrestField::twist(const CrestRow* rows, const CrestAxes& axes, CrestSample* samples) {
  if (!samples[0].known || !samples[3].known) return;
  const Vector3 b = cross(axes.normal, rows[0].across);
  const double stride = dot(subtract(rows[1].place, rows[0].place), b);
  const double rise = (samples[5].k - samples[3].k) - (samples[2].k - samples[0].k);
  for (std::size_t i = 0; i < 6; ++i) {
    const double share = static_cast<double>(i % 3) - 1.0;
    samples[i].e += dot(samples[i].t, b) * share * rise / (2 * stride);
  }
}

void CrestField::interpretRow(const ProbeSample* middle, const ProbeSample* outer,
                              const CrestRow& row, const CrestAxes& axes,
                              CrestSample* samples) const {
  const auto supported = [](const ProbeSample& sample) { return sample.supported; };
  if (!std::all_of(middle, middle + 3, supported) || !std::all_of(outer, outer + 4, supported)) {
    return;
  }
  const auto k = [&](const ProbeSample& sample) { return kOf(sample, axes.normal); };
  const double in_row[5] = {k(outer[0]), k(middle[0]), k(middle[1]), k(middle[2]), k(outer[1])};
  const double along_b = (k(outer[3]) - k(outer[2])) / (2 * axes.reach);
  const Vector3 b = cross(axes.normal, row.across);
  for (std::size_t i = 0; i < 3; ++i) {
    interpret(middle[i], axes, samples[i]);
    samples[i].e = dot(samples[i].t, row.across) * (in_row[i + 2] - in_row[i]) / (2 * row.span) +
                   dot(samples[i].t, b) * along_b;
  }
}

/** Where a line's vertex and its curvature expect the surface at half a radius to both sides along
 * t. */
void CrestField::placeAside(const CrestVertex& v, Vector3* places) const {
  const double far = 2 * kHalfStep * v.radius;
  const double turn = std::clamp(v.k * far, -1.0, 1.0);
  const double sink = (type_ == CrestType::kRidge ? 0.5 : -0.5) * turn * far;
  const Vector3 middle = along(v.position, -sink, v.normal);
  places[0] = along(middle, far * (1 - turn * turn / 6), v.t);
  places[1] = along(middle, -far * (1 - turn * turn / 6), v.t);
}

bool CrestField::lookAside(const CrestVertex* vertices, ProbeRequest request, ProbeSample* found) {
  Vector3 positions[2 * kMostVertices];
  for (std::size_t i = 0; i < request.count; i += 2) placeAside(vertices[i / 2], positions + i);
  request.positions = positions;
  probe_.evaluate(request, found);
  return std::all_of(found, found + request.count,
                     [](const ProbeSample& sample) { return sample.supported; });
}

/** Two half steps, each projected onto the surface, which may bend unexpectedly, or end there. A
 * sample is from half way if the second step fails, and not supported if the first does. */
void CrestField::walkAside(const CrestVertex* vertices, ProbeRequest request, ProbeSample* found) {
  Vector3 positions[2 * kMostVertices], directions[2 * kMostVertices];
  ProbeSample near[2 * kMostVertices];
  for (std::size_t i = 0; i < request.count; ++i) {
    const CrestVertex& v = vertices[i / 2];
    directions[i] = scaled(v.t, i % 2 == 0 ? 1.0 : -1.0);
    positions[i] = along(v.position, kHalfStep * v.radius, directions[i]);
  }
  request.positions = positions;
  probe_.evaluate(request, near);
  for (std::size_t i = 0; i < request.count; ++i) {
    if (!near[i].supported) continue;
    const Vector3& n = near[i].normal;
    const Vector3 on = normalized(along(directions[i], -dot(directions[i], n), n));
    positions[i] = along(near[i].position, kHalfStep * vertices[i / 2].radius, on);
  }
  probe_.evaluate(request, found);
  for (std::size_t i = 0; i < request.count; ++i) {
    if (!near[i].supported || !found[i].supported) found[i] = near[i];
  }
}

void CrestField::findProminence(CrestVertex* vertices, std::size_t count) {
  ProbeSample found[2 * kMostVertices];
  ProbeRequest request;
  request.count = 2 * count;
  for (std::size_t i = 0; i < count; ++i) {
    request.side = along(request.side, 2.0, vertices[i].normal);
  }
  if (!lookAside(vertices, request, found)) walkAside(vertices, request, found);
  for (std::size_t i = 0; i < count; ++i) {
    vertices[i].prominence = prominenceOf(vertices[i], found + 2 * i);
  }
}

double CrestField::prominenceOf(const CrestVertex& v, const ProbeSample* aside) const {
  // Beyond a border nothing is known.
  if (!aside[0].supported || !aside[1].supported) return 0;
  return lineProminence(v.k, kOf(aside[0], v.normal), kOf(aside[1], v.normal));
}

}  // namespace pcl_slim::detail
