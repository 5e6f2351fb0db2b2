// SPDX-License-Identifier: BSD-3-Clause
// Large clouds of surfaces with formulas, and how far fits of them are from the truth:
// scale_bench make statue 28000000 0.0005 cloud.ply; scale_bench truth statue a.slim [b.slim];
// scale_bench seams statue tiled.slim whole.slim.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "pcl_slim/cloud/morton.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/query/projection.h"
#include "pcl_slim/stream/record_source.h"
#include "pcl_slim/stream/stream_fit.h"
#include "pcl_slim/surface/slim_blocks.h"
#include "pcl_slim/surface/surface_io.h"
#include "scale/scale_clouds.h"

namespace {

using namespace pcl_slim;

constexpr std::uint64_t kTruthPoints = 1000000;
constexpr std::uint64_t kMany = std::uint64_t{1} << 41;  ///< points that the truth is chosen from

int usage() {
  std::fprintf(stderr,
               "scale_bench make statue|sheet|skew POINTS SIGMA OUT.ply|.f32\n"
               "scale_bench plan CLOUD.f32 TILE_POINTS\n"
               "scale_bench truth statue|sheet|skew SURFACE.slim...\n"
               "scale_bench seams statue|sheet|skew TILED.slim WHOLE.slim\n");
  return 2;
}

bool kindOf(const std::string& name, ScaleSurface::Kind& kind) {
  using Kind = ScaleSurface::Kind;
  kind = name == "sheet" ? Kind::kSheet : name == "skew" ? Kind::kSkew : Kind::kStatue;
  return name == "sheet" || name == "skew" || name == "statue";
}

/** Writes a cloud; sigma is a share of the diagonal. */
int make(const ScaleSurface& surface, std::uint64_t count, double sigma, const std::string& path) {
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (file == nullptr) {
    std::fprintf(stderr, "scale_bench: cannot write '%s'\n", path.c_str());
    return 1;
  }
  if (path.size() > 4 && path.compare(path.size() - 4, 4, ".ply") == 0) {
    std::fprintf(file,
                 "ply\nformat binary_little_endian 1.0\nelement vertex %llu\nproperty float x\n"
                 "property float y\nproperty float z\nend_header\n",
                 static_cast<unsigned long long>(count));
  }
  const double noise = sigma * surface.diagonal();
  constexpr std::uint64_t kPiece = 1 << 20;
  std::vector<float> piece;
  bool good = true;
  for (std::uint64_t first = 0; first < count && good; first += kPiece) {
    const auto n = static_cast<std::size_t>(std::min(kPiece, count - first));
    piece.resize(3 * n);
    parallelFor(n, resolveThreads(0), 4096, [&](std::size_t i, int) {
      const auto p = surface.point(first + i, count);
      for (std::size_t a = 0; a < 3; ++a)
        piece[3 * i + a] = static_cast<float>(p[a] + noise * gaussianAt(first + i, 20 + a));
    });
    good = std::fwrite(piece.data(), sizeof(float), piece.size(), file) == piece.size();
  }
  good = std::fclose(file) == 0 && good;
  if (!good) std::fprintf(stderr, "scale_bench: cannot write all of '%s'\n", path.c_str());
  return good ? 0 : 1;
}

/** Root mean square of what is added. */
struct Rms {
  double squares = 0;
  std::size_t count = 0;

  void add(double value) {
    squares += value * value;
    ++count;
  }
  double value() const {
    return std::sqrt(squares / static_cast<double>(std::max<std::size_t>(1, count)));
  }
};

constexpr double kDegrees = 180 / M_PI;

/** Points of the true surface, others than the scan's. */
std::vector<std::array<double, 3>> truePoints(const ScaleSurface& surface) {
  std::vector<std::array<double, 3>> points(kTruthPoints);
  for (std::uint64_t i = 0; i < kTruthPoints; ++i)
    points[i] = surface.point(i * (kMany / kTruthPoints), kMany);
  return points;
}

/** Points on a surface read from a file. */
struct OnSurface {
  SLIMSurface surface;
  Projection projected;
};

Result<OnSurface> project(const PointStore& store, const std::string& path) {
  OnSurface made;
  Result<SLIMSurface> slim = loadSlim(path);
  if (!slim) return slim.error();
  made.surface = std::move(*slim);
  ProjectionParams params;
  params.curvature = true;
  if (Error error = projectPoints(store, made.surface, params, made.projected)) return error;
  return made;
}

PointStore storeOf(const std::vector<std::array<double, 3>>& points) {
  CloudView view;
  view.xyz = points.data();
  view.xyz_stride = sizeof(points[0]);
  view.scalar = CloudView::Scalar::kDouble;
  view.size = points.size();
  return std::move(*PointStore::build(view));
}

std::array<double, 3> worldOf(const PointStore& store, const std::array<double, 3>& local) {
  std::array<double, 3> p;
  for (std::size_t a = 0; a < 3; ++a) p[a] = store.origin()[a] + store.scale() * local[a];
  return p;
}

template <typename A, typename B>
double angleBetween(const A& a, const B& b) {
  double dot = 0;
  for (std::size_t k = 0; k < 3; ++k) dot += static_cast<double>(a[k]) * static_cast<double>(b[k]);
  return kDegrees * std::acos(std::min(1.0, std::abs(dot)));
}

int fail(const Error& error) {
  std::fprintf(stderr, "scale_bench: %s\n", error.message.c_str());
  return 1;
}

/** Projects points of the true surface and reports how far they go, and normals turn. */
int truth(const ScaleSurface& surface, const std::string& path) {
  const PointStore store = storeOf(truePoints(surface));
  const auto on = project(store, path);
  if (!on) return fail(on.error());
  Rms distance, angle;
  for (std::size_t i = 0; i < store.size(); ++i) {
    if (on->projected.supported[i] == 0) continue;
    const auto p = worldOf(store, on->projected.position[i]);
    distance.add(surface.distance(p) / surface.diagonal());
    angle.add(angleBetween(surface.normal(p), on->projected.normal[i]));
  }
  std::printf("%s leaves %zu rms_over_diagonal %.4g normals_deg %.4g unsupported %zu\n",
              path.c_str(), on->surface.numLeaves(), distance.value(), angle.value(),
              store.size() - distance.count);
  return 0;
}

/** Which tile of a surface in blocks a point is in, and whether another one is near. */
class TileBorders {
 public:
  explicit TileBorders(const SlimDirectory& directory) : info_(directory.info) {
    for (const SlimBlock& block : directory.blocks) {
      if (!block.isCoarse()) blocks_.push_back(block);
    }
  }

  /** \param[in] near share of the diagonal */
  bool isSeam(const std::array<double, 3>& world, double near) const {
    std::array<double, 3> p;
    for (std::size_t a = 0; a < 3; ++a) p[a] = (world[a] - info_.origin[a]) / info_.scale;
    const std::size_t own = tileAt(p);
    for (std::size_t a = 0; a < 3; ++a) {
      for (const double side : {-near, near}) {
        std::array<double, 3> q = p;
        q[a] += side * info_.diagonal;
        const std::size_t other = tileAt(q);
        if (other != own && other != kNone) return true;
      }
    }
    return false;
  }

 private:
  static constexpr std::size_t kNone = ~std::size_t{0};

  std::size_t tileAt(const std::array<double, 3>& p) const {
    const std::uint64_t key = mortonCode(p[0], p[1], p[2]);
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      if (key >= blocks_[b].first_key && key < blocks_[b].end_key) return b;
    }
    return kNone;
  }

  SurfaceInfo info_;
  std::vector<SlimBlock> blocks_;
};

/** How two surfaces of one cloud differ at some of the points, and from the truth. */
struct Differences {
  Rms position, normal, curvature, tiled, whole;
};

/** Compares a surface fitted by tiles with one fitted in memory, at the tiles' borders and inside.
 */
int seams(const ScaleSurface& surface, const std::string& tiled, const std::string& whole) {
  constexpr double kNear = 0.005;
  const auto directory = loadSlimDirectory(tiled);
  if (!directory) return fail(directory.error());
  const TileBorders borders(*directory);
  const PointStore store = storeOf(truePoints(surface));
  const auto a = project(store, tiled), b = project(store, whole);
  if (!a || !b) return fail(a ? b.error() : a.error());
  Differences parts[2];
  const double diagonal = surface.diagonal(), local = store.scale() / diagonal;
  for (std::size_t i = 0; i < store.size(); ++i) {
    const Projection &pa = a->projected, &pb = b->projected;
    const auto place = worldOf(store, store.position(i));
    if (pa.supported[i] == 0 || pb.supported[i] == 0 || surface.isClump(place)) continue;
    Differences& part = parts[borders.isSeam(place, kNear) ? 0 : 1];
    double square = 0;
    for (std::size_t k = 0; k < 3; ++k)
      square += std::pow(local * (pa.position[i][k] - pb.position[i][k]), 2);
    part.position.add(std::sqrt(square));
    part.normal.add(angleBetween(pa.normal[i], pb.normal[i]));
    part.curvature.add(
        (std::abs(double{pa.curvature[i][0]}) - std::abs(double{pb.curvature[i][0]})) / local);
    part.tiled.add(surface.distance(worldOf(store, pa.position[i])) / diagonal);
    part.whole.add(surface.distance(worldOf(store, pb.position[i])) / diagonal);
  }
  const char* names[2] = {"seam", "inside"};
  for (std::size_t k = 0; k < 2; ++k) {
    const Differences& p = parts[k];
    std::printf(
        "%s points %zu difference/L %.3g normals_deg %.3g mean_curvature*L %.3g "
        "tiled_to_truth %.3g in_memory_to_truth %.3g\n",
        names[k], p.position.count, p.position.value(), p.normal.value(), p.curvature.value(),
        p.tiled.value(), p.whole.value());
  }
  std::printf("seam over inside: position %.3f normals %.3f curvature %.3f\n",
              parts[0].position.value() / parts[1].position.value(),
              parts[0].normal.value() / parts[1].normal.value(),
              parts[0].curvature.value() / parts[1].curvature.value());
  return 0;
}

/** Prints the tiles of a cloud of float triplets: points, with those around them, first level. */
int plan(const std::string& path, std::uint64_t tile_points) {
  RecordLayout layout;
  layout.path = path;
  layout.step = 3 * sizeof(float);
  layout.count = std::filesystem::file_size(path) / layout.step;
  for (std::size_t a = 0; a < 3; ++a) layout.position[a].offset = 4 * a;
  RecordSource source(layout);
  StreamParams params;
  params.tile_points = tile_points;
  StreamFit fit(params);
  if (const Error error = fit.prepare(source)) return fail(error);
  const FitStatistics& noise = fit.statistics().fit;
  std::printf("lambda %g correlation %g neighbors %zu thinning %zu cells %zu\n", noise.lambda,
              noise.noise.correlation, static_cast<std::size_t>(noise.noise.neighbors),
              static_cast<std::size_t>(fit.statistics().noise_thinning), fit.plan().cells.size());
  for (std::size_t t = 0; t < fit.plan().tiles.size(); ++t) {
    const TilePlan::Tile& tile = fit.plan().tiles[t];
    std::printf("tile %zu points %zu loaded at most %zu first level %d cells %zu\n", t,
                static_cast<std::size_t>(tile.points),
                static_cast<std::size_t>(fit.loadedPoints(t)), fit.firstLevel(t),
                tile.end_cell - tile.first_cell);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 4 && std::strcmp(argv[1], "plan") == 0)
    return plan(argv[2], std::strtoull(argv[3], nullptr, 10));
  ScaleSurface::Kind kind{};
  if (argc < 4 || !kindOf(argv[2], kind)) return usage();
  const ScaleSurface surface(kind);
  if (std::strcmp(argv[1], "make") == 0 && argc == 6)
    return make(surface, std::strtoull(argv[3], nullptr, 10), std::strtod(argv[4], nullptr),
                argv[5]);
  if (std::strcmp(argv[1], "seams") == 0 && argc == 5) return seams(surface, argv[3], argv[4]);
  if (std::strcmp(argv[1], "truth") != 0) return usage();
  for (int i = 3; i < argc; ++i) {
    if (const int status = truth(surface, argv[i])) return status;
  }
  return 0;
}
