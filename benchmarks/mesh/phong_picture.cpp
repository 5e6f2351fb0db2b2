// SPDX-License-Identifier: BSD-3-Clause
// Draws a mesh with interpolated normals (Phong 1975) through a SLIM surface's camera, with the
// shading and the lines of SLIM surfaces, for comparison: the meshes of the paper's Figures 2 and
// 11.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "camera/camera_rays.h"
#include "common/options.h"
#include "mesh/bench_mesh.h"
#include "pcl_slim/core/symmetric.h"
#include "pcl_slim/filters/io/surface_files.h"
#include "pcl_slim/render/picture_lines.h"
#include "pcl_slim/render/shading.h"
#include "render/camera_file.h"
#include "render/view_request.h"

namespace {

using namespace pcl_slim;
using namespace pcl_slim::mesh_bench;
using detail::CameraRays;
using detail::PixelRect;

struct Settings {
  std::string mesh, surface, output, mode = "shaded";
  ViewRequest view;
  bool contour = false, suggestive = false;
  double line_width = LineStyle().width;
};

/** Means of the normals of the faces about each vertex, weighed by area. */
Points vertexNormals(const Mesh& mesh) {
  Points normals(mesh.vertices.size());
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const Vector3 area = areaVector(mesh.vertices, mesh.faces[f]);
    for (const std::uint32_t v : mesh.faces[f]) normals[v] = along(normals[v], 1.0, area);
  }
  for (Vector3& normal : normals) {
    if (length(normal) > 0) normal = normalized(normal);
  }
  return normals;
}

/** Derivatives of a mesh's interpolated normals: a symmetric tensor a vertex, the mean of those of
 * the faces about it (Rusinkiewicz 2004). */
std::vector<Symmetric3<double>> vertexBends(const Mesh& mesh, const Points& normals) {
  std::vector<Symmetric3<double>> bends(mesh.vertices.size());
  std::vector<int> faces(mesh.vertices.size(), 0);
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const IndexRow corners = mesh.faces[f];
    const Vector3 &a = mesh.vertices[corners[0]], &na = normals[corners[0]];
    const Vector3 e = subtract(mesh.vertices[corners[1]], a);
    const Vector3 g = subtract(mesh.vertices[corners[2]], a);
    if (!(length(cross(e, g)) > 0)) continue;
    const Vector3 u = normalized(e), v = normalized(cross(cross(e, g), e));
    const Vector3 ne = subtract(normals[corners[1]], na), ng = subtract(normals[corners[2]], na);
    // The normal changes by (d/du, d/dv) along e = (e_u, 0) and g = (g_u, g_v).
    const double eu = length(e), gu = dot(g, u), gv = dot(g, v);
    const Vector3 du = scaled(ne, 1 / eu), dv = scaled(along(ng, -gu, du), 1 / gv);
    const double uu = dot(du, u), vv = dot(dv, v), uv = 0.5 * (dot(du, v) + dot(dv, u));
    constexpr std::array<std::array<std::size_t, 2>, 6> kPlaces = {
        {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}}};
    constexpr std::array<std::size_t, 6> kEntries = {kXX, kYY, kZZ, kXY, kXZ, kYZ};
    for (const std::uint32_t c : corners) {
      ++faces[c];
      for (std::size_t k = 0; k < 6; ++k) {
        const auto [i, j] = kPlaces[k];
        bends[c][kEntries[k]] +=
            uu * u[i] * u[j] + vv * v[i] * v[j] + uv * (u[i] * v[j] + v[i] * u[j]);
      }
    }
  }
  for (std::size_t v = 0; v < bends.size(); ++v) {
    for (double& x : bends[v]) x /= std::max(1, faces[v]);
  }
  return bends;
}

/** A triangle's corners in local units, their normals and the derivatives of these. */
struct Triangle {
  std::array<Vector3, 3> corner, normal;
  std::array<Symmetric3<double>, 3> bend;
};

class MeshRasterizer {
 public:
  MeshRasterizer(const SLIMSurface& surface, const Camera& camera, unsigned columns)
      : rays_(camera, surface.info.origin, surface.info.scale), leaf_(middleLeaf(surface)) {
    radius_ = surface.radius[leaf_];
    buffer_.resize(camera.size.width, camera.size.height, columns);
  }

  void draw(const Triangle& triangle) {
    const auto& p = triangle.corner;
    const Vector3 middle = scaled(along(along(p[0], 1, p[1]), 1, p[2]), 1.0 / 3);
    double radius = 0;
    for (const Vector3& corner : p) radius = std::max(radius, length(subtract(corner, middle)));
    const PixelRect bounds = rays_.pixelsOfBall(middle, radius);
    for (int y = bounds.y0; y <= bounds.y1; ++y) {
      for (int x = bounds.x0; x <= bounds.x1; ++x) meet(triangle, x, y);
    }
  }

  const GBuffer& buffer() const { return buffer_; }

 private:
  /** Where a pixel's ray meets a triangle (Moeller and Trumbore 1997). */
  void meet(const Triangle& triangle, int x, int y) {
    const detail::Ray ray = rays_.ray(x, y);
    const auto& p = triangle.corner;
    const Vector3 e1 = subtract(p[1], p[0]), e2 = subtract(p[2], p[0]);
    const Vector3 across = cross(ray.direction, e2);
    const double determinant = dot(e1, across);
    if (determinant == 0) return;
    const Vector3 from = subtract(ray.origin, p[0]), turned = cross(from, e1);
    const double u = dot(from, across) / determinant;
    const double v = dot(ray.direction, turned) / determinant;
    const double t = dot(e2, turned) / determinant;
    const std::size_t pixel = buffer_.index(x, y);
    if (u < 0 || v < 0 || u + v > 1 || t <= 0 || t >= buffer_.depth[pixel]) return;
    const auto& n = triangle.normal;
    Vector3 normal = along(along(scaled(n[0], 1 - u - v), u, n[1]), v, n[2]);
    if (!(length(normal) > 0)) normal = cross(e1, e2);
    if (dot(normal, ray.direction) > 0) normal = scaled(normal, -1);
    store(pixel, t, along(ray.origin, t, ray.direction), normalized(normal));
    for (std::size_t k = 0; k < 6 && !buffer_.hessian.empty(); ++k) {
      const auto& b = triangle.bend;
      buffer_.hessian[pixel][k] =
          static_cast<float>((1 - u - v) * b[0][k] + u * b[1][k] + v * b[2][k]);
    }
  }

  void store(std::size_t pixel, double t, const Vector3& point, const Vector3& normal) {
    buffer_.depth[pixel] = static_cast<float>(t);
    buffer_.surfel[pixel] = leaf_;
    if (!buffer_.radius.empty()) buffer_.radius[pixel] = radius_;
    for (std::size_t a = 0; a < 3; ++a) {
      buffer_.normal[pixel][a] = static_cast<float>(normal[a]);
      if (!buffer_.position.empty()) buffer_.position[pixel][a] = static_cast<float>(point[a]);
      if (!buffer_.gradient.empty()) buffer_.gradient[pixel][a] = static_cast<float>(normal[a]);
    }
  }

  /** The leaf of median radius: lines are found at its scale. */
  static std::uint32_t middleLeaf(const SLIMSurface& surface) {
    std::vector<std::uint32_t> leaves = surface.leaves();
    const auto middle = leaves.begin() + static_cast<std::ptrdiff_t>(leaves.size() / 2);
    std::nth_element(leaves.begin(), middle, leaves.end(), [&](std::uint32_t a, std::uint32_t b) {
      return surface.radius[a] < surface.radius[b];
    });
    return *middle;
  }

  CameraRays rays_;
  std::uint32_t leaf_;
  float radius_ = 0.0f;
  GBuffer buffer_;
};

/** \brief What the camera sees of a mesh, in the units of a surface. */
GBuffer rasterize(const Mesh& mesh, const Camera& camera, const SLIMSurface& surface,
                  unsigned columns) {
  const SurfaceInfo& info = surface.info;
  MeshRasterizer rasterizer(surface, camera, columns);
  const Points normals = vertexNormals(mesh);
  const std::vector<Symmetric3<double>> bends = vertexBends(mesh, normals);
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const IndexRow corners = mesh.faces[f];
    for (std::size_t k = 2; k < corners.size(); ++k) {
      Triangle triangle;
      for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t v = corners[i == 0 ? 0 : k + i - 2];
        triangle.corner[i] = scaled(subtract(mesh.vertices[v], info.origin), 1 / info.scale);
        triangle.normal[i] = normals[v];
        for (std::size_t a = 0; a < 6; ++a) triangle.bend[i][a] = bends[v][a] * info.scale;
      }
      rasterizer.draw(triangle);
    }
  }
  return rasterizer.buffer();
}

Error draw(Settings& s) {
  if (Error error = s.view.parse()) return error;
  const auto mode = shadingModeOf(s.mode);
  const auto mesh = loadMesh(s.mesh);
  if (!mesh) return mesh.error();
  const auto surface = loadSurface(s.surface);
  if (!surface) return surface.error();
  const Camera camera = s.view.viewOf(spheresOf(*surface)).camera;

  PictureLineParams wanted;
  LineStyle style;
  style.width = s.line_width;
  wanted.contour = s.contour || s.suggestive;
  wanted.suggestive = s.suggestive;
  ShadingParams shading;
  shading.mode = *mode;
  shading.gradient_background = false;
  const GBuffer buffer =
      rasterize(*mesh, camera, *surface, columnsFor(shading) | pictureLineColumns(wanted));
  auto image = shade(buffer, camera, shading, surface->info.scale);
  if (!image) return image.error();
  if (wanted.contour) {
    const auto lines = findPictureLines(buffer, camera, *surface, wanted);
    if (!lines) return lines.error();
    if (Error error = drawLines(*lines, style, *image)) return error;
  }
  return saveImage(s.output, *image);
}

}  // namespace

int main(int argc, char** argv) {
  Settings s;
  OptionTable options("phong_picture", "1", "Draws a mesh as a SLIM surface's picture is drawn.");
  options.positional("IN.ply", &s.mesh, "the mesh");
  options.positional("IN.slim", &s.surface, "a surface fitted to it: its units and its view");
  options.positional("OUT.png|.ppm", &s.output, "the picture");
  options.choice("mode", &s.mode, {"shaded", "normal", "reflection"}, "what the picture shows");
  options.toggle("contour", &s.contour, "draw contours");
  options.toggle("suggestive", &s.suggestive, "draw contours and suggestive contours");
  options.number("line_width", &s.line_width, 0.1, 100, "width of strong lines, pixels");
  s.view.declareSize(options);
  s.view.declareCamera(options);
  if (const auto status = options.parse(argc, argv)) return *status;
  if (const Error error = draw(s)) {
    std::fprintf(stderr, "phong_picture: %s\n", error.message.c_str());
    return 2;
  }
  return 0;
}
