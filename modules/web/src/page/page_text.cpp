// SPDX-License-Identifier: BSD-3-Clause
#include "page/page_text.h"

#include <algorithm>
#include <cmath>

#include "columns/gzip.h"
#include "page/viewer_text.h"
#include "pcl_slim/core/base64.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/query/detail/color_rules.h"
#include "pcl_slim/render/color_map.h"
#include "pcl_slim/render/detail/frame_constants.h"

namespace pcl_slim::detail {
namespace {

std::string
htmlText(const std::string& words)
{
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
std::string
colorTable(int count, double low, const ColorAt& colorAt)
{
  std::string text;
  for (int i = 0; i < count; ++i) {
    const Color color = colorAt(low + (1.0 - low) * i / (count - 1.0));
    text += (i == 0 ? "" : ",") + JsonText::numbers(color, 4);
  }
  return "[" + text + "]";
}

/** \brief The colours of color_map.h: linear between 7 or 5 of them. */
std::string
colorTables()
{
  JsonText tables;
  tables.member("diverging", colorTable(7, -1.0, divergingColor));
  tables.member("perceptual", colorTable(7, 0.0, perceptualColor));
  tables.member("size", colorTable(5, 0.0, sizeColor));
  tables.member("category", colorTable(10, 0.0, [](double x) {
                  return categoryColor(static_cast<std::uint32_t>(std::lround(9.0 * x)));
                }));
  return tables.object();
}

std::string
constants()
{
  JsonText json;
  for (const FrameConstant& c : kFrameConstants) json.member(c.name, JsonText::number(c.value));
  json.member("kMaxLayers", JsonText::number(kMaxLayers));
  json.member("kColorGate", JsonText::number(kColorGate));
  json.member("kOtherSheet", JsonText::number(kOtherSheet));
  return json.object();
}

std::string
cameraJson(const Camera& camera)
{
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

std::string
mapName(ColorMap map)
{
  return map == ColorMap::kDiverging    ? "diverging"
         : map == ColorMap::kPerceptual ? "perceptual"
                                        : "auto";
}

void
replace(std::string& text, const std::string& mark, const std::string& value)
{
  const std::size_t at = text.find(mark);
  if (at != std::string::npos) text.replace(at, mark.size(), value);
}

}  // namespace

JsonText
pageOptions(const Camera& camera, const ShadingParams& shading, const PageParams& params)
{
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

Result<std::string>
fillPage(const std::string& title, JsonText options, const PageParts& parts)
{
  std::string page = viewerText();
  const std::string mark = "<!--viewer-->";
  const std::size_t begin = page.find(mark), code = begin + mark.size(),
                    end = page.find(mark, code);
  const auto script = gzip({page.begin() + static_cast<std::ptrdiff_t>(code),
                            page.begin() + static_cast<std::ptrdiff_t>(end)});
  if (!script) return script.error();
  page.replace(begin, end + mark.size() - begin, base64(script->data(), script->size()));
  replace(page, "<!--title-->", htmlText(title));
  replace(page, "<!--heading-->", htmlText(title));
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

std::vector<std::uint8_t>
stillPicture(Image image)
{
  constexpr int kStep = 8;  // of 256: a third of the bytes
  for (std::uint8_t& channel : image.rgb) {
    channel = static_cast<std::uint8_t>(std::min(255, (channel + kStep / 2) / kStep * kStep));
  }
  auto bytes = encodePng(image);
  return bytes ? std::move(*bytes) : std::vector<std::uint8_t>();
}

Camera
smallCamera(Camera camera, int longest)
{
  const double shrink =
      std::max({1.0, camera.size.width / double(longest), camera.size.height / double(longest)});
  camera.size.width = std::max(1, static_cast<int>(camera.size.width / shrink));
  camera.size.height = std::max(1, static_cast<int>(camera.size.height / shrink));
  return camera;
}

}  // namespace pcl_slim::detail
