// SPDX-License-Identifier: BSD-3-Clause
#include "unit/web/web_decoder.h"

#include <zlib.h>

#include "page_columns.h"
#include "page_textures.h"
#include "pcl_slim/surface/detail/detail_sizes.h"
#include "pcl_slim/surface/oct_normal.h"
#include "pcl_slim/surface/surfel_color.h"

namespace pcl_slim::test {

using namespace detail;
namespace {

/** \brief Inverse of gzip(). */
Result<std::vector<unsigned char>> gunzip(const std::vector<unsigned char>& bytes) {
  z_stream stream{};
  if (inflateInit2(&stream, 15 + 16) != Z_OK) return badInput("out of memory");
  stream.next_in = const_cast<unsigned char*>(bytes.data());
  stream.avail_in = static_cast<uInt>(bytes.size());
  std::vector<unsigned char> out;
  unsigned char part[1 << 16];
  int status = Z_OK;
  while (status == Z_OK || status == Z_BUF_ERROR) {
    stream.next_out = part;
    stream.avail_out = sizeof part;
    status = inflate(&stream, Z_FINISH);
    const std::size_t made = sizeof part - stream.avail_out;
    out.insert(out.end(), part, part + made);
    if (made == 0) break;
  }
  inflateEnd(&stream);
  if (status != Z_STREAM_END) return badInput("the page's data are damaged; save the page again");
  return out;
}

float floatOf(std::uint32_t bits) {
  float value;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

/** \brief Inverse of gridCode(). */
float gridCoordinate(std::uint32_t code) {
  return static_cast<float>(code / kNormalGrid - 1.0);
}

/** \brief Inverse of zigzag(). */
double unzigzag(std::uint32_t code) {
  return code % 2 == 0 ? 0.5 * code : -0.5 * (code + 1.0);
}

/** \brief Reads what PlaneWriter wrote; zeros, and failed(), beyond its end. */
class PlaneReader {
 public:
  explicit PlaneReader(const std::vector<unsigned char>& data) : data_(data) {}

  std::vector<std::uint32_t> get(std::size_t count, int bytes) {
    failed_ = failed_ || count > left() / static_cast<std::size_t>(bytes);
    if (failed_) return {};
    std::vector<std::uint32_t> column(count, 0);
    for (int plane = 0; plane < bytes; ++plane) {
      for (std::uint32_t& v : column) v |= static_cast<std::uint32_t>(data_[at_++]) << (8 * plane);
    }
    return column;
  }

  std::uint32_t getNumber() {
    const auto one = get(1, 4);
    return failed_ ? 0 : one[0];
  }

  double getDouble() {
    const std::uint64_t low = getNumber(), bits = low | static_cast<std::uint64_t>(getNumber())
                                                            << 32;
    double value;
    std::memcpy(&value, &bits, sizeof value);
    return value;
  }

  bool failed() const { return failed_; }
  std::size_t left() const { return data_.size() - at_; }

 private:
  const std::vector<unsigned char>& data_;
  std::size_t at_ = 0;
  bool failed_ = false;
};

/** \brief Reads the columns of a surface one by one. */
class Unpacker {
 public:
  explicit Unpacker(const std::vector<unsigned char>& bytes) : in_(bytes) {}

  Result<WebSurface> unpack() {
    const Error damaged = badInput("the page's data are damaged; save the page again");
    if (!getHeader()) return damaged;
    SLIMSurface& s = web_.surface;
    s.info = header_.info;
    n_ = header_.surfels;
    if (n_ > in_.left()) return damaged;  // before memory is taken
    s.resize(n_);
    getBalls();
    getDetail();
    getCoefficients();
    getTrimMaps();
    if (header_.colored) getColors();
    if (header_.textured) getTextures();
    if (in_.failed() || in_.left() > 0 || s.validate()) return damaged;
    return std::move(web_);
  }

 private:
  /** \return false for bytes that are no header of this version */
  bool getHeader() {
    if (in_.getNumber() != kWebMagic) return false;
    header_.surfels = in_.getNumber();
    header_.leaves = in_.getNumber();
    const auto small = in_.get(5, 1);
    if (in_.failed()) return false;
    SurfaceInfo& info = header_.info;
    info.degree = static_cast<int>(small[0]);
    info.blend_kernel = static_cast<WeightKernel>(small[1]);
    info.oriented = small[2] != 0;
    info.paper_mode = small[3] != 0;
    header_.setColors(small[4] > 0, small[4] > 1);
    header_.visitNumbers([&](double& number) { number = in_.getDouble(); });
    return !in_.failed() && header_.leaves <= header_.surfels && info.degree >= 1 &&
           info.degree <= kMaxDegree;
  }

  bool exact() const { return header_.precision == 0.0; }

  /** \param[in] valueOf float(std::uint32_t code) */
  template <typename ValueOf>
  void getColumn(int bytes, std::vector<float>& column, const ValueOf& valueOf) {
    const auto codes = in_.get(n_, bytes);
    column.resize(n_);
    for (std::size_t i = 0; i < codes.size(); ++i) column[i] = valueOf(codes[i]);
  }

  void getLogarithms(std::vector<float>& column, const LogScale& scale) {
    if (exact()) return getColumn(4, column, floatOf);
    getColumn(scale.bytes, column,
              [&](std::uint32_t code) { return static_cast<float>(scale.value(code)); });
  }

  void getBalls() {
    SLIMSurface& s = web_.surface;
    std::vector<float>* const axes[3] = {&s.cx, &s.cy, &s.cz};
    if (exact()) {
      for (auto* column : {&s.cx, &s.cy, &s.cz, &s.nx, &s.ny, &s.nz})
        getColumn(4, *column, floatOf);
    } else {
      for (std::size_t k = 0; k < 3; ++k) {
        std::uint32_t cell = 0;
        getColumn(2, *axes[k], [&](std::uint32_t step) {
          cell = (cell + step) & 0xffffu;
          return static_cast<float>(header_.corner[k] + cell * header_.step);
        });
      }
      std::vector<float> a, b;
      getColumn(2, a, gridCoordinate);
      getColumn(2, b, gridCoordinate);
      for (std::size_t i = 0; i < n_; ++i) {
        const std::array<float, 3> normal = decodeNormal({a[i], b[i]});
        s.nx[i] = normal[0];
        s.ny[i] = normal[1];
        s.nz[i] = normal[2];
      }
    }
    getLogarithms(s.radius, header_.radius);
    getLogarithms(s.error, header_.error);
  }

  void getDetail() {
    SLIMSurface& s = web_.surface;
    const auto level = in_.get(n_, 1), degree = in_.get(n_, 1);
    if (in_.failed()) return;
    for (std::size_t i = 0; i < n_; ++i) {
      s.level[i] = static_cast<std::uint8_t>(level[i]);
      s.degree[i] = static_cast<std::uint8_t>(degree[i]);
      s.flags[i] = i < header_.leaves ? kSurfelLeaf : 0;
    }
    getLogarithms(web_.own, header_.size);
    getLogarithms(web_.parent, header_.size);
    for (float& size : web_.parent) size = size > 0.0f ? size : DetailSizes::kNoParent;
  }

  void getCoefficients() {
    SLIMSurface& s = web_.surface;
    const auto stride = static_cast<std::size_t>(s.stride());
    for (std::size_t k = 0; k < stride; ++k) {
      const auto codes = exact() ? in_.get(n_, 4) : getEscaped();
      for (std::size_t i = 0; i < codes.size(); ++i) {
        s.coefficients[i * stride + k] =
            exact()
                ? floatOf(codes[i])
                : static_cast<float>(unzigzag(codes[i]) /
                                     stepsOf(header_.precision, k, s.radius[i] / s.info.diagonal));
      }
    }
  }

  std::vector<std::uint32_t> getEscaped() {
    auto codes = in_.get(n_, 1);
    const auto large = static_cast<std::size_t>(std::count(codes.begin(), codes.end(), kEscape));
    const auto values = in_.get(large, 3);
    if (in_.failed()) return {};
    auto next = values.begin();
    for (std::uint32_t& code : codes) {
      if (code == kEscape) code = *next++;
    }
    return codes;
  }

  void getTrimMaps() {
    std::vector<std::uint8_t> sides(n_, 0), bits;
    const auto read = in_.get(n_, 1);
    for (std::size_t i = 0; i < read.size(); ++i) {
      const auto side = static_cast<int>(read[i]);
      if (side > TrimMap::kMostSide) return;  // bytes are left over: damaged
      sides[i] = static_cast<std::uint8_t>(side);
      const std::size_t begin = bits.size();
      bits.resize(begin + TrimMap::numBytes(side), 0);
      const int bytes_of_row = (side + 7) / 8;
      const auto rows = in_.get(static_cast<std::size_t>(bytes_of_row * side), 1);
      if (in_.failed()) return;
      std::vector<std::uint32_t> row(static_cast<std::size_t>(bytes_of_row), 0);
      for (int k = 0; k < side * side; ++k) {
        const auto byte = static_cast<std::size_t>(k % side / 8);
        if (k % side % 8 == 0)
          row[byte] ^= rows[static_cast<std::size_t>(k / side * bytes_of_row) + byte];
        const std::uint32_t bit = row[byte] >> (k % side % 8) & 1u;
        bits[begin + static_cast<std::size_t>(k >> 3)] |= static_cast<std::uint8_t>(bit << (k & 7));
      }
    }
    web_.surface.setTrimMaps(sides, bits);
  }

  void getColors() {
    std::vector<std::uint8_t>& colors = web_.surface.colors;
    if (n_ > in_.left() / kColorBytes) return;  // bytes are missing or left over: damaged
    colors.resize(n_ * kColorBytes);
    for (std::size_t k = 0; k < kColorBytes; ++k) {
      const auto column = in_.get(n_, 1);
      for (std::size_t i = 0; i < n_; ++i)
        colors[i * kColorBytes + k] = static_cast<std::uint8_t>(column[i]);
    }
    for (std::size_t at = 0; at < colors.size(); at += 3) {
      for (const std::size_t c : {0, 2})
        colors[at + c] = static_cast<std::uint8_t>(colors[at + c] + colors[at + 1]);
    }
  }

  void getTextures() {
    const auto error = in_.get(1, 1), sides = in_.get(n_, 1), counts = in_.get(kTexelPlanes, 4);
    if (in_.failed()) return;
    color_error_ = static_cast<int>(error[0]);
    for (auto& channel : planes_) {
      for (std::size_t k = 0; k < kTexelPlanes; ++k) channel[k] = {in_.get(counts[k], 1), 0};
    }
    if (in_.failed()) return;
    std::vector<std::uint8_t> texels;
    for (std::size_t i = 0; i < n_; ++i)
      addTexture(static_cast<int>(sides[i]), &web_.surface.colors[i * kColorBytes], texels);
    web_.surface.setTextures({sides.begin(), sides.end()}, texels);
  }

  void addTexture(int side, const std::uint8_t* first, std::vector<std::uint8_t>& texels) {
    const LumaTexel begin(first, color_error_);
    std::vector<LumaTexel> read(static_cast<std::size_t>(side * side));
    for (int row = 0; row < side; ++row) {
      for (int column = 0; column < side; ++column) {
        const TexelContext context = contextOf(read, side, column, row, begin);
        LumaTexel& texel = read[static_cast<std::size_t>(row * side + column)];
        texel = context.predicted;
        for (std::size_t c = 0; c < 3 && context.stored; ++c) {
          auto& [plane, at] = planes_[c][context.plane];
          const auto residual = static_cast<std::uint8_t>(at < plane.size() ? plane[at] : 0);
          ++at;
          texel.value[c] = static_cast<std::uint8_t>(texel.value[c] + residual);
          texel.size += std::abs(static_cast<std::int8_t>(residual));
        }
        std::uint8_t rgb[3];
        texel.setRgb(color_error_, rgb);
        texels.insert(texels.end(), rgb, rgb + 3);
      }
    }
  }

  PlaneReader in_;
  int color_error_ = 0;
  std::array<std::array<std::pair<std::vector<std::uint32_t>, std::size_t>, kTexelPlanes>, 3>
      planes_;  ///< residuals, and how many are read
  WebHeader header_;
  WebSurface web_;
  std::size_t n_ = 0;
};

}  // namespace

Result<WebSurface> decodeWebSurface(const std::vector<unsigned char>& bytes) {
  const auto columns = gunzip(bytes);
  if (!columns) return columns.error();
  return Unpacker(*columns).unpack();
}

}  // namespace pcl_slim::test
