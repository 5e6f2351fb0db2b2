// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/web/web_surface.h"

#include "page_columns.h"
#include "page_textures.h"
#include "pcl_slim/surface/detail/detail_sizes.h"
#include "pcl_slim/surface/detail/new_frame.h"
#include "pcl_slim/surface/oct_normal.h"
#include "pcl_slim/surface/surfel_color.h"

namespace pcl_slim {

using namespace detail;
namespace {

/** \brief The surfels of a surface in a page's order, column by column. */
class Packer {
 public:
  Packer(const SLIMSurface& surface, double precision, int color_error)
      : s_(surface),
        color_error_(color_error),
        sizes_(surface),
        cells_({&surface.cx, &surface.cy, &surface.cz}) {
    header_.surfels = static_cast<std::uint32_t>(s_.size());
    header_.leaves = static_cast<std::uint32_t>(s_.numLeaves());
    header_.info = s_.info;
    header_.precision = precision;
    header_.setColors(s_.hasColors(), s_.hasTextures());
    std::copy(cells_.corner, cells_.corner + 3, header_.corner);
    header_.step = cells_.step;
    header_.radius.cover(s_.radius);
    header_.error.cover(s_.error);
    std::vector<float> sizes = sizes_.own;
    for (const float size : sizes_.parent) {
      if (size < DetailSizes::kNoParent) sizes.push_back(size);
    }
    header_.size.cover(sizes);
    order_ = cells_.order([&](std::uint32_t i) { return s_.isLeaf(i); });
  }

  Result<std::vector<unsigned char>> pack() {
    putHeader();
    putBalls();
    putDetail();
    putCoefficients();
    putTrimMaps();
    if (header_.colored) putColors();
    if (header_.textured) putTextures();
    return gzip(out_.data, residuals_);
  }

 private:
  void putHeader() {
    const SurfaceInfo& info = header_.info;
    out_.putNumber(kWebMagic);
    out_.putNumber(header_.surfels);
    out_.putNumber(header_.leaves);
    out_.put(
        {static_cast<std::uint32_t>(info.degree), static_cast<std::uint32_t>(info.blend_kernel),
         static_cast<std::uint32_t>(info.hasFront()), static_cast<std::uint32_t>(info.paper_mode),
         header_.codeOfColors()},
        1);
    header_.visitNumbers([&](double number) { out_.putDouble(number); });
  }

  bool exact() const { return header_.precision == 0.0; }

  /** \param[in] codeOf std::uint32_t(std::uint32_t surfel) */
  template <typename CodeOf>
  void putColumn(int bytes, const CodeOf& codeOf) {
    std::vector<std::uint32_t> column;
    column.reserve(order_.size());
    for (const std::uint32_t i : order_) column.push_back(codeOf(i));
    out_.put(column, bytes);
  }

  void putFloats(const std::vector<float>& column) {
    putColumn(4, [&](std::uint32_t i) { return bitsOf(column[i]); });
  }

  /** \brief Eight bits of a logarithm, or the float itself. */
  void putLogarithms(const std::vector<float>& column, const LogScale& scale) {
    if (exact()) return putFloats(column);
    putColumn(scale.bytes, [&](std::uint32_t i) { return scale.code(column[i]); });
  }

  void putBalls() {
    if (exact()) {
      for (const auto* column : {&s_.cx, &s_.cy, &s_.cz, &s_.nx, &s_.ny, &s_.nz})
        putFloats(*column);
    } else {
      cells_.write(order_, out_);
      putColumn(2, [&](std::uint32_t i) { return gridCode(codeOf(i).a); });
      putColumn(2, [&](std::uint32_t i) { return gridCode(codeOf(i).b); });
    }
    putLogarithms(s_.radius, header_.radius);
    putLogarithms(s_.error, header_.error);
  }

  OctNormal codeOf(std::uint32_t i) const {
    return encodeNormal({s_.nx[i], s_.ny[i], s_.nz[i]}, kNormalGrid);
  }

  void putDetail() {
    putColumn(1, [&](std::uint32_t i) { return s_.level[i]; });
    putColumn(1, [&](std::uint32_t i) { return s_.degree[i]; });
    std::vector<float> parent = sizes_.parent;
    for (float& size : parent) size = size < DetailSizes::kNoParent ? size : 0.0f;
    putLogarithms(sizes_.own, header_.size);
    putLogarithms(parent, header_.size);
  }

  double roundedRadius(std::uint32_t i) const {
    return header_.radius.value(header_.radius.code(s_.radius[i]));
  }

  SurfelFrame ballOf(std::uint32_t i) const {
    return {{s_.cx[i], s_.cy[i], s_.cz[i]}, {s_.nx[i], s_.ny[i], s_.nz[i]}, s_.radius[i]};
  }

  /** \brief The ball and frame that the viewer will have. */
  SurfelFrame roundedBall(std::uint32_t i) const {
    SurfelFrame to;
    for (std::size_t k = 0; k < 3; ++k) to.center[k] = cells_.rounded(k, i);
    const std::array<float, 3> normal = decodeNormal(codeOf(i));
    to.normal = {normal[0], normal[1], normal[2]};
    to.radius = roundedRadius(i);
    return to;
  }

  void putCoefficients() {
    const auto stride = static_cast<std::size_t>(s_.stride());
    if (exact()) {
      for (std::size_t k = 0; k < stride; ++k) {
        putColumn(4, [&](std::uint32_t i) { return bitsOf(s_.coefficientsOf(i)[k]); });
      }
      return;
    }
    std::vector<std::vector<std::uint32_t>> columns(stride);
    for (const std::uint32_t i : order_) {
      const auto c = inNewFrame(s_.degree[i], s_.coefficientsOf(i), ballOf(i), roundedBall(i));
      const double diagonals = roundedRadius(i) / s_.info.diagonal;
      for (std::size_t k = 0; k < stride; ++k) {
        columns[k].push_back(zigzag(c[k] * stepsOf(header_.precision, k, diagonals)));
      }
    }
    for (auto& column : columns) putEscaped(column);
  }

  /** \brief One byte per code; larger codes follow the column, three bytes each. */
  void putEscaped(std::vector<std::uint32_t>& column) {
    std::vector<std::uint32_t> large;
    for (std::uint32_t& code : column) {
      if (code < kEscape) continue;
      large.push_back(code);
      code = kEscape;
    }
    out_.put(column, 1);
    out_.put(large, 3);
  }

  void putTrimMaps() {
    putColumn(1, [&](std::uint32_t i) { return static_cast<std::uint32_t>(s_.trimMap(i).side); });
    for (const std::uint32_t i : order_) {
      const TrimMap map = s_.trimMap(i);
      for (int row = 0; row < map.side; ++row) putTrimRow(map, row);
    }
  }

  /** \brief The difference from the row before, which compresses better than the row. */
  void putTrimRow(const TrimMap& map, int row) {
    for (int first = 0; first < map.side; first += 8) {
      std::uint32_t byte = 0;
      for (int k = first; k < std::min(first + 8, map.side); ++k) {
        const bool before = row > 0 && map.at(k, row - 1);
        byte |= static_cast<std::uint32_t>(map.at(k, row) != before) << (k - first);
      }
      out_.put({byte}, 1);
    }
  }

  /** \brief Red and blue as their differences from green, which compress better. */
  void putColors() {
    std::vector<std::uint8_t>& colors = colors_ = s_.colors;
    for (const std::uint32_t i : order_) {
      if (exact()) break;
      recolorInNewFrame(ballOf(i), roundedBall(i), colors.data() + i * kColorBytes);
    }
    for (std::size_t k = 0; k < kColorBytes; ++k) {
      const std::size_t green = 3 * (k / 3) + 1;
      putColumn(1, [&](std::uint32_t i) {
        const std::uint8_t* of = colors.data() + i * kColorBytes;
        return static_cast<std::uint8_t>(of[k] - (k == green ? 0 : of[green]));
      });
    }
  }

  /** \brief Rounding balls and frames moves texels by less than a tenth of their width. Each texture
   * begins with the constant term of its surfel's colour. */
  void putTextures() {
    TexturePacker packer(color_error_);
    for (const std::uint32_t i : order_) {
      const SurfelTexture texture = s_.texture(i);
      packer.add(texture.side, texture.rgb, colors_.data() + i * kColorBytes);
    }
    const std::size_t before = out_.data.size();
    packer.write(out_);
    residuals_ = out_.data.size() - before;
  }

  const SLIMSurface& s_;
  int color_error_;
  std::vector<std::uint8_t> colors_;  ///< in the rounded frames
  DetailSizes sizes_;
  CenterCells cells_;
  WebHeader header_;
  std::vector<std::uint32_t> order_;
  PlaneWriter out_;
  std::size_t residuals_ = 0;  ///< bytes of textures, the last of all
};

}  // namespace

Result<std::vector<unsigned char>> encodeWebSurface(const SLIMSurface& surface, double precision,
                                                    int color_error) {
  if (precision != 0.0 && !(precision >= 16.0 && precision <= 65536.0)) {
    return Error{ErrorCode::kBadArgument, "the precision must be 0 or 16 to 65536 steps"};
  }
  if (color_error < 0 || color_error > kMostColorError) {
    return Error{ErrorCode::kBadArgument, "the error of colours must be 0 to 32 of 255"};
  }
  if (Error error = surface.validate()) return error;
  return Packer(surface, precision, color_error).pack();
}

}  // namespace pcl_slim
