// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/render/picture_lines.h"

#include <cmath>

#include "lines/contours.h"
#include "lines/line_fields.h"
#include "pcl_slim/core/parallel.h"

namespace pcl_slim {

using namespace detail;

Error
PictureLineParams::validate() const
{
  if (!(crest_curvature > 0) || !std::isfinite(crest_curvature))
    return {ErrorCode::kBadArgument, "the least curvature of a crest line must be above 0"};
  if (!(suggestive_derivative > 0) || !std::isfinite(suggestive_derivative))
    return {ErrorCode::kBadArgument,
            "the least derivative of a suggestive contour must be above 0"};
  if (!(min_length >= 0)) return {ErrorCode::kBadArgument, "the least length must be 0 or more"};
  return {};
}

unsigned
pictureLineColumns(const PictureLineParams& params)
{
  return params.crest || params.suggestive ? kGradientColumn | kHessianColumn | kLeafColumns : 0u;
}

namespace {

Error
checkBuffer(const GBuffer& buffer, const Camera& camera, const PictureLineParams& params)
{
  if (buffer.width != camera.size.width || buffer.height != camera.size.height)
    return {
        ErrorCode::kBadArgument,
        "the G-buffer and the camera differ in size; find lines with the camera it was made by"};
  const std::size_t n = buffer.numPixels();
  const bool bent = buffer.hessian.size() == n && buffer.gradient.size() == n;
  if ((params.crest || params.suggestive) && !(bent && buffer.radius.size() == n))
    return {ErrorCode::kBadArgument,
            "the G-buffer lacks columns; render it with those of pictureLineColumns()"};
  return {};
}

}  // namespace

Result<std::vector<PictureLine>>
findPictureLines(const GBuffer& buffer, const Camera& camera, const SLIMSurface& surface,
                 const PictureLineParams& params)
{
  if (Error error = params.validate()) return error;
  if (Error error = camera.validate()) return error;
  if (Error error = checkBuffer(buffer, camera, params)) return error;
  const int threads = resolveThreads(params.threads);
  const PixelGeometry geometry(buffer, camera, surface);
  const double unit = 1.0 / geometry.diagonal();
  std::vector<PictureLine> lines;
  const auto keep = [&](const ZeroTracer& tracer, int field_kind, PictureLineKind kind) {
    keepStrong(tracer.lines(field_kind, params.min_length, threads), kind, params.min_length,
               lines);
  };
  if (params.suggestive) {
    const auto least = static_cast<float>(params.suggestive_derivative * unit * unit);
    const RadialField field(geometry, least, threads);
    keep(ZeroTracer(field, threads), 1, PictureLineKind::kSuggestive);
  }
  if (params.crest) {
    const auto least = static_cast<float>(params.crest_curvature * unit);
    const CrestField field(geometry, least, threads);
    const ZeroTracer tracer(field, threads);
    keep(tracer, CrestField::kRavine, PictureLineKind::kRavine);
    keep(tracer, CrestField::kRidge, PictureLineKind::kRidge);
  }
  if (params.contour) traceContours(geometry, params.min_length, threads, lines);
  return lines;
}

}  // namespace pcl_slim
