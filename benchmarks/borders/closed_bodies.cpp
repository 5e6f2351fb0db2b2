// SPDX-License-Identifier: BSD-3-Clause
#include "closed_bodies.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <unordered_map>

namespace pcl_slim::measure {

namespace {

using Point = std::array<double, 3>;

constexpr double kSparsest = 1.0 / 20.0;  ///< of the largest density
constexpr std::size_t kTries = 8;         ///< candidates for a point of a blue spread, at most

/** An ellipsoid's half axes. */
constexpr Point kAxes{{1.0, 0.6, 0.35}};

/** An amphora: a vessel about the z axis and two handles, parts of tori across x. All blend
 * smoothly. */
constexpr double kHalfHeight = 1.2, kHandleX = 0.42, kHandleZ = 0.42, kHandleMajor = 0.3,
                 kHandleMinor = 0.12, kBlend = 0.1;

/** The lesser of two values, rounded where they differ by less than kBlend. */
double smoothLeast(double a, double b) {
  const double h = std::max(0.0, kBlend - std::abs(a - b)) / kBlend;
  return std::min(a, b) - 0.25 * kBlend * h * h;
}

/** About the distance to the amphora, negative inside. */
double amphoraAt(const Point& p) {
  const double belly = (p[2] + 0.3) / 0.55, lip = (p[2] - 1.05) / 0.2;
  const double radius = 0.25 + 0.55 * std::exp(-belly * belly) + 0.12 * std::exp(-lip * lip);
  const double wall = 0.8 * (std::hypot(p[0], p[1]) - radius);
  const double vessel = -smoothLeast(-wall, kHalfHeight - std::abs(p[2]));
  const double ring = std::hypot(std::abs(p[0]) - kHandleX, p[2] - kHandleZ) - kHandleMajor;
  return smoothLeast(vessel, std::hypot(ring, p[1]) - kHandleMinor);
}

Point amphoraGradient(const Point& p) {
  constexpr double kStep = 1e-5;
  Point gradient;
  for (std::size_t a = 0; a < 3; ++a) {
    Point high = p, low = p;
    high[a] += kStep;
    low[a] -= kStep;
    gradient[a] = (amphoraAt(high) - amphoraAt(low)) / (2.0 * kStep);
  }
  return gradient;
}

/** A prism along y over a convex polygon in x and z: what edges and corners are like. */
class Prism {
 public:
  explicit Prism(Body body) {
    switch (body) {
      case Body::kSlab: corners_ = {{-0.9, -0.04}, {0.9, -0.04}, {0.9, 0.04}, {-0.9, 0.04}}; break;
      case Body::kWedge: corners_ = {{-0.9, 0}, {0.9, 0}, {0.9, 1.04}}; break;  // 30 degrees
      default: corners_ = {{-0.9, -0.9}, {0.9, -0.9}, {0.9, 0.9}, {-0.9, 0.9}};
    }
  }

  /** A place of the surface. \param[in] unit draws from [0, 1) */
  template <typename Unit>
  Point draw(const Unit& unit) const {
    const std::size_t n = corners_.size();
    double sides = 0, base = 0;
    for (std::size_t k = 0; k < n; ++k) {
      sides += 2 * kHalfLength * lengthOf(k);
      base += fanAreaOf(k);
    }
    double at = (sides + 2 * base) * unit();
    for (std::size_t k = 0; k < n; at -= 2 * kHalfLength * lengthOf(k), ++k) {
      if (at >= 2 * kHalfLength * lengthOf(k)) continue;
      const auto &a = corners_[k], &b = corners_[(k + 1) % n];
      const double t = unit(), y = kHalfLength * (2 * unit() - 1);
      return {a[0] + t * (b[0] - a[0]), y, a[1] + t * (b[1] - a[1])};
    }
    const double y = at < base ? kHalfLength : -kHalfLength;
    double in_fan = std::fmod(at, base);
    std::size_t k = 1;
    while (k + 2 < n && in_fan >= fanAreaOf(k)) in_fan -= fanAreaOf(k++);
    double s = unit(), t = unit();
    if (s + t > 1) {
      s = 1 - s;
      t = 1 - t;
    }
    const auto &o = corners_[0], &a = corners_[k], &b = corners_[k + 1];
    return {o[0] + s * (a[0] - o[0]) + t * (b[0] - o[0]), y,
            o[1] + s * (a[1] - o[1]) + t * (b[1] - o[1])};
  }

 private:
  static constexpr double kHalfLength = 0.9;

  double lengthOf(std::size_t k) const {
    const auto &a = corners_[k], &b = corners_[(k + 1) % corners_.size()];
    return std::hypot(b[0] - a[0], b[1] - a[1]);
  }

  /** Of the triangle of the first corner and side k, 0 where they touch. */
  double fanAreaOf(std::size_t k) const {
    const auto &o = corners_[0], &a = corners_[k], &b = corners_[(k + 1) % corners_.size()];
    return 0.5 * std::abs((a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0]));
  }

  std::vector<std::array<double, 2>> corners_;
};

/** Candidates evenly spread over a body. */
class Sampler {
 public:
  Sampler(Body body, std::uint64_t seed) : body_(body), prism_(body), random_(seed) {}

  double unit() { return std::uniform_real_distribution<double>(0.0, 1.0)(random_); }
  double gauss() { return gauss_(random_); }

  Point draw() {
    if (body_ >= Body::kCube) return prism_.draw([this] { return unit(); });
    if (body_ == Body::kEllipsoid) return ellipsoid();
    return body_ == Body::kAmphora ? amphora() : exact();
  }

 private:
  /** A shape of scenes.h. They are made by the thousand: seeds follow each other. */
  Point exact() {
    constexpr std::size_t kBatch = 4096;
    if (next_ == batch_.points.size()) {
      const Shape shape = body_ == Body::kSphere  ? Shape::kSphere
                          : body_ == Body::kTorus ? Shape::kTorus
                                                  : Shape::kBumpy;
      batch_ = makeScene(shape, kBatch, 0.0, 0.0, random_());
      next_ = 0;
    }
    const double* p = batch_.points.data() + next_;
    next_ += 3;
    return {p[0], p[1], p[2]};
  }

  /** A direction scaled to the axes; area a direction is as |(x/a, y/b, z/c) of the normal|. */
  Point ellipsoid() {
    for (;;) {
      Point d{gauss(), gauss(), gauss()};
      const double length = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
      Point p;
      double stretch_sq = 0.0;
      for (std::size_t a = 0; a < 3; ++a) {
        d[a] /= length;
        p[a] = kAxes[a] * d[a];
        stretch_sq += d[a] * d[a] / (kAxes[a] * kAxes[a]);
      }
      if (unit() < kAxes[2] * std::sqrt(stretch_sq)) return p;
    }
  }

  /** A point of a thin shell about the surface, moved onto it. */
  Point amphora() {
    constexpr double kShell = 0.02;
    for (;;) {
      Point p{1.9 * unit() - 0.95, 1.9 * unit() - 0.95, 2.5 * unit() - 1.25};
      if (std::abs(amphoraAt(p)) > 2.0 * kShell) continue;
      Point gradient = amphoraGradient(p);
      const double slope_sq =
          gradient[0] * gradient[0] + gradient[1] * gradient[1] + gradient[2] * gradient[2];
      const double value = amphoraAt(p);
      if (value * value > kShell * kShell * slope_sq) continue;
      for (int step = 0; step < 4; ++step) {
        gradient = amphoraGradient(p);
        const double sq =
            gradient[0] * gradient[0] + gradient[1] * gradient[1] + gradient[2] * gradient[2];
        const double along = amphoraAt(p) / sq;
        for (std::size_t a = 0; a < 3; ++a) p[a] -= along * gradient[a];
      }
      return p;
    }
  }

  Body body_;
  Prism prism_;
  std::mt19937_64 random_;
  std::normal_distribution<double> gauss_;
  Scene batch_;
  std::size_t next_ = 0;
};

/** Points none of which is nearer to another than a distance. */
class ApartPoints {
 public:
  explicit ApartPoints(double least) : least_sq_(least * least), cell_(least) {}

  bool add(const Point& p) {
    std::array<std::int64_t, 3> at;
    for (std::size_t a = 0; a < 3; ++a) at[a] = static_cast<std::int64_t>(std::floor(p[a] / cell_));
    for (int k = 0; k < 27; ++k) {
      const auto found =
          cells_.find(key({at[0] + k % 3 - 1, at[1] + k / 3 % 3 - 1, at[2] + k / 9 - 1}));
      if (found == cells_.end()) continue;
      for (const Point& q : found->second) {
        const double dx = p[0] - q[0], dy = p[1] - q[1], dz = p[2] - q[2];
        if (dx * dx + dy * dy + dz * dz < least_sq_) return false;
      }
    }
    cells_[key(at)].push_back(p);
    return true;
  }

 private:
  static std::int64_t key(const std::array<std::int64_t, 3>& at) {
    constexpr std::int64_t kHalf = 1 << 20;
    return ((at[0] + kHalf) << 42) | ((at[1] + kHalf) << 21) | (at[2] + kHalf);
  }

  double least_sq_, cell_;
  std::unordered_map<std::int64_t, std::vector<Point>> cells_;
};

/** Whether a candidate is one of an uneven spread's points. */
bool isKept(Spread spread, const Point& p, Sampler& sampler) {
  if (spread == Spread::kUneven) {
    const double t = std::clamp(0.5 * (p[0] + 1.0), 0.0, 1.0);
    return sampler.unit() < std::pow(kSparsest, t);
  }
  return spread != Spread::kStep || p[0] < 0.1 || sampler.unit() < kSparsest;
}

std::vector<Point> blueSpread(Body body, std::size_t count, std::uint64_t seed) {
  for (double apart = 4.0 / std::sqrt(static_cast<double>(count));; apart *= 0.93) {
    Sampler sampler(body, seed);
    ApartPoints kept(apart);
    std::vector<Point> points;
    for (std::size_t k = 0; k < kTries * count && points.size() < count; ++k) {
      const Point p = sampler.draw();
      if (kept.add(p)) points.push_back(p);
    }
    if (points.size() == count) return points;
  }
}

}  // namespace

bool parseBody(const std::string& name, Body& body) {
  static const char* const kNames[] = {"sphere",  "torus", "bumpy", "ellipsoid",
                                       "amphora", "cube",  "slab",  "wedge"};
  const auto* found = std::find(std::begin(kNames), std::end(kNames), name);
  if (found == std::end(kNames)) return false;
  body = static_cast<Body>(found - std::begin(kNames));
  return true;
}

bool parseSpread(const std::string& name, Spread& spread) {
  static const char* const kNames[] = {"random", "blue", "uneven", "step"};
  const auto* found = std::find(std::begin(kNames), std::end(kNames), name);
  if (found == std::end(kNames)) return false;
  spread = static_cast<Spread>(found - std::begin(kNames));
  return true;
}

Scene makeBody(Body body, Spread spread, std::size_t count, double noise, std::uint64_t seed) {
  Sampler sampler(body, seed);
  std::vector<Point> points;
  if (spread == Spread::kBlue) points = blueSpread(body, count, seed);
  while (points.size() < count) {
    const Point p = sampler.draw();
    if (isKept(spread, p, sampler)) points.push_back(p);
  }
  Point low = points[0], high = points[0];
  for (const Point& p : points) {
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], p[a]);
      high[a] = std::max(high[a], p[a]);
    }
  }
  Scene scene;
  scene.diagonal =
      std::sqrt((high[0] - low[0]) * (high[0] - low[0]) + (high[1] - low[1]) * (high[1] - low[1]) +
                (high[2] - low[2]) * (high[2] - low[2]));
  for (const Point& p : points) {
    for (const double value : p) {
      scene.points.push_back(value + noise * scene.diagonal * sampler.gauss());
    }
  }
  return scene;
}

}  // namespace pcl_slim::measure
