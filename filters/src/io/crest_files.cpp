// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/filters/io/crest_files.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>

#include "io/point_formats.h"
#include "io/vtp/vtp.h"
#include "pcl_slim/core/file_access.h"
#include "pcl_slim/core/order_statistics.h"

namespace pcl_slim {

namespace {

constexpr double kFloatStep = 0x1p-23;  ///< distance of neighbouring floats over their size
constexpr double kShareOfStep = 1e-3;

const char* const kColumns[] = {
    "x",         "y",  "z",  "normal_x",     "normal_y", "normal_z", "tangent_x", "tangent_y",
    "tangent_z", "k1", "k2", "significance", "strength", "type",     "line"};
constexpr std::size_t kWholeNumbers = 2;  ///< of the columns, the last ones
constexpr std::size_t kNumColumns = sizeof(kColumns) / sizeof(kColumns[0]);

/** Whether float keeps vertices where they are. */
bool floatsSuffice(const CrestLines& lines) {
  double farthest = 0, length = 0;
  for (const auto& p : lines.position) {
    for (const double value : p) farthest = std::max(farthest, std::abs(value));
  }
  for (const double l : lines.length) length += l;
  const double step = length / static_cast<double>(std::max<std::size_t>(lines.numVertices(), 1));
  return farthest * kFloatStep <= kShareOfStep * step;
}

template <typename T>
void put(std::uint8_t*& at, T value) {
  std::memcpy(at, &value, sizeof(value));
  at += sizeof(value);
}

/** Everything behind a vertex's coordinates. */
void putRest(const CrestLines& lines, std::size_t line, std::size_t v, std::uint8_t*& at) {
  for (const auto* vector : {&lines.normal[v], &lines.tangent[v]}) {
    for (const float value : *vector) put(at, value);
  }
  put(at, lines.k1[v]);
  put(at, lines.k2[v]);
  put(at, lines.significance[v]);
  put(at, static_cast<float>(lines.strength[line]));
  put(at, static_cast<std::uint32_t>(lines.type[line]));
  put(at, static_cast<std::uint32_t>(line));
}

}  // namespace

PointFile toPointFile(const CrestLines& lines) {
  PointFile file;
  PointTable& cloud = file.cloud;
  const bool narrow = floatsSuffice(lines);
  for (std::size_t c = 0; c < kNumColumns; ++c) {
    const bool whole = c + kWholeNumbers >= kNumColumns;
    addField(cloud, kColumns[c], c < 3 && !narrow ? kFloat64 : whole ? kUInt32 : kFloat32);
  }
  cloud.resize(lines.numVertices());
  std::uint8_t* at = cloud.data.data();
  for (std::size_t line = 0; line < lines.numLines(); ++line) {
    for (std::uint32_t v = lines.line_begin[line]; v < lines.line_begin[line + 1]; ++v) {
      for (const double value : lines.position[v]) {
        if (narrow)
          put(at, static_cast<float>(value));
        else
          put(at, value);
      }
      putRest(lines, line, v, at);
    }
  }
  return file;
}

namespace {

constexpr double kMargin = 10;            ///< pixels around the picture
constexpr int kSamples = 4;               ///< of a leaf's patch to each side of its centre
constexpr double kPatch = 0.67;           ///< of a leaf's radius: the patches cover all the surface
constexpr double kCell = 0.25;            ///< of the median radius
constexpr std::size_t kMostCells = 4000;  ///< a side of the depth map
constexpr double kBehind = 0.5;           ///< radii: depth behind the front to which lines show
constexpr double kSteepest = 4.0;         ///< of the slopes that a cell of the map allows for
constexpr const char* kColors[] = {"#1f4fb4", "#c0281e"};  // ridges, ravines

struct Axes {
  Vector3 right, up, toward;

  explicit Axes(const CrestView& view)
      : right(normalized(cross(view.up, view.toward_viewer))),
        toward(normalized(view.toward_viewer)) {
    up = cross(toward, right);
  }
  /** Right, up and towards the viewer. */
  Vector3 operator()(const Vector3& p) const { return {dot(p, right), dot(p, up), dot(p, toward)}; }
};

struct Frame {
  double low[2] = {0, 0}, high[2] = {0, 0};

  void add(const Vector3& p, double reach) {
    for (std::size_t a = 0; a < 2; ++a) {
      low[a] = empty ? p[a] - reach : std::min(low[a], p[a] - reach);
      high[a] = empty ? p[a] + reach : std::max(high[a], p[a] + reach);
    }
    empty = false;
  }
  double side() const { return std::max({high[0] - low[0], high[1] - low[1], 1e-300}); }

  bool empty = true;
};

/** The depth of what is foremost, on a grid of the picture. */
class DepthMap {
 public:
  DepthMap(const SLIMSurface& surface, const Axes& axes, const Frame& frame) : frame_(frame) {
    std::vector<float> radii;
    for (std::size_t i = 0; i < surface.size(); ++i) {
      if (surface.isLeaf(i)) radii.push_back(surface.radius[i]);
    }
    if (radii.empty()) return;
    cell_ = std::max(kCell * median(radii) * surface.info.scale, frame.side() / kMostCells);
    columns_ = static_cast<std::size_t>((frame.high[0] - frame.low[0]) / cell_) + 1;
    rows_ = static_cast<std::size_t>((frame.high[1] - frame.low[1]) / cell_) + 1;
    depth_.assign(columns_ * rows_, -std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < surface.size(); ++i) {
      if (surface.isLeaf(i)) draw(surface, i, axes);
    }
  }

  /** Whether the surface well in front of a vertex hides it. */
  bool hides(const Vector3& p, double radius, double facing) const {
    const std::size_t at = index(p);
    if (at >= depth_.size()) return false;
    const double slope = std::min(kSteepest, 1 / std::max(std::abs(facing), 1e-3));
    return depth_[at] > p[2] + kBehind * radius + cell_ * slope;
  }

 private:
  std::size_t index(const Vector3& p) const {
    const double x = (p[0] - frame_.low[0]) / cell_, y = (p[1] - frame_.low[1]) / cell_;
    if (!(x >= 0 && y >= 0 && x < static_cast<double>(columns_) &&
          y < static_cast<double>(rows_))) {
      return depth_.size();
    }
    return static_cast<std::size_t>(y) * columns_ + static_cast<std::size_t>(x);
  }

  void draw(const SLIMSurface& surface, std::size_t i, const Axes& axes) {
    const LocalFrame frame({surface.nx[i], surface.ny[i], surface.nz[i]});
    const Vector3 c = {surface.cx[i], surface.cy[i], surface.cz[i]};
    const double r = surface.radius[i];
    for (int a = -kSamples; a <= kSamples; ++a) {
      for (int b = -kSamples; b <= kSamples; ++b) {
        if (a * a + b * b > kSamples * kSamples) continue;
        const double u = kPatch * a / kSamples, v = kPatch * b / kSamples;
        const double h = evaluateHeight(surface.degree[i], surface.coefficientsOf(i), u, v);
        if (!(std::abs(h) < 1)) continue;
        const Vector3 p = along(along(along(c, r * u, frame.u), r * v, frame.v), r * h, frame.w);
        const Vector3 seen = axes(along(surface.info.origin, surface.info.scale, p));
        const std::size_t at = index(seen);
        if (at < depth_.size()) depth_[at] = std::max(depth_[at], seen[2]);
      }
    }
  }

  Frame frame_;
  double cell_ = 1;
  std::size_t columns_ = 0, rows_ = 0;
  std::vector<double> depth_;
};

void appendNumber(std::string& text, const char* format, double value) {
  char digits[64];
  std::snprintf(digits, sizeof(digits), format, value);
  std::replace(digits, digits + sizeof(digits), ',', '.');  // independent of the locale
  text += digits;
}

/** The stretches of one line that are seen, as paths. */
class Painter {
 public:
  Painter(const CrestLines& lines, const Axes& axes, const Frame& frame, const DepthMap* map,
          double zoom)
      : lines_(lines), axes_(axes), frame_(frame), map_(map), zoom_(zoom) {}

  /** \param[in] color 0: what shows as a ridge, 1: as a ravine. */
  std::string paths(std::size_t line, std::size_t color) const {
    std::string text;
    const std::size_t begin = lines_.line_begin[line], n = lines_.line_begin[line + 1] - begin;
    bool drawing = false;
    for (std::size_t i = 0; i < n + lines_.closed[line]; ++i) {
      const std::size_t v = begin + i % n;
      const Vector3 p = axes_(lines_.position[v]);
      const Vector3 normal = {lines_.normal[v][0], lines_.normal[v][1], lines_.normal[v][2]};
      const double facing = dot(normal, axes_.toward);
      const std::size_t shown = static_cast<std::size_t>(lines_.type[line]) ^ (facing < 0 ? 1 : 0);
      if (shown != color || (map_ != nullptr && map_->hides(p, lines_.radius[v], facing))) {
        drawing = false;
        continue;
      }
      text += drawing ? "L" : "M";
      appendNumber(text, "%.2f", kMargin + zoom_ * (p[0] - frame_.low[0]));
      appendNumber(text, " %.2f", kMargin + zoom_ * (frame_.high[1] - p[1]));
      drawing = true;
    }
    return text;
  }

 private:
  const CrestLines& lines_;
  const Axes& axes_;
  const Frame& frame_;
  const DepthMap* map_;
  double zoom_;
};

Frame frameOf(const CrestLines& lines, const CrestView& view, const Axes& axes) {
  Frame frame;
  for (const auto& p : lines.position) frame.add(axes(p), 0);
  if (view.surface == nullptr) return frame;
  const SurfaceInfo& info = view.surface->info;
  for (std::size_t i = 0; i < view.surface->size(); ++i) {
    if (!view.surface->isLeaf(i)) continue;
    const Vector3 c = {view.surface->cx[i], view.surface->cy[i], view.surface->cz[i]};
    frame.add(axes(along(info.origin, info.scale, c)), 0);
  }
  return frame;
}

}  // namespace

std::string crestSvg(const CrestLines& lines, const CrestView& view) {
  const Axes axes(view);
  const Frame frame = frameOf(lines, view, axes);
  const double zoom = view.width / frame.side();
  DepthMap* map = nullptr;
  std::vector<DepthMap> maps;
  if (view.surface != nullptr) {
    maps.emplace_back(*view.surface, axes, frame);
    map = &maps.front();
  }
  const Painter painter(lines, axes, frame, map, zoom);
  std::string text = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"";
  appendNumber(text, "%.0f", 2 * kMargin + zoom * (frame.high[0] - frame.low[0]));
  appendNumber(text, "\" height=\"%.0f", 2 * kMargin + zoom * (frame.high[1] - frame.low[1]));
  text += "\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n";
  for (const std::size_t color : {1, 0}) {
    text += "<g fill=\"none\" stroke=\"" + std::string(kColors[color]);
    appendNumber(text, "\" stroke-width=\"%.2f", view.line_width);
    text += "\" stroke-linecap=\"round\" stroke-linejoin=\"round\">\n";
    for (std::size_t line = 0; line < lines.numLines(); ++line) {
      const std::string path = painter.paths(line, color);
      if (!path.empty()) text += "<path d=\"" + path + "\"/>\n";
    }
    text += "</g>\n";
  }
  return text + "</svg>\n";
}

namespace {

Error saveCrestPly(const std::string& path, const CrestLines& lines) {
  Result<std::vector<unsigned char>> made = formatPly(toPointFile(lines));
  if (!made) return made.error();
  std::vector<unsigned char>& bytes = *made;
  std::size_t edges = 0;
  const std::size_t body = bytes.size();
  for (std::size_t line = 0; line < lines.numLines(); ++line) {
    const auto path_of_line = pathOf(lines, line);
    for (std::size_t i = 0; i + 1 < path_of_line.size(); ++i, ++edges) {
      const std::int32_t ends[2] = {static_cast<std::int32_t>(path_of_line[i]),
                                    static_cast<std::int32_t>(path_of_line[i + 1])};
      bytes.resize(bytes.size() + sizeof(ends));
      std::memcpy(bytes.data() + body + edges * sizeof(ends), ends, sizeof(ends));
    }
  }
  static const std::string kEnd = "end_header\n";
  const auto end = std::search(bytes.begin(), bytes.end(), kEnd.begin(), kEnd.end());
  const std::string element =
      "element edge " + std::to_string(edges) + "\nproperty int vertex1\nproperty int vertex2\n";
  bytes.insert(end, element.begin(), element.end());
  return writeFile(path, bytes.data(), bytes.size());
}

}  // namespace

Error checkCrestExtension(const std::string& path) {
  const std::string extension = lowerExtension(path);
  for (const char* known : {".vtp", ".ply", ".pcd", ".svg"}) {
    if (extension == known) return {};
  }
  return {ErrorCode::kBadArgument, "'" + path + "' must be named .vtp, .ply, .pcd or .svg"};
}

Error saveCrestLines(const std::string& path, const CrestLines& lines, const CrestView& view) {
  if (Error error = checkCrestExtension(path)) return error;
  if (Error error = lines.validate()) return error;
  const std::string extension = lowerExtension(path);
  if (extension == ".vtp") return saveCrestVtp(path, lines);
  if (extension == ".ply") return saveCrestPly(path, lines);
  if (extension == ".pcd") return savePointFile(path, toPointFile(lines));
  if (!(length(cross(view.toward_viewer, view.up)) > 0)) {
    return {ErrorCode::kBadArgument,
            "the view goes along its own up direction, or one of them is 0; change one"};
  }
  const std::string text = crestSvg(lines, view);
  return writeFile(path, text.data(), text.size());
}

}  // namespace pcl_slim
