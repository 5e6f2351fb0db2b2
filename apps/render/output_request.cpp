// SPDX-License-Identifier: BSD-3-Clause
// What pcl_slim_render makes beside a plain picture: lines over it, or a page in place of it; and
// which options have no effect on what is made.
#include "render/output_request.h"

#include <algorithm>

#include "pcl_slim/core/file_access.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/filters/io/point_file.h"

namespace pcl_slim {

namespace {

/** A line whose ends are as near to each other as its vertices do is closed. */
void close(SpaceLine& line) {
  double length = 0;
  for (std::size_t i = 1; i < line.points.size(); ++i)
    length += pcl_slim::length(subtract(line.points[i], line.points[i - 1]));
  const double step = length / static_cast<double>(line.points.size());
  const double gap = pcl_slim::length(subtract(line.points.front(), line.points.back()));
  if (line.points.size() > 3 && gap < 1.5 * step) line.points.push_back(line.points.front());
}

/** Lines of a file that pcl_slim_lines wrote: neighbours of one line number are neighbours. */
Result<std::vector<SpaceLine>> loadLines(const std::string& path) {
  const auto file = loadPointFile(path);
  if (!file) return file.error();
  const PointTable& cloud = file->cloud;
  std::vector<PointField> fields;
  for (const char* name : {"x", "y", "z", "line", "type"}) {
    const int index = findField(cloud, name);
    if (index < 0) {
      return Error{ErrorCode::kBadInput,
                   path + " has no field " + name + "; name a .pcd or .ply file of pcl_slim_lines"};
    }
    fields.push_back(cloud.fields[static_cast<std::size_t>(index)]);
  }
  std::vector<SpaceLine> lines;
  double last = -1;
  for (std::size_t i = 0; i < numPoints(cloud); ++i) {
    const auto value = [&](std::size_t f) { return fieldValue(cloud, i, fields[f]); };
    if (lines.empty() || value(3) != last) lines.emplace_back();
    last = value(3);
    lines.back().kind = value(4) == 0 ? PictureLineKind::kRidge : PictureLineKind::kRavine;
    lines.back().points.push_back({value(0), value(1), value(2)});
  }
  for (SpaceLine& line : lines) close(line);
  return lines;
}

}  // namespace

void LineRequest::declare(OptionTable& table) {
  table.choice("lines", &lines, {"none", "crest", "suggestive", "contour", "all"},
               "lines over the picture; none with -mode sketch: all");
  table.text("line_file", &file, "FILE.pcd|.ply",
             "lines of pcl_slim_lines to draw where they are seen", FileUse::kRead);
  table.number("line_width", &width, 0.1, 100, "width of strong lines, pixels");
  table.number("line_curvature", &curvature, 1e-6, 1e9,
               "least curvature of crest lines, 1/L; auto: by their integral of it", "auto");
  table.number("line_slope", &slope, 1e-6, 1e12,
               "least growth of radial curvature on suggestive contours, 1/L^2; auto: likewise",
               "auto");
  table.number("line_length", &length, 0, 1e6, "least length of a line, pixels");
}

void LineRequest::applyMode(PictureRequest& colors) {
  crest = colors.mode == "crest";
  contours = colors.mode == "contours";
  sketch = colors.mode == "sketch";
  if (crest || contours) colors.mode = "shaded";
  if (!sketch) return;
  // The surface under white paper need not be smooth.
  colors.mode = "shaded";
  colors.supersampling = 1;
  colors.occlusion = 0;
}

Error LineRequest::load() {
  if (file.empty()) return {};
  auto loaded = loadLines(file);
  if (!loaded) return loaded.error();
  in_space_ = std::move(*loaded);
  return {};
}

PictureLineParams LineRequest::finding(int threads) const {
  PictureLineParams params;
  const bool all = lines == "all" || (sketch && lines == "none" && file.empty());
  params.crest = all || crest || lines == "crest";
  params.suggestive = all || contours || lines == "suggestive";
  params.contour = all || contours || sketch || lines == "contour";
  params.crest_curvature = curvature;
  params.suggestive_derivative = slope;
  params.min_length = length;
  params.threads = threads;
  return params;
}

Error LineRequest::draw(SurfaceRenderer& renderer, const Camera& camera, RenderParams rendering,
                        Image& image, std::size_t& count) const {
  const PictureLineParams params = finding(rendering.threads);
  rendering.columns = pictureLineColumns(params);
  GBuffer buffer;
  if (Error error = renderer.render(camera, rendering, buffer)) return error;
  auto found = findPictureLines(buffer, camera, renderer.surface(), params);
  if (!found) return found.error();
  auto seen = projectLines(in_space_, buffer, camera, renderer.surface());
  if (!seen) return seen.error();
  found->insert(found->end(), seen->begin(), seen->end());
  if (sketch) std::fill(image.rgb.begin(), image.rgb.end(), std::uint8_t{255});
  count = found->size();
  LineStyle style;
  style.width = width;
  return drawLines(*found, style, image);
}

namespace {

Error refused(const std::string& option, const std::string& why) {
  return {ErrorCode::kBadArgument, option + " " + why};
}

}  // namespace

void PageRequest::declare(OptionTable& table) {
  table.number("precision", &precision, 0.0, 65536.0,
               "of a page: steps of a coefficient per radius, 16 or more; 0: nothing is rounded");
  table.integer("color_error", &color_error, 0, 32,
                "of a page: greatest change of a texture's red, green or blue, of 255; 0: none");
}

bool PageRequest::isPage(const std::string& output) {
  const std::string extension = lowerExtension(output);
  return extension == ".html" || extension == ".htm";
}

Error PageRequest::check(const OptionTable& table, const std::string& output,
                         const std::string& mode) {
  if (!isPage(output)) {
    for (const char* name : {"precision", "color_error"}) {
      if (table.given(name)) {
        return refused("-" + std::string(name), "is for pages: name an output that ends in .html");
      }
    }
    return {};
  }
  for (const char* name : {"size", "bar", "turntable", "region", "aa", "lines", "line_width",
                           "line_curvature", "line_slope", "line_length", "lights", "filtered"}) {
    if (table.given(name)) {
      return refused("-" + std::string(name), "means nothing in a page: leave it out");
    }
  }
  if (mode != "auto" && !shadingModeOf(mode)) {
    return refused("-mode " + mode, "cannot be shown in a page: name another mode");
  }
  return {};
}

std::string PageRequest::titleOf(const std::string& input) {
  const std::size_t folder = input.find_last_of('/');
  const std::string name = folder == std::string::npos ? input : input.substr(folder + 1);
  return name.substr(0, name.size() - lowerExtension(name).size());
}

namespace {

/** Options that change nothing where the rule applies, and why. */
struct Rule {
  bool applies;
  std::vector<const char*> names;
  const char* why;
};

/** Of the colours: the first rule that names an option gives the reason. */
std::vector<Rule> colorRules(const DrawnThing& d) {
  const ShadingMode mode = d.shading.mode;
  const bool plain = mode == ShadingMode::kNormal || mode == ShadingMode::kReflection;
  const bool traced = d.picture.isTraced(), picture = !d.is_page && !traced;
  return {
      {traced,
       {"range", "map", "bar", "unit", "lighting", "lod"},
       "-mode raytraced does not use it"},
      {!traced, {"lights"}, "only -mode raytraced has lights"},
      {d.lines.sketch, {"ao", "aa", "lighting", "white"}, "-mode sketch draws lines on white"},
      {!showsNumbers(mode), {"range"}, "the mode shows no numbers"},
      {picture && !showsNumbers(mode), {"map", "unit"}, "the mode shows no numbers"},
      {picture && !hasColorBar(mode), {"bar"}, "the mode shows no numbers"},
      {picture && !d.picture.bar, {"unit"}, "only -bar names it"},
      {plain, {"lighting"}, "the mode has no light"},
      {picture && (plain || !d.shading.lighting), {"ao"}, "nothing is lit"},
  };
}

/** Of what is drawn. */
std::vector<Rule> objectRules(const DrawnThing& d) {
  const PictureLineParams found = d.lines.finding(1);
  return {
      {!d.is_surface, {"hole", "trim", "min_component", "lod"}, "it is for surfaces"},
      {!d.is_splats, {"filtered"}, "it is for splats"},
      {!d.trim, {"hole"}, "-trim 0 keeps no borders"},
      {!d.lines.any(), {"line_width"}, "no lines are drawn; give -lines"},
      {!found.crest, {"line_curvature"}, "no crest lines are drawn"},
      {!found.suggestive, {"line_slope"}, "no suggestive contours are drawn"},
      {!found.crest && !found.suggestive && !found.contour,
       {"line_length"},
       "no lines are looked for"},
  };
}

}  // namespace

std::vector<std::string> idleOptions(const OptionTable& table, const DrawnThing& drawn) {
  std::vector<std::string> notes, named;
  for (const auto& rules : {colorRules(drawn), objectRules(drawn)}) {
    for (const Rule& rule : rules) {
      for (const std::string name : rule.names) {
        const bool again = std::find(named.begin(), named.end(), name) != named.end();
        if (!rule.applies || again || !table.given(name)) continue;
        named.push_back(name);
        notes.push_back("  -" + name + " has no effect: " + rule.why);
      }
    }
  }
  return notes;
}

}  // namespace pcl_slim
