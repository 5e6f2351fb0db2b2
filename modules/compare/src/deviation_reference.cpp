// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <deque>
#include <string>
#include <utility>

#include "feet/surface_feet.h"
#include "pcl_slim/compare/deviation.h"
#include "pcl_slim/core/parallel.h"
#include "place_order.h"

namespace pcl_slim {

using namespace detail;

namespace {

/** A wall's other side faces a place's side at least so far away. Sharp edges of a right angle do
 * not. */
constexpr double kWallCosine = -0.5;

/** Places between two reports, so that cancellation is noticed. */
constexpr std::size_t kSlice = 256 * kRun;

/** The direction a place's side faces; zero: unknown. */
Vector3 sideOf(const DeviationPlaces& places, std::size_t i) {
  if (!places.normals || !isFinite(places.normals[i])) return {};
  return {places.normals[i][0], places.normals[i][1], places.normals[i][2]};
}

/** Whether a place's side faces away from the nearest place of all as from the other side of a wall. */
bool facesWall(const Vector3& side, const Vector3& nearest_normal) {
  return dot(normalized(side), nearest_normal) < kWallCosine;
}

}  // namespace

struct DeviationReference::Data {
  bool oriented = false;
  std::unique_ptr<TriangleIndex> triangles;
  std::vector<std::array<std::uint32_t, 3>> corners;  ///< of a mesh with errors
  std::vector<float> vertex_sigma;
  const SLIMSurface* surface = nullptr;
  std::unique_ptr<FootIndex> feet;

  ReferenceFoot footOnMesh(const Vector3& place, const Vector3& side, double max_distance,
                           std::uint32_t hints[2]) const;
  double sigmaAt(const TriangleFoot& foot) const;
  Vector3 toLocal(const Vector3& p) const {
    return scaled(subtract(p, surface->info.origin), 1 / surface->info.scale);
  }
  Vector3 toWorld(const Vector3& p) const {
    return along(surface->info.origin, surface->info.scale, p);
  }
  ReferenceFoot worldFoot(const Vector3& local, const Vector3& side, const SidedFeet& found) const;
};

double DeviationReference::Data::sigmaAt(const TriangleFoot& foot) const {
  if (vertex_sigma.empty()) return 0;
  double sigma = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    sigma += foot.weights[k] * vertex_sigma[corners[foot.triangle][k]];
  }
  return sigma;
}

ReferenceFoot DeviationReference::Data::footOnMesh(const Vector3& place, const Vector3& side,
                                                   double max_distance,
                                                   std::uint32_t hints[2]) const {
  ReferenceFoot made;
  const TriangleFoot nearest = triangles->nearest(place, max_distance, nullptr, hints[0]);
  if (!nearest.found()) return made;
  hints[0] = nearest.triangle;
  TriangleFoot foot = nearest;
  made.state = FootState::kFound;
  if (dot(side, side) > 0 && !(dot(nearest.normal, side) > 0)) {
    foot = triangles->nearest(place, max_distance, &side, hints[1]);
    if (!foot.found()) {
      made.state = FootState::kFacesAway;
      return made;
    }
    hints[1] = foot.triangle;
    if (!nearest.border && facesWall(side, nearest.normal)) {
      const bool same_side = (nearest.distance >= 0) == (foot.distance >= 0);
      if (!same_side) made.state = FootState::kHidden;
    } else if (!nearest.border && foot.part != TrianglePart::kFace) {
      // Beside a sharp edge the nearest place of all knows in from out.
      foot.distance = std::copysign(foot.distance, nearest.distance);
    }
  }
  if (foot.border) made.state = FootState::kBorder;
  made.distance = foot.distance;
  made.position = foot.position;
  made.normal = foot.normal;
  made.sigma = sigmaAt(foot);
  return made;
}

ReferenceFoot DeviationReference::Data::worldFoot(const Vector3& local, const Vector3& side,
                                                  const SidedFeet& found) const {
  ReferenceFoot made;
  if (!found.foot.found) {
    if (!found.faces) made.state = FootState::kFacesAway;
    return made;
  }
  const SurfaceFoot& foot = found.foot;
  made.state = foot.border ? FootState::kBorder : FootState::kFound;
  const bool wall = !found.faces && !found.nearest.border && facesWall(side, found.nearest.normal);
  if (wall && !foot.border) {
    const double before = dot(subtract(local, found.nearest.position), found.nearest.normal);
    if ((before >= 0) != (foot.distance >= 0)) made.state = FootState::kHidden;
  }
  const double scale = surface->info.scale;
  made.distance = foot.distance * scale;
  made.position = toWorld(foot.position);
  made.normal = foot.normal;
  made.sigma = foot.sigma * scale;
  return made;
}

DeviationReference::DeviationReference(std::unique_ptr<Data> data) : data_(std::move(data)) {}
DeviationReference::DeviationReference(DeviationReference&&) noexcept = default;
DeviationReference& DeviationReference::operator=(DeviationReference&&) noexcept = default;
DeviationReference::~DeviationReference() = default;

Result<DeviationReference> DeviationReference::make(const SLIMSurface& surface, int threads) {
  if (Error error = checkThreads(threads)) return error;
  if (surface.numLeaves() == 0) {
    return badInput("the reference surface has no leaves: fit it to points that have a surface");
  }
  auto data = std::make_unique<Data>();
  data->surface = &surface;
  data->oriented = surface.info.hasFront();
  data->feet = std::make_unique<FootIndex>(surface, resolveThreads(threads));
  return DeviationReference(std::move(data));
}

Result<DeviationReference> DeviationReference::make(const TriangleMesh& mesh,
                                                    std::vector<float> vertex_sigma, int threads) {
  if (!vertex_sigma.empty() && vertex_sigma.size() != mesh.vertices.size()) {
    return badInput("the reference mesh has " + std::to_string(mesh.vertices.size()) +
                    " vertices and " + std::to_string(vertex_sigma.size()) +
                    " standard errors: give one a vertex, or none");
  }
  Result<TriangleIndex> index = TriangleIndex::make(mesh, threads);
  if (!index) return index.error();
  auto data = std::make_unique<Data>();
  data->triangles = std::make_unique<TriangleIndex>(std::move(*index));
  data->oriented = data->triangles->statistics().oriented();
  if (!vertex_sigma.empty()) {
    data->corners = mesh.triangles;
    data->vertex_sigma = std::move(vertex_sigma);
  }
  return DeviationReference(std::move(data));
}

bool DeviationReference::oriented() const {
  return data_->oriented;
}

Bounds DeviationReference::bounds() const {
  if (data_->triangles) return data_->triangles->bounds();
  Bounds box;
  box.add(data_->toWorld(data_->feet->patches.bounds.low));
  box.add(data_->toWorld(data_->feet->patches.bounds.high));
  return box;
}

const TriangleIndexStatistics* DeviationReference::meshStatistics() const {
  return data_->triangles ? &data_->triangles->statistics() : nullptr;
}

std::size_t DeviationReference::memoryBytes() const {
  if (data_->triangles) {
    return data_->triangles->memoryBytes() +
           data_->corners.size() * sizeof(std::array<std::uint32_t, 3>) +
           data_->vertex_sigma.size() * sizeof(float);
  }
  const PatchIndex& patches = data_->feet->patches;
  return data_->feet->probe.memoryBytes() + patches.tree.memoryBytes() +
         patches.patches.size() * sizeof(LeafPatch);
}

/** Finds the feet of runs of places, in an order. */
struct DeviationReference::Run {
  const Data& data;
  const DeviationPlaces& places;
  const FootVisitor& visitor;
  const AlignedVector<std::uint32_t>& order;
  bool sided;           ///< sides of places count
  double max_distance;  ///< may be infinite

  Vector3 sideAt(std::uint32_t i) const { return sided ? sideOf(places, i) : Vector3{}; }
  void onMesh(std::size_t begin, std::size_t end) const;
  void onSurface(std::size_t begin, std::size_t end, FootFinder& finder) const;
  void give(std::uint32_t i, ReferenceFoot foot) const;
};

/** Hands a foot out; where the reference has no side, on that of the place's normal. */
void DeviationReference::Run::give(std::uint32_t i, ReferenceFoot foot) const {
  if (!data.oriented && dot(sideOf(places, i), foot.normal) < 0) {
    foot.normal = scaled(foot.normal, -1);
    foot.distance = -foot.distance;
  }
  visitor.take(visitor.body, i, foot);
}

void DeviationReference::Run::onMesh(std::size_t begin, std::size_t end) const {
  std::uint32_t hints[2] = {TriangleFoot::kNone, TriangleFoot::kNone};
  for (std::size_t j = begin; j < end; ++j) {
    const std::uint32_t i = order[j];
    give(i, data.footOnMesh(places.positions[i], sideAt(i), max_distance, hints));
  }
}

void DeviationReference::Run::onSurface(std::size_t begin, std::size_t end,
                                        FootFinder& finder) const {
  finder.restart();
  FeetRequest request;
  std::array<SidedFeet, FeetRequest::kMost> found;
  request.max_distance = max_distance / data.surface->info.scale;
  for (std::size_t j = begin; j < end; j += request.count) {
    request.count = std::min(FeetRequest::kMost, end - j);
    for (std::size_t k = 0; k < request.count; ++k) {
      request.places[k] = data.toLocal(places.positions[order[j + k]]);
      request.sides[k] = sideAt(order[j + k]);
    }
    finder.find(request, found);
    for (std::size_t k = 0; k < request.count; ++k) {
      give(order[j + k], data.worldFoot(request.places[k], request.sides[k], found[k]));
    }
  }
}

Error DeviationReference::visit(const DeviationPlaces& places, const FootParams& params,
                                const FootVisitor& visitor, Progress* progress) const {
  if (Error error = params.validate()) return error;
  const int threads = resolveThreads(params.threads);
  std::size_t finite = 0;
  const auto order = mortonOrder(places.positions, places.count, threads, finite);
  visitor.prepare(visitor.body);
  const Data& d = *data_;
  const Run run{d,
                places,
                visitor,
                order,
                params.sides && places.oriented && d.oriented,
                params.max_distance > 0 ? params.max_distance : Bounds::kInfinity};
  std::deque<FootFinder> finders;
  for (int t = 0; t < threads && d.feet; ++t) finders.emplace_back(*d.feet);
  for (std::size_t slice = 0; slice < finite; slice += kSlice) {
    if (progress) {
      if (progress->cancelled()) return {ErrorCode::kCancelled, "cancelled"};
      progress->report(static_cast<float>(slice) / static_cast<float>(finite), "distances");
    }
    const std::size_t stop = std::min(finite, slice + kSlice);
    parallelFor((stop - slice + kRun - 1) / kRun, threads, 1, [&](std::size_t k, int thread) {
      const std::size_t begin = slice + k * kRun, end = std::min(stop, begin + kRun);
      if (d.feet) return run.onSurface(begin, end, finders[static_cast<std::size_t>(thread)]);
      run.onMesh(begin, end);
    });
  }
  ReferenceFoot none;
  none.state = FootState::kNotFinite;
  for (std::size_t j = finite; j < places.count; ++j) visitor.take(visitor.body, order[j], none);
  return {};
}

Error DeviationReference::find(const DeviationPlaces& places, const FootParams& params,
                               std::vector<ReferenceFoot>& feet, Progress* progress) const {
  feet.assign(places.count, ReferenceFoot());
  const Error error = forEach(
      places, params, [&](std::size_t i, const ReferenceFoot& foot) { feet[i] = foot; }, progress);
  if (error) feet.clear();
  return error;
}

}  // namespace pcl_slim
