// SPDX-License-Identifier: BSD-3-Clause
// Triangles in a G-buffer, band by band of the picture.
#include "pcl_slim/render/mesh_renderer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "camera/camera_rays.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/core/vector3.h"

namespace pcl_slim {

using namespace detail;
namespace {

constexpr int kBand = 16;            ///< rows of the picture that a thread draws at a time
constexpr double kSmooth = 0.70711;  ///< cosine of the most that a corner's normal may be off
constexpr double kSlack = 1e-9;      ///< of a triangle beyond its sides: neighbours leave no gap

Error badMesh(const char* what) {
  return {ErrorCode::kBadInput, what};
}

Error validateMesh(const TriangleMesh& mesh) {
  const std::size_t count = mesh.vertices.size();
  const auto fits = [count](std::size_t size) { return size == 0 || size == count; };
  if (!fits(mesh.normals.size()) || !fits(mesh.colors.size()) || !fits(mesh.k1.size()) ||
      !fits(mesh.k2.size()))
    return badMesh("the mesh's columns and vertices differ in number; write it again");
  for (const auto& t : mesh.triangles) {
    for (const std::uint32_t v : t) {
      if (v >= count)
        return badMesh("a triangle of the mesh names a vertex that is not there; write it again");
      if (!isFinite(mesh.vertices[v]))
        return badMesh("a vertex of a triangle is not finite; remove that triangle");
    }
  }
  return {};
}

Vector3 boxMiddle(const TriangleMesh& mesh) {
  Bounds box;
  for (const auto& t : mesh.triangles) {
    for (const std::uint32_t v : t) box.add(mesh.vertices[v]);
  }
  return mesh.triangles.empty() ? Vector3{} : scaled(along(box.low, 1.0, box.high), 0.5);
}

/** \brief A triangle about the origin of the buffer. */
struct Facet {
  std::array<Vector3, 3> corner;
  Vector3 area;  ///< normal times twice the area

  Facet(const TriangleMesh& mesh, std::size_t triangle, const Vector3& origin) {
    for (std::size_t k = 0; k < 3; ++k)
      corner[k] = subtract(mesh.vertices[mesh.triangles[triangle][k]], origin);
    area = cross(subtract(corner[1], corner[0]), subtract(corner[2], corner[0]));
  }
  Vector3 middle() const {
    return scaled(along(along(corner[0], 1.0, corner[1]), 1.0, corner[2]), 1.0 / 3.0);
  }
};

/** \brief Where a ray meets a triangle: shares of its second and third corner, and the depth. */
struct Hit {
  double u = 0.0, v = 0.0, depth = -1.0;

  Hit(const Ray& ray, const Facet& facet) {
    const auto& p = facet.corner;
    const Vector3 e1 = subtract(p[1], p[0]), e2 = subtract(p[2], p[0]);
    const Vector3 across = cross(ray.direction, e2);
    const double determinant = dot(e1, across);
    if (determinant == 0.0) return;
    const Vector3 from = subtract(ray.origin, p[0]), turned = cross(from, e1);
    u = dot(from, across) / determinant;
    v = dot(ray.direction, turned) / determinant;
    if (u >= -kSlack && v >= -kSlack && u + v <= 1.0 + kSlack)
      depth = dot(e2, turned) / determinant;
  }
};

/** \brief Draws a mesh's triangles into one buffer. */
class MeshRasterizer {
 public:
  MeshRasterizer(const TriangleMesh& mesh, const Camera& camera, const MeshRenderParams& params,
                 GBuffer& buffer)
      : mesh_(mesh),
        origin_(boxMiddle(mesh)),
        rays_(camera, origin_, 1.0),
        params_(params),
        buffer_(buffer) {}

  MeshRenderStatistics draw();

 private:
  bool isTurnedAway(const Facet& facet) const;
  void drawBand(int band, MeshRenderStatistics& counts);
  void meet(std::size_t triangle, const Facet& facet, const PixelRect& rows,
            MeshRenderStatistics& counts);
  bool mayMeet(const Facet& facet, const PixelRect& block) const;
  void meetBlock(std::size_t triangle, const Facet& facet, const PixelRect& block,
                 MeshRenderStatistics& counts);
  void store(std::size_t pixel, std::size_t triangle, const Facet& facet, const Hit& hit,
             const Ray& ray);
  void storeCurvature(std::size_t pixel, std::size_t triangle, const std::array<double, 3>& shares);

  const TriangleMesh& mesh_;
  Vector3 origin_;
  CameraRays rays_;
  const MeshRenderParams& params_;
  GBuffer& buffer_;
  std::vector<PixelRect> pixels_;                    ///< of each triangle
  std::vector<std::vector<std::uint32_t>> in_band_;  ///< triangles, ascending
};

/** \brief Whether only the back of a triangle is seen: of any of its points. */
bool MeshRasterizer::isTurnedAway(const Facet& facet) const {
  return dot(facet.area, rays_.directionTo(facet.corner[0])) > 0.0;
}

MeshRenderStatistics MeshRasterizer::draw() {
  const int threads = resolveThreads(params_.threads);
  const std::size_t count = mesh_.triangles.size();
  pixels_.assign(count, {});
  std::vector<std::uint8_t> away(count, 0);
  parallelFor(count, threads, 4096, [&](std::size_t i, int) {
    const Facet facet(mesh_, i, origin_);
    const Vector3 middle = facet.middle();
    double radius = 0.0;
    for (const Vector3& corner : facet.corner)
      radius = std::max(radius, length(subtract(corner, middle)));
    away[i] = params_.sides == VisibleSides::kFront && isTurnedAway(facet);
    if (away[i] == 0) pixels_[i] = rays_.pixelsOfBall(middle, radius);
  });
  MeshRenderStatistics all;
  all.triangles = count;
  in_band_.assign(static_cast<std::size_t>((buffer_.height + kBand - 1) / kBand), {});
  for (std::size_t i = 0; i < count; ++i) {
    all.back_facing += away[i];
    if (pixels_[i].empty()) {
      all.outside_frustum += away[i] == 0;
      continue;
    }
    for (int band = pixels_[i].y0 / kBand; band <= pixels_[i].y1 / kBand; ++band)
      in_band_[static_cast<std::size_t>(band)].push_back(static_cast<std::uint32_t>(i));
  }
  std::vector<MeshRenderStatistics> counts(in_band_.size());
  parallelFor(in_band_.size(), threads, 1,
              [&](std::size_t band, int) { drawBand(static_cast<int>(band), counts[band]); });
  for (const MeshRenderStatistics& one : counts) all += one;
  all.covered_pixels = buffer_.numCovered();
  return all;
}

void MeshRasterizer::drawBand(int band, MeshRenderStatistics& counts) {
  for (const std::uint32_t i : in_band_[static_cast<std::size_t>(band)]) {
    PixelRect rows = pixels_[i];
    rows.y0 = std::max(rows.y0, band * kBand);
    rows.y1 = std::min(rows.y1, band * kBand + kBand - 1);
    meet(i, Facet(mesh_, i, origin_), rows, counts);
  }
}

/** \brief Whether the pixels of a block may meet a triangle: on each of its sides some corner of the
 * block is within. The volume that a ray spans with an edge is linear over the picture but for the
 * ray's length. */
bool MeshRasterizer::mayMeet(const Facet& facet, const PixelRect& block) const {
  const std::array<Ray, 4> rays{rays_.ray(block.x0, block.y0), rays_.ray(block.x1, block.y0),
                                rays_.ray(block.x0, block.y1), rays_.ray(block.x1, block.y1)};
  std::array<bool, 2> outside{};  // beyond a side, for a front and for a back
  for (std::size_t k = 0; k < 3; ++k) {
    const Vector3 &a = facet.corner[k], &b = facet.corner[(k + 1) % 3];
    constexpr double kRounding = 1e-14;
    double low = HUGE_VAL, high = -HUGE_VAL, farthest = 0.0;
    for (const Ray& ray : rays) {
      const Vector3 from = subtract(a, ray.origin);
      const double volume = dot(ray.direction, cross(from, subtract(b, ray.origin)));
      low = std::min(low, volume);
      high = std::max(high, volume);
      farthest = std::max(farthest, dot(from, from));
    }
    const double slack = kSlack * length(facet.area) + kRounding * farthest;
    outside[0] = outside[0] || high < -slack;
    outside[1] = outside[1] || low > slack;
  }
  return !outside[0] || !outside[1];
}

void MeshRasterizer::meet(std::size_t triangle, const Facet& facet, const PixelRect& rows,
                          MeshRenderStatistics& counts) {
  constexpr int kBlock = 8;
  for (int y0 = rows.y0; y0 <= rows.y1; y0 += kBlock) {
    for (int x0 = rows.x0; x0 <= rows.x1; x0 += kBlock) {
      const PixelRect block{x0, y0, std::min(x0 + kBlock - 1, rows.x1),
                            std::min(y0 + kBlock - 1, rows.y1)};
      const bool large = block.x1 - x0 + block.y1 - y0 > 4;
      if (large && !mayMeet(facet, block)) continue;
      meetBlock(triangle, facet, block, counts);
    }
  }
}

void MeshRasterizer::meetBlock(std::size_t triangle, const Facet& facet, const PixelRect& block,
                               MeshRenderStatistics& counts) {
  for (int y = block.y0; y <= block.y1; ++y) {
    for (int x = block.x0; x <= block.x1; ++x) {
      const Ray ray = rays_.ray(x, y);
      const Hit hit(ray, facet);
      ++counts.rays_first;
      const std::size_t pixel = buffer_.index(x, y);
      if (!(hit.depth > params_.near_plane) || !(hit.depth < buffer_.depth[pixel])) continue;
      const Vector3 place = along(along(origin_, 1.0, ray.origin), hit.depth, ray.direction);
      const bool shown = std::all_of(
          params_.cuts.begin(), params_.cuts.end(),
          [&](const HalfSpace& side) { return dot(side.normal, place) >= side.offset; });
      if (shown) store(pixel, triangle, facet, hit, ray);
    }
  }
}

void MeshRasterizer::store(std::size_t pixel, std::size_t triangle, const Facet& facet,
                           const Hit& hit, const Ray& ray) {
  const std::array<double, 3> shares{1.0 - hit.u - hit.v, hit.u, hit.v};
  const auto& corners = mesh_.triangles[triangle];
  const Vector3 own = normalized(facet.area);
  Vector3 normal{};
  for (std::size_t k = 0; k < 3; ++k) {
    Vector3 n = own;
    if (!mesh_.normals.empty()) {
      const auto& given = mesh_.normals[corners[k]];
      const Vector3 corner = normalized({given[0], given[1], given[2]});
      if (dot(corner, own) > kSmooth) n = corner;
    }
    normal = along(normal, shares[k], n);
  }
  normal = normalized(normal);
  const bool back = dot(facet.area, ray.direction) > 0.0;
  if (dot(normal, ray.direction) > 0.0) normal = scaled(normal, -1.0);
  const Vector3 place = along(ray.origin, hit.depth, ray.direction);
  buffer_.depth[pixel] = static_cast<float>(hit.depth);
  buffer_.surfel[pixel] = static_cast<std::uint32_t>(triangle);
  buffer_.back_face[pixel] = back && params_.sides == VisibleSides::kBoth;
  for (std::size_t a = 0; a < 3; ++a) {
    buffer_.normal[pixel][a] = static_cast<float>(normal[a]);
    if (!buffer_.position.empty()) buffer_.position[pixel][a] = static_cast<float>(place[a]);
    if (!buffer_.gradient.empty()) buffer_.gradient[pixel][a] = static_cast<float>(normal[a]);
    double color = 0.0;
    for (std::size_t k = 0; k < 3 && !mesh_.colors.empty(); ++k)
      color += shares[k] * mesh_.colors[corners[k]][a] / 255.0;
    if (!mesh_.colors.empty())
      buffer_.color[pixel][a] = static_cast<float>(std::clamp(color, 0.0, 1.0));
  }
  if (!buffer_.principal.empty()) storeCurvature(pixel, triangle, shares);
}

void MeshRasterizer::storeCurvature(std::size_t pixel, std::size_t triangle,
                                    const std::array<double, 3>& shares) {
  double k1 = 0.0, k2 = 0.0;
  for (std::size_t k = 0; k < 3 && !mesh_.k1.empty(); ++k) {
    k1 += shares[k] * mesh_.k1[mesh_.triangles[triangle][k]];
    k2 += shares[k] * mesh_.k2[mesh_.triangles[triangle][k]];
  }
  if (!std::isfinite(k1) || !std::isfinite(k2)) k1 = k2 = 0.0;  // unknown: grey
  buffer_.principal[pixel] = {static_cast<float>(k1), static_cast<float>(k2)};
  buffer_.mean_curvature[pixel] = static_cast<float>(0.5 * (k1 + k2));
  buffer_.gaussian_curvature[pixel] = static_cast<float>(k1 * k2);
}

}  // namespace

Error MeshRenderParams::validate() const {
  if (!(near_plane >= 0.0 && std::isfinite(near_plane)))
    return {ErrorCode::kBadArgument, "the near plane must be a finite distance of 0 or more"};
  return checkThreads(threads);
}

MeshRenderStatistics& MeshRenderStatistics::operator+=(const MeshRenderStatistics& other) {
  triangles += other.triangles;
  outside_frustum += other.outside_frustum;
  back_facing += other.back_facing;
  rays_first += other.rays_first;
  covered_pixels += other.covered_pixels;
  return *this;
}

Error renderMesh(const TriangleMesh& mesh, const Camera& camera, const MeshRenderParams& params,
                 unsigned columns, GBuffer& buffer, MeshRenderStatistics* statistics) {
  buffer = GBuffer();
  if (Error error = camera.validate()) return error;
  if (Error error = params.validate()) return error;
  if (Error error = validateMesh(mesh)) return error;
  buffer.resize(camera.size.width, camera.size.height, columns);
  if (!mesh.colors.empty()) buffer.color.assign(buffer.numPixels(), {1.0f, 1.0f, 1.0f});
  const MeshRenderStatistics counts = MeshRasterizer(mesh, camera, params, buffer).draw();
  if (statistics != nullptr) *statistics = counts;
  return {};
}

}  // namespace pcl_slim
