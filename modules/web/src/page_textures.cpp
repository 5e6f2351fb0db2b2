// SPDX-License-Identifier: BSD-3-Clause
#include "page_textures.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "pcl_slim/core/vector3.h"

namespace pcl_slim::detail {

namespace {

int signedByte(int value) {
  return static_cast<std::int8_t>(static_cast<std::uint8_t>(value));
}

/** Differences count from -128 on. */
int numberOf(const LumaTexel& texel, std::size_t channel) {
  return channel == 0 ? texel.value[0] : signedByte(texel.value[channel]);
}

/** Whether no place of a texture's disc takes its colour from a texel. */
bool isOutsideDisc(int side, int column, int row) {
  // A texel colours places less than a texel from its middle along either axis.
  const auto gap = [&](int k) { return std::max(std::abs(2 * k + 1 - side) - 2, 0); };
  return gap(column) * gap(column) + gap(row) * gap(row) >= side * side;
}

}  // namespace

LumaTexel LumaTexel::of(const std::array<int, 3>& rgb) {
  const int orange = signedByte(rgb[0] - rgb[2]), base = (rgb[2] + (orange >> 1)) & 255;
  const int green = signedByte(rgb[1] - base);
  LumaTexel texel;
  texel.value = {static_cast<std::uint8_t>(base + (green >> 1)), static_cast<std::uint8_t>(orange),
                 static_cast<std::uint8_t>(green)};
  return texel;
}

std::array<int, 3> LumaTexel::rgb() const {
  const int orange = signedByte(value[1]), green = signedByte(value[2]);
  const int base = value[0] - (green >> 1), blue = base - (orange >> 1);
  return {(blue + orange) & 255, (base + green) & 255, blue & 255};
}

TexelContext contextOf(const std::vector<LumaTexel>& texels, int side, int column, int row,
                       const LumaTexel& first) {
  const auto at = static_cast<std::size_t>(row * side + column),
             below = at - static_cast<std::size_t>(side);
  TexelContext context;
  context.stored = !isOutsideDisc(side, column, row);
  LumaTexel& predicted = context.predicted;
  predicted = row > 0 ? texels[below] : column > 0 ? texels[at - 1] : first;
  predicted.size = 0;
  if (row == 0 || !context.stored) return context;
  int around = texels[below].size;
  if (column + 1 < side) around += texels[below + 1].size;
  if (column > 0) {
    const LumaTexel &left = texels[at - 1], &corner = texels[below - 1];
    around += left.size + corner.size;
    for (std::size_t c = 0; c < 3; ++c) {
      const int a = numberOf(left, c), b = numberOf(texels[below], c), d = numberOf(corner, c);
      predicted.value[c] =
          static_cast<std::uint8_t>(std::clamp(a + b - d, std::min(a, b), std::max(a, b)));
    }
  }
  for (const int least : {1, 3, 6, 12, 24, 48}) context.plane += around >= least;
  return context;
}

LumaTexel TexturePacker::rounded(const std::uint8_t* rgb) const {
  const int step = 2 * color_error_ + 1;
  std::array<int, 3> steps;
  for (std::size_t c = 0; c < 3; ++c) steps[c] = (rgb[c] + color_error_) / step;
  return LumaTexel::of(steps);
}

void TexturePacker::add(int side, const std::uint8_t* rgb, const std::uint8_t* first) {
  sides_.push_back(static_cast<std::uint32_t>(side));
  texels_.assign(static_cast<std::size_t>(side) * static_cast<std::size_t>(side), {});
  const LumaTexel begin = rounded(first);
  for (int row = 0; row < side; ++row) {
    for (int column = 0; column < side; ++column) {
      const auto at = static_cast<std::size_t>(row * side + column);
      const TexelContext context = contextOf(texels_, side, column, row, begin);
      LumaTexel& texel = texels_[at];
      texel = context.predicted;
      if (!context.stored) continue;
      texel = rounded(rgb + 3 * at);
      for (std::size_t c = 0; c < 3; ++c) {
        const auto residual =
            static_cast<unsigned char>(texel.value[c] - context.predicted.value[c]);
        planes_[c][context.plane].push_back(residual);
        texel.size += std::abs(signedByte(residual));
      }
    }
  }
}

void TexturePacker::write(PlaneWriter& out) const {
  out.put({static_cast<std::uint32_t>(color_error_)}, 1);
  out.put(sides_, 1);
  std::vector<std::uint32_t> counts;
  for (const auto& plane : planes_[0]) counts.push_back(static_cast<std::uint32_t>(plane.size()));
  out.put(counts, 4);
  for (const auto& channel : planes_) {
    for (const auto& plane : channel) out.data.insert(out.data.end(), plane.begin(), plane.end());
  }
}

namespace {

/** Where places of a surfel's plane are in the plane that it had before. */
class FrameChange {
 public:
  FrameChange(int degree, const float* c, const SurfelFrame& from, const SurfelFrame& to)
      : c_(inNewFrame(degree, c, from, to)),
        from_(from.normal),
        to_(to.normal),
        shift_(subtract(to.center, from.center)),
        from_radius_(from.radius),
        to_radius_(to.radius) {}

  /** \brief Of the point of the surface there. */
  std::array<double, 2> before(double u, double v) const {
    Vector3 offset = shift_;
    // No place farther from the plane has colours of the texture.
    constexpr double kMostHeight = SurfelTexture::kReach;
    const double h = std::clamp(heightAt(u, v), -kMostHeight, kMostHeight);
    for (std::size_t k = 0; k < 3; ++k)
      offset[k] += to_radius_ * (u * to_.u[k] + v * to_.v[k] + h * to_.w[k]);
    return {dot(offset, from_.u) / from_radius_, dot(offset, from_.v) / from_radius_};
  }

 private:
  /** Coefficients above the degree are 0. */
  double heightAt(double u, double v) const {
    std::array<float, kMaxCoefficients> c;
    std::transform(c_.begin(), c_.end(), c.begin(), [](double x) { return static_cast<float>(x); });
    return evaluateHeight(kMaxDegree, c.data(), u, v);
  }

  std::array<double, kMaxCoefficients> c_;
  LocalFrame from_, to_;
  Vector3 shift_;
  double from_radius_, to_radius_;
};

}  // namespace

std::vector<std::uint8_t> textureInNewFrame(const SurfelTexture& texture, int degree,
                                            const float* c, const SurfelFrame& from,
                                            const SurfelFrame& to) {
  constexpr double kReach = SurfelTexture::kReach;
  constexpr double kMostShift = 0.1;  // [texels]
  constexpr double kCorner = 0.7;     // [reach] of a square inside the disc
  const FrameChange change(degree, c, from, to);
  const double texel = 2.0 * kReach / texture.side;
  double shift = 0.0;
  for (const double u : {-kCorner * kReach, kCorner * kReach}) {
    for (const double v : {-kCorner * kReach, kCorner * kReach}) {
      const auto place = change.before(u, v);
      shift = std::max(shift, std::hypot(place[0] - u, place[1] - v) / texel);
    }
  }
  const std::size_t bytes = SurfelTexture::numBytes(texture.side);
  if (shift <= kMostShift) return {texture.rgb, texture.rgb + bytes};
  std::vector<std::uint8_t> texels;
  texels.reserve(bytes);
  for (int row = 0; row < texture.side; ++row) {
    for (int column = 0; column < texture.side; ++column) {
      const auto place =
          change.before((column + 0.5) * texel - kReach, (row + 0.5) * texel - kReach);
      const auto color =
          texture.colorAt(static_cast<float>(place[0]), static_cast<float>(place[1]));
      for (const float value : color)
        texels.push_back(static_cast<std::uint8_t>(std::lround(value)));
    }
  }
  return texels;
}

}  // namespace pcl_slim::detail
