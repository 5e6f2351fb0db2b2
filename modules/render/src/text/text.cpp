// SPDX-License-Identifier: BSD-3-Clause
// Text from outlines of letters, antialiased by the exact area that they cover of a pixel.
#include "text/text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <vector>

namespace pcl_slim::detail {

namespace {

using Place = std::array<double, 2>;

/** Code points of UTF-8; bytes that are none count as "?". */
std::vector<std::uint32_t> lettersOf(const std::string& text) {
  std::vector<std::uint32_t> letters;
  for (std::size_t i = 0; i < text.size();) {
    const auto first = static_cast<unsigned char>(text[i]);
    const std::size_t length = first < 0x80             ? 1
                               : (first & 0xe0) == 0xc0 ? 2
                               : (first & 0xf0) == 0xe0 ? 3
                               : (first & 0xf8) == 0xf0 ? 4
                                                        : 0;
    std::uint32_t letter = length == 1 ? first : first & (0x7fu >> length);
    bool good = length > 0 && i + length <= text.size();
    for (std::size_t k = 1; good && k < length; ++k) {
      const auto next = static_cast<unsigned char>(text[i + k]);
      good = (next & 0xc0) == 0x80;
      letter = letter << 6 | (next & 0x3f);
    }
    letters.push_back(good ? letter : '?');
    i += good ? length : 1;
  }
  return letters;
}

const Glyph& glyphOf(std::uint32_t letter) {
  const auto find = [](std::uint32_t code) {
    return std::lower_bound(kGlyphs, kGlyphs + kNumGlyphs, code,
                            [](const Glyph& glyph, std::uint32_t c) { return glyph.letter < c; });
  };
  const Glyph* const found = find(letter);
  const bool known = found != kGlyphs + kNumGlyphs && found->letter == letter;
  return known ? *found : *find('?');
}

/** Signed area that a closed outline covers of each pixel of a box. Each piece of the outline adds
 * the area between it and the pixel's right side to its pixel, and the rest of its height to the
 * next one: sums along rows are the areas. */
class Coverage {
 public:
  Coverage(int width, int height)
      : width_(width),
        height_(height),
        sums_(static_cast<std::size_t>(width + 2) * static_cast<std::size_t>(height), 0.0f) {}

  /** A straight piece inside the box. */
  void add(Place a, Place b) {
    const double sign = a[1] < b[1] ? 1.0 : -1.0;
    if (sign < 0) std::swap(a, b);
    const double slope = b[1] > a[1] ? (b[0] - a[0]) / (b[1] - a[1]) : 0.0;
    for (int row = static_cast<int>(a[1]); row < height_ && row < b[1]; ++row) {
      const double top = std::max<double>(row, a[1]), bottom = std::min<double>(row + 1, b[1]);
      if (!(bottom > top)) continue;
      const double at_top = a[0] + (top - a[1]) * slope, at_bottom = a[0] + (bottom - a[1]) * slope;
      addInRow(row, std::min(at_top, at_bottom), std::max(at_top, at_bottom),
               sign * (bottom - top));
    }
  }

  /** Passes each pixel's share, at most 1, to take(x, y, share). */
  template <typename Take>
  void forEach(const Take& take) const {
    for (int y = 0; y < height_; ++y) {
      float sum = 0;
      for (int x = 0; x < width_; ++x) {
        sum += sums_[index(x, y)];
        take(x, y, std::min(1.0f, std::abs(sum)));
      }
    }
  }

 private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_ + 2) +
           static_cast<std::size_t>(x);
  }

  /** A piece of a height from x0 to x1 in one row. */
  void addInRow(int row, double x0, double x1, double height) {
    const int last = static_cast<int>(x1);
    for (int x = static_cast<int>(x0); x <= last; ++x) {
      const double left = std::max<double>(x, x0), right = std::min<double>(x + 1, x1);
      const double part = x1 > x0 ? height * (right - left) / (x1 - x0) : height;
      const double covered = part * (x + 1 - 0.5 * (left + right));
      sums_[index(x, row)] += static_cast<float>(covered);
      sums_[index(x + 1, row)] += static_cast<float>(part - covered);
    }
  }

  int width_, height_;
  std::vector<float> sums_;
};

/** Follows a path from font units to pixels. */
class Outline {
 public:
  Outline(const char* path, double scale, const Place& origin) : scale_(scale), origin_(origin) {
    char command = 'M';
    for (const char* at = path; *at != '\0';) {
      while (*at == ' ') ++at;
      if (*at >= 'A') command = *at++;
      if (command == 'M') {
        close();
        begin_ = last_ = place(at);
      } else if (command == 'L') {
        lineTo(place(at));
      } else {
        const Place control = place(at);
        curveTo(control, place(at));
      }
    }
    close();
  }

  const std::vector<std::array<Place, 2>>& pieces() const { return pieces_; }

 private:
  Place place(const char*& at) const {
    Place p;
    for (double& value : p) {
      char* end = nullptr;
      value = static_cast<double>(std::strtol(at, &end, 10));
      at = end;
    }
    return {origin_[0] + scale_ * p[0], origin_[1] - scale_ * p[1]};
  }

  void lineTo(const Place& to) {
    pieces_.push_back({last_, to});
    last_ = to;
  }

  /** Pieces that are off the parabola by less than a thirtieth of a pixel. */
  void curveTo(const Place& control, const Place& to) {
    const Place from = last_;
    const double bend =
        std::hypot(from[0] - 2 * control[0] + to[0], from[1] - 2 * control[1] + to[1]);
    const int count = 1 + static_cast<int>(std::sqrt(8.0 * bend));
    for (int i = 1; i <= count; ++i) {
      const double t = static_cast<double>(i) / count, s = 1 - t;
      lineTo({s * s * from[0] + 2 * s * t * control[0] + t * t * to[0],
              s * s * from[1] + 2 * s * t * control[1] + t * t * to[1]});
    }
  }

  void close() {
    if (!pieces_.empty()) lineTo(begin_);
  }

  double scale_;
  Place origin_, begin_{}, last_{};
  std::vector<std::array<Place, 2>> pieces_;
};

void mix(Image& image, int x, int y, const Color& ink, float share) {
  if (x < 0 || y < 0 || x >= image.width || y >= image.height) return;
  const std::size_t at = 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                              static_cast<std::size_t>(x));
  for (std::size_t k = 0; k < 3; ++k) {
    const float mixed = (1.0f - share) * image.rgb[at + k] + share * 255.0f * ink[k];
    image.rgb[at + k] = static_cast<std::uint8_t>(std::lround(mixed));
  }
}

void drawGlyph(Image& image, const Place& origin, double scale, const Glyph& glyph,
               const Color& ink) {
  const Outline outline(glyph.path, scale, origin);
  if (outline.pieces().empty()) return;
  Place low = outline.pieces()[0][0], high = low;
  for (const auto& piece : outline.pieces()) {
    for (std::size_t a = 0; a < 2; ++a) {
      low[a] = std::min(low[a], piece[1][a]);
      high[a] = std::max(high[a], piece[1][a]);
    }
  }
  const int left = static_cast<int>(std::floor(low[0])), top = static_cast<int>(std::floor(low[1]));
  Coverage coverage(static_cast<int>(std::floor(high[0])) + 1 - left,
                    static_cast<int>(std::floor(high[1])) + 1 - top);
  for (const auto& [a, b] : outline.pieces())
    coverage.add({a[0] - left, a[1] - top}, {b[0] - left, b[1] - top});
  coverage.forEach([&](int x, int y, float share) {
    if (share > 0) mix(image, left + x, top + y, ink, share);
  });
}

}  // namespace

double textWidth(const std::string& text, double em) {
  double width = 0;
  for (const std::uint32_t letter : lettersOf(text)) width += glyphOf(letter).advance;
  return width * em / kUnitsPerEm;
}

void drawText(Image& image, double x, double baseline, double em, const std::string& text,
              const Color& ink) {
  const double scale = em / kUnitsPerEm;
  for (const std::uint32_t letter : lettersOf(text)) {
    const Glyph& glyph = glyphOf(letter);
    drawGlyph(image, {x, baseline}, scale, glyph, ink);
    x += scale * glyph.advance;
  }
}

}  // namespace pcl_slim::detail
