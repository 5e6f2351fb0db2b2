// SPDX-License-Identifier: BSD-3-Clause
#include "page_columns.h"

#include <zlib.h>

#include "pcl_slim/core/vector3.h"
#include "pcl_slim/splat/splat_set.h"
#include "pcl_slim/surface/oct_normal.h"
#include "pcl_slim/surface/polynomial.h"

namespace pcl_slim::detail {

Result<std::vector<unsigned char>> gzip(const std::vector<unsigned char>& bytes,
                                        std::size_t residuals) {
  constexpr int kGzipWindow = 15 + 16;  // zlib's largest window, in gzip's frame
  z_stream stream{};
  if (bytes.size() > 0x7fffffff || deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED,
                                                kGzipWindow, 9, Z_DEFAULT_STRATEGY) != Z_OK) {
    return badInput("too much data for a page; fit the surface with -compact 1 or a larger error");
  }
  stream.next_in = const_cast<unsigned char*>(bytes.data());
  std::vector<unsigned char> out;
  unsigned char part[1 << 16];
  int status = Z_OK;
  const auto run = [&](const auto& step) {
    do {
      stream.next_out = part;
      stream.avail_out = sizeof part;
      status = step();
      out.insert(out.end(), part, stream.next_out);
    } while (status == Z_OK && stream.avail_out == 0);
  };
  if (residuals > 0) {
    stream.avail_in = static_cast<uInt>(bytes.size() - residuals);
    run([&] { return deflate(&stream, Z_BLOCK); });
    run([&] { return deflateParams(&stream, Z_BEST_COMPRESSION, Z_RLE); });
  }
  stream.avail_in = static_cast<uInt>(bytes.data() + bytes.size() - stream.next_in);
  run([&] { return deflate(&stream, Z_FINISH); });
  deflateEnd(&stream);
  if (status != Z_STREAM_END) return badInput("the page's data are damaged; save the page again");
  return out;
}

Result<std::vector<unsigned char>> packLines(const std::vector<SpaceLine>& lines,
                                             const std::array<double, 3>& origin, double scale) {
  std::array<std::vector<double>, 3> axes;
  std::vector<std::uint32_t> kinds, counts;
  for (const SpaceLine& line : lines) {
    kinds.push_back(line.kind == PictureLineKind::kRidge ? 0 : 1);
    counts.push_back(static_cast<std::uint32_t>(line.points.size()));
    for (const auto& point : line.points) {
      for (std::size_t k = 0; k < 3; ++k) axes[k].push_back((point[k] - origin[k]) / scale);
    }
  }
  double extent = std::numeric_limits<double>::min();
  std::array<double, 3> corner{};
  for (std::size_t k = 0; k < 3 && !axes[k].empty(); ++k) {
    const auto [least, most] = std::minmax_element(axes[k].begin(), axes[k].end());
    corner[k] = *least;
    extent = std::max(extent, *most - *least);
  }
  const double step = extent / kCenterSteps;
  PlaneWriter out;
  out.putNumber(static_cast<std::uint32_t>(lines.size()));
  out.put(kinds, 1);
  out.put(counts, 4);
  out.putDouble(step);
  for (std::size_t k = 0; k < 3; ++k) {
    std::uint32_t last = 0;
    std::vector<std::uint32_t> steps;
    for (const double x : axes[k]) {
      const auto cell = static_cast<std::uint32_t>(std::lround((x - corner[k]) / step));
      steps.push_back((cell - last) & 0xffffu);
      last = cell;
    }
    out.putDouble(corner[k]);
    out.put(steps, 2);
  }
  return gzip(out.data);
}

namespace {

constexpr std::uint32_t kMagic = 0x31534c53;  ///< "SLS1"

/** \brief Coloured discs in a page's order, column by column. */
class SplatPacker {
 public:
  explicit SplatPacker(const SplatSet& splats)
      : s_(splats),
        cells_({&splats.x, &splats.y, &splats.z}),
        order_(cells_.order([](std::uint32_t) { return true; })) {
    radius_.cover(s_.radius);
  }

  std::vector<unsigned char> pack() {
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
  void putColumn(int bytes, const CodeOf& valueOf) {
    std::vector<std::uint32_t> column;
    for (const std::uint32_t i : order_) column.push_back(valueOf(i));
    out_.put(column, bytes);
  }

  OctNormal codeOf(std::uint32_t i) const {
    return encodeNormal({s_.nx[i], s_.ny[i], s_.nz[i]}, kNormalGrid);
  }

  /** \brief What a colour changes by from the centre to the rim along an axis of the disc. */
  std::uint32_t changeOf(std::uint32_t i, std::size_t channel, bool along_u) const {
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

}  // namespace

Result<std::vector<unsigned char>> packSplats(const SplatSet& splats) {
  return gzip(SplatPacker(splats).pack());
}

}  // namespace pcl_slim::detail
