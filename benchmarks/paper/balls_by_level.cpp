// SPDX-License-Identifier: BSD-3-Clause
// Balls of the surfels, level by level: internal ones blue, leaves pink (Fig. 7).
#include <algorithm>
#include <cmath>

#include "paper/study.h"
#include "pcl_slim/render/image.h"

namespace pcl_slim::paper {

namespace {

constexpr int kSize = 320, kPanels = 5;
constexpr std::array<double, 3> kInternal = {0.35, 0.5, 0.95}, kLeaf = {1.0, 0.55, 0.7};

/** A picture of balls seen along -z of a turned frame. */
class BallPicture {
 public:
  explicit BallPicture(double scale)
      : scale_(scale), depth_(kSize * kSize, -1e300), color_(kSize * kSize, {1, 1, 1}) {}

  void draw(const Vector3& center, double radius, const std::array<double, 3>& color) {
    const double x0 = kSize / 2.0 + scale_ * center[0], y0 = kSize / 2.0 - scale_ * center[1];
    const double r = scale_ * radius;
    const int high_y = std::min(kSize - 1, static_cast<int>(std::floor(y0 + r)));
    for (int y = std::max(0, static_cast<int>(std::ceil(y0 - r))); y <= high_y; ++y) {
      const int high_x = std::min(kSize - 1, static_cast<int>(std::floor(x0 + r)));
      for (int x = std::max(0, static_cast<int>(std::ceil(x0 - r))); x <= high_x; ++x) {
        const double dx = (x - x0) / r, dy = (y0 - y) / r, rest = 1 - dx * dx - dy * dy;
        if (rest <= 0) continue;
        const double dz = std::sqrt(rest), depth = center[2] + radius * dz;
        const auto at = static_cast<std::size_t>(y * kSize + x);
        if (depth <= depth_[at]) continue;
        depth_[at] = depth;
        const double light = 0.25 + 0.75 * std::max(0.0, 0.45 * dx + 0.45 * dy + 0.77 * dz);
        color_[at] = {light * color[0], light * color[1], light * color[2]};
      }
    }
  }

  void copyTo(Image& image, int panel) const {
    for (std::size_t y = 0; y < kSize; ++y) {
      for (std::size_t x = 0; x < kSize; ++x) {
        for (std::size_t k = 0; k < 3; ++k) {
          image.rgb[3 * (y * static_cast<std::size_t>(image.width) +
                         static_cast<std::size_t>(panel) * kSize + x) +
                    k] = static_cast<std::uint8_t>(255 * color_[y * kSize + x][k]);
        }
      }
    }
  }

 private:
  double scale_;
  std::vector<double> depth_;
  std::vector<std::array<double, 3>> color_;
};

/** A place seen from the front and a little from above; y is up. */
Vector3 turned(const SLIMSurface& surface, std::size_t i) {
  const double angle = 0.4, x = surface.cx[i] - surface.root_ball[0],
               y = surface.cy[i] - surface.root_ball[1], z = surface.cz[i] - surface.root_ball[2];
  const double front = std::cos(angle) * z + std::sin(angle) * x;
  return {std::cos(angle) * x - std::sin(angle) * z, 0.97 * y - 0.24 * front,
          0.97 * front + 0.24 * y};
}

}  // namespace

Error ballsByLevel(const StudySettings& settings) {
  const auto model = loadModel(settings, "stanford_dragon_res2.ply");
  if (!model) return model.error();
  FitParams params;
  params.paper_mode = true;
  params.degree = 2;
  params.size = MDLThreshold{0.01};
  params.threads = settings.threads;
  const auto fitted = fitModel(*model, params);
  if (!fitted) return fitted.error();
  const SLIMSurface& surface = fitted->surface;
  Table table("Balls of the dragon level by level, quadratics, T = .01 (Fig. 7)",
              {"level k", "r_r / L", "internal", "leaves"});
  Image image;
  image.width = kPanels * kSize;
  image.height = kSize;
  image.rgb.resize(3u * kPanels * kSize * kSize);
  const int first = *std::min_element(surface.level.begin(), surface.level.end());
  const int last = *std::max_element(surface.level.begin(), surface.level.end());
  for (int level = first; level <= last; ++level) {
    BallPicture picture(0.6 * kSize / surface.root_ball[3]);
    std::size_t leaves = 0, internal = 0;
    for (std::size_t i = 0; i < surface.size(); ++i) {
      const bool leaf = surface.isLeaf(i);
      // A leaf once found stays in the pictures of the finer levels, as in the paper's.
      if (surface.level[i] != level && !(leaf && surface.level[i] < level)) continue;
      picture.draw(turned(surface, i), 0.5 * surface.radius[i], leaf ? kLeaf : kInternal);
      leaves += leaf && surface.level[i] == level;
      internal += !leaf;
    }
    const double golden = 0.6180339887;
    table.row({std::to_string(level), number("%.4f", 0.1 * std::pow(golden, level - 1)),
               std::to_string(internal), std::to_string(leaves)});
    if (level - first < kPanels) picture.copyTo(image, level - first);
  }
  if (Error error = table.save(settings, "fig07")) return error;
  return saveImage(settings.out + "/fig07.png", image);
}

}  // namespace pcl_slim::paper
