// SPDX-License-Identifier: BSD-3-Clause
// Sides of points by the normals and signs of their cells (docs/sides.md, "Sides before the
// cover").
#include "pcl_slim/cloud/detail/sides.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <utility>
#include <vector>

#include "pcl_slim/core/order_statistics.h"
#include "pcl_slim/core/parallel.h"
#include "sides/side_cells.h"

namespace pcl_slim::detail {

namespace {

/** Turns every connected component of the cells outward. */
void turnCellsOutward(const SideCells& cut, const CellGraph& graph, SignedParts& found) {
  std::vector<SidePatch> patches(cut.cells.size());
  for (std::size_t c = 0; c < patches.size(); ++c)
    patches[c] = {cut.cells[c].mean, graph.sheets[c].normal, cut.cells[c].count};
  turnOutward(patches, graph.edges, found);
}

/** Cosine between a direction and a point's beam towards its sensor. */
double beamCosine(const PointStore& store, std::size_t point, const Vector3& direction) {
  const Vector3 ray = subtract(store.sensor(point), store.position(point));
  const double range = length(ray);
  return range > 0 ? dot(ray, direction) / range : 0.0;
}

/// Least cosine of a normal and the point's beam from which the normal is not tilted.
constexpr double kObliqueBeam = 0.7;

/** Tilts an oblique normal to the mean of itself and the beam. Cells between two near sheets have
 * normals along the sheets, but the visible side of a surface faces its sensor. */
Vector3 withBeam(const PointStore& store, std::size_t point, const Vector3& normal) {
  const Vector3 beam = normalized(subtract(store.sensor(point), store.position(point)));
  return dot(beam, normal) < kObliqueBeam ? normalized(along(normal, 1, beam)) : normal;
}

/** Signs of the cells' normals: each faces the sensors of its points on average. */
std::vector<signed char> signsBySensors(const PointStore& store, const SideCells& cut,
                                        const CellGraph& graph) {
  std::vector<double> votes(cut.cells.size(), 0.0);
  for (std::size_t i = 0; i < store.size(); ++i) {
    const std::uint32_t c = cut.cell_of[i];
    votes[c] += beamCosine(store, i, graph.sheets[c].normal);
  }
  std::vector<signed char> signs(votes.size());
  std::transform(votes.begin(), votes.end(), signs.begin(),
                 [](double vote) { return static_cast<signed char>(vote < 0 ? -1 : 1); });
  return signs;
}

/// Least length of the mean of unit normals that agree.
constexpr double kAgreeingMean = 0.5;

/** Signed normals of the cells. Each is the mean over the near cells on its sheet if these agree,
 * because the normals of cells of few points are arbitrary. */
std::vector<Vector3> smoothedNormals(const SideCells& cut, const CellGraph& graph,
                                     const std::vector<signed char>& signs, int threads) {
  std::vector<Vector3> normals(cut.cells.size());
  const std::size_t each = graph.neighbors.size() / std::max<std::size_t>(1, normals.size());
  parallelFor(normals.size(), threads, 1024, [&](std::size_t c, int) {
    Vector3 sum{};
    double count = 0;
    for (std::size_t k = c * each; k < (c + 1) * each; ++k) {
      const std::uint32_t near = graph.neighbors[k];
      if (near == SideCells::kNone) continue;
      sum = along(sum, signs[near] * cut.cells[near].count, graph.sheets[near].normal);
      count += cut.cells[near].count;
    }
    const bool agree = length(sum) > kAgreeingMean * count;
    normals[c] = agree ? normalized(sum) : scaled(graph.sheets[c].normal, signs[c]);
  });
  return normals;
}

/** Confidence of signs: share of the agreement of near cells that they satisfy; 1: all. */
double agreementOf(const CellGraph& graph, const std::vector<signed char>& signs) {
  double agreed = 0, all = 0;
  for (const SignedEdge& e : graph.edges) {
    agreed += signs[e.a] * signs[e.b] * e.agreement;
    all += std::abs(e.agreement);
  }
  return all > 0 ? agreed / all : 0;
}

/** Whether an edge connects two sheets whose signed normals are opposite. */
bool facesApart(const SignedEdge& e, const CellGraph& graph,
                const std::vector<signed char>& signs) {
  const double cosine = dot(graph.sheets[e.a].normal, graph.sheets[e.b].normal);
  return e.apart && signs[e.a] * signs[e.b] * cosine < 0;
}

/** Marks the cells with an edge to another sheet that faces the other way. */
std::vector<char> cellsFacingApart(const SideCells& cut, const CellGraph& graph,
                                   const std::vector<signed char>& signs) {
  std::vector<char> faces(cut.cells.size(), 0);
  for (const SignedEdge& e : graph.edges) {
    if (facesApart(e, graph, signs)) faces[e.a] = faces[e.b] = 1;
  }
  return faces;
}

/** Median distance of sheets that face apart. */
double medianGap(const SideCells& cut, const CellGraph& graph,
                 const std::vector<signed char>& signs) {
  std::vector<double> gaps;
  for (const SignedEdge& e : graph.edges) {
    if (!facesApart(e, graph, signs)) continue;
    const Vector3 between = subtract(cut.cells[e.a].mean, cut.cells[e.b].mean);
    gaps.push_back(std::abs(dot(between, graph.sheets[e.a].normal)));
  }
  return gaps.empty() ? HUGE_VAL : median(gaps);
}

/// Number of steps from a cell near another sheet to the cells that get sides with it.
constexpr int kRings = 2;

/** The edges between cells within kRings steps of another sheet. */
std::vector<SignedEdge> edgesNearOtherSheets(const CellGraph& graph) {
  std::vector<char> near(graph.sheets.size(), 0);
  for (const SignedEdge& e : graph.edges) {
    if (e.apart) near[e.a] = near[e.b] = 1;
  }
  for (int ring = 0; ring < kRings; ++ring) {
    const std::vector<char> before = near;
    for (const SignedEdge& e : graph.edges) {
      if (!e.apart && (before[e.a] || before[e.b])) near[e.a] = near[e.b] = 1;
    }
  }
  std::vector<SignedEdge> edges;
  std::copy_if(graph.edges.begin(), graph.edges.end(), std::back_inserter(edges),
               [&](const SignedEdge& e) { return near[e.a] && near[e.b]; });
  return edges;
}

/// Least share of the agreement across sheets that a component with certain sides satisfies.
constexpr double kSureShare = 0.85;
/// Least agreement across sheets of such a component: that of as many exactly opposite normals.
constexpr double kLeastAgreement = 10;

/** Marks the cells of components with certain sides, whose sheets nearly all face apart. Scattered
 * points and badly registered layers of scans have sheets, too, but these agree only by chance.
 * \param[out] share of the agreement across sheets in such components */
std::vector<char> cellsOfSureParts(const SignedParts& found, const std::vector<SignedEdge>& edges,
                                   double& share) {
  struct Apart {
    double met = 0, all = 0;
  };
  std::vector<Apart> parts(found.part.size());
  for (const SignedEdge& e : edges) {
    if (!e.apart || found.part[e.a] != found.part[e.b]) continue;
    Apart& part = parts[found.part[e.a]];
    part.met += found.signs[e.a] * found.signs[e.b] * e.agreement;
    part.all += std::abs(e.agreement);
  }
  std::vector<char> sure(parts.size());
  const auto isSure = [&](const Apart& part) {
    return part.all >= kLeastAgreement && part.met >= kSureShare * part.all;
  };
  double kept = 0, all = 0;
  for (const Apart& part : parts) {
    kept += isSure(part) ? part.all : 0;
    all += part.all;
  }
  share = all > 0 ? kept / all : 0;
  for (std::size_t c = 0; c < sure.size(); ++c) sure[c] = isSure(parts[found.part[c]]);
  return sure;
}

/** Unit normals of the points, from those of their cells.
 * \param[in] sided one byte for each cell; 0: its points get no side
 * \param[in] by_sensors whether a point's own beam overrules the sign of its cell
 * \param[out] thin share of the points in front of others that face apart */
std::vector<std::array<float, 3>> normalsOfPoints(const PointStore& store, const SideCells& cut,
                                                  const CellGraph& graph,
                                                  const std::vector<signed char>& signs,
                                                  const std::vector<char>& sided, bool by_sensors,
                                                  const SideConstants& constants, int threads,
                                                  double& thin) {
  constexpr std::size_t kTask = 4096;
  const std::vector<Vector3> normals = smoothedNormals(cut, graph, signs, threads);
  const std::vector<char> apart = cellsFacingApart(cut, graph, signs);
  std::vector<std::array<float, 3>> points(store.size());
  std::vector<std::size_t> facing((store.size() + kTask - 1) / kTask, 0);
  parallelFor(facing.size(), threads, 1, [&](std::size_t task, int) {
    for (std::size_t i = task * kTask; i < std::min(store.size(), (task + 1) * kTask); ++i) {
      const std::uint32_t c = cut.cell_of[i];
      if (!sided[c]) {
        points[i] = {0, 0, 0};
        continue;
      }
      const CellSheet& sheet = graph.sheets[c];
      const Vector3 offset = subtract(store.position(i), cut.cells[c].mean);
      const Vector3 normal = sheet.isRod() ? scaled(sheet.rodNormal(offset), signs[c]) : normals[c];
      bool turned = !sheet.isRod() && sheet.isBeyond(offset);
      bool own = false;  // the point's beam overrules the cell
      if (by_sensors) {
        const double cosine = beamCosine(store, i, normal);
        own = std::abs(cosine) > constants.clear_beam && (cosine < 0) != turned;
        turned ^= own;
      }
      facing[task] += own || apart[c] != 0;
      Vector3 side = scaled(normal, turned ? -1 : 1);
      if (by_sensors) side = withBeam(store, i, side);
      for (std::size_t a = 0; a < 3; ++a) points[i][a] = static_cast<float>(side[a]);
    }
  });
  thin = 0;
  for (const std::size_t count : facing)
    thin += static_cast<double>(count) / static_cast<double>(store.size());
  return points;
}

/** Marks the points of cells that are on rods. */
std::vector<char> pointsOnRods(const SideCells& cut, const CellGraph& graph) {
  std::vector<char> marks(cut.cell_of.size());
  std::transform(cut.cell_of.begin(), cut.cell_of.end(), marks.begin(),
                 [&](std::uint32_t c) { return graph.sheets[c].isRod(); });
  return marks;
}

/** Signs of all cells: by the sensors of their points or, without sensors, by contraction, with
 * every connected component turned outward. \param[out] confidence agreementOf() the signs */
std::vector<signed char> signsOfAll(const PointStore& store, const SideCells& cut,
                                    const CellGraph& graph, double& confidence) {
  SignedParts found;
  if (store.hasSensors()) {
    found.signs = signsBySensors(store, cut, graph);
  } else {
    found = contractSigned(cut.cells.size(), graph.edges);
    turnCellsOutward(cut, graph, found);
  }
  confidence = agreementOf(graph, found.signs);
  return std::move(found.signs);
}

/** Finds sides of the points near another sheet, and sides of all points. */
void findFacingSides(const PointStore& store, const SideCells& cut, CellGraph& graph,
                     const SideConstants& constants, int threads, Sides& sides) {
  std::vector<SignedEdge> near = edgesNearOtherSheets(graph);
  const SignedParts found = contractSigned(cut.cells.size(), near);
  const std::vector<char> sided = cellsOfSureParts(found, near, sides.sure);
  const std::vector<char> all(sided.size(), 1);
  const std::vector<signed char> outward = signsOfAll(store, cut, graph, sides.outward_confidence);
  double thin = 0;
  sides.outward = normalsOfPoints(store, cut, graph, outward, all, store.hasSensors(), constants,
                                  threads, thin);
  graph.edges = std::move(near);
  sides.confidence = agreementOf(graph, found.signs);
  sides.normals =
      normalsOfPoints(store, cut, graph, found.signs, sided, false, constants, threads, sides.thin);
}

constexpr double kCellSpacing = 1.2;  ///< least width of a cell [spacings]

}  // namespace

Sides findSides(const PointStore& store, double noise, double spacing, SideScope scope,
                const SideConstants& constants, int threads) {
  threads = resolveThreads(threads);
  const double width = std::max(constants.cell_noise * noise, kCellSpacing * spacing);
  const SideCells cut(store, width, threads);
  CellGraph graph = graphOf(cut, constants, threads);
  Sides sides;
  sides.cells = cut.cells.size();
  sides.on_rods = pointsOnRods(cut, graph);
  if (scope == SideScope::kFacing) {
    findFacingSides(store, cut, graph, constants, threads, sides);
    return sides;
  }
  const std::vector<signed char> signs = signsOfAll(store, cut, graph, sides.confidence);
  if (store.hasSensors()) sides.confidence = 1;
  sides.gap = medianGap(cut, graph, signs);
  sides.normals = normalsOfPoints(store, cut, graph, signs, std::vector<char>(signs.size(), 1),
                                  store.hasSensors(), constants, threads, sides.thin);
  return sides;
}

}  // namespace pcl_slim::detail
