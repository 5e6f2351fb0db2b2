// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "pcl_slim/surface/detail/new_frame.h"
#include "pcl_slim/surface/oct_normal.h"
#include "pcl_slim/surface/polynomial.h"
#include "pcl_slim/surface/surface.h"
#include "pcl_slim/surface/surfel_color.h"

// Adaptive binary range coding (Martin 1979; the carries are those of LZMA). Encoder and decoder
// have the same members, so that one template describes a format in both directions: bit(model,
// value) writes the value and returns it, or ignores it and returns the one that was written.

namespace pcl_slim::detail {

/** \brief Chance that a bit is 1: the mean of a fast and a slow running average. */
class BitModel {
 public:
  /** \brief In 1/4096, within 16 ... 4080, so that every bit takes some space. */
  std::uint32_t chance() const {
    return std::clamp((std::uint32_t{fast_} + slow_) >> 5, 16u, 4080u);
  }

  void update(bool bit) {
    fast_ =
        static_cast<std::uint16_t>(bit ? fast_ + ((0xffff - fast_) >> 4) : fast_ - (fast_ >> 4));
    slow_ =
        static_cast<std::uint16_t>(bit ? slow_ + ((0xffff - slow_) >> 7) : slow_ - (slow_ >> 7));
  }

 private:
  std::uint16_t fast_ = 0x8000, slow_ = 0x8000;
};

class RangeEncoder {
 public:
  bool bit(BitModel& model, bool value) {
    const std::uint32_t ones = (range_ >> 12) * model.chance();
    model.update(value);
    return narrow(value, ones);
  }

  /** \brief A bit of which nothing is known. */
  bool bit(bool value) { return narrow(value, range_ >> 1); }

  std::vector<unsigned char> finish() {
    for (int i = 0; i < 5; ++i) shiftOut();
    return std::move(bytes_);
  }

 private:
  bool narrow(bool value, std::uint32_t ones) {
    if (!value) low_ += ones;
    range_ = value ? ones : range_ - ones;
    for (; range_ < (1u << 24); range_ <<= 8) shiftOut();
    return value;
  }

  /** Writes the top byte of low_ once no carry can change it. */
  void shiftOut() {
    if (low_ < 0xff000000u || low_ > 0xffffffffu) {
      const auto carry = static_cast<unsigned char>(low_ >> 32);
      for (; held_ > 0; --held_) {
        bytes_.push_back(static_cast<unsigned char>(top_ + carry));
        top_ = 0xff;
      }
      top_ = static_cast<unsigned char>(low_ >> 24);
    }
    ++held_;
    low_ = (low_ & 0x00ffffffu) << 8;
  }

  std::uint64_t low_ = 0;
  std::uint32_t range_ = 0xffffffffu;
  unsigned char top_ = 0;
  std::uint64_t held_ = 1;  ///< top_ and bytes of 0xff behind it
  std::vector<unsigned char> bytes_;
};

class RangeDecoder {
 public:
  RangeDecoder(const unsigned char* bytes, std::size_t size) : at_(bytes), end_(bytes + size) {
    for (int i = 0; i < 5; ++i) code_ = code_ << 8 | next();
  }

  bool bit(BitModel& model, bool = false) {
    const bool value = narrow((range_ >> 12) * model.chance());
    model.update(value);
    return value;
  }

  bool bit(bool = false) { return narrow(range_ >> 1); }

  /** \brief Whether more was read than was written. */
  bool failed() const { return missing_ > 0; }
  /** \brief Whether exactly what was written has been read. */
  bool done() const { return !failed() && at_ == end_; }

 private:
  bool narrow(std::uint32_t ones) {
    const bool value = code_ < ones;
    if (!value) code_ -= ones;
    range_ = value ? ones : range_ - ones;
    for (; range_ < (1u << 24); range_ <<= 8) code_ = code_ << 8 | next();
    return value;
  }

  std::uint32_t next() {
    if (at_ < end_) return *at_++;
    ++missing_;
    return 0;
  }

  const unsigned char *at_, *end_;
  std::uint32_t code_ = 0, range_ = 0xffffffffu;
  std::uint64_t missing_ = 0;
};

/** \brief Codes whole numbers that are mostly small: sign, length and leading digits adapt. */
class NumberModel {
 public:
  static constexpr int kMostDigits = 52;  ///< binary, of the magnitude

  template <typename Coder>
  std::int64_t code(Coder& coder, std::int64_t value) {
    if (coder.bit(zero_, value == 0)) return 0;
    const bool negative = coder.bit(sign_, value < 0);
    const std::uint64_t size = static_cast<std::uint64_t>(negative ? -value : value);
    int digits = 1;
    while (digits < kMostDigits && coder.bit(longer_[index(digits)], (size >> digits) != 0))
      ++digits;
    std::uint64_t read = 1;
    for (int k = digits - 2; k >= 0; --k) {
      const bool digit = (size >> k & 1) != 0;
      const bool leading = k >= digits - 3;
      const bool got = leading ? coder.bit(leading_[index(digits)][read], digit) : coder.bit(digit);
      read = read << 1 | static_cast<std::uint64_t>(got);
    }
    return negative ? -static_cast<std::int64_t>(read) : static_cast<std::int64_t>(read);
  }

 private:
  static std::size_t index(int digits) { return static_cast<std::size_t>(digits); }

  BitModel zero_, sign_;
  std::array<BitModel, kMostDigits + 1> longer_;
  std::array<std::array<BitModel, 4>, kMostDigits + 1> leading_;
};

/** \brief Coefficients of polynomials that are orthonormal under the weight (1 - s^2)^2 over the
 * unit disc: moving one of them moves the surface by the same RMS, whichever it is. */
class OrthonormalBasis {
 public:
  using Coefficients = std::array<double, kMaxCoefficients>;

  OrthonormalBasis() {
    std::array<std::array<int, 2>, kMaxCoefficients> powers{};
    std::size_t count = 0;
    for (int d = 0; d <= kMaxDegree; ++d) {
      for (int v = 0; v <= d; ++v) powers[count++] = {d - v, v};
    }
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t j = 0; j <= i; ++j) {
        double sum = moment(powers[i][0] + powers[j][0], powers[i][1] + powers[j][1]);
        for (std::size_t k = 0; k < j; ++k) sum -= root_[i][k] * root_[j][k];
        root_[i][j] = i == j ? std::sqrt(sum) : sum / root_[j][j];
      }
    }
  }

  /** \brief From powers of u and v. The first n of either kind depend on each other alone. */
  Coefficients from(const Coefficients& c, std::size_t n) const {
    Coefficients a{};
    for (std::size_t k = 0; k < n; ++k) {
      for (std::size_t i = k; i < n; ++i) a[k] += root_[i][k] * c[i];
    }
    return a;
  }

  /** \brief To powers of u and v. */
  Coefficients to(const Coefficients& a, std::size_t n) const {
    Coefficients c{};
    for (std::size_t k = n; k-- > 0;) {
      c[k] = a[k];
      for (std::size_t i = k + 1; i < n; ++i) c[k] -= root_[i][k] * c[i];
      c[k] /= root_[k][k];
    }
    return c;
  }

 private:
  /** Weighted mean of u^a v^b. */
  static double moment(int a, int b) {
    if (a % 2 != 0 || b % 2 != 0) return 0.0;
    const double n = 0.5 * (a + b);
    double mean = 6.0 / ((n + 1.0) * (n + 2.0) * (n + 3.0));
    for (int k = 1; k < a; k += 2) mean *= k;
    for (int k = 1; k < b; k += 2) mean *= k;
    for (int k = 2; k <= a + b; k += 2) mean /= k;
    return mean;
  }

  std::array<std::array<double, kMaxCoefficients>, kMaxCoefficients>
      root_{};  ///< Cholesky's, of moments
};

/** \brief A positive number as a whole number of shares of an octave; 0 has the code of kLeast
 * octaves. */
struct LogCode {
  static constexpr double kLeast = -80.0;
  double steps;  ///< an octave

  std::int64_t code(double value) const {
    return value > 0.0 ? std::llround(steps * std::max(kLeast, std::log2(value)))
                       : std::llround(steps * kLeast);
  }

  double value(std::int64_t code) const {
    const double octaves = static_cast<double>(code) / steps;
    return octaves > kLeast ? std::exp2(octaves) : 0.0;
  }
};

/** \brief One surfel apart from its columns. */
struct Surfel {
  SurfelFrame ball{};
  double error = 0.0, effective_count = 0.0;
  std::int64_t degree = 1, level = 1, flags = 0;
  std::array<double, kMaxCoefficients> coefficients{};
  std::int64_t side = 0;           ///< of the trim map
  std::vector<std::uint8_t> bits;  ///< of the trim map
  std::array<std::uint8_t, kColorBytes> color{};
};

/** \brief What all surfels of a block are rounded to. */
struct Tolerance {
  double shift = 0.0;            ///< RMS that rounding may move a leaf by, local units
  std::uint32_t normals = 1023;  ///< steps of a normal's coordinate to each side
  bool colored = false;
};

/** \brief Codes surfel after surfel, each relative to those before. \tparam Coder RangeEncoder, to
 * which the surfels are rounded as they are written, or RangeDecoder, which fills them. */
template <typename Coder>
class SurfelCodec {
 public:
  SurfelCodec(Coder& coder, const Tolerance& tolerance) : coder_(coder), tolerance_(tolerance) {}

  void code(Surfel& s) {
    const Surfel given = s;
    codeKind(s);
    codeBall(s);
    codeShape(s, given);
    if ((s.flags & kSurfelOpen) != 0) codeTrimMap(s);
    if (tolerance_.colored) codeColor(s, given);
    recent_[count_++ % kRecent] = Place{s.ball.center, codes_, s.color};
  }

  /** \brief Whether a number had too many digits to be written. */
  bool overflowed() const { return overflowed_; }

 private:
  static constexpr std::size_t kRecent = 32;
  static constexpr std::int64_t kMost = (std::int64_t{1} << NumberModel::kMostDigits) - 1;
  static constexpr int kRadiusSteps = 32;   ///< of an octave
  static constexpr int kCenterOctaves = 5;  ///< a centre's steps are finer than its radius by these
  static constexpr LogCode kErrors{8.0}, kCounts{4.0};

  struct Codes {
    std::int64_t degree = 0, level = 0, radius = 0, a = 0, b = 0, error = 0, count = 0, side = 0;
  };
  struct Place {
    Vector3 center{};
    Codes codes;
    std::array<std::uint8_t, kColorBytes> color{};
  };

  std::int64_t number(NumberModel& model, std::int64_t value) {
    overflowed_ = overflowed_ || value > kMost || value < -kMost;
    return model.code(coder_, std::clamp(value, -kMost, kMost));
  }

  /** A number near a prediction. */
  std::int64_t near(NumberModel& model, std::int64_t value, std::int64_t predicted) {
    const std::int64_t read = predicted + number(model, value - predicted);
    if (std::abs(read) <= kMost) return read;
    overflowed_ = true;
    return 0;
  }

  std::int64_t rounded(double value) {
    if (std::abs(value) < static_cast<double>(kMost)) return std::llround(value);
    overflowed_ = true;
    return 0;
  }

  void codeKind(Surfel& s) {
    s.degree = codes_.degree = near(degree_, s.degree, codes_.degree);
    s.level = codes_.level = near(level_, s.level, codes_.level);
    std::int64_t flags = 0;
    for (std::size_t k = 0; k < flags_.size(); ++k) {
      const bool bit = coder_.bit(flags_[k][leaf_ ? 1 : 0], (s.flags >> k & 1) != 0);
      flags |= std::int64_t{bit} << k;
    }
    s.flags = flags;
    leaf_ = (flags & kSurfelLeaf) != 0;
  }

  /** The radius is rounded up, so that no ball covers less. */
  void codeBall(Surfel& s) {
    const double octaves = std::ceil(kRadiusSteps * std::log2(std::max(s.ball.radius, 0x1p-60)));
    codes_.radius = near(radius_, rounded(octaves), codes_.radius);
    const auto code = static_cast<double>(codes_.radius);
    s.ball.radius = static_cast<float>(std::exp2(code / kRadiusSteps));
    const auto octave = static_cast<int>(std::floor(code / kRadiusSteps));
    const double step = std::ldexp(1.0, std::clamp(octave, -200, 200) - kCenterOctaves);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int64_t last = rounded(center_[k] / step);
      const std::int64_t cell = near(center_model_[k], rounded(s.ball.center[k] / step), last);
      center_[k] = s.ball.center[k] = static_cast<float>(static_cast<double>(cell) * step);
    }
    const Place& place = nearest(s.ball.center);
    codeNormal(s, place.codes);
    codes_.error = near(error_, kErrors.code(s.error), place.codes.error);
    codes_.count = near(effective_count_, kCounts.code(s.effective_count), place.codes.count);
    s.error = kErrors.value(codes_.error);
    s.effective_count = kCounts.value(codes_.count);
    color_ = place.color;
  }

  const Place& nearest(const Vector3& center) const {
    const auto distance = [&](const Place& place) {
      const Vector3 d = subtract(place.center, center);
      return dot(d, d);
    };
    const auto end = recent_.begin() + static_cast<std::ptrdiff_t>(std::min(count_, kRecent));
    const auto least = std::min_element(recent_.begin(), end, [&](const Place& x, const Place& y) {
      return distance(x) < distance(y);
    });
    return *least;
  }

  void codeNormal(Surfel& s, const Codes& predicted) {
    const auto grid = static_cast<double>(tolerance_.normals);
    const OctNormal given = encodeNormal(s.ball.normal, grid);
    codes_.a = near(normal_[0], rounded(double{given.a} * grid), predicted.a);
    codes_.b = near(normal_[1], rounded(double{given.b} * grid), predicted.b);
    const auto coordinate = [grid](std::int64_t code) {
      return static_cast<float>(std::clamp(static_cast<double>(code) / grid, -1.0, 1.0));
    };
    const std::array<float, 3> normal = decodeNormal({coordinate(codes_.a), coordinate(codes_.b)});
    s.ball.normal = {normal[0], normal[1], normal[2]};
  }

  /** Coefficients in the rounded ball, in steps that move the surface alike. */
  void codeShape(Surfel& s, const Surfel& given) {
    const int degree = static_cast<int>(std::clamp<std::int64_t>(s.degree, 1, kMaxDegree));
    const auto n = static_cast<std::size_t>(numCoefficients(degree));
    const double shift = leaf_ ? tolerance_.shift : std::max(tolerance_.shift, kInternal * s.error);
    const double step = shift * std::sqrt(12.0 / static_cast<double>(n)) / s.ball.radius;
    const auto ideal = idealCoefficients(given, s.ball, degree);
    OrthonormalBasis::Coefficients a{};
    std::uint64_t size = 0;
    for (std::size_t k = 0; k < n; ++k) {
      const double steps = ideal[k] / step;
      const std::int64_t whole =
          rounded(std::copysign(std::floor(std::abs(steps) + kRound), steps));
      const std::int64_t code = number(coefficients_[k][activity(size)], whole);
      if (k > 0) size += static_cast<std::uint64_t>(std::abs(code));
      a[k] = static_cast<double>(code) * step;
    }
    s.coefficients = basis_.to(a, n);
  }

  /** Those before they are rounded; unknown to a decoder. */
  OrthonormalBasis::Coefficients idealCoefficients(const Surfel& given, const SurfelFrame& ball,
                                                   int degree) const {
    if (kDecoding) return {};
    std::array<float, kMaxCoefficients> c;
    std::copy(given.coefficients.begin(), given.coefficients.end(), c.begin());
    return basis_.from(inNewFrame(degree, c.data(), given.ball, ball),
                       static_cast<std::size_t>(numCoefficients(degree)));
  }

  /** Number of binary digits of the coefficients so far, by which the next ones are predicted. */
  static std::size_t activity(std::uint64_t size) {
    std::size_t digits = 0;
    while (digits + 1 < kActivities && (size >> digits) != 0) ++digits;
    return digits;
  }

  /** Bit after bit, each expected as its neighbours are. */
  void codeTrimMap(Surfel& s) {
    s.side = codes_.side = near(side_, s.side, codes_.side);
    if (s.side < TrimMap::kLeastSide || s.side > TrimMap::kMostSide) return;
    const auto side = static_cast<int>(s.side);
    s.bits.resize(TrimMap::numBytes(side), 0);
    const auto at = [&](int column, int row) {
      if (column < 0 || row < 0 || column >= side) return 0;
      const int k = row * side + column;
      return s.bits[static_cast<std::size_t>(k >> 3)] >> (k & 7) & 1;
    };
    for (int row = 0; row < side; ++row) {
      for (int column = 0; column < side; ++column) {
        const int about = at(column - 1, row) | at(column, row - 1) << 1 |
                          at(column + 1, row - 1) << 2 | at(column - 1, row - 1) << 3;
        const bool inside =
            coder_.bit(trim_[static_cast<std::size_t>(about)], at(column, row) != 0);
        const int k = row * side + column;
        auto& byte = s.bits[static_cast<std::size_t>(k >> 3)];
        byte = static_cast<std::uint8_t>((byte & ~(1 << (k & 7))) | (int{inside} << (k & 7)));
      }
    }
  }

  /** The constant terms relative to the nearest surfel's, red and blue after green. */
  void codeColor(Surfel& s, const Surfel& given) {
    if (!kDecoding) recolorInNewFrame(given.ball, s.ball, s.color.data());
    const auto byte = [&](std::size_t k, int predicted) {
      const auto change = static_cast<std::int8_t>(s.color[k] - predicted);
      s.color[k] = static_cast<std::uint8_t>(predicted + number(colors_[k], change));
    };
    byte(1, color_[1]);
    const int lighter = s.color[1] - color_[1];
    byte(0, color_[0] + lighter);
    byte(2, color_[2] + lighter);
    for (std::size_t k = 3; k < kColorBytes; k += 3) {
      byte(k + 1, 0);
      byte(k, s.color[k + 1]);
      byte(k + 2, s.color[k + 1]);
    }
  }

  static constexpr bool kDecoding = std::is_same_v<Coder, RangeDecoder>;
  static constexpr double kInternal =
      0.2;                               ///< of its residual: what an internal surfel may move by
  static constexpr double kRound = 0.4;  ///< a half rounds down: zeros are cheap
  static constexpr std::size_t kActivities = 6;

  Coder& coder_;
  Tolerance tolerance_;
  OrthonormalBasis basis_;
  bool overflowed_ = false, leaf_ = true;
  Codes codes_;
  Vector3 center_{};
  std::array<std::uint8_t, kColorBytes> color_{};  ///< of the nearest surfel
  std::array<Place, kRecent> recent_{};
  std::size_t count_ = 0;

  NumberModel degree_, level_, radius_, error_, effective_count_, side_;
  std::array<NumberModel, 3> center_model_;
  std::array<NumberModel, 2> normal_;
  std::array<std::array<NumberModel, kActivities>, kMaxCoefficients> coefficients_;
  std::array<NumberModel, kColorBytes> colors_;
  std::array<std::array<BitModel, 2>, 3> flags_;
  std::array<BitModel, 16> trim_;
};

}  // namespace pcl_slim::detail
