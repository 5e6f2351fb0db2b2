// SPDX-License-Identifier: BSD-3-Clause
#include "borders/open_scenes.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace pcl_slim::borders {
namespace {

/** \brief Length in space of a straight line of a chart. */
double lineLength(const Chart& chart, const Flat& from, const Flat& to) {
  constexpr int kParts = 200;
  double sum = 0.0;
  Vector3 last = chart.place(from);
  for (int i = 1; i <= kParts; ++i) {
    const double t = static_cast<double>(i) / kParts;
    const Vector3 next =
        chart.place({from[0] + t * (to[0] - from[0]), from[1] + t * (to[1] - from[1])});
    sum += length(subtract(next, last));
    last = next;
  }
  return sum;
}

double holeLength(const Chart& chart, const Hole& hole) {
  const Flat& c = hole.centre;
  if (hole.cap) return 2.0 * M_PI * hole.half[0];
  double sum = 0.0;
  if (!hole.round) {
    const double left = c[0] - hole.half[0], right = c[0] + hole.half[0];
    const double below = c[1] - hole.half[1], above = c[1] + hole.half[1];
    sum = lineLength(chart, {left, below}, {left, above}) +
          lineLength(chart, {right, below}, {right, above});
    if (!hole.notch) sum += 2.0 * lineLength(chart, {left, above}, {right, above});
    return sum;
  }
  constexpr int kParts = 90;
  for (int i = 0; i < kParts; ++i) {
    const double a = 2.0 * M_PI * i / kParts, b = 2.0 * M_PI * (i + 1) / kParts;
    sum += lineLength(chart, {c[0] + hole.half[0] * std::cos(a), c[1] + hole.half[0] * std::sin(a)},
                      {c[0] + hole.half[0] * std::cos(b), c[1] + hole.half[0] * std::sin(b)});
  }
  return sum;
}

/** \brief The share of a scanner's way along a tunnel's middle from which it sees a place as it
 * sees a place opposite: half at the ends. */
double seenShare(const Sheet& tunnel, double v) {
  const double radius = tunnel.chart->period() / (2.0 * M_PI);
  const auto part = [&](double way) { return way / std::hypot(way, radius); };
  return 0.5 * (part(v - tunnel.low[1]) + part(tunnel.high[1] - v));
}

}  // namespace

double Hole::size() const {
  return 2.0 * std::min(half[0], half[1]);
}

bool Sheet::isBand() const {
  return chart->period() > 0.0 && high[0] - low[0] > chart->period() - 1e-6;
}

bool Sheet::isInOutline(const Flat& at) const {
  if (at[1] < low[1] || at[1] > high[1]) return false;
  if (isBand()) return true;
  if (outline.empty()) return at[0] >= low[0] && at[0] <= high[0];
  bool inside = false;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Flat &a = outline[i], &b = outline[(i + 1) % outline.size()];
    if ((a[1] > at[1]) == (b[1] > at[1])) continue;
    inside ^= at[0] < a[0] + (at[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
  }
  return inside;
}

bool Sheet::isInHole(const Hole& hole, const Flat& at, double wider) const {
  if (hole.cap) {
    const Vector3 to = subtract(chart->place(at), chart->place(hole.centre));
    return length(to) < hole.half[0] + wider;
  }
  double x = std::abs(at[0] - hole.centre[0]);
  if (isBand()) x = std::min(x, chart->period() - x);
  const double y = std::abs(at[1] - hole.centre[1]);
  if (hole.round) return std::hypot(x, y) < hole.half[0] + wider;
  return x < hole.half[0] + wider && y < hole.half[1] + wider;
}

bool Sheet::contains(const Flat& at) const {
  return isInOutline(at) && std::none_of(holes.begin(), holes.end(),
                                         [&](const Hole& hole) { return isInHole(hole, at); });
}

double Sheet::borderLength() const {
  double sum = 0.0;
  if (isBand() && !whole) {
    sum = lineLength(*chart, low, {high[0], low[1]}) + lineLength(*chart, {low[0], high[1]}, high);
  } else if (!whole) {
    std::vector<Flat> corners = outline;
    if (corners.empty()) corners = {low, {high[0], low[1]}, high, {low[0], high[1]}};
    for (std::size_t i = 0; i < corners.size(); ++i) {
      sum += lineLength(*chart, corners[i], corners[(i + 1) % corners.size()]);
    }
  }
  for (const Hole& hole : holes) {
    if (hole.size() >= kKeptHole) sum += holeLength(*chart, hole);
  }
  return sum;
}

void OpenScene::sample(double noise, std::uint64_t seed) {
  constexpr double kProfile = 1.6;  ///< spacings between lines of a profile scanner
  std::mt19937_64 random(seed);
  std::normal_distribution<double> gauss;
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  sigma = noise;
  const auto add = [&](const Sheet& sheet, const Flat& at) {
    const double density = sheet.chart->stretch(at) / sheet.chart->mostStretch() *
                           (sampling == Sampling::kMoving ? seenShare(sheet, at[1]) : 1.0);
    if (!sheet.contains(at) || unit(random) > density) return;
    Vector3 p = sheet.chart->place(at);
    for (double& value : p) value += noise * gauss(random);
    points.push_back(fromCharts(p));
    for (const double value : fromCharts(sheet.chart->normal(at))) {
      normals.push_back(static_cast<float>(value));
    }
  };
  for (const Sheet& sheet : sheets) {
    const double width = sheet.high[0] - sheet.low[0], height = sheet.high[1] - sheet.low[1];
    if (sampling == Sampling::kProfiles) {
      for (double v = sheet.low[1] + 0.5 * kProfile; v < sheet.high[1]; v += kProfile) {
        for (double u = unit(random) / kProfile; u < width; u += 1.0 / kProfile) {
          add(sheet, {sheet.low[0] + u, v});
        }
      }
      continue;
    }
    if (sampling == Sampling::kJittered) {
      for (double v = sheet.low[1] + 0.5; v < sheet.high[1]; v += 1.0) {
        for (double u = sheet.low[0] + 0.5; u < sheet.high[0]; u += 1.0) {
          add(sheet, {u + 0.6 * unit(random) - 0.3, v + 0.6 * unit(random) - 0.3});
        }
      }
      continue;
    }
    const auto tries = static_cast<std::size_t>(width * height * sheet.chart->mostStretch());
    for (std::size_t i = 0; i < tries; ++i) {
      const double u = sheet.low[0] + width * unit(random);
      add(sheet, {u, sheet.low[1] + height * unit(random)});
    }
  }
}

CloudView OpenScene::view(bool with_normals) const {
  CloudView view;
  view.xyz = points.data();
  view.xyz_stride = sizeof(Vector3);
  view.scalar = CloudView::Scalar::kDouble;
  view.size = points.size();
  if (with_normals) {
    view.normal = normals.data();
    view.normal_stride = 3 * sizeof(float);
  }
  return view;
}

Vector3 OpenScene::rotated(const Vector3& place, double angle) const {
  if (angle == 0.0) return place;
  const Vector3 axis = normalized({1.0, 2.0, 3.0});
  const double c = std::cos(angle);
  return along(along(scaled(place, c), std::sin(angle), cross(axis, place)),
               (1.0 - c) * dot(axis, place), axis);
}

double OpenScene::borderLength() const {
  double sum = 0.0;
  for (const Sheet& sheet : sheets) sum += sheet.borderLength();
  return sum;
}

std::array<std::size_t, 2> OpenScene::loops() const {
  std::array<std::size_t, 2> count{};
  for (const Sheet& sheet : sheets) {
    const std::size_t outer = sheet.whole ? 0 : sheet.isBand() ? 2 : 1;
    for (std::size_t& c : count) c += outer;
    for (const Hole& hole : sheet.holes) {
      if (hole.notch) continue;
      count[0] += hole.size() >= kKeptHole ? 1 : 0;
      ++count[1];
    }
  }
  return count;
}

}  // namespace pcl_slim::borders
