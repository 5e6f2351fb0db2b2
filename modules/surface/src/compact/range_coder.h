// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

// Adaptive binary range coding (Martin 1979; the carries are those of LZMA). Encoder and decoder have the
// same members, so that one template describes a format in both directions: bit(model, value) writes the
// value and returns it, or ignores it and returns the one that was written.

namespace pcl_slim::detail {

/** \brief Chance that a bit is 1: the mean of a fast and a slow running average. */
class BitModel {
 public:
  /** \brief In 1/4096, within 16 ... 4080, so that every bit takes some space. */
  std::uint32_t chance() const
  {
    return std::clamp((std::uint32_t{fast_} + slow_) >> 5, 16u, 4080u);
  }

  void update(bool bit)
  {
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
  bool bit(BitModel& model, bool value)
  {
    const std::uint32_t ones = (range_ >> 12) * model.chance();
    model.update(value);
    return narrow(value, ones);
  }

  /** \brief A bit of which nothing is known. */
  bool bit(bool value) { return narrow(value, range_ >> 1); }

  std::vector<unsigned char> finish()
  {
    for (int i = 0; i < 5; ++i) shiftOut();
    return std::move(bytes_);
  }

 private:
  bool narrow(bool value, std::uint32_t ones)
  {
    if (!value) low_ += ones;
    range_ = value ? ones : range_ - ones;
    for (; range_ < (1u << 24); range_ <<= 8) shiftOut();
    return value;
  }

  /** Writes the top byte of low_ once no carry can change it. */
  void shiftOut()
  {
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
  RangeDecoder(const unsigned char* bytes, std::size_t size) : at_(bytes), end_(bytes + size)
  {
    for (int i = 0; i < 5; ++i) code_ = code_ << 8 | next();
  }

  bool bit(BitModel& model, bool = false)
  {
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
  bool narrow(std::uint32_t ones)
  {
    const bool value = code_ < ones;
    if (!value) code_ -= ones;
    range_ = value ? ones : range_ - ones;
    for (; range_ < (1u << 24); range_ <<= 8) code_ = code_ << 8 | next();
    return value;
  }

  std::uint32_t next()
  {
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
  std::int64_t code(Coder& coder, std::int64_t value)
  {
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

}  // namespace pcl_slim::detail
