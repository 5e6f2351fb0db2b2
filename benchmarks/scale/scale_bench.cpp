// SPDX-License-Identifier: BSD-3-Clause
// Large clouds of surfaces with formulas, and how far fits of them are from the truth:
// scale_bench make statue 28000000 0.0005 cloud.ply; scale_bench truth statue a.slim [b.slim].
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "pcl_slim/core/parallel.h"
#include "pcl_slim/query/projection.h"
#include "pcl_slim/stream/record_source.h"
#include "pcl_slim/stream/stream_fit.h"
#include "pcl_slim/surface/surface_io.h"
#include "scale/scale_clouds.h"

namespace {

using namespace pcl_slim;

constexpr std::uint64_t kTruthPoints = 1000000;
constexpr std::uint64_t kMany = std::uint64_t{1} << 41;  ///< points that the truth is chosen from

int
usage()
{
  std::fprintf(stderr,
               "scale_bench make statue|sheet|skew POINTS SIGMA OUT.ply|.f32\n"
               "scale_bench plan CLOUD.f32 TILE_POINTS\n"
               "scale_bench truth statue|sheet|skew SURFACE.slim...\n");
  return 2;
}

bool
kindOf(const std::string& name, ScaleSurface::Kind& kind)
{
  using Kind = ScaleSurface::Kind;
  kind = name == "sheet" ? Kind::kSheet : name == "skew" ? Kind::kSkew : Kind::kStatue;
  return name == "sheet" || name == "skew" || name == "statue";
}

/** Writes a cloud; sigma is a share of the diagonal. */
int
make(const ScaleSurface& surface, std::uint64_t count, double sigma, const std::string& path)
{
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

/** Projects points of the true surface and tells how far they go, and normals turn. */
int
truth(const ScaleSurface& surface, const std::string& path)
{
  const auto slim = loadSlim(path);
  if (!slim) {
    std::fprintf(stderr, "scale_bench: %s\n", slim.error().message.c_str());
    return 2;
  }
  std::vector<std::array<double, 3>> points(kTruthPoints);
  // Other points than the scan's.
  for (std::uint64_t i = 0; i < kTruthPoints; ++i)
    points[i] = surface.point(i * (kMany / kTruthPoints), kMany);
  CloudView view;
  view.xyz = points.data();
  view.xyz_stride = sizeof(points[0]);
  view.scalar = CloudView::Scalar::kDouble;
  view.size = points.size();
  const auto store = PointStore::build(view);
  Projection projected;
  if (const Error error = projectPoints(*store, *slim, {}, projected)) {
    std::fprintf(stderr, "scale_bench: %s\n", error.message.c_str());
    return 1;
  }
  double squares = 0, angles = 0;
  std::size_t count = 0, lost = 0;
  for (std::size_t i = 0; i < store->size(); ++i) {
    if (projected.supported[i] == 0) {
      ++lost;
      continue;
    }
    std::array<double, 3> p;
    for (std::size_t a = 0; a < 3; ++a)
      p[a] = store->origin()[a] + store->scale() * projected.position[i][a];
    const auto n = surface.normal(p);
    double dot = 0;
    for (std::size_t a = 0; a < 3; ++a) dot += n[a] * static_cast<double>(projected.normal[i][a]);
    const double d = surface.distance(p) / surface.diagonal();
    squares += d * d;
    const double angle = std::acos(std::min(1.0, std::abs(dot)));
    angles += angle * angle;
    ++count;
  }
  const double n = std::max<double>(1.0, static_cast<double>(count));
  std::printf("%s leaves %zu rms_over_diagonal %.4g normals_deg %.4g unsupported %zu\n",
              path.c_str(), slim->numLeaves(), std::sqrt(squares / n),
              std::sqrt(angles / n) * 180 / 3.14159265358979323846, lost);
  return 0;
}

/** Prints the tiles of a cloud of float triplets: points, with those around them, first level. */
int
plan(const std::string& path, std::uint64_t tile_points)
{
  RecordLayout layout;
  layout.path = path;
  layout.step = 3 * sizeof(float);
  layout.count = std::filesystem::file_size(path) / layout.step;
  for (std::size_t a = 0; a < 3; ++a) layout.position[a].offset = 4 * a;
  RecordSource source(layout);
  StreamParams params;
  params.tile_points = tile_points;
  StreamFit fit(params);
  if (const Error error = fit.prepare(source)) {
    std::fprintf(stderr, "scale_bench: %s\n", error.message.c_str());
    return 1;
  }
  const FitStatistics& noise = fit.statistics().fit;
  std::printf("lambda %g correlation %g neighbors %zu thinning %zu cells %zu\n", noise.lambda,
              noise.noise_correlation, static_cast<std::size_t>(noise.noise_neighbors),
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

int
main(int argc, char** argv)
{
  if (argc == 4 && std::strcmp(argv[1], "plan") == 0)
    return plan(argv[2], std::strtoull(argv[3], nullptr, 10));
  ScaleSurface::Kind kind{};
  if (argc < 4 || !kindOf(argv[2], kind)) return usage();
  const ScaleSurface surface(kind);
  if (std::strcmp(argv[1], "make") == 0 && argc == 6)
    return make(surface, std::strtoull(argv[3], nullptr, 10), std::strtod(argv[4], nullptr),
                argv[5]);
  if (std::strcmp(argv[1], "truth") != 0) return usage();
  for (int i = 3; i < argc; ++i) {
    if (const int status = truth(surface, argv[i])) return status;
  }
  return 0;
}
