// SPDX-License-Identifier: BSD-3-Clause
// Borders of parts that are so flat that a few wide triangles would do: every hole and corner of
// the points is one of the mesh.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <random>
#include <vector>

#include "pcl_slim/mesh/mesh_extraction.h"
#include "pcl_slim/query/surface_probe.h"
#include "support/clouds.h"

namespace {

using namespace pcl_slim;
using pcl_slim_test::Cloud;

/// Lengths are in spacings of the points.
constexpr double kSide = 100;

/** A sheet over a part of the square [0, 100]^2. */
struct Part {
  const char* name;
  std::uint64_t holes;
  std::function<double(double, double)> inside;  ///< how far inside a place is; below 0: outside
  double border;                                 ///< its length
  double noise = 0.1;
  double wave = 0;  ///< height of waves 50 long
  double yaw = 0, tilt = 0;
};

void PrintTo(const Part& part, std::ostream* out) {
  *out << part.name;
}

double insideSquare(double x, double y) {
  return std::min({x, y, kSide - x, kSide - y});
}

Part plate() {
  return {"plate", 0, insideSquare, 4 * kSide};
}

Part plateWithHole() {
  const auto inside = [](double x, double y) {
    return std::min(insideSquare(x, y), std::hypot(x - 50, y - 50) - 20);
  };
  return {"plate with a hole of 40", 1, inside, 4 * kSide + 40 * M_PI};
}

Part slabWithShaft() {
  const auto inside = [](double x, double y) {
    const double dx = std::abs(x - 45) - 12.5, dy = std::abs(y - 60) - 12.5;
    const double out = std::hypot(std::max(dx, 0.0), std::max(dy, 0.0));
    return std::min(insideSquare(x, y), out > 0 ? out : std::max(dx, dy));
  };
  return {"slab with a square shaft of 25", 1, inside, 4 * kSide + 100};
}

/** 36 holes 8 wide. */
Part sieve() {
  const auto inside = [](double x, double y) {
    const auto toHole = [](double at) { return std::clamp(std::round((at - 10) / 16), 0.0, 5.0); };
    const double dx = x - 10 - 16 * toHole(x), dy = y - 10 - 16 * toHole(y);
    return std::min(insideSquare(x, y), std::hypot(dx, dy) - 4);
  };
  return {"sieve", 36, inside, 4 * kSide + 36 * 8 * M_PI};
}

Part bar() {
  const auto inside = [](double x, double y) { return std::min(insideSquare(x, y), 12 - y); };
  return {"bar 12 wide", 0, inside, 2 * kSide + 24};
}

std::vector<Part> parts() {
  std::vector<Part> all = {plate(), plateWithHole(), slabWithShaft(), sieve(), bar()};
  const auto add = [&](Part part, const char* name) {
    part.name = name;
    all.push_back(std::move(part));
  };
  Part turned = sieve();
  turned.yaw = 0.5;
  turned.tilt = 0.6;
  add(turned, "turned sieve");
  Part exact = sieve();
  exact.noise = 0;
  add(exact, "sieve without noise");
  Part wavy = sieve();
  wavy.wave = 3;
  add(wavy, "wavy sieve");
  return all;
}

class FlatBorders : public testing::TestWithParam<Part> {
 protected:
  Vector3 place(const Vector3& p) const { return turn(p, 1); }
  /** Back into the square. */
  Vector3 flat(const Vector3& p) const { return turn(p, -1); }

  Cloud cloud() const {
    Cloud made;
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> along(0, kSide);
    std::normal_distribution<double> gauss;
    const Part& part = GetParam();
    for (int i = 0; i < kSide * kSide; ++i) {
      const double x = along(random), y = along(random);
      const double z = part.wave * std::sin(2 * M_PI * x / 50) + part.noise * gauss(random);
      if (part.inside(x, y) < 0) continue;
      const Vector3 p = place({x, y, z});
      made.add(p[0], p[1], p[2]);
    }
    return made;
  }

 private:
  Vector3 turn(const Vector3& p, double side) const {
    const double a = side * GetParam().yaw, b = side * GetParam().tilt;
    const auto yaw = [&](const Vector3& q) -> Vector3 {
      return {std::cos(a) * q[0] - std::sin(a) * q[1], std::sin(a) * q[0] + std::cos(a) * q[1],
              q[2]};
    };
    const auto tilt = [&](const Vector3& q) -> Vector3 {
      return {std::cos(b) * q[0] - std::sin(b) * q[2], q[1],
              std::sin(b) * q[0] + std::cos(b) * q[2]};
    };
    return side > 0 ? tilt(yaw(p)) : yaw(tilt(p));
  }
};

/** What of the square's surroundings a mesh covers, seen from above, on a grid of places. */
class Coverage {
 public:
  static constexpr double kStep = 0.25, kLow = -10;
  static constexpr std::size_t kNodes = 481;

  Coverage() : times_(kNodes * kNodes, 0) {}

  static double at(std::size_t node) { return kLow + kStep * static_cast<double>(node); }
  int times(std::size_t column, std::size_t row) const { return times_[row * kNodes + column]; }

  void add(const Vector3& a, const Vector3& b, const Vector3& c) {
    const auto side = [](const Vector3& p, const Vector3& q, double x, double y) {
      return (q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0]);
    };
    const auto range = [&](std::size_t axis, std::size_t& first, std::size_t& last) {
      const double low = std::min({a[axis], b[axis], c[axis]});
      const double high = std::max({a[axis], b[axis], c[axis]});
      first = static_cast<std::size_t>(std::max(0.0, std::ceil((low - kLow) / kStep)));
      last = static_cast<std::size_t>(std::max(0.0, std::floor((high - kLow) / kStep) + 1));
      last = std::min(last, kNodes);
    };
    std::size_t begin[2], end[2];
    range(0, begin[0], end[0]);
    range(1, begin[1], end[1]);
    for (std::size_t row = begin[1]; row < end[1]; ++row) {
      for (std::size_t column = begin[0]; column < end[0]; ++column) {
        const double x = at(column), y = at(row);
        const bool left[3] = {side(a, b, x, y) > 0, side(b, c, x, y) > 0, side(c, a, x, y) > 0};
        if (left[0] == left[1] && left[1] == left[2]) ++times_[row * kNodes + column];
      }
    }
  }

 private:
  std::vector<int> times_;
};

TEST_P(FlatBorders, AreThoseOfThePoints) {
  const Part& part = GetParam();
  SLIMSurface surface;
  FitParams fit;
  fit.threads = 1;
  ASSERT_FALSE(fitSurface(pcl_slim_test::storeOf(cloud()), fit, surface));
  TriangleMesh mesh;
  MeshStatistics statistics;
  ASSERT_FALSE(extractMesh(surface, {}, mesh, &statistics));
  EXPECT_EQ(statistics.census.euler, 1 - static_cast<std::int64_t>(part.holes));
  EXPECT_EQ(statistics.census.components, 1u);
  EXPECT_EQ(statistics.census.nonmanifold_edges, 0u);
  EXPECT_EQ(statistics.census.nonmanifold_vertices, 0u);

  Coverage coverage;
  for (const auto& t : mesh.triangles) {
    coverage.add(flat(mesh.vertices[t[0]]), flat(mesh.vertices[t[1]]), flat(mesh.vertices[t[2]]));
  }
  double beyond = 0, missing = 0, twice = 0, farthest = 0, deepest = 0;
  for (std::size_t row = 0; row < Coverage::kNodes; ++row) {
    for (std::size_t column = 0; column < Coverage::kNodes; ++column) {
      const double inside = part.inside(Coverage::at(column), Coverage::at(row));
      const int times = coverage.times(column, row);
      const double area = Coverage::kStep * Coverage::kStep;
      if (times > 1) twice += area;
      if (inside < 0 && times > 0) {
        beyond += area;
        farthest = std::max(farthest, -inside);
      }
      if (inside >= 0 && times == 0) {
        missing += area;
        deepest = std::max(deepest, inside);
      }
    }
  }
  EXPECT_LE(beyond, 0.75 * part.border);
  EXPECT_LE(missing, 0.25 * part.border);
  EXPECT_LE(farthest, 2.5);
  EXPECT_LE(deepest, 2.5);
  EXPECT_LE(twice, 0.01 * part.border) << "no triangle is turned over";
}

/** Edges on the border of a mesh: their ends, and the way out of the mesh in its plane. */
struct RimEdge {
  Vector3 from, to, outwards;
};

std::vector<RimEdge> rimOf(const TriangleMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> uses;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      uses[{mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3]}] = t;
    }
  }
  std::vector<RimEdge> rim;
  for (const auto& [ends, t] : uses) {
    if (uses.count({ends.second, ends.first}) > 0) continue;
    const auto& own = mesh.triangles[t];
    const Vector3 &a = mesh.vertices[own[0]], &b = mesh.vertices[own[1]];
    const Vector3 normal = cross(subtract(b, a), subtract(mesh.vertices[own[2]], a));
    const Vector3 &from = mesh.vertices[ends.first], &to = mesh.vertices[ends.second];
    rim.push_back({from, to, normalized(cross(subtract(to, from), normal))});
  }
  return rim;
}

/** How far the line on which the surface ends is from a place along a way, up to a reach. */
double distanceToEnd(SurfaceProbe& probe, const SurfaceInfo& info, const Vector3& place,
                     const Vector3& way, double reach) {
  const auto isOutside = [&](double s) {
    const Vector3 at = scaled(subtract(along(place, s, way), info.origin), 1 / info.scale);
    ProbeRequest request;
    request.positions = &at;
    request.count = 1;
    request.curvature = false;
    ProbeSample sample;
    probe.evaluate(request, &sample);
    return !sample.supported || sample.outside > 0.5;
  };
  const bool here = isOutside(0);
  for (double off = 0; off <= reach; off += 0.02) {
    if (isOutside(here ? -off : off) != here) return off;
  }
  return reach;
}

TEST_P(FlatBorders, EdgesFollowTheLineOnWhichTheSurfaceEnds) {
  const pcl_slim_test::Fitted fit = pcl_slim_test::fitted(cloud());
  TriangleMesh mesh;
  ASSERT_FALSE(extractMesh(fit.surface, {}, mesh));
  const ProbeIndex index(fit.surface, ProbeUse::kExtraction);
  SurfaceProbe probe(index);
  std::size_t edges = 0, ends_off = 0, middles_off = 0;
  for (const RimEdge& edge : rimOf(mesh)) {
    const Vector3 middle = along(scaled(edge.from, 0.5), 0.5, edge.to);
    const auto off = [&](const Vector3& place) {
      return distanceToEnd(probe, fit.surface.info, place, edge.outwards, 1);
    };
    ++edges;
    ends_off += off(edge.from) > 0.1 ? 1 : 0;
    middles_off += off(middle) > 0.18 ? 1 : 0;
  }
  // An edge is not divided where its triangle would fold, or where the line runs along its way.
  EXPECT_GT(edges, 100u);
  EXPECT_LE(ends_off, edges / 50);
  EXPECT_LE(middles_off, edges / 50);
}

INSTANTIATE_TEST_SUITE_P(Parts, FlatBorders, testing::ValuesIn(parts()));

}  // namespace
