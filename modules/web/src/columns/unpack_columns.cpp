// SPDX-License-Identifier: BSD-3-Clause
#include "columns/web_columns.h"
#include "columns/web_header.h"
#include "pcl_slim/surface/detail/detail_sizes.h"
#include "pcl_slim/surface/oct_normal.h"
#include "pcl_slim/surface/surfel_color.h"

namespace pcl_slim::detail {
namespace {

class Unpacker {
 public:
  explicit Unpacker(const std::vector<unsigned char>& bytes) : in_(bytes) {}

  Result<WebSurface> unpack()
  {
    const Error damaged = badInput("the page's data are damaged; save the page again");
    if (!header_.read(in_)) return damaged;
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
    if (in_.failed() || in_.left() > 0 || s.validate()) return damaged;
    return std::move(web_);
  }

 private:
  bool exact() const { return header_.precision == 0.0; }

  /** \param[in] valueOf float(std::uint32_t code) */
  template <typename ValueOf>
  void getColumn(int bytes, std::vector<float>& column, const ValueOf& valueOf)
  {
    const auto codes = in_.get(n_, bytes);
    column.resize(n_);
    for (std::size_t i = 0; i < codes.size(); ++i) column[i] = valueOf(codes[i]);
  }

  void getLogarithms(std::vector<float>& column, const LogScale& scale)
  {
    if (exact()) return getColumn(4, column, floatOf);
    getColumn(scale.bytes, column,
              [&](std::uint32_t code) { return static_cast<float>(scale.value(code)); });
  }

  void getBalls()
  {
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

  void getDetail()
  {
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

  void getCoefficients()
  {
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

  std::vector<std::uint32_t> getEscaped()
  {
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

  void getTrimMaps()
  {
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

  void getColors()
  {
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

  PlaneReader in_;
  WebHeader header_;
  WebSurface web_;
  std::size_t n_ = 0;
};

}  // namespace

Result<WebSurface>
unpackColumns(const std::vector<unsigned char>& bytes)
{
  return Unpacker(bytes).unpack();
}

}  // namespace pcl_slim::detail
