// SPDX-License-Identifier: BSD-3-Clause
#include "render/picture_request.h"

#include <algorithm>
#include <sstream>
#include <vector>

#include "pcl_slim/core/file_access.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/filters/io/point_file.h"

namespace pcl_slim {

void
PictureRequest::declareColors(OptionTable& table)
{
  table.choice(
      "mode", &mode,
      {"auto", "shaded", "normal", "mean", "gauss", "kmax", "kmin", "level", "size", "error",
       "reflection", "color", "raytraced", "crest", "contours", "sketch"},
      "what the colours show; auto: splats, and surfaces in a page, in their colours if they have "
      "any; others shaded");
  table.text(
      "range", &range_text, "auto|X|LO,HI",
      "values that the colours span, -X to X for curvatures and 0 to X for errors; auto: the "
      "picture's without outliers");
  table.choice("map", &map, {"auto", "diverging", "perceptual"}, "colours of numbers");
  table.toggle("bar", &bar, "draw the colours with their numbers and unit into the picture");
  table.text("unit", &unit, "NAME", "unit of length that -bar names, such as mm");
  table.choice("lighting", &lighting, {"auto", "0", "1"},
               "light on the colours; auto: all but -mode color");
}

void
PictureRequest::declareFinish(OptionTable& table)
{
  table.number("ao", &occlusion, 0.0, 1.0, "strength of the shade in hollows");
  table.toggle("white", &white, "white background");
  table.integer("aa", &supersampling, 1, 8, "N x N rays a pixel");
}

Error
PictureRequest::parse()
{
  if (range_text == "auto") return {};
  std::vector<double> values;
  const bool read = parseNumberList(range_text, values);
  if (read && values.size() == 1 && values[0] > 0.0 && mode != "size") {
    range = {mode == "error" ? 0.0 : -values[0], values[0]};
    return {};
  }
  if (read && values.size() == 2 && values[0] < values[1]) {
    range = {values[0], values[1]};
    return {};
  }
  return {ErrorCode::kBadArgument,
          "-range takes auto, a number above 0 (but for -mode size) or two numbers, the lower one "
          "first, such as -2,5, not '" +
              range_text + "'"};
}

ShadingParams
PictureRequest::shadingFor(bool has_colors, int threads) const
{
  ShadingParams params;
  const std::string automatic = has_colors ? "color" : "shaded";
  params.mode = *shadingModeOf(mode == "auto" || isTraced() ? automatic : mode);
  params.lighting = lighting == "auto" ? params.mode != ShadingMode::kColor : lighting == "1";
  params.range = range;
  params.map = map == "diverging"    ? ColorMap::kDiverging
               : map == "perceptual" ? ColorMap::kPerceptual
                                     : ColorMap::kAuto;
  params.color_bar = bar;
  params.unit = unit;
  params.ambient_occlusion = occlusion;
  params.gradient_background = !white;
  params.supersampling = supersampling;
  params.threads = threads;
  return params;
}

namespace {

/** \brief Reads AZ,EL[,STRENGTH[,RADIUS]]. */
bool
readLight(const std::string& text, TracedRequest::Light& light)
{
  std::vector<double> values;
  if (!parseNumberList(text, values) || values.size() < 2 || values.size() > 4) return false;
  values.resize(4, 0.0);
  constexpr double kUsual = 0.8;  // strength of the stronger of the default lights
  const bool with_strength = text.find(',') != text.rfind(',');
  light = {values[0], values[1], with_strength ? values[2] : kUsual, values[3]};
  return light.strength >= 0.0 && light.spread >= 0.0 && light.spread <= 45.0;
}

}  // namespace

void
TracedRequest::declare(OptionTable& table)
{
  table.text("lights", &lights_text, "auto|AZ,EL[,STRENGTH[,RADIUS]][:...]",
             "lights of -mode raytraced, degrees to the viewer's right and up; a radius in degrees "
             "makes soft shadows; auto: two");
}

Error
TracedRequest::parse()
{
  if (lights_text == "auto") return {};
  std::istringstream all(lights_text);
  bool good = !lights_text.empty() && lights_text.back() != ':';
  for (std::string one; good && std::getline(all, one, ':');) {
    good = readLight(one, lights.emplace_back()) && lights.size() <= 32;
  }
  if (good) return {};
  return {ErrorCode::kBadArgument,
          "-lights takes auto or up to 32 lights AZ,EL[,STRENGTH[,RADIUS]] with colons between, "
          "strengths of 0 or more and radii of 0 to 45, such as -45,40,0.8,1.5:50,20,0.3, not '" +
              lights_text + "'"};
}

std::vector<RayLight>
TracedRequest::lightsFor(const Camera& camera) const
{
  if (lights.empty()) return defaultLights(camera);
  std::vector<RayLight> all;
  for (const Light& light : lights) {
    RayLight& one = all.emplace_back();
    one.towards = lightDirection(camera, light.azimuth, light.elevation);
    one.color.fill(static_cast<float>(light.strength));
    one.spread = light.spread;
  }
  return all;
}

namespace {

/** A line whose ends are as near to each other as its vertices do is closed. */
void
close(SpaceLine& line)
{
  double length = 0;
  for (std::size_t i = 1; i < line.points.size(); ++i)
    length += pcl_slim::length(subtract(line.points[i], line.points[i - 1]));
  const double step = length / static_cast<double>(line.points.size());
  const double gap = pcl_slim::length(subtract(line.points.front(), line.points.back()));
  if (line.points.size() > 3 && gap < 1.5 * step) line.points.push_back(line.points.front());
}

/** Lines of a file that pcl_slim_lines wrote: neighbours of one line number are neighbours. */
Result<std::vector<SpaceLine>>
loadLines(const std::string& path)
{
  const auto file = loadPointFile(path);
  if (!file) return file.error();
  const pcl::PCLPointCloud2& cloud = file->cloud;
  std::vector<pcl::PCLPointField> fields;
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

void
LineRequest::declare(OptionTable& table)
{
  table.choice("lines", &lines, {"none", "crest", "suggestive", "contour", "all"},
               "lines over the picture; none with -mode sketch: all");
  table.text("line_file", &file, "FILE.pcd|.ply",
             "lines of pcl_slim_lines to draw where they are seen");
  table.number("line_width", &width, 0.1, 100, "width of strong lines, pixels");
  table.number("line_curvature", &curvature, 1e-6, 1e9, "least curvature of crest lines, 1/L");
  table.number("line_slope", &slope, 1e-6, 1e12,
               "least growth of radial curvature on suggestive contours, 1/L^2");
  table.number("line_length", &length, 0, 1e6, "least length of a line, pixels");
}

void
LineRequest::applyMode(PictureRequest& colors)
{
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

Error
LineRequest::load()
{
  if (file.empty()) return {};
  auto loaded = loadLines(file);
  if (!loaded) return loaded.error();
  in_space_ = std::move(*loaded);
  return {};
}

PictureLineParams
LineRequest::finding(int threads) const
{
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

Error
LineRequest::draw(SurfaceRenderer& renderer, const Camera& camera, RenderParams rendering,
                  Image& image, std::size_t& count) const
{
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

Error
refused(const std::string& option, const std::string& why)
{
  return {ErrorCode::kBadArgument, option + " " + why};
}

}  // namespace

void
PageRequest::declare(OptionTable& table)
{
  table.number("precision", &precision, 0.0, 65536.0,
               "of a page: steps of a coefficient per radius, 16 or more; 0: nothing is rounded");
}

bool
PageRequest::isPage(const std::string& output)
{
  const std::string extension = lowerExtension(output);
  return extension == ".html" || extension == ".htm";
}

Error
PageRequest::check(const OptionTable& table, const std::string& output, const std::string& mode)
{
  if (!isPage(output)) {
    return table.given("precision")
               ? refused("-precision", "is for pages: name an output that ends in .html")
               : Error{};
  }
  for (const char* name :
       {"size", "bar", "turntable", "region", "aa", "lines", "line_width", "line_curvature",
        "line_slope", "line_length", "skip", "repeat", "lights", "filtered"}) {
    if (table.given(name)) {
      return refused("-" + std::string(name), "means nothing in a page: leave it out");
    }
  }
  if (mode != "auto" && !shadingModeOf(mode)) {
    return refused("-mode " + mode, "cannot be shown in a page: name another mode");
  }
  return {};
}

std::string
PageRequest::titleOf(const std::string& input)
{
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
std::vector<Rule>
colorRules(const DrawnThing& d)
{
  const ShadingMode mode = d.shading.mode;
  const bool plain = mode == ShadingMode::kNormal || mode == ShadingMode::kReflection;
  const bool traced = d.picture.isTraced(), picture = !d.is_page && !traced;
  return {
      {traced,
       {"range", "map", "bar", "unit", "lighting", "lod", "repeat"},
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
std::vector<Rule>
objectRules(const DrawnThing& d)
{
  const PictureLineParams found = d.lines.finding(1);
  return {
      {d.is_splats, {"hole", "trim", "lod", "repeat"}, "it is for surfaces"},
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

std::vector<std::string>
idleOptions(const OptionTable& table, const DrawnThing& drawn)
{
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
