// SPDX-License-Identifier: BSD-3-Clause
#include "page/page_text.h"
#include "pcl_slim/render/surface_renderer.h"
#include "pcl_slim/web/page.h"
#include "pcl_slim/web/web_surface.h"

namespace pcl_slim {

using namespace detail;
namespace {

/** \brief The ranges that pictures of this view have in each mode. */
Result<std::string>
rangesSeen(SurfaceRenderer& renderer, const Camera& camera, const RenderParams& rendering,
           ShadingParams shading)
{
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

Result<std::string>
encodePage(const SLIMSurface& surface, const Camera& camera, const RenderParams& rendering,
           const ShadingParams& shading, const PageParams& params)
{
  if (!rendering.cuts.empty() || rendering.derivatives != Derivatives::kBlended) {
    return Error{ErrorCode::kBadArgument,
                 "a page shows a whole surface with blended derivatives; leave out cuts"};
  }
  auto data = encodeWebSurface(surface, params.precision);
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
  options.member("trim", JsonText::boolean(rendering.trim));
  options.member("near", JsonText::number(rendering.near_plane));
  options.member("lod", JsonText::number(rendering.lod));
  options.member("points", std::to_string(surface.info.num_points));
  options.member("ranges", *ranges);
  return fillPage(params.title, options,
                  {std::move(*data), std::move(*lines), stillPicture(std::move(*still))});
}

}  // namespace pcl_slim
