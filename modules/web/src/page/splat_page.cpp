// SPDX-License-Identifier: BSD-3-Clause
#include <vector>

#include "columns/center_cells.h"
#include "columns/gzip.h"
#include "columns/web_header.h"
#include "page/page_text.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/splat/splat_set.h"
#include "pcl_slim/surface/oct_normal.h"
#include "pcl_slim/surface/polynomial.h"
#include "pcl_slim/web/page.h"

namespace pcl_slim {

using namespace detail;
namespace {

constexpr std::uint32_t kMagic = 0x31534c53;  ///< "SLS1"

class SplatPacker {
 public:
  explicit SplatPacker(const SplatSet& splats)
      : s_(splats),
        cells_({&splats.x, &splats.y, &splats.z}),
        order_(cells_.order([](std::uint32_t) { return true; }))
  {
    radius_.cover(s_.radius);
  }

  std::vector<unsigned char> pack()
  {
    out_.putNumber(kMagic);
    out_.putNumber(static_cast<std::uint32_t>(s_.size()));
    out_.putNumber(s_.gradient.empty() ? 0 : 1);
    for (const double x : s_.origin) out_.putDouble(x);
    for (const double x : cells_.corner) out_.putDouble(x);
    for (const double x : {cells_.step, radius_.low, radius_.ratio}) out_.putDouble(x);
    cells_.write(order_, out_);
    putColumn(2, [&](std::uint32_t i) { return gridCode(codeOf(i).a); });
    putColumn(2, [&](std::uint32_t i) { return gridCode(codeOf(i).b); });
    putColumn(1, [&](std::uint32_t i) { return radius_.code(s_.radius[i]); });
    for (const int shift : {16, 8, 0}) {
      putColumn(1, [&](std::uint32_t i) { return s_.rgb[i] >> shift & 255u; });
    }
    for (std::size_t channel = 0; channel < 3 && !s_.gradient.empty(); ++channel) {
      for (const bool along_u : {true, false}) {
        putColumn(1, [&](std::uint32_t i) { return changeOf(i, channel, along_u); });
      }
    }
    return std::move(out_.data);
  }

 private:
  template <typename CodeOf>
  void putColumn(int bytes, const CodeOf& valueOf)
  {
    std::vector<std::uint32_t> column;
    for (const std::uint32_t i : order_) column.push_back(valueOf(i));
    out_.put(column, bytes);
  }

  OctNormal codeOf(std::uint32_t i) const
  {
    return encodeNormal({s_.nx[i], s_.ny[i], s_.nz[i]}, kNormalGrid);
  }

  /** \brief What a colour changes by from the centre to the rim along an axis of the disc. */
  std::uint32_t changeOf(std::uint32_t i, std::size_t channel, bool along_u) const
  {
    constexpr double kStep = 4.0, kMost = 127.0;
    const std::array<float, 3> normal = decodeNormal(codeOf(i));
    const LocalFrame frame(normalized({normal[0], normal[1], normal[2]}));
    const Vector3& axis = along_u ? frame.u : frame.v;
    double change = 0.0;
    for (std::size_t k = 0; k < 3; ++k) change += s_.gradient[i][3 * channel + k] * axis[k];
    return zigzag(std::clamp(change * s_.radius[i] / kStep, -kMost, kMost));
  }

  const SplatSet& s_;
  CenterCells cells_;
  std::vector<std::uint32_t> order_;
  LogScale radius_;
  PlaneWriter out_;
};

/** \brief Coloured discs for a page, before they are deflated: 16 bits a coordinate, normals of 12 bits a
 * coordinate, radii as 8-bit logarithms, colours as they are and their change over the disc in steps of 4. */
std::vector<unsigned char>
packSplats(const SplatSet& splats)
{
  return SplatPacker(splats).pack();
}

}  // namespace

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
