// SPDX-License-Identifier: BSD-3-Clause
// Draws a mesh face by face with flat shading, so that every fold and facet shows.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>

#include "common/options.h"
#include "mesh/bench_mesh.h"
#include "pcl_slim/filters/io/point_file.h"
#include "pcl_slim/render/image.h"

namespace {

using namespace pcl_slim;
using namespace pcl_slim::mesh_bench;

struct Settings {
  std::string input, output;
  std::vector<double> eye, up, middle;
  double width = 1;
  int size = 400;
};

/** A parallel view: where a place falls on the picture, in samples, and how near it is. */
struct View {
  Vector3 right, up, towards, middle;
  double scale = 1, half = 0;

  Vector3 onPicture(const Vector3& p) const {
    const Vector3 from = subtract(p, middle);
    return {half + scale * dot(from, right), half - scale * dot(from, up), dot(from, towards)};
  }
};

constexpr int kSamples = 3;  ///< a side of a pixel

class Canvas {
 public:
  explicit Canvas(int size)
      : size_(size * kSamples),
        depth_(static_cast<std::size_t>(size_) * size_, std::numeric_limits<double>::lowest()),
        light_(depth_.size(), 1.0) {}

  int size() const { return size_; }

  void fill(const Vector3& a, const Vector3& b, const Vector3& c, double light) {
    const double area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    if (area == 0) return;
    const auto [low_x, high_x] = std::minmax({a[0], b[0], c[0]});
    const auto [low_y, high_y] = std::minmax({a[1], b[1], c[1]});
    for (int y = first(low_y); y <= last(high_y); ++y) {
      for (int x = first(low_x); x <= last(high_x); ++x) {
        const double u = ((x - a[0]) * (c[1] - a[1]) - (y - a[1]) * (c[0] - a[0])) / area;
        const double v = ((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])) / area;
        if (u < 0 || v < 0 || u + v > 1) continue;
        const std::size_t at = static_cast<std::size_t>(y) * size_ + x;
        const double depth = a[2] + u * (b[2] - a[2]) + v * (c[2] - a[2]);
        if (depth <= depth_[at]) continue;
        depth_[at] = depth;
        light_[at] = light;
      }
    }
  }

  Image image() const {
    Image made;
    made.width = made.height = size_ / kSamples;
    for (int y = 0; y < made.height; ++y) {
      for (int x = 0; x < made.width; ++x) {
        double sum = 0;
        for (int s = 0; s < kSamples * kSamples; ++s) {
          sum += light_[static_cast<std::size_t>(y * kSamples + s / kSamples) * size_ +
                        x * kSamples + s % kSamples];
        }
        const double mean = sum / (kSamples * kSamples);
        const auto value = static_cast<std::uint8_t>(std::lround(255 * std::pow(mean, 1 / 2.2)));
        made.rgb.insert(made.rgb.end(), 3, value);
      }
    }
    return made;
  }

 private:
  int first(double x) const { return std::max(0, static_cast<int>(std::ceil(x))); }
  int last(double x) const { return std::min(size_ - 1, static_cast<int>(std::floor(x))); }

  int size_;
  std::vector<double> depth_, light_;
};

View viewOf(const Settings& s) {
  View view;
  for (std::size_t a = 0; a < 3; ++a) {
    view.towards[a] = s.eye[a];
    view.up[a] = s.up[a];
    view.middle[a] = s.middle[a];
  }
  view.towards = normalized(view.towards);
  view.right = normalized(cross(view.up, view.towards));
  view.up = cross(view.towards, view.right);
  view.scale = s.size * kSamples / s.width;
  view.half = s.size * kSamples / 2.0;
  return view;
}

Error draw(const Settings& s) {
  const auto mesh = loadMesh(s.input);
  if (!mesh) return mesh.error();
  const View view = viewOf(s);
  const Vector3 lamp = normalized(along(along(view.towards, 0.5, view.up), -0.6, view.right));
  Canvas canvas(s.size);
  for (std::size_t f = 0; f < mesh->faces.size(); ++f) {
    const IndexRow corners = mesh->faces[f];
    const Vector3 normal = normalized(areaVector(mesh->vertices, corners));
    const double light = 0.06 + 0.74 * std::abs(dot(normal, lamp));
    for (std::size_t k = 2; k < corners.size(); ++k) {
      canvas.fill(view.onPicture(mesh->vertices[corners[0]]),
                  view.onPicture(mesh->vertices[corners[k - 1]]),
                  view.onPicture(mesh->vertices[corners[k]]), light);
    }
  }
  return saveImage(s.output, canvas.image());
}

}  // namespace

int main(int argc, char** argv) {
  Settings s;
  OptionTable options("mesh_picture", "1", "Draws a mesh with flat faces.");
  options.positional("IN.ply", &s.input, "the mesh");
  options.positional("OUT.png|.ppm", &s.output, "the picture, square");
  options.numbers("eye", &s.eye, "X,Y,Z", "direction to stand in");
  options.numbers("up", &s.up, "X,Y,Z", "direction that is up");
  options.numbers("middle", &s.middle, "X,Y,Z", "place in the middle of the picture");
  options.number("width", &s.width, 1e-9, 1e9, "what the picture spans, units of the mesh");
  options.integer("size", &s.size, 16, 4096, "pixels a side");
  if (const auto status = options.parse(argc, argv)) return *status;
  if (s.eye.empty()) s.eye = {0, 0, 1};
  if (s.up.empty()) s.up = {0, 1, 0};
  if (s.middle.empty()) s.middle = {0, 0, 0};
  if (const Error error = draw(s)) {
    std::fprintf(stderr, "mesh_picture: %s\n", error.message.c_str());
    return 2;
  }
  return 0;
}
