// SPDX-License-Identifier: BSD-3-Clause
#include "borders/charts.h"

#include <algorithm>
#include <cmath>

namespace pcl_slim::borders {
namespace {

class Plane : public Chart {
 public:
  Plane(double height, double side) : height_(height), side_(side) {}
  Vector3 place(const Flat& at) const override { return {at[0], at[1], height_}; }
  Vector3 normal(const Flat&) const override { return {0.0, 0.0, side_}; }
  ChartFoot foot(const Vector3& p) const override {
    return {{p[0], p[1]}, side_ * (p[2] - height_)};
  }

 private:
  double height_, side_;
};

class Wavy : public Chart {
 public:
  Vector3 place(const Flat& at) const override {
    return {at[0], at[1], kHigh * std::sin(at[0] / kLong) * std::cos(at[1] / kWide)};
  }
  Vector3 normal(const Flat& at) const override { return normalized(upward(at)); }
  ChartFoot foot(const Vector3& p) const override {
    ChartFoot foot{{p[0], p[1]}, 0.0};
    for (int step = 0; step < 4; ++step) {
      const Vector3 n = normal(foot.at);
      foot.height = dot(subtract(p, place(foot.at)), n);
      foot.at = {p[0] - foot.height * n[0], p[1] - foot.height * n[1]};
    }
    return foot;
  }
  double stretch(const Flat& at) const override { return length(upward(at)); }
  double mostStretch() const override { return 1.2; }

 private:
  static constexpr double kHigh = 8.0, kLong = 16.0, kWide = 20.0;

  static Vector3 upward(const Flat& at) {
    const double x = at[0] / kLong, y = at[1] / kWide;
    return {-kHigh / kLong * std::cos(x) * std::cos(y), kHigh / kWide * std::sin(x) * std::sin(y),
            1.0};
  }
};

class Cylinder : public Chart {
 public:
  Cylinder(double radius, double side) : radius_(radius), side_(side) {}
  Vector3 place(const Flat& at) const override {
    const double a = at[0] / radius_;
    return {radius_ * std::cos(a), radius_ * std::sin(a), at[1]};
  }
  Vector3 normal(const Flat& at) const override {
    const double a = at[0] / radius_;
    return {side_ * std::cos(a), side_ * std::sin(a), 0.0};
  }
  ChartFoot foot(const Vector3& p) const override {
    return {{radius_ * std::atan2(p[1], p[0]), p[2]}, side_ * (std::hypot(p[0], p[1]) - radius_)};
  }
  double period() const override { return 2.0 * M_PI * radius_; }

 private:
  double radius_, side_;
};

class Elbow : public Chart {
 public:
  Elbow(double radius, double bend) : radius_(radius), bend_(bend) {}
  Vector3 place(const Flat& at) const override {
    const Vector3 n = normal(at);
    const double b = at[1] / bend_;
    return along({bend_ * std::cos(b), bend_ * std::sin(b), 0.0}, radius_, n);
  }
  Vector3 normal(const Flat& at) const override {
    const double a = at[0] / radius_, b = at[1] / bend_;
    return {std::cos(a) * std::cos(b), std::cos(a) * std::sin(b), std::sin(a)};
  }
  ChartFoot foot(const Vector3& p) const override {
    const double beyond = std::hypot(p[0], p[1]) - bend_;
    return {{radius_ * std::atan2(p[2], beyond), bend_ * std::atan2(p[1], p[0])},
            std::hypot(beyond, p[2]) - radius_};
  }
  double stretch(const Flat& at) const override {
    return 1.0 + radius_ / bend_ * std::cos(at[0] / radius_);
  }
  double mostStretch() const override { return 1.0 + radius_ / bend_; }
  double period() const override { return 2.0 * M_PI * radius_; }

 private:
  double radius_, bend_;
};

/** The half planes go down from the x axis, each by half the angle beside straight down. */
class Wedge : public Chart {
 public:
  explicit Wedge(double angle) : sine_(std::sin(0.5 * angle)), cosine_(std::cos(0.5 * angle)) {}
  Vector3 place(const Flat& at) const override {
    return {at[0], at[1] * sine_, -std::abs(at[1]) * cosine_};
  }
  Vector3 normal(const Flat& at) const override {
    return {0.0, at[1] < 0.0 ? -cosine_ : cosine_, sine_};
  }
  ChartFoot foot(const Vector3& p) const override {
    const double side = p[1] < 0.0 ? -1.0 : 1.0;
    const double down = std::max(0.0, std::abs(p[1]) * sine_ - p[2] * cosine_);
    return {{p[0], side * down}, std::abs(p[1]) * cosine_ + p[2] * sine_};
  }

 private:
  double sine_, cosine_;
};

class Room : public Chart {
 public:
  Room(double width, double depth) : width_(width), depth_(depth) {}
  Vector3 place(const Flat& at) const override {
    const Wall w = wallOf(at[0]);
    return {w.from[0] + w.way * w.to[0], w.from[1] + w.way * w.to[1], at[1]};
  }
  Vector3 normal(const Flat& at) const override {
    const Wall w = wallOf(at[0]);
    return {-w.to[1], w.to[0], 0.0};
  }
  ChartFoot foot(const Vector3& p) const override {
    ChartFoot best;
    double nearest = 1e9, start = 0.0;
    for (int k = 0; k < 4; ++k) {
      const double size = k % 2 == 0 ? width_ : depth_;
      const Wall w = wallOf(start + 0.5 * size);
      const double x = p[0] - w.from[0], y = p[1] - w.from[1];
      const double way = std::clamp(x * w.to[0] + y * w.to[1], 0.0, size);
      const double beside = std::hypot(x - way * w.to[0], y - way * w.to[1]);
      if (beside < nearest) {
        nearest = beside;
        best = {{start + way, p[2]}, -x * w.to[1] + y * w.to[0]};
      }
      start += size;
    }
    return best;
  }
  double period() const override { return 2.0 * (width_ + depth_); }

 private:
  struct Wall {
    Flat from, to;  ///< a corner, and the direction from it
    double way;     ///< along it
  };

  Wall wallOf(double u) const {
    u -= period() * std::floor(u / period());
    if (u < width_) return {{0.0, 0.0}, {1.0, 0.0}, u};
    u -= width_;
    if (u < depth_) return {{width_, 0.0}, {0.0, 1.0}, u};
    u -= depth_;
    if (u < width_) return {{width_, depth_}, {-1.0, 0.0}, u};
    return {{0.0, depth_}, {0.0, -1.0}, u - width_};
  }

  double width_, depth_;
};

class Sphere : public Chart {
 public:
  explicit Sphere(double radius) : radius_(radius) {}
  Vector3 place(const Flat& at) const override { return scaled(normal(at), radius_); }
  Vector3 normal(const Flat& at) const override {
    const double a = at[0] / radius_, b = at[1] / radius_;
    return {std::cos(b) * std::cos(a), std::cos(b) * std::sin(a), std::sin(b)};
  }
  ChartFoot foot(const Vector3& p) const override {
    return {{radius_ * std::atan2(p[1], p[0]), radius_ * std::atan2(p[2], std::hypot(p[0], p[1]))},
            length(p) - radius_};
  }
  double stretch(const Flat& at) const override { return std::max(0.0, std::cos(at[1] / radius_)); }
  double period() const override { return 2.0 * M_PI * radius_; }

 private:
  double radius_;
};

}  // namespace

ChartPointer planeChart(double height, double side) {
  return std::make_shared<Plane>(height, side);
}
ChartPointer wavyChart() {
  return std::make_shared<Wavy>();
}
ChartPointer cylinderChart(double radius, double side) {
  return std::make_shared<Cylinder>(radius, side);
}
ChartPointer elbowChart(double radius, double bend) {
  return std::make_shared<Elbow>(radius, bend);
}
ChartPointer wedgeChart(double angle) {
  return std::make_shared<Wedge>(angle);
}
ChartPointer roomChart(double width, double depth) {
  return std::make_shared<Room>(width, depth);
}
ChartPointer sphereChart(double radius) {
  return std::make_shared<Sphere>(radius);
}

}  // namespace pcl_slim::borders
