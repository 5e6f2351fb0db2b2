// SPDX-License-Identifier: BSD-3-Clause
// Scans with gaps as quadratic leaves and as a plain QSplat (Fig. 18, below): half of the points
// makes both, the other half, as far as it is seen, measures them.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "paper/study.h"
#include "pcl_slim/cloud/knn.h"
#include "pcl_slim/render/auto_view.h"
#include "pcl_slim/render/image.h"
#include "pcl_slim/render/shading.h"
#include "pcl_slim/render/surface_renderer.h"
#include "qsplat/qsplat.h"
#include "support/lab/bench.h"

namespace pcl_slim::paper {
namespace {

using bench::QSplat;
using bench::Splat;

constexpr int kSize = 700;                     ///< pixels a side
constexpr std::size_t kPlanePoints = 16;       ///< neighbours whose plane gives a point its normal
constexpr double kInside = 0.75, kNear = 3.0;  ///< [spacings] surely data, and surely none beyond
constexpr double kSameSheet = 4.0;  ///< [spacings] off a point that a pixel shows another sheet
constexpr double kFloatsOfDisc = 7, kFloatsOfQuadric = 12;

/** A scan seen by one camera. Its points are discs whose radius is their spacing; they face the
 * camera. */
struct Scan {
  std::vector<Splat> points;  ///< world units; those of even index make the pictures
  Camera camera;
  double spacing = 0;  ///< median
};

/** Eigenvector of the least eigenvalue of some points' covariance. */
Vector3 planeNormal(const PointStore& store, const std::vector<std::uint32_t>& points) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  const auto at = [&](std::uint32_t i) { return Eigen::Vector3d(store.position(i).data()); };
  for (const std::uint32_t i : points) mean += at(i) / static_cast<double>(points.size());
  for (const std::uint32_t i : points) moments += (at(i) - mean) * (at(i) - mean).transpose();
  const Eigen::Vector3d n =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(moments).eigenvectors().col(0);
  return {n.x(), n.y(), n.z()};
}

Scan seenFrom(const PointStore& store, const Camera& camera) {
  Scan scan;
  scan.camera = camera;
  NeighborSearch search(store);
  std::vector<std::uint32_t> neighbors;
  std::vector<float> squared;
  std::vector<double> spacings;
  for (std::size_t i = 0; i < store.size(); ++i) {
    search.nearest(i, kPlanePoints + 1, neighbors, squared);
    const Vector3 place = along(store.origin(), store.scale(), store.position(i));
    Vector3 normal = planeNormal(store, neighbors);
    if (dot(normal, subtract(camera.position, place)) < 0) normal = scaled(normal, -1.0);
    const double spacing = store.scale() * std::sqrt(M_PI * squared.back() / kPlanePoints);
    scan.points.push_back({place, normal, spacing});
    spacings.push_back(spacing);
  }
  scan.spacing = measure::median(spacings);
  return scan;
}

/** Means of the points of each cell of a grid, as discs that enclose a cell: equal ones, as QSplat's.
 */
std::vector<Splat> cellDiscs(const std::vector<Splat>& points, double cell) {
  std::map<std::array<std::int64_t, 3>, std::pair<Splat, double>> cells;
  for (std::size_t i = 0; i < points.size(); i += 2) {
    std::array<std::int64_t, 3> key{};
    for (std::size_t a = 0; a < 3; ++a) {
      key[a] = static_cast<std::int64_t>(std::floor(points[i].center[a] / cell));
    }
    auto& [sum, count] = cells[key];
    sum.center = along(sum.center, 1.0, points[i].center);
    sum.normal = along(sum.normal, 1.0, points[i].normal);
    count += 1;
  }
  std::vector<Splat> discs;
  discs.reserve(cells.size());
  for (const auto& [key, value] : cells) {
    discs.push_back({scaled(value.first.center, 1 / value.second), normalized(value.first.normal),
                     0.5 * std::sqrt(3.0) * cell});
  }
  return discs;
}

/** As many of them as wanted, within some of a hundred. */
std::vector<Splat> discsOf(const Scan& scan, double wanted) {
  double low = 0.1 * scan.spacing, high = 100 * scan.spacing;
  for (int step = 0; step < 30; ++step) {
    const double middle = std::sqrt(low * high);
    std::vector<Splat> discs = cellDiscs(scan.points, middle);
    if (std::abs(static_cast<double>(discs.size()) / wanted - 1) < 0.005) return discs;
    (static_cast<double>(discs.size()) > wanted ? low : high) = middle;
  }
  return cellDiscs(scan.points, high);
}

/** A frame in world units. */
GBuffer frameOf(const std::vector<Splat>& discs, const Camera& camera) {
  GBuffer frame;
  frame.resize(kSize, kSize, kPositionColumn);
  QSplat(discs).draw(detail::CameraRays(camera, {0, 0, 0}, 1.0), frame);
  return frame;
}

/** The scan's points as discs of some spacings. */
GBuffer pointsFrame(const Scan& scan, double spacings) {
  std::vector<Splat> discs = scan.points;
  for (Splat& disc : discs) disc.radius *= spacings;
  return frameOf(discs, scan.camera);
}

Result<GBuffer> frameOf(const SLIMSurface& surface, const Camera& camera, bool trim) {
  RenderParams params;
  params.columns = kPositionColumn;
  params.trim = trim;
  params.close_gaps = true;
  params.sides = VisibleSides::kBoth;
  GBuffer frame;
  if (Error error = renderSurface(surface, camera, params, frame)) return error;
  for (std::size_t i = 0; i < frame.numPixels(); ++i) {
    frame.depth[i] *= static_cast<float>(surface.info.scale);
    for (std::size_t a = 0; a < 3; ++a) {
      frame.position[i][a] =
          static_cast<float>(surface.info.origin[a] + surface.info.scale * frame.position[i][a]);
    }
  }
  return frame;
}

/** Where the scan is seen: surely data, and all that may be. */
struct Masks {
  GBuffer inside, near;
};

/** The row's cells behind the counts: distance and angle of withheld points, and what is open and
 * filled. */
std::vector<std::string> measured(const Scan& scan, const Masks& masks, const GBuffer& frame) {
  const detail::CameraRays rays(scan.camera, {0, 0, 0}, 1.0);
  double sum = 0;
  std::vector<double> angles;
  std::size_t seen = 0;
  for (std::size_t i = 1; i < scan.points.size(); i += 2) {
    const Splat& p = scan.points[i];
    const detail::PixelRect rect = rays.pixelsOfBall(p.center, 1e-9);
    if (rect.empty()) continue;
    const std::size_t pixel = frame.index(rect.x0, rect.y0);
    const double depth = length(subtract(p.center, scan.camera.position));
    if (depth > masks.inside.depth[pixel] + p.radius) continue;
    ++seen;
    if (!frame.covered(pixel)) continue;
    Vector3 n{}, q{};
    for (std::size_t a = 0; a < 3; ++a) {
      n[a] = frame.normal[pixel][a];
      q[a] = frame.position[pixel][a];
    }
    const double off = dot(n, subtract(p.center, q));
    if (std::abs(off) > kSameSheet * p.radius) continue;
    sum += off * off / (p.radius * p.radius);
    angles.push_back(std::acos(std::min(1.0, std::abs(dot(n, p.normal)))) * 180 / M_PI);
  }
  std::size_t open = 0, filled = 0, data = 0;
  for (std::size_t i = 0; i < frame.numPixels(); ++i) {
    data += masks.inside.covered(i);
    open += masks.inside.covered(i) && !frame.covered(i);
    filled += frame.covered(i) && !masks.near.covered(i);
  }
  const auto count = static_cast<double>(std::max<std::size_t>(1, angles.size()));
  const auto share = [&](std::size_t pixels) {
    return number("%.2f %%", 100.0 * static_cast<double>(pixels) / static_cast<double>(data));
  };
  return {number("%.3f", std::sqrt(sum / count)), number("%.1f", measure::median(angles)),
          number("%.1f %%", 100 * (1 - count / static_cast<double>(seen))), share(open),
          share(filled)};
}

/** What a study of one scan needs. */
struct Subject {
  const char* file;
  const char* picture;          ///< name of its pictures; null: none
  std::array<double, 10> view;  ///< camera as pcl_slim_render takes it; all 0: chosen
};

constexpr Subject kSubjects[] = {
    {"lion_takanawa.pcd", "lion", {2.92, -6.07, 0.63, -2.75, 3.2, -2.3, 0, 0, 1, 9}},
    {"lone_star_geyser_tls.pcd", nullptr, {}},
    {"stanford_bunny_raw_scans.pcd", nullptr, {}},
};

Error savePicture(const StudySettings& settings, const Subject& subject, const char* name,
                  const GBuffer& frame, const Camera& camera) {
  if (!subject.picture) return {};
  ShadingParams shading;
  shading.ambient_occlusion = 0;
  shading.gradient_background = false;
  const auto image = shade(frame, camera, shading);
  if (!image) return image.error();
  return saveImage(settings.out + "/fig18_" + name + ".png", *image);
}

Camera cameraOf(const Subject& subject, const SLIMSurface& surface) {
  const BoundingSpheres object = spheresOf(surface);
  Camera camera = cameraFor(chooseView(object), object, {kSize, kSize});
  if (subject.view[9] == 0) return camera;
  for (std::size_t a = 0; a < 3; ++a) {
    camera.position[a] = subject.view[a];
    camera.look_at[a] = subject.view[a + 3];
    camera.up[a] = subject.view[a + 6];
  }
  camera.fov = subject.view[9];
  return camera;
}

/** The points of even index as a model of their own. */
Model halfOf(const PointStore& store, const std::string& name) {
  Model half;
  half.name = name;
  for (std::size_t i = 0; i < store.size(); i += 2) {
    half.points.push_back(along(store.origin(), store.scale(), store.position(i)));
    if (!store.hasNormals()) continue;
    const auto n = store.normal(i);
    half.normals.insert(half.normals.end(), n.begin(), n.end());
  }
  return half;
}

Error compare(const StudySettings& settings, const Subject& subject, Table& table) {
  const auto model = loadModel(settings, subject.file);
  if (!model) return model.error();
  const auto store = PointStore::build(model->view(), settings.threads);
  if (!store) return store.error();
  FitParams params;
  params.degree = 2;
  params.threads = settings.threads;
  const auto fitted = fitModel(halfOf(*store, model->name), params);
  if (!fitted) return fitted.error();
  const Scan scan = seenFrom(*store, cameraOf(subject, fitted->surface));
  const Masks masks{pointsFrame(scan, kInside), pointsFrame(scan, kNear)};
  const auto leaves = static_cast<double>(fitted->surface.numLeaves());
  const auto row = [&](const char* what, const char* name, double primitives, double floats,
                       const GBuffer& frame) {
    std::vector<std::string> cells = {model->name, what, number("%.0f", primitives),
                                      number("%.0fK", floats * primitives / 1000)};
    for (const std::string& cell : measured(scan, masks, frame)) cells.push_back(cell);
    table.row(cells);
    return savePicture(settings, subject, name, frame, scan.camera);
  };
  if (Error error = savePicture(settings, subject, "points", masks.inside, scan.camera))
    return error;
  for (const bool bytes : {false, true}) {
    const auto discs = discsOf(scan, (bytes ? kFloatsOfQuadric / kFloatsOfDisc : 1) * leaves);
    if (Error error =
            row(bytes ? "QSplat, as many floats" : "QSplat, as many", bytes ? "floats" : "discs",
                static_cast<double>(discs.size()), kFloatsOfDisc, frameOf(discs, scan.camera))) {
      return error;
    }
  }
  for (const bool trim : {false, true}) {
    const auto frame = frameOf(fitted->surface, scan.camera, trim);
    if (!frame) return frame.error();
    if (Error error = row(trim ? "quadratic leaves" : "the same without borders",
                          trim ? "leaves" : "whole", leaves, kFloatsOfQuadric, *frame)) {
      return error;
    }
  }
  return {};
}

}  // namespace

Error splatsBeside(const StudySettings& settings) {
  Table table(
      "Scans with gaps as quadratic leaves and as QSplat, made of every other point (Fig. 18)",
      {"scan", "drawn as", "primitives", "floats", "off the other points, spacings, RMS",
       "normals, median, degrees", "points missed", "data left open", "gaps filled"});
  for (const Subject& subject : kSubjects) {
    if (Error error = compare(settings, subject, table)) return error;
  }
  return table.save(settings, "fig18");
}

}  // namespace pcl_slim::paper
