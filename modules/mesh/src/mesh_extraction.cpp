// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/mesh/mesh_extraction.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "borders/borders.h"
#include "contour/contour.h"
#include "pcl_slim/core/stopwatch.h"
#include "pcl_slim/mesh/detail/mesh_topology.h"
#include "vertices/surface_vertices.h"

namespace pcl_slim {

using namespace detail;

namespace {

constexpr int kMostRounds = 6;

/** Takes away the crossings on edges of cells that have been divided, and renumbers the others'
 * cells. */
void keepWhole(const std::vector<std::uint32_t>& numbers, std::vector<EdgeCrossing>& crossings) {
  std::size_t kept = 0;
  for (const EdgeCrossing& crossing : crossings) {
    EdgeCrossing own = crossing;
    bool whole = true;
    for (std::uint32_t& cell : own.cell) {
      cell = numbers[cell];
      whole = whole && cell != CellTree::kDivided;
    }
    if (whole) crossings[kept++] = own;
  }
  crossings.resize(kept);
}

/** Contours the surface on a tree: edges, distances at corners, crossings, vertices. Cells with
 * vertices on an edge of more than two faces are divided and their edges contoured again, a few
 * times at most. */
SheetVertices contour(const ProbeField& field, bool oriented, CellTree& tree,
                      MeshStatistics& statistics, const Progress* progress) {
  CornerValues corners(field);
  std::vector<EdgeCrossing> crossings;
  SheetVertices vertices;
  statistics.split_cells = 0;
  for (int round = 0; round < kMostRounds; ++round) {
    statistics.rounds = static_cast<std::uint64_t>(round) + 1;
    const std::vector<CellEdge> edges = cellEdges(tree, round > 0);
    const auto ends = corners.evaluate(tree, edges);
    if (progress != nullptr && progress->cancelled()) return vertices;
    findCrossings(tree, edges, ends, corners.values(), oriented, crossings);
    vertices = findSheetVertices(crossings, oriented, field.threads);
    const std::vector<std::uint32_t> cells = crowdedCells(vertices, field.threads);
    if (cells.empty() || round + 1 == kMostRounds) break;
    statistics.split_cells += cells.size();
    keepWhole(tree.split(cells), crossings);
  }
  statistics.corners = corners.values().size();
  return vertices;
}

constexpr double kNoiseShare = 0.25;      ///< of the noise's deviation: the default tolerance
constexpr double kLeastTolerance = 1e-4;  ///< of the diagonal, by default
/// Spacings of the points: narrower cells follow detail that the points do not resolve. The second
/// is for a tolerance below the default one.
constexpr double kLeastSpacings = 1, kLeastAsked = 0.5;
constexpr double kWidestGap = 6;  ///< spacings: gaps of the contouring that are closed
constexpr double kMargin = 3.0;   ///< cells around sixteen places
constexpr double kMostRelaxation = 100;
/// Of the least points of a component, where the surface has several: area times density is as little
/// of a small one's points.
constexpr double kPieceShare = 0.4;

Error cancelledError() {
  return {ErrorCode::kCancelled, "the extraction was cancelled"};
}

/** Local units. */
double defaultTolerance(const SLIMSurface& surface) {
  const SurfaceInfo& info = surface.info;
  const double noise = std::sqrt(std::max(0.0, info.lambda)) * info.diagonal;
  return std::max(kNoiseShare * noise, kLeastTolerance * info.diagonal);
}

/** One extraction: what its steps share. */
class Extraction {
 public:
  Extraction(const SLIMSurface& surface, const MeshParams& params, MeshStatistics& statistics,
             Progress* progress)
      : surface_(surface),
        params_(params),
        statistics_(statistics),
        progress_(progress),
        threads_(resolveThreads(params.threads)),
        index_(surface, ProbeUse::kExtraction) {}

  /** \param[in] tolerance local units. */
  Error run(double tolerance) {
    statistics_.tolerance = tolerance * surface_.info.scale;
    Stopwatch clock;
    report(0.0f, "dividing cells");
    const bool finer = tolerance < defaultTolerance(surface_);
    const double least = finer ? kLeastAsked : kLeastSpacings;
    const bool trim = params_.trim && surface_.hasTrimMaps();
    const std::vector<LeafShape> shapes = shapesOf(surface_, tolerance, least, trim, threads_);
    CellTree tree;
    if (Error error = tree.build(shapes, threads_)) return error;
    statistics_.seconds_tree = clock.lap();
    const ProbeField field{index_, kMargin * thriftyCellSize(shapes), threads_};
    if (cancelled()) return cancelledError();
    report(0.2f, "contouring");
    const SheetVertices sheets =
        contour(field, surface_.info.oriented, tree, statistics_, progress_);
    statistics_.seconds_contour = clock.lap();
    makeVertices(sheets, field);
    statistics_.cells = tree.numNear();
    if (cancelled()) return cancelledError();
    report(0.8f, "smoothing triangles");
    relax(field, triangles_, params_.relax, vertices_);
    if (cancelled()) return cancelledError();
    statistics_.seconds_vertices = clock.lap();
    report(0.9f, "trimming");
    if (trim) {
      markUncovered(field, surface_.info.cover_threshold, vertices_);
      trimAtBorder(field, tolerance, triangles_, vertices_);
    }
    separate();
    const double share = statistics_.left_out.kept > 1 ? kPieceShare : 1;
    dropCrumbs(field, share * params_.min_component_points, vertices_, triangles_, statistics_);
    cleanTriangles(triangles_, vertices_);
    closeBorders(field);
    statistics_.seconds_trim = clock.lap();
    if (params_.sharp != nullptr) addSharpEdges();
    statistics_.seconds_sharpen = clock.lap();
    if (Error error = simplify(field)) return error;
    cleanTriangles(triangles_, vertices_);
    measureArea();
    countLoops(field, surface_.info.scale, triangles_, vertices_, statistics_);
    statistics_.seconds_simplify = clock.lap();
    return cancelled() ? cancelledError() : Error{};
  }

  std::size_t numTriangles() const { return triangles_.size(); }

  /** The mesh in world units, without vertices that no triangle names. */
  void write(TriangleMesh& mesh) const;

 private:
  void report(float share, const char* stage) {
    if (progress_ != nullptr) progress_->report(share, stage);
  }
  bool cancelled() const { return progress_ != nullptr && progress_->cancelled(); }

  void makeVertices(const SheetVertices& sheets, const ProbeField& field);
  void turnToTriangles();
  void separate();
  void closeBorders(const ProbeField& field);
  void measureArea();
  void addSharpEdges();
  Error simplify(const ProbeField& field);

  const SLIMSurface& surface_;
  const MeshParams& params_;
  MeshStatistics& statistics_;
  Progress* progress_;
  int threads_;
  ProbeIndex index_;
  SurfaceVertices vertices_;
  std::vector<Triangle> triangles_;
};

/** Puts the cells' vertices onto the surface and connects them. */
void Extraction::makeVertices(const SheetVertices& sheets, const ProbeField& field) {
  vertices_ = SurfaceVertices();
  vertices_.resize(sheets.position.size());
  vertices_.position = sheets.position;
  vertices_.normal = sheets.normal;
  vertices_.size = sheets.size;
  std::vector<std::uint32_t> all(vertices_.count());
  std::iota(all.begin(), all.end(), 0u);
  putOnSurface(field, all, vertices_);
  statistics_.unprojected = static_cast<std::uint64_t>(
      std::count(vertices_.supported.begin(), vertices_.supported.end(), 0));
  triangles_ = cutIntoTriangles(sheets.of_crossing, vertices_.position, vertices_.normal);
  separate();
  if (!surface_.info.oriented) agreeOnSides(triangles_, threads_);
  dropTurned(triangles_, threads_);
  separate();
  LoopChoice gaps;
  gaps.width = kWidestGap;
  gaps.inside = gaps.project = true;
  statistics_.closed_gaps = closeLoops(field, gaps, triangles_, vertices_).count;
  separate();
  if (!surface_.info.oriented) turnToTriangles();
}

/** Turns normals to the side that the triangles about them face. */
void Extraction::turnToTriangles() {
  std::vector<Vector3> sum(vertices_.count(), Vector3{});
  for (const Triangle& t : triangles_) {
    const Vector3& p = vertices_.position[t[0]];
    const Vector3 area =
        cross(subtract(vertices_.position[t[1]], p), subtract(vertices_.position[t[2]], p));
    for (const std::uint32_t v : t) sum[v] = along(sum[v], 1, area);
  }
  for (std::size_t v = 0; v < sum.size(); ++v) {
    if (!(dot(sum[v], vertices_.normal[v]) < 0)) continue;
    vertices_.normal[v] = scaled(vertices_.normal[v], -1);
    std::swap(vertices_.k1[v], vertices_.k2[v]);
    vertices_.k1[v] = -vertices_.k1[v];
    vertices_.k2[v] = -vertices_.k2[v];
  }
}

/** No edge of more than two triangles, no vertex of more than one fan. */
void Extraction::separate() {
  const std::size_t count = vertices_.count();
  const std::vector<std::uint32_t> copies = separateFans(count, triangles_, threads_);
  vertices_.resize(count + copies.size());
  for (std::size_t i = 0; i < copies.size(); ++i) {
    const std::size_t to = count + i, from = copies[i];
    vertices_.position[to] = vertices_.position[from];
    vertices_.normal[to] = vertices_.normal[from];
    vertices_.k1[to] = vertices_.k1[from];
    vertices_.k2[to] = vertices_.k2[from];
    vertices_.outside[to] = vertices_.outside[from];
    vertices_.size[to] = vertices_.size[from];
    vertices_.on_border[to] = vertices_.on_border[from];
    vertices_.supported[to] = vertices_.supported[from];
  }
}

/** Closes the loops that are left: small holes by vertices on the surface, then all where the mesh
 * is to be watertight. */
void Extraction::closeBorders(const ProbeField& field) {
  LoopChoice choice;
  choice.width = params_.hole_size - kGrowth;
  choice.project = true;
  ClosedLoops closed = closeLoops(field, choice, triangles_, vertices_);
  if (params_.watertight) {
    choice.all = true;
    choice.project = false;
    const ClosedLoops more = closeLoops(field, choice, triangles_, vertices_);
    closed.count += more.count;
    closed.area += more.area;
  }
  statistics_.closed_holes = closed.count;
  statistics_.closed_area = closed.area * surface_.info.scale * surface_.info.scale;
}

void Extraction::measureArea() {
  double area = 0;
  for (const Triangle& t : triangles_) area += areaOf(t, vertices_);
  statistics_.area = area * surface_.info.scale * surface_.info.scale;
}

/** Brings positions and curvatures from one surface's local units to another's. */
void changeUnits(const SurfaceInfo& from, const SurfaceInfo& to, SurfaceVertices& vertices) {
  const double scale = from.scale / to.scale;
  const Vector3 shift = scaled(subtract(from.origin, to.origin), 1 / to.scale);
  for (Vector3& p : vertices.position) p = along(shift, scale, p);
  for (float& k : vertices.k1) k = static_cast<float>(k / scale);
  for (float& k : vertices.k2) k = static_cast<float>(k / scale);
}

void Extraction::addSharpEdges() {
  report(0.92f, "adding sharp edges");
  changeUnits(surface_.info, params_.sharp->info, vertices_);
  sharpen(*params_.sharp, threads_, triangles_, vertices_, statistics_);
  changeUnits(params_.sharp->info, surface_.info, vertices_);
}

/** Collapses edges until there are no more triangles than requested, and puts the vertices back
 * onto the surface. */
Error Extraction::simplify(const ProbeField& field) {
  const std::size_t before = triangles_.size();
  if (params_.max_triangles == 0 || before <= params_.max_triangles) return {};
  report(0.95f, "simplifying");
  collapseEdges(params_.max_triangles, triangles_, vertices_);
  if (triangles_.size() > params_.max_triangles) {
    return {ErrorCode::kBadArgument,
            "the mesh cannot have fewer than " + std::to_string(triangles_.size()) +
                " triangles without losing holes or pieces; allow as many"};
  }
  statistics_.collapsed = before - triangles_.size();
  if (params_.sharp != nullptr) return {};  // the surface is round where the mesh is not
  std::vector<std::uint32_t> used;
  for (const Triangle& t : triangles_) used.insert(used.end(), t.begin(), t.end());
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  putOnSurface(field, used, vertices_);
  return {};
}

void Extraction::write(TriangleMesh& mesh) const {
  const SurfaceInfo& info = surface_.info;
  constexpr std::uint32_t kUnused = 0xffffffffu;
  std::vector<std::uint32_t> number(vertices_.count(), kUnused);
  for (const Triangle& t : triangles_) {
    for (const std::uint32_t v : t) number[v] = 0;
  }
  std::uint32_t next = 0;
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (number[v] == kUnused) continue;
    number[v] = next++;
    const Vector3& n = vertices_.normal[v];
    mesh.vertices.push_back(along(info.origin, info.scale, vertices_.position[v]));
    mesh.normals.push_back(
        {static_cast<float>(n[0]), static_cast<float>(n[1]), static_cast<float>(n[2])});
    mesh.k1.push_back(static_cast<float>(vertices_.k1[v] / info.scale));
    mesh.k2.push_back(static_cast<float>(vertices_.k2[v] / info.scale));
  }
  mesh.triangles.reserve(triangles_.size());
  for (const Triangle& t : triangles_) {
    mesh.triangles.push_back({number[t[0]], number[t[1]], number[t[2]]});
  }
}

}  // namespace

Error MeshParams::validate() const {
  if (!(tolerance >= 0) || !std::isfinite(tolerance)) {
    return {ErrorCode::kBadArgument, "the tolerance is not a length; give 0 or more"};
  }
  if (!(hole_size >= 0)) {
    return {ErrorCode::kBadArgument, "the hole size must be 0 spacings or more"};
  }
  if (!(min_component_points >= 0)) {
    return {ErrorCode::kBadArgument, "the least points of a component must be 0 or more"};
  }
  if (relax < 0 || relax > kMostRelaxation) {
    return {ErrorCode::kBadArgument, "the rounds of relaxation must be 0 to 100"};
  }
  return checkThreads(threads);
}

Error extractMesh(const SLIMSurface& surface, const MeshParams& params, TriangleMesh& mesh,
                  MeshStatistics* statistics, Progress* progress) {
  mesh.clear();
  MeshStatistics own;
  MeshStatistics& counts = statistics != nullptr ? *statistics : own;
  counts = MeshStatistics();
  if (Error error = params.validate()) return error;
  if (Error error = surface.validate()) return error;
  if (params.sharp != nullptr) {
    if (Error error = params.sharp->validate()) return error;
    if (!params.sharp->info.oriented) {
      return badInput("the surface with sharp edges has no sides; fit it to points with normals");
    }
  }
  if (surface.numLeaves() == 0) return badInput("the surface has no leaves; fit it to more points");
  std::optional<SLIMSurface> kept;
  if (params.min_component_points > 0) {
    kept = surface;
    counts.left_out = dropComponents(params.min_component_points, *kept, params.threads);
  }
  Extraction extraction(kept ? *kept : surface, params, counts, progress);
  const double asked = params.tolerance / surface.info.scale;
  if (Error error = extraction.run(asked > 0 ? asked : defaultTolerance(surface))) return error;
  if (extraction.numTriangles() == 0) {
    return {ErrorCode::kNoSurface, "no triangle fits the surface; lower the tolerance"};
  }
  extraction.write(mesh);
  counts.census = censusOf(mesh);
  return {};
}

}  // namespace pcl_slim
