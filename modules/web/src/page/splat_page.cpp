// SPDX-License-Identifier: BSD-3-Clause
#include "columns/gzip.h"
#include "columns/pack_splats.h"
#include "page/page_text.h"
#include "pcl_slim/web/page.h"

namespace pcl_slim {

using namespace detail;

Result<std::string>
encodePage(const SplatSet& splats, const Camera& camera, const DiscRenderParams& rendering,
           const ShadingParams& shading, const PageParams& params)
{
  ShadingParams plain = shading;
  plain.color_bar = false;
  plain.gradient_background = false;
  auto still = renderPicture(splats, smallCamera(camera, kStillSize), rendering, plain);
  if (!still) return still.error();
  auto data = gzip(packSplats(splats));
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
  options.member("front", JsonText::boolean(rendering.sides == VisibleSides::kFront));
  options.member("near", JsonText::number(rendering.near_plane));
  options.member("lod", "0");
  options.member("ranges", ranges.object());
  return fillPage(params.title, options,
                  {std::move(*data), std::move(*lines), stillPicture(std::move(*still))});
}

}  // namespace pcl_slim
