// SPDX-License-Identifier: BSD-3-Clause
// Blending in space, whose zero is looked for along a ray, against averaging intersections along
// it: as drawings in the plane (Figs. 8, 9), and their cost on a surface (section 3).
#include <algorithm>
#include <cmath>
#include <random>

#include "paper/study.h"
#include "paper/svg.h"
#include "pcl_slim/query/detail/ray_surfel.h"
#include "support/lab/bench.h"

namespace pcl_slim::paper {

namespace {

using detail::Approach;
using detail::Ray;
using detail::RayPolynomial;
using detail::RaySurfel;

/** A leaf in the plane: a parabola over the tangent of a disc. */
struct PlaneLeaf {
  Point2 center;
  double turn, radius, c0, c1, c2;  ///< angle of the tangent, coefficients in radii

  double distance(const Point2& p) const {
    return std::hypot(p[0] - center[0], p[1] - center[1]) / radius;
  }
  double f(const Point2& p) const {
    const double dx = (p[0] - center[0]) / radius, dy = (p[1] - center[1]) / radius;
    const double u = std::cos(turn) * dx + std::sin(turn) * dy;
    const double w = -std::sin(turn) * dx + std::cos(turn) * dy;
    return radius * (w - c0 - c1 * u - c2 * u * u);
  }
};

constexpr double kShrink = 2.0 / 3.0, kSide = 460.0;
const std::array<PlaneLeaf, 3> kLeaves = {{{{-0.62, -0.16}, 0.42, 0.62, 0.14, 0.1, -0.32},
                                           {{0.04, 0.07}, 0.02, 0.62, -0.16, -0.1, -0.35},
                                           {{0.66, -0.14}, -0.48, 0.60, 0.22, 0.15, -0.30}}};
const std::array<const char*, 3> kLeafColors = {"#1f4e9c", "#2a9d8f", "#e9a21b"};

double weightAt(double s) {
  return s < 1 ? std::pow(1 - s * s, 4) : 0;
}

/** Blend of the leaves at a place; 0 beyond all of them. */
double blendAt(const Point2& p) {
  double sum = 0, weight = 0;
  for (const PlaneLeaf& leaf : kLeaves) {
    const double w = weightAt(leaf.distance(p));
    sum += w * leaf.f(p);
    weight += w;
  }
  return weight > 0 ? sum / weight : 0;
}

/** A vertical ray from above: the y at which f falls to 0, or nothing (-9). */
template <typename Function>
double zeroOn(double x, const Function& f) {
  double last = 0;
  for (double y = 0.8; y > -0.9; y -= 0.002) {
    const double value = f(Point2{x, y});
    if (last > 0 && value <= 0) return y + 0.002 * value / (value - last);
    last = value;
  }
  return -9;
}

struct RayHits {
  std::vector<Point2> leaves;  ///< those that count
  Point2 first{0, -9}, average{0, -9};
};

RayHits averageOn(double x) {
  RayHits hits;
  for (const PlaneLeaf& leaf : kLeaves) {
    const Point2 q = {x, zeroOn(x, [&](const Point2& p) { return leaf.f(p); })};
    if (q[1] > -9 && leaf.distance(q) < kShrink && q[1] > hits.first[1]) hits.first = q;
  }
  double sum = 0, weight = 0;
  for (const PlaneLeaf& leaf : kLeaves) {
    const Point2 q = {x, zeroOn(x, [&](const Point2& p) { return leaf.f(p); })};
    const double w = q[1] > -9 && hits.first[1] > -9 ? weightAt(leaf.distance(hits.first)) : 0;
    if (w <= 0) continue;
    hits.leaves.push_back(q);
    sum += w * q[1];
    weight += w;
  }
  if (weight > 0) hits.average = {x, sum / weight};
  return hits;
}

/** A panel with the leaves. */
class Panel {
 public:
  Panel(Svg& svg, double left, const std::string& title) : svg_(svg), left_(left) {
    svg.text({left + kSide / 2, 26}, "middle", title);
    for (std::size_t k = 0; k < kLeaves.size(); ++k) {
      const PlaneLeaf& leaf = kLeaves[k];
      const std::string color = kLeafColors[k];
      svg.circle(at(leaf.center), kScale * leaf.radius,
                 "fill=\"" + color + "\" fill-opacity=\"0.08\" stroke=\"" + color + "\"");
      svg.circle(at(leaf.center), kScale * leaf.radius * kShrink,
                 "fill=\"none\" stroke-dasharray=\"3 3\" stroke=\"" + color + "\"");
      std::vector<Point2> curve;
      for (double u = -1; u <= 1; u += 0.05) {
        const double h = leaf.c0 + leaf.c1 * u + leaf.c2 * u * u;
        const Point2 p = {
            leaf.center[0] + leaf.radius * (std::cos(leaf.turn) * u - std::sin(leaf.turn) * h),
            leaf.center[1] + leaf.radius * (std::sin(leaf.turn) * u + std::cos(leaf.turn) * h)};
        if (leaf.distance(p) < 1) curve.push_back(at(p));
      }
      svg.polyline(curve, "stroke-width=\"1.6\" stroke=\"" + color + "\"");
    }
  }

  Point2 at(const Point2& p) const {
    return {left_ + kSide / 2 + kScale * p[0], 0.4 * kSide - kScale * p[1]};
  }

  template <typename HeightAt>
  void curve(const HeightAt& heightAt, const std::string& style) {
    std::vector<Point2> points;
    for (double x = -1.1; x <= 1.1; x += 0.004) {
      const double y = heightAt(x);
      if (y > -9) points.push_back(at({x, y}));
    }
    svg_.polyline(points, style);
  }

  void ray(double x) {
    svg_.line(at({x, 0.85}), at({x, -0.75}), "stroke=\"#222222\" stroke-width=\"1\"");
  }

 private:
  static constexpr double kScale = 165;
  Svg& svg_;
  double left_;
};

Error drawBlends(const StudySettings& settings) {
  constexpr double kRay = 0.4;
  const std::string red = "stroke=\"#d1495b\" stroke-width=\"2.6\"";
  const auto inSpace = [](double x) { return zeroOn(x, blendAt); };
  Svg svg(2 * kSide + 60, 380);
  Panel space(svg, 10, "in space: the zero of the blend, searched along the ray");
  space.curve(inSpace, red);
  space.ray(kRay);
  double low = -0.6, high = 0.75;
  for (int step = 0; step < 9; ++step) {
    const double middle = 0.5 * (low + high);
    svg.circle(space.at({kRay, middle}), 3, "fill=\"white\" stroke=\"#222222\"");
    (blendAt({kRay, middle}) > 0 ? high : low) = middle;
  }
  svg.circle(space.at({kRay, inSpace(kRay)}), 4.5, "fill=\"#d1495b\"");

  Panel rays(svg, 50 + kSide, "on rays: the mean of the leaves' intersections");
  rays.curve(inSpace, "stroke=\"#d1495b\" stroke-width=\"1\" stroke-dasharray=\"2 3\"");
  rays.curve([](double x) { return averageOn(x).average[1]; }, red);
  rays.ray(kRay);
  const RayHits hits = averageOn(kRay);
  for (const Point2& q : hits.leaves) svg.circle(rays.at(q), 3.5, "fill=\"#222222\"");
  svg.circle(rays.at(hits.first), 6.5, "fill=\"none\" stroke=\"#222222\" stroke-width=\"1.4\"");
  svg.circle(rays.at(hits.average), 4.5, "fill=\"#d1495b\"");
  svg.text({10, 352}, "start", "open dots: where the blend is evaluated; red: its zero");
  svg.text({50 + kSide, 352}, "start", "dots: intersections; ringed: the first in a shrunk ball");
  svg.text({50 + kSide, 370}, "start", "red: their weighted mean; fine dashes: the zero in space");
  return svg.save(settings.out + "/fig08.svg");
}

/** A ray and the leaves that it may meet. */
struct Query {
  Ray ray;
  double limit = 0.0;  ///< where its stretch ends
  std::vector<RaySurfel> leaves;
};

/** Rays towards points of the cloud, up to 60 degrees off the surfaces' normals, a tenth of L long.
 */
std::vector<Query> makeQueries(const Fitted& fitted, std::size_t count) {
  const SLIMSurface& s = fitted.surface;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> share(-1, 1);
  std::vector<Query> queries;
  while (queries.size() < count) {
    const std::size_t i = random() % fitted.store.size();
    const auto& n = fitted.projection.normal[i];
    const Vector3 normal = {n[0], n[1], n[2]};
    const Vector3 away =
        normalized(along(normal, 1.2, {share(random), share(random), share(random)}));
    if (dot(away, normal) < 0.5) continue;
    Query query;
    query.limit = 0.06;
    query.ray = {along(fitted.store.position(i), 0.5 * query.limit, away), scaled(away, -1)};
    for (const std::uint32_t k : s.leaves()) {
      const Vector3 d = subtract({s.cx[k], s.cy[k], s.cz[k]}, fitted.store.position(i));
      if (length(d) > 0.5 * query.limit + s.radius[k]) continue;
      const RaySurfel leaf(s, k);
      if (Approach(leaf, query.ray).distance_sq < 1) query.leaves.push_back(leaf);
    }
    queries.push_back(std::move(query));
  }
  return queries;
}

/** A leaf along a ray. */
struct OnRay {
  RayPolynomial f;
  double depth, distance_sq, radius;

  OnRay(const RaySurfel& leaf, const Approach& approach, const Ray& ray)
      : f(leaf, approach, ray.direction),
        depth(approach.depth),
        distance_sq(approach.distance_sq),
        radius(leaf.radius) {}
  double stationOf(double t) const { return (t - depth) / radius; }
  double weightAtDepth(double t) const {
    const double s = stationOf(t);
    return weightAt(std::sqrt(std::min(1.0, distance_sq + s * s)));
  }
};

std::vector<OnRay> onRay(const Query& query) {
  std::vector<OnRay> leaves;
  for (const RaySurfel& leaf : query.leaves)
    leaves.emplace_back(leaf, Approach(leaf, query.ray), query.ray);
  return leaves;
}

/** Depth by averaging (eq. 6), or infinity. */
double averagedDepth(const Query& query) {
  const std::vector<OnRay> leaves = onRay(query);
  double first = HUGE_VAL;
  for (std::size_t k = 0; k < leaves.size(); ++k) {
    const double reach_sq = kShrink * kShrink - leaves[k].distance_sq;
    if (reach_sq <= 0) continue;
    const double reach = std::sqrt(reach_sq);
    const auto roots =
        detail::rootsInInterval(query.leaves[k].degree, leaves[k].f.a, -reach, reach);
    if (roots.count > 0) first = std::min(first, leaves[k].depth + leaves[k].radius * roots.at[0]);
  }
  double sum = 0, weight = 0;
  for (std::size_t k = 0; k < leaves.size() && first < HUGE_VAL; ++k) {
    const double w = leaves[k].weightAtDepth(first);
    if (w <= 0) continue;
    const double s = leaves[k].stationOf(first);
    const auto roots =
        detail::rootsInInterval(query.leaves[k].degree, leaves[k].f.a, s - 0.25, s + 0.25);
    if (roots.count == 0) continue;
    sum += w * (leaves[k].depth + leaves[k].radius * roots.at[0]);
    weight += w;
  }
  return weight > 0 ? sum / weight : HUGE_VAL;
}

/** Depth of the first zero of the blend in space, by steps of a twentieth of a leaf and Illinois'
 * rule. */
double depthInSpace(const Query& query, std::size_t& evaluations) {
  const std::vector<OnRay> leaves = onRay(query);
  double step = HUGE_VAL;
  for (const OnRay& leaf : leaves) step = std::min(step, 0.1 * leaf.radius);
  const auto blend = [&](double t) {
    double sum = 0, weight = 0;
    ++evaluations;
    for (const OnRay& leaf : leaves) {
      const double w = leaf.weightAtDepth(t), s = leaf.stationOf(t);
      if (w <= 0) continue;
      const double* a = leaf.f.a;
      sum += w * leaf.radius * (a[0] + s * (a[1] + s * (a[2] + s * (a[3] + s * a[4]))));
      weight += w;
    }
    return weight > 0 ? sum / weight : 0.0;
  };
  double low = 0, f_low = 0;
  for (double t = 0; t < query.limit; t += step) {
    double f_high = blend(t), high = t;
    if (!(f_low > 0 && f_high <= 0)) {
      low = t;
      f_low = f_high;
      continue;
    }
    while (high - low > 1e-7) {
      const double middle = (low * f_high - high * f_low) / (f_high - f_low);
      const double value = blend(middle);
      if (std::abs(value) < 1e-8) return middle;
      if (value > 0) {
        low = middle;
        f_low = value;
        f_high *= 0.5;
      } else {
        high = middle;
        f_high = value;
        f_low *= 0.5;
      }
    }
    return 0.5 * (low + high);
  }
  return HUGE_VAL;
}

Error addRow(const StudySettings& settings, const Model& model, int degree, Table& table) {
  FitParams params;
  params.degree = degree;
  params.threads = settings.threads;
  const auto fitted = fitModel(model, params);
  if (!fitted) return fitted.error();
  const std::vector<Query> queries = makeQueries(*fitted, 4000);
  std::vector<double> averaged, in_space;
  std::size_t evaluations = 0, leaves = 0;
  for (const Query& query : queries) leaves += query.leaves.size();
  double begin = measure::cpuSeconds();
  for (const Query& query : queries) averaged.push_back(averagedDepth(query));
  const double average_time = measure::cpuSeconds() - begin;
  begin = measure::cpuSeconds();
  for (const Query& query : queries) in_space.push_back(depthInSpace(query, evaluations));
  const double space_time = measure::cpuSeconds() - begin;
  std::vector<double> apart;
  for (std::size_t i = 0; i < queries.size(); ++i) {
    if (averaged[i] < HUGE_VAL && in_space[i] < HUGE_VAL)
      apart.push_back(std::abs(averaged[i] - in_space[i]) / fitted->store.diagonal());
  }
  std::sort(apart.begin(), apart.end());
  const auto count = static_cast<double>(queries.size());
  table.row({model.name, std::to_string(degree),
             number("%.1f", static_cast<double>(leaves) / count),
             number("%.2f", 1e6 * average_time / count), number("%.2f", 1e6 * space_time / count),
             number("%.1f", static_cast<double>(evaluations) / count),
             number("%.1f", space_time / average_time), number("%.1e", apart[apart.size() / 2]),
             number("%.1e", apart[apart.size() * 95 / 100])});
  return {};
}

}  // namespace

Error blendingOnRays(const StudySettings& settings) {
  if (Error error = drawBlends(settings)) return error;
  Table table("Averaging along rays against the zero of the blend in space (Figs. 8, 9)",
              {"model", "degree", "leaves on the ray", "averaging, us a ray", "in space, us a ray",
               "evaluations", "times", "median difference / L", "95th percentile"});
  for (const char* file : {"stanford_bunny_zipper.ply", "stanford_dragon_res2.ply"}) {
    const auto model = loadModel(settings, file);
    if (!model) return model.error();
    for (const int degree : {2, 3, 4}) {
      if (Error error = addRow(settings, *model, degree, table)) return error;
    }
  }
  return table.save(settings, "fig08");
}

}  // namespace pcl_slim::paper
