// SPDX-License-Identifier: BSD-3-Clause
// Crest lines in pictures of noisy exact shapes against exact lines: how much of what is seen is
// found, and how much of what is found is false. Figures are sums over six views.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "common/run_program.h"
#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/fit/fit.h"
#include "picture_views.h"
#include "support/lab/bench.h"
#include "support/lab/line_truth.h"

namespace {

using namespace pcl_slim;
using namespace pcl_slim::lines_bench;
using measure::Segment;

struct Settings {
  std::string shapes = "sphere,torus,ellipsoid,bumpy,box,cube", noise = "0,0.0001,0.001,0.005";
  std::string picture;
  int points = 100000, seed = 7, cells = 700, width = 800, height = 700;
  PictureLineParams lines;
  std::vector<double> noise_list;
};

struct Shape {
  std::string name;
  measure::LineSurface surface;
  std::vector<Segment> truth;
};

/** Lengths in diagonals of the shape, summed over the views. */
struct Outcome {
  double seen = 0, met = 0;   ///< of true lines; with a found line next to them
  double found = 0, off = 0;  ///< of found lines; with no true line next to them
  double suggestive = 0;      ///< of suggestive contours [pixels a view]
  double radius = 0;          ///< of the leaves [pixels]
};

OptionTable declareOptions(Settings& s) {
  OptionTable options("picture_truth_bench", "1", "Measures crest lines in pictures.");
  options.text("shape", &s.shapes, "NAME,...",
               "sphere, torus, ellipsoid, bumpy, mix, box, wtorus, cube");
  options.text("noise", &s.noise, "S,...", "noise, as a share of the box diagonal");
  options.integer("points", &s.points, 100, 10000000, "points of a cloud");
  options.integer("seed", &s.seed, 0, 1000000, "seed of the clouds");
  options.integer("cells", &s.cells, 50, 10000, "cells a side of the grid that finds exact lines");
  options.number("crest", &s.lines.crest_curvature, 0, 1e6, "least curvature [1/L]; 0: automatic");
  options.integer("width", &s.width, 16, 8192, "pixels");
  options.integer("height", &s.height, 16, 8192, "pixels");
  options.text("picture", &s.picture, "PREFIX", "draw the lines of each first view");
  return options;
}

constexpr double kHalfEdge = 0.6;  ///< of the cube

Error makeShape(const Settings& s, const std::string& name, Shape& shape) {
  shape.name = name;
  if (name == "cube") {
    shape.truth = measure::cubeEdges(kHalfEdge, 200);
    return {};
  }
  if (!measure::parseLineSurface(name, shape.surface))
    return {ErrorCode::kBadArgument, "there is no shape '" + name + "'; see -h"};
  if (name == "sphere" || name == "torus") return {};  // what rounding finds there is no line
  for (const bool ravine : {false, true}) {
    const auto lines =
        measure::exactLines(shape.surface, ravine, static_cast<std::size_t>(s.cells));
    shape.truth.insert(shape.truth.end(), lines.begin(), lines.end());
  }
  return {};
}

Error fit(const Settings& s, const measure::Scene& scene, SLIMSurface& surface) {
  const auto store = PointStore::build(measure::viewOf(scene, nullptr, true), s.lines.threads);
  if (!store) return store.error();
  return fitSurface(*store, FitParams(), surface);
}

/** Whether a camera sees a segment, and not as a contour, which is drawn as one.
 * \param[in] reach [pixels] */
bool isSeen(const PictureView& view, const SLIMSurface& surface, const Segment& segment,
            double reach) {
  const auto seen = projectLines({{PictureLineKind::kRidge, {segment[0], segment[1]}}}, view.buffer,
                                 view.camera, surface);
  if (!seen || seen->empty()) return false;
  const auto& place = seen->front().points.front();
  for (const PictureLine& line : view.lines) {
    if (line.kind != PictureLineKind::kContour) continue;
    for (const auto& p : line.points) {
      if (std::hypot(p[0] - place[0], p[1] - place[1]) < reach) return false;
    }
  }
  return true;
}

double lengthOf(const Segment& segment) {
  return length(subtract(segment[1], segment[0]));
}

Vector3 middleOf(const Segment& segment) {
  return along(segment[0], 0.5, subtract(segment[1], segment[0]));
}

/** Adds what one view shows. \param[in] reach a line nearer than this is next to another. */
void score(const Shape& shape, const SLIMSurface& surface, const PictureView& view, double reach,
           double pixel, double diagonal, Outcome& sum) {
  std::vector<Segment> found;
  for (const SpaceLine& line : crestLinesInSpace(surface, view)) {
    for (std::size_t i = 1; i < line.points.size(); ++i) {
      const Segment segment{line.points[i - 1], line.points[i]};
      // Longer than a line's pixels are: it passes from one sheet to another.
      if (lengthOf(segment) < reach) found.push_back(segment);
    }
  }
  const measure::SegmentIndex truth(shape.truth, 2 * reach), lines(found, 2 * reach);
  for (const Segment& segment : found) {
    sum.found += lengthOf(segment) / diagonal;
    if (truth.distance(middleOf(segment)) > reach) sum.off += lengthOf(segment) / diagonal;
  }
  for (const Segment& segment : shape.truth) {
    if (!isSeen(view, surface, segment, reach / pixel)) continue;
    sum.seen += lengthOf(segment) / diagonal;
    if (lines.distance(middleOf(segment)) < reach) sum.met += lengthOf(segment) / diagonal;
  }
}

Error savePicture(const Settings& s, const std::string& path, const PictureView& view) {
  Image image;
  image.width = s.width;
  image.height = s.height;
  image.rgb.assign(static_cast<std::size_t>(3) * s.width * s.height, 255);
  if (Error error = drawLines(view.lines, {}, image)) return error;
  return saveImage(path, image);
}

Error runScene(const Settings& s, const Shape& shape, double noise, Outcome& sum) {
  const auto points = static_cast<std::size_t>(s.points);
  const auto seed = static_cast<std::uint64_t>(s.seed);
  const measure::Scene scene =
      shape.name == "cube" ? measure::sampleCube(kHalfEdge, points, noise, seed)
                           : measure::sampleSurface(shape.surface, points, noise, 0.05, seed);
  SLIMSurface surface;
  if (Error error = fit(s, scene, surface)) return error;
  SurfaceRenderer renderer(surface, s.lines.threads);
  constexpr double kTowards[][3] = {{.2, -.85, .5}, {-.7, .4, .6},   {.75, .6, -.3},
                                    {.9, -.2, .4},  {-.3, -.6, -.7}, {-.1, .8, .6}};
  for (const auto& towards : kTowards) {
    PictureView view;
    view.camera.position = scaled(normalized({towards[0], towards[1], towards[2]}), 4.0);
    view.camera.up = {0, 0, 1};
    view.camera.fov = 36;
    view.camera.size = {s.width, s.height};
    if (Error error = renderView(renderer, s.lines, view)) return error;
    auto lines = findPictureLines(view.buffer, view.camera, surface, s.lines);
    if (!lines) return lines.error();
    view.lines = std::move(*lines);
    const double pixel = 2.0 * std::tan(18 * M_PI / 180) * 3.4 / s.height;
    double radius = 0, covered = 0;
    for (std::size_t i = 0; i < view.buffer.numPixels(); ++i) {
      if (!view.buffer.covered(i)) continue;
      radius += view.buffer.radius[i] * surface.info.scale;
      covered += 1;
    }
    radius /= std::max(1.0, covered);
    sum.radius += radius / pixel / 6;
    score(shape, surface, view, std::max(3 * pixel, 0.25 * radius), pixel, scene.diagonal, sum);
    for (const PictureLine& line : view.lines) {
      if (line.kind != PictureLineKind::kSuggestive) continue;
      for (std::size_t i = 1; i < line.points.size(); ++i)
        sum.suggestive += std::hypot(line.points[i][0] - line.points[i - 1][0],
                                     line.points[i][1] - line.points[i - 1][1]) /
                          6;
    }
    if (!s.picture.empty() && &towards == &kTowards[0]) {
      char tail[40];
      std::snprintf(tail, sizeof tail, "_%g.png", noise);
      if (Error error = savePicture(s, s.picture + shape.name + tail, view)) return error;
    }
  }
  return {};
}

Exit run(Settings& s) {
  if (Error error = measure::parseLists({{"noise", &s.noise, 0, 1, false, &s.noise_list}}))
    return error;
  s.lines.crest = s.lines.suggestive = s.lines.contour = true;
  std::printf(
      "| shape | noise | leaf radius [pixels] | true length seen [L] | found of it | found length "
      "[L] | false of it | suggestive [pixels] |\n|---|---|---|---|---|---|---|---|\n");
  for (std::size_t at = 0; at <= s.shapes.size();) {
    const std::size_t comma = std::min(s.shapes.find(',', at), s.shapes.size());
    Shape shape;
    if (Error error = makeShape(s, s.shapes.substr(at, comma - at), shape)) return error;
    for (const double noise : s.noise_list) {
      Outcome r;
      if (Error error = runScene(s, shape, noise, r)) return error;
      std::printf("| %s | %g | %.0f | %.2f | %.3f | %.2f | %.3f | %.0f |\n", shape.name.c_str(),
                  noise, r.radius, r.seen, r.seen > 0 ? r.met / r.seen : 0.0, r.found,
                  r.found > 0 ? r.off / r.found : 0.0, r.suggestive);
      std::fflush(stdout);
    }
    at = comma + 1;
  }
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  Settings s;
  OptionTable options = declareOptions(s);
  return runProgram(options, argc, argv, "use fewer points", [&] { return run(s); });
}
