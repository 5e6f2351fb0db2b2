// SPDX-License-Identifier: BSD-3-Clause

#include "support/lab/line_truth.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <unordered_map>

#include "pcl_slim/core/vector3.h"

namespace pcl_slim::measure {

namespace {

constexpr double kTau = 2 * M_PI;
constexpr double kMajor = 1.0, kMinor = 0.4, kWaves = 0.04;
constexpr std::size_t kAreaCells = 1000;

/** A unit direction; the poles and the seam are on no plane of symmetry. */
Vector3 direction(double u, double v) {
  const double z = 1 - 2 * v, r = std::sqrt(std::max(0.0, 1 - z * z));
  const Vector3 d = {r * std::cos(kTau * u), r * std::sin(kTau * u), z};
  static const Vector3 a = normalized({0.61, 0.53, 0.59});
  static const Vector3 b = normalized(cross(a, {0.2, -0.9, 0.31}));
  static const Vector3 c = cross(a, b);
  return {dot(d, a), dot(d, b), dot(d, c)};
}

LineSurface starShaped(std::function<double(const Vector3&)> radius,
                       std::function<Jet(const Jet&, const Jet&, const Jet&)> implicit) {
  return {[radius = std::move(radius)](double u, double v) {
            const Vector3 d = direction(u, v);
            return scaled(d, radius(d));
          },
          std::move(implicit)};
}

LineSurface torusWithWaves(double waves) {
  const auto map = [waves](double u, double v) {
    const double a = kTau * (u + 0.0137), b = kTau * (v + 0.0219);
    const double r = kMinor * (1 + waves * std::cos(6 * a) * std::cos(3 * b));
    const double rho = kMajor + r * std::cos(b);
    return Vector3{rho * std::cos(a), rho * std::sin(a), r * std::sin(b)};
  };
  const auto implicit = [waves](const Jet& x, const Jet& y, const Jet& z) {
    const Jet rho = sqrt(x * x + y * y) - kMajor;
    const Jet wave = cos(6.0 * atan2(y, x)) * cos(3.0 * atan2(z, rho));
    return sqrt(rho * rho + z * z) - kMinor * (1.0 + waves * wave);
  };
  return {map, implicit};
}

/** Bumps of a sphere: a height and a frequency each. */
struct Bumps {
  double height, frequency;
};

LineSurface bumpySphere(const std::vector<Bumps>& all) {
  return starShaped(
      [all](const Vector3& d) {
        double r = 1;
        for (const auto& [h, f] : all)
          r += h * std::sin(f * d[0]) * std::sin(f * d[1]) * std::cos(f * d[2]);
        return r;
      },
      [all](const Jet& x, const Jet& y, const Jet& z) {
        const Jet r = sqrt(x * x + y * y + z * z), inverse = pow(r, -1);
        Jet value = r - 1.0;
        for (const auto& [h, f] : all) {
          const Jet a = x * inverse * f, b = y * inverse * f, c = z * inverse * f;
          value = value - h * sin(a) * sin(b) * cos(c);
        }
        return value;
      });
}

Vector3 derivative(const LineSurface& s, double u, double v, bool by_u) {
  constexpr double kStep = 1e-5;
  const double a = by_u ? kStep : 0, b = by_u ? 0 : kStep;
  return scaled(subtract(s.map(u + a, v + b), s.map(u - a, v - b)), 0.5 / kStep);
}

double areaElement(const LineSurface& s, double u, double v) {
  v = std::clamp(v, 1e-4, 1 - 1e-4);
  return length(cross(derivative(s, u, v, true), derivative(s, u, v, false)));
}

}  // namespace

bool parseLineSurface(const std::string& name, LineSurface& surface) {
  if (name == "sphere") {
    surface = starShaped(
        [](const Vector3&) { return 1.0; },
        [](const Jet& x, const Jet& y, const Jet& z) { return sqrt(x * x + y * y + z * z) - 1.0; });
  } else if (name == "ellipsoid") {
    surface = starShaped(
        [](const Vector3& d) {
          return 1 / std::sqrt(d[0] * d[0] + d[1] * d[1] / 0.64 + d[2] * d[2] / 0.25);
        },
        [](const Jet& x, const Jet& y, const Jet& z) {
          return x * x + y * y * (1 / 0.64) + z * z * 4.0 - 1.0;
        });
  } else if (name == "box") {
    surface = starShaped(
        [](const Vector3& d) {
          return std::pow(std::pow(d[0], 10) + std::pow(d[1], 10) + std::pow(d[2], 10), -0.1);
        },
        [](const Jet& x, const Jet& y, const Jet& z) {
          return pow(x * x, 5) + pow(y * y, 5) + pow(z * z, 5) - 1.0;
        });
  } else if (name == "bumpy") {
    surface = bumpySphere({{0.1, 5}});
  } else if (name == "mix") {
    surface = bumpySphere({{0.1, 2.5}, {0.004, 20}});
  } else if (name == "torus" || name == "wtorus") {
    surface = torusWithWaves(name == "torus" ? 0.0 : kWaves);
  } else {
    return false;
  }
  return true;
}

double areaOf(const LineSurface& surface) {
  double sum = 0;
  for (std::size_t i = 0; i < kAreaCells; ++i) {
    for (std::size_t j = 0; j < kAreaCells; ++j) {
      sum += areaElement(surface, (static_cast<double>(i) + 0.5) / kAreaCells,
                         (static_cast<double>(j) + 0.5) / kAreaCells);
    }
  }
  return sum / (kAreaCells * kAreaCells);
}

Scene sampleSurface(const LineSurface& surface, std::size_t count, double noise,
                    double normal_noise, std::uint64_t seed) {
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  std::normal_distribution<double> gauss;
  double most = 0;
  for (int i = 0; i < 20000; ++i) most = std::max(most, areaElement(surface, unit(rng), unit(rng)));
  most *= 1.05;
  Scene scene;
  Bounds box;
  while (scene.points.size() < 3 * count) {
    const double u = unit(rng), v = unit(rng);
    if (unit(rng) * most > areaElement(surface, u, v)) continue;
    const ExactCrest at = exactCrest(surface, u, v, false);
    Vector3 n = at.normal;
    box.add(at.position);
    for (std::size_t a = 0; a < 3; ++a) {
      scene.points.push_back(at.position[a]);
      n[a] += normal_noise * gauss(rng);
    }
    n = normalized(n);
    for (const double value : n) scene.normals.push_back(static_cast<float>(value));
  }
  scene.diagonal = box.diagonal();
  for (double& value : scene.points) value += noise * scene.diagonal * gauss(rng);
  return scene;
}

namespace {

constexpr double kStep = 2e-4;  ///< of differences of exact curvatures along the surface
constexpr int kSecants = 4;

Jet jetAt(const LineSurface& s, const Vector3& p) {
  return s.implicit(Jet::variable(p[0], 0), Jet::variable(p[1], 1), Jet::variable(p[2], 2));
}

double form(const Vector3& a, const std::array<double, 6>& h, const Vector3& b) {
  return a[0] * (h[0] * b[0] + h[1] * b[1] + h[2] * b[2]) +
         a[1] * (h[1] * b[0] + h[3] * b[1] + h[4] * b[2]) +
         a[2] * (h[2] * b[0] + h[4] * b[1] + h[5] * b[2]);
}

/** Everything but e. */
ExactCrest crestAt(const LineSurface& s, const Vector3& p, bool ravine) {
  const Jet jet = jetAt(s, p);
  const double g = length(jet.g);
  ExactCrest c;
  c.position = p;
  c.normal = scaled(jet.g, 1 / g);
  const Vector3 axis = std::abs(c.normal[0]) < 0.6 ? Vector3{1, 0, 0} : Vector3{0, 1, 0};
  const Vector3 a = normalized(cross(c.normal, axis)), b = cross(c.normal, a);
  const double uu = form(a, jet.h, a) / g, uv = form(a, jet.h, b) / g, vv = form(b, jet.h, b) / g;
  const double mean = 0.5 * (uu + vv), spread = std::hypot(0.5 * (uu - vv), uv);
  const double angle = 0.5 * std::atan2(uv, 0.5 * (uu - vv));
  const Vector3 t1 = along(scaled(a, std::cos(angle)), std::sin(angle), b);
  c.t = ravine ? cross(c.normal, t1) : t1;
  c.k = ravine ? spread - mean : mean + spread;
  c.other = ravine ? -mean - spread : mean - spread;
  return c;
}

/** Moves a place along a direction and back onto the surface. */
Vector3 moved(const LineSurface& s, const Vector3& p, const Vector3& d, double step) {
  Vector3 q = along(p, step, d);
  for (int i = 0; i < 3; ++i) {
    const Jet jet = jetAt(s, q);
    q = along(q, -jet.value / dot(jet.g, jet.g), jet.g);
  }
  return q;
}

struct Corner {
  double u, v;
  ExactCrest crest;
};

/** e at one corner, in the sense of another's t. */
double alignedE(const ExactCrest& c, const Vector3& t) {
  return dot(c.t, t) < 0 ? -c.e : c.e;
}

/** The zero of e between two corners, by secants on the exact surface. */
Vector3 zeroBetween(const LineSurface& s, const Corner& a, const Corner& b, const Vector3& t,
                    bool ravine) {
  double low = 0, high = 1, at_low = alignedE(a.crest, t), at_high = alignedE(b.crest, t);
  Vector3 place{};
  for (int i = 0; i < kSecants; ++i) {
    const double x = low + (high - low) * at_low / (at_low - at_high);
    const ExactCrest c = exactCrest(s, a.u + x * (b.u - a.u), a.v + x * (b.v - a.v), ravine);
    const double e = alignedE(c, t);
    place = c.position;
    if ((e > 0) == (at_low > 0)) {
      low = x;
      at_low = e;
    } else {
      high = x;
      at_high = e;
    }
    if (at_low == at_high) break;
  }
  return place;
}

/** Adds what a line leaves in one triangle of the grid. */
void addTriangle(const LineSurface& s, const Corner* const (&corner)[3], bool ravine,
                 std::vector<Segment>& segments) {
  const ExactCrest& c = corner[0]->crest;
  double e[3];
  for (int i = 0; i < 3; ++i) {
    const ExactCrest& own = corner[i]->crest;
    if (!(own.k > std::abs(own.other))) return;
    e[i] = alignedE(own, c.t);
  }
  if ((e[0] > 0) == (e[1] > 0) && (e[1] > 0) == (e[2] > 0)) return;
  const Vector3 a = subtract(corner[1]->crest.position, c.position);
  const Vector3 b = subtract(corner[2]->crest.position, c.position);
  // Gradient of e in the triangle's plane: a maximum of k along t where e falls along t.
  const double aa = dot(a, a), ab = dot(a, b), bb = dot(b, b), det = aa * bb - ab * ab;
  if (!(det > 0)) return;
  const double x = (bb * (e[1] - e[0]) - ab * (e[2] - e[0])) / det;
  const double y = (aa * (e[2] - e[0]) - ab * (e[1] - e[0])) / det;
  if (!(x * dot(a, c.t) + y * dot(b, c.t) < 0)) return;
  Segment segment{};
  std::size_t ends = 0;
  for (int i = 0; i < 3 && ends < 2; ++i) {
    const int j = (i + 1) % 3;
    if ((e[i] > 0) == (e[j] > 0)) continue;
    segment[ends++] = zeroBetween(s, *corner[i], *corner[j], c.t, ravine);
  }
  segments.push_back(segment);
}

double distanceToSegment(const Vector3& p, const Segment& s) {
  const Vector3 d = subtract(s[1], s[0]);
  const double d_sq = dot(d, d);
  const double x = d_sq > 0 ? std::clamp(dot(subtract(p, s[0]), d) / d_sq, 0.0, 1.0) : 0.0;
  return length(subtract(p, along(s[0], x, d)));
}

}  // namespace

ExactCrest exactCrest(const LineSurface& surface, double u, double v, bool ravine) {
  ExactCrest c = crestAt(surface, surface.map(u, v), ravine);
  // Five points: the error is of the order of the step's fourth power.
  double k[4];
  const double at[4] = {-2, -1, 1, 2};
  for (int i = 0; i < 4; ++i) {
    k[i] = crestAt(surface, moved(surface, c.position, c.t, at[i] * kStep), ravine).k;
  }
  c.e = (k[0] - 8 * k[1] + 8 * k[2] - k[3]) / (12 * kStep);
  return c;
}

std::vector<Segment> exactLines(const LineSurface& surface, bool ravine, std::size_t cells) {
  std::vector<Segment> segments;
  std::vector<Corner> row[2];
  for (std::size_t j = 0; j <= cells; ++j) {
    row[0].swap(row[1]);
    row[1].clear();
    // The map is singular at the poles: rows begin and end a little away from them.
    const double v = 1e-4 + (1 - 2e-4) * static_cast<double>(j) / static_cast<double>(cells);
    for (std::size_t i = 0; i <= cells; ++i) {
      const double u = static_cast<double>(i) / static_cast<double>(cells);
      row[1].push_back({u, v, exactCrest(surface, u, v, ravine)});
    }
    for (std::size_t i = 0; j > 0 && i < cells; ++i) {
      const Corner &a = row[0][i], &b = row[0][i + 1], &c = row[1][i], &d = row[1][i + 1];
      addTriangle(surface, {&a, &b, &d}, ravine, segments);
      addTriangle(surface, {&a, &d, &c}, ravine, segments);
    }
  }
  return segments;
}

Scene sampleCube(double half_edge, std::size_t count, double noise, std::uint64_t seed) {
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<double> place(-half_edge, half_edge);
  std::normal_distribution<double> gauss;
  Scene scene;
  scene.diagonal = 2.0 * half_edge * std::sqrt(3.0);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t face = rng() % 6;
    const double side = face < 3 ? 1.0 : -1.0;
    for (std::size_t a = 0; a < 3; ++a) {
      const double exact = a == face % 3 ? side * half_edge : place(rng);
      scene.points.push_back(exact + noise * scene.diagonal * gauss(rng));
      scene.normals.push_back(a == face % 3 ? static_cast<float>(side) : 0.0f);
    }
  }
  return scene;
}

std::vector<Segment> cubeEdges(double half_edge, int pieces) {
  std::vector<Segment> edges;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (int corner = 0; corner < 4; ++corner) {
      for (int i = 0; i < pieces; ++i) {
        Segment segment;
        for (int end = 0; end < 2; ++end) {
          Vector3& p = segment[static_cast<std::size_t>(end)];
          p[axis] = half_edge * (2.0 * (i + end) / pieces - 1.0);
          p[(axis + 1) % 3] = corner % 2 ? half_edge : -half_edge;
          p[(axis + 2) % 3] = corner / 2 ? half_edge : -half_edge;
        }
        edges.push_back(segment);
      }
    }
  }
  return edges;
}

struct SegmentIndex::Cells {
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> lists;

  static std::uint64_t key(std::int64_t x, std::int64_t y, std::int64_t z) {
    constexpr std::uint64_t kMask = (std::uint64_t{1} << 21) - 1;
    return (static_cast<std::uint64_t>(x) & kMask) << 42 |
           (static_cast<std::uint64_t>(y) & kMask) << 21 | (static_cast<std::uint64_t>(z) & kMask);
  }
};

SegmentIndex::SegmentIndex(std::vector<Segment> segments, double reach)
    : segments_(std::move(segments)), reach_(reach), cells_(std::make_unique<Cells>()) {
  for (std::uint32_t i = 0; i < segments_.size(); ++i) {
    std::int64_t low[3], high[3];
    for (std::size_t a = 0; a < 3; ++a) {
      const auto [least, most] = std::minmax(segments_[i][0][a], segments_[i][1][a]);
      low[a] = static_cast<std::int64_t>(std::floor((least - reach) / reach));
      high[a] = static_cast<std::int64_t>(std::floor((most + reach) / reach));
    }
    for (std::int64_t x = low[0]; x <= high[0]; ++x) {
      for (std::int64_t y = low[1]; y <= high[1]; ++y) {
        for (std::int64_t z = low[2]; z <= high[2]; ++z) {
          cells_->lists[Cells::key(x, y, z)].push_back(i);
        }
      }
    }
  }
}

SegmentIndex::~SegmentIndex() = default;
SegmentIndex::SegmentIndex(SegmentIndex&&) noexcept = default;

double SegmentIndex::distance(const Vector3& p) const {
  double least = reach_;
  const auto cell = [&](double v) { return static_cast<std::int64_t>(std::floor(v / reach_)); };
  const auto it = cells_->lists.find(Cells::key(cell(p[0]), cell(p[1]), cell(p[2])));
  if (it == cells_->lists.end()) return least;
  for (const std::uint32_t i : it->second) {
    least = std::min(least, distanceToSegment(p, segments_[i]));
  }
  return least;
}

double SegmentIndex::totalLength() const {
  double sum = 0;
  for (const Segment& s : segments_) sum += length(subtract(s[1], s[0]));
  return sum;
}

const std::vector<Segment>& SegmentIndex::segments() const {
  return segments_;
}

namespace {

/** Calls body(place, length that it represents) along segments, in pieces no longer than a size. */
template <typename Body>
void forPieces(const std::vector<Segment>& segments, double size, const Body& body) {
  for (const Segment& s : segments) {
    const Vector3 d = subtract(s[1], s[0]);
    const double l = length(d);
    const int pieces = std::max(1, static_cast<int>(std::ceil(l / size)));
    for (int i = 0; i < pieces; ++i) {
      body(along(s[0], (i + 0.5) / pieces, d), l / pieces);
    }
  }
}

}  // namespace

LineScore scoreLines(const std::vector<std::vector<Segment>>& found,
                     const std::vector<std::vector<Segment>>& truth, double spacing) {
  LineScore score;
  double near_length = 0;
  const double far = 3 * spacing, piece = 0.1 * spacing;
  for (std::size_t type = 0; type < truth.size(); ++type) {
    const SegmentIndex true_index(truth[type], 1.01 * far), found_index(found[type], 1.01 * far);
    forPieces(found[type], piece, [&](const Vector3& p, double l) {
      const double d = true_index.distance(p);
      score.found_length += l;
      if (d > spacing) score.off1 += l;
      if (d > far) {
        score.off3 += l;
      } else {
        near_length += l;
        score.rms += l * d * d;
      }
    });
    forPieces(truth[type], piece, [&](const Vector3& p, double l) {
      const double d = found_index.distance(p);
      score.true_length += l;
      if (d <= spacing) score.found1 += l;
      if (d <= far) score.found3 += l;
    });
  }
  score.rms = near_length > 0 ? std::sqrt(score.rms / near_length) / spacing : 0;
  for (double* share : {&score.found1, &score.found3}) *share /= std::max(score.true_length, 1e-30);
  for (double* share : {&score.off1, &score.off3}) *share /= std::max(score.found_length, 1e-30);
  return score;
}

}  // namespace pcl_slim::measure
