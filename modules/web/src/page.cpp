// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/web/page.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "page_columns.h"
#include "pcl_slim/core/base64.h"
#include "pcl_slim/leaf/detail/gates.h"
#include "pcl_slim/render/color_map.h"
#include "pcl_slim/render/detail/bar_text.h"
#include "pcl_slim/render/detail/frame_constants.h"
#include "pcl_slim/render/detail/light.h"
#include "pcl_slim/render/detail/ticks.h"
#include "pcl_slim/render/surface_renderer.h"
#include "pcl_slim/web/web_surface.h"

namespace pcl_slim {

using namespace detail;

namespace detail {

// The page without its data, an array that web/bundle.cmake makes.
extern const unsigned char kViewer[];
extern const std::size_t kViewerBytes;

}  // namespace detail

namespace {

constexpr int kStillSize = 240;  ///< pixels along the longer side of the still picture
constexpr int kRangeSize = 400;  ///< the same of the frame that automatic ranges are taken from

/** \brief Writes a JSON object, member by member. */
class JsonText {
 public:
  void member(const std::string& name, const std::string& json) {
    text_ += (text_.empty() ? "" : ",") + quoted(name) + ":" + json;
  }

  std::string object() const { return "{" + text_ + "}"; }

  /** \param[in] digits significant ones; 17 give every double back */
  static std::string number(double value, int digits = 17) {
    char text[40];
    std::snprintf(text, sizeof text, "%.*g", digits, value);
    return text;
  }

  static std::string boolean(bool value) { return value ? "true" : "false"; }

  /** \brief A list of numbers from anything that a range-based loop takes. */
  template <typename Numbers>
  static std::string numbers(const Numbers& values, int digits = 17) {
    std::string text;
    for (const auto value : values) {
      text += (text.empty() ? "" : ",") + number(static_cast<double>(value), digits);
    }
    return "[" + text + "]";
  }

  /** \brief A string; what could end the page's script is written as its code. */
  static std::string quoted(const std::string& words) {
    std::string text = "\"";
    for (const char c : words) {
      if (static_cast<unsigned char>(c) < 0x20 || c == '"' || c == '\\' || c == '<') {
        char code[8];
        std::snprintf(code, sizeof code, "\\u%04x", static_cast<unsigned>(c));
        text += code;
      } else {
        text += c;
      }
    }
    return text + "\"";
  }

 private:
  std::string text_;
};

std::string htmlText(const std::string& words) {
  std::string text;
  for (const char c : words) {
    if (c == '&') {
      text += "&amp;";
    } else if (c == '<') {
      text += "&lt;";
    } else {
      text += c;
    }
  }
  return text;
}

/** \brief Colours at even steps over a map's range. */
template <typename ColorAt>
std::string colorTable(int count, double low, const ColorAt& colorAt) {
  std::string text;
  for (int i = 0; i < count; ++i) {
    const Color color = colorAt(low + (1.0 - low) * i / (count - 1.0));
    text += (i == 0 ? "" : ",") + JsonText::numbers(color, 4);
  }
  return "[" + text + "]";
}

/** \brief The colours of color_map.h: linear between 7 or 5 of them. */
std::string colorTables() {
  JsonText tables;
  tables.member("diverging", colorTable(7, -1.0, divergingColor));
  tables.member("perceptual", colorTable(7, 0.0, perceptualColor));
  tables.member("size", colorTable(5, 0.0, sizeColor));
  tables.member("category", colorTable(10, 0.0, [](double x) {
                  return categoryColor(static_cast<std::uint32_t>(std::lround(9.0 * x)));
                }));
  return tables.object();
}

std::string constants() {
  JsonText json;
  for (const FrameConstant& c : kFrameConstants) json.member(c.name, JsonText::number(c.value));
  for (const LightConstant& c : kLightConstants) {
    json.member(c.name, c.count > 1 ? JsonText::numbers(c.value) : JsonText::number(c.value[0]));
  }
  json.member("kMaxLayers", JsonText::number(kMaxLayers));
  json.member("kColorGate", JsonText::number(kColorGate));
  json.member("kOtherSheet", JsonText::number(kOtherSheet));
  json.member("kTextureReach", JsonText::number(SurfelTexture::kReach));
  json.member("kTextureOuterWeight", JsonText::number(SurfelTexture::kOuterWeight));
  return json.object();
}

std::string cameraJson(const Camera& camera) {
  JsonText json;
  json.member("position", JsonText::numbers(camera.position));
  json.member("look_at", JsonText::numbers(camera.look_at));
  json.member("up", JsonText::numbers(camera.up));
  json.member("aspect", JsonText::number(double(camera.size.width) / camera.size.height));
  const bool parallel = camera.projection == Camera::Projection::kOrthographic;
  json.member(parallel ? "height" : "fov",
              JsonText::number(parallel ? camera.view_height : camera.fov));
  return json.object();
}

std::string mapName(ColorMap map) {
  return map == ColorMap::kDiverging    ? "diverging"
         : map == ColorMap::kPerceptual ? "perceptual"
                                        : "auto";
}

void replace(std::string& text, const std::string& mark, const std::string& value) {
  const std::size_t at = text.find(mark);
  if (at != std::string::npos) text.replace(at, mark.size(), value);
}

/** \brief What the viewer takes from the command line and from the C++ renderer's tables. */
JsonText pageOptions(const Camera& camera, const ShadingParams& shading, const PageParams& params) {
  JsonText json;
  json.member("camera", cameraJson(camera));
  json.member("turn", JsonText::numbers(params.up));
  json.member("mode", JsonText::quoted(nameOf(shading.mode)));
  if (shading.range[0] < shading.range[1]) json.member("range", JsonText::numbers(shading.range));
  json.member("map", JsonText::quoted(mapName(shading.map)));
  json.member("unit", JsonText::quoted(shading.unit));
  json.member("lighting", JsonText::boolean(shading.lighting));
  json.member("ao", JsonText::number(shading.ambient_occlusion));
  json.member("white", JsonText::boolean(!shading.gradient_background));
  json.member("colors", colorTables());
  json.member("constants", constants());
  return json;
}

/** \brief What is packed into a page, each part deflated. */
struct PageParts {
  std::vector<unsigned char> data;   ///< the model
  std::vector<unsigned char> lines;  ///< packLines()
  std::vector<std::uint8_t> still;   ///< picture as PNG, or empty
};

std::string cssColor(const Color& color) {
  const auto bytes = bytesOf(color);
  char text[8];
  std::snprintf(text, sizeof text, "#%02x%02x%02x", bytes[0], bytes[1], bytes[2]);
  return text;
}

/** \brief The colours of deviations from low to high, as stops of a CSS gradient: grey between
 * minus and plus the level of detection. */
std::string legendGradient(const DeviationScale& scale) {
  constexpr int kStops = 8;  // to each side: the map is linear between seven colours
  const double level = std::min(scale.level, scale.range);
  std::string text;
  const auto stop = [&](double value, const Color& color) {
    text +=
        "," + cssColor(color) + " " + JsonText::number(50.0 * (1.0 + value / scale.range), 6) + "%";
  };
  for (int i = kStops; i >= 0; --i) {
    const double value = -level - (scale.range - level) * i / kStops;
    stop(value, deviationColor(scale, value));
  }
  for (const double end : {-level, level}) stop(end, insignificantColor());
  for (int i = 0; i <= kStops; ++i) {
    const double value = level + (scale.range - level) * i / kStops;
    stop(value, deviationColor(scale, value));
  }
  return "linear-gradient(to right" + text + ")";
}

/** \brief What the colours of deviations mean, below the page's title. */
std::string legendHtml(const DeviationScale& scale) {
  std::string html = "<div id=key>deviation, " +
                     htmlText(scale.unit.empty() ? "length" : scale.unit) +
                     "<div class=colors style=\"background:" + legendGradient(scale) +
                     "\"></div><div class=ticks>";
  for (const double tick : roundTicks(-scale.range, scale.range, false)) {
    html += "<span style=\"left:" + JsonText::number(50.0 * (1.0 + tick / scale.range), 4) +
            "%\">" + (tick > 0.0 ? "+" : "") + printedTick(tickText(tick)) + "</span>";
  }
  html +=
      "</div><i style=\"background:" + cssColor(insignificantColor()) +
      "\"></i><span>not significant</span><i style=\"background:" + cssColor(noCounterpartColor()) +
      "\"></i><span>no counterpart</span><div>level of detection " + levelText(scale) +
      "</div></div>";
  return html;
}

/** \brief Fills the viewer's text, its script deflated. */
Result<std::string> fillPage(const PageParams& params, JsonText options, const PageParts& parts) {
  std::string page(kViewer, kViewer + kViewerBytes);
  const std::string mark = "<!--viewer-->";
  const std::size_t begin = page.find(mark), code = begin + mark.size(),
                    end = page.find(mark, code);
  const auto script = gzip({page.begin() + static_cast<std::ptrdiff_t>(code),
                            page.begin() + static_cast<std::ptrdiff_t>(end)});
  if (!script) return script.error();
  page.replace(begin, end + mark.size() - begin, base64(script->data(), script->size()));
  replace(page, "<!--title-->", htmlText(params.title));
  replace(page, "<!--heading-->", htmlText(params.title));
  replace(page, "<!--legend-->", params.deviations ? legendHtml(*params.deviations) : "");
  if (!parts.still.empty()) {
    replace(page, "<!--still-->",
            "<img id=still alt=\"\" src=\"data:image/png;base64," +
                base64(parts.still.data(), parts.still.size()) + "\">");
  }
  options.member("bytes", std::to_string(parts.data.size()));
  options.member("lineBytes", std::to_string(parts.lines.size()));
  replace(page, "<!--options-->", options.object());
  replace(page, "<!--lines-->", base64(parts.lines.data(), parts.lines.size()));
  replace(page, "<!--data-->", base64(parts.data.data(), parts.data.size()));
  return page;
}

/** \brief The picture that a page shows before, and instead of, its viewer: as PNG, in few colours.
 */
std::vector<std::uint8_t> stillPicture(Image image) {
  constexpr int kStep = 8;  // of 256: a third of the bytes
  for (std::uint8_t& channel : image.rgb) {
    channel = static_cast<std::uint8_t>(std::min(255, (channel + kStep / 2) / kStep * kStep));
  }
  auto bytes = encodePng(image);
  return bytes ? std::move(*bytes) : std::vector<std::uint8_t>();
}

/** \brief The same camera for a picture whose longer side is at most `longest` pixels. */
Camera smallCamera(Camera camera, int longest) {
  const double shrink =
      std::max({1.0, camera.size.width / double(longest), camera.size.height / double(longest)});
  camera.size.width = std::max(1, static_cast<int>(camera.size.width / shrink));
  camera.size.height = std::max(1, static_cast<int>(camera.size.height / shrink));
  return camera;
}

/** \brief The ranges that pictures of this view have in each mode. */
Result<std::string> rangesSeen(SurfaceRenderer& renderer, const Camera& camera,
                               const RenderParams& rendering, ShadingParams shading) {
  GBuffer buffer;
  if (Error error = renderer.render(smallCamera(camera, kRangeSize), rendering, buffer))
    return error;
  JsonText ranges;
  shading.range = {};
  for (const ShadingMode mode :
       {ShadingMode::kMean, ShadingMode::kGaussian, ShadingMode::kKMax, ShadingMode::kKMin,
        ShadingMode::kLevel, ShadingMode::kSize, ShadingMode::kError}) {
    shading.mode = mode;
    const ShadingRange range = rangeOf(buffer, shading, renderer.surface().info.scale);
    ranges.member(nameOf(mode), JsonText::numbers(std::array<double, 2>{range.low, range.high}, 6));
  }
  return ranges.object();
}

}  // namespace

Result<std::string> encodePage(const SLIMSurface& surface, const Camera& camera,
                               const RenderParams& rendering, const ShadingParams& shading,
                               const PageParams& params) {
  if (params.deviations) {
    if (Error error = params.deviations->validate()) return error;
  }
  if (!rendering.cuts.empty()) {
    return Error{ErrorCode::kBadArgument,
                 "a page shows a whole surface with blended derivatives; leave out cuts"};
  }
  auto data = encodeWebSurface(surface, params.precision, params.color_error);
  if (!data) return data.error();
  auto lines = packLines(params.lines, surface.info.origin, surface.info.scale);
  if (!lines) return lines.error();
  SurfaceRenderer renderer(surface, rendering.threads);
  RenderParams all = rendering;
  all.columns = kAllColumns;
  const auto ranges = rangesSeen(renderer, camera, all, shading);
  if (!ranges) return ranges.error();
  ShadingParams plain = shading;
  plain.color_bar = false;
  plain.gradient_background = false;
  auto still = renderPicture(renderer, smallCamera(camera, kStillSize), rendering, plain);
  if (!still) return still.error();

  JsonText options = pageOptions(camera, shading, params);
  const bool front = rendering.sides == VisibleSides::kFront ||
                     (rendering.sides == VisibleSides::kAuto && surface.info.hasFront());
  options.member("kind", "\"surface\"");
  options.member("front", JsonText::boolean(front));
  options.member("cutFront", JsonText::boolean(rendering.sides == VisibleSides::kFront));
  options.member("trim", JsonText::boolean(rendering.trim));
  options.member("near", JsonText::number(rendering.near_plane));
  options.member("lod", JsonText::number(rendering.lod));
  options.member("points", std::to_string(surface.info.num_points));
  options.member("ranges", *ranges);
  return fillPage(params, options,
                  {std::move(*data), std::move(*lines), stillPicture(std::move(*still))});
}

Result<std::string> encodePage(const SplatSet& splats, const Camera& camera,
                               const DiscRenderParams& rendering, const ShadingParams& shading,
                               const PageParams& params) {
  if (params.deviations) {
    if (Error error = params.deviations->validate()) return error;
  }
  ShadingParams plain = shading;
  plain.color_bar = false;
  plain.gradient_background = false;
  auto still = renderPicture(splats, smallCamera(camera, kStillSize), rendering, plain);
  if (!still) return still.error();
  auto data = packSplats(splats);
  if (!data) return data.error();
  auto lines = packLines(params.lines, splats.origin, 1.0);
  if (!lines) return lines.error();

  GBuffer buffer;
  if (Error error = renderDiscs(splats, smallCamera(camera, kRangeSize), rendering, buffer)) {
    return error;
  }
  ShadingParams size = shading;
  size.mode = ShadingMode::kSize;
  size.range = {};
  const ShadingRange range = rangeOf(buffer, size, 1.0);
  JsonText ranges, options = pageOptions(camera, shading, params);
  ranges.member("size", JsonText::numbers(std::array<double, 2>{range.low, range.high}, 6));
  options.member("kind", "\"splats\"");
  const std::string front = JsonText::boolean(rendering.sides == VisibleSides::kFront);
  options.member("front", front);
  options.member("cutFront", front);
  options.member("near", JsonText::number(rendering.near_plane));
  options.member("lod", "0");
  options.member("ranges", ranges.object());
  return fillPage(params, options,
                  {std::move(*data), std::move(*lines), stillPicture(std::move(*still))});
}

}  // namespace pcl_slim
