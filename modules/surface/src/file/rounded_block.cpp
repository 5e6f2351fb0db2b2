// SPDX-License-Identifier: BSD-3-Clause
#include "file/slim_file.h"

#include <algorithm>
#include <cmath>

#include "file/surfel_codec.h"

namespace pcl_slim::detail {
namespace {

constexpr std::size_t kHeadBytes = sizeof(double) + sizeof(std::uint32_t) + 1;

Surfel surfelOf(const SLIMSurface& s, std::size_t i) {
  Surfel one;
  one.ball = {{s.cx[i], s.cy[i], s.cz[i]}, {s.nx[i], s.ny[i], s.nz[i]}, s.radius[i]};
  one.error = s.error[i];
  one.effective_count = s.effective_count[i];
  one.degree = s.degree[i];
  one.level = s.level[i];
  one.flags = s.flags[i];
  std::copy_n(s.coefficientsOf(i), s.stride(), one.coefficients.begin());
  const TrimMap map = s.trimMap(i);
  one.side = map.side;
  one.bits.assign(map.bits, map.bits + TrimMap::numBytes(map.side));
  if (s.hasColors())
    std::copy_n(s.colors.begin() + static_cast<std::ptrdiff_t>(i * kColorBytes), kColorBytes,
                one.color.begin());
  return one;
}

/** Whether the columns can represent what was read. */
bool plausible(const Surfel& one, int degree) {
  const bool open = (one.flags & kSurfelOpen) != 0;
  return one.degree >= 1 && one.degree <= degree && one.level >= 0 && one.level <= 255 &&
         open == (one.side != 0) && one.side <= TrimMap::kMostSide;
}

void setColumns(const std::vector<Surfel>& surfels, bool colored, SLIMSurface& s) {
  s.resize(surfels.size());
  std::vector<std::uint8_t> sides, bits, colors;
  for (std::size_t i = 0; i < surfels.size(); ++i) {
    const Surfel& one = surfels[i];
    const auto set = [i](std::vector<float>& column, double value) {
      column[i] = static_cast<float>(value);
    };
    set(s.cx, one.ball.center[0]);
    set(s.cy, one.ball.center[1]);
    set(s.cz, one.ball.center[2]);
    set(s.nx, one.ball.normal[0]);
    set(s.ny, one.ball.normal[1]);
    set(s.nz, one.ball.normal[2]);
    set(s.radius, one.ball.radius);
    set(s.error, one.error);
    set(s.effective_count, one.effective_count);
    s.degree[i] = static_cast<std::uint8_t>(one.degree);
    s.level[i] = static_cast<std::uint8_t>(one.level);
    s.flags[i] = static_cast<std::uint8_t>(one.flags);
    const auto stride = static_cast<std::size_t>(s.stride());
    for (std::size_t k = 0; k < stride; ++k)
      s.coefficients[i * stride + k] = static_cast<float>(one.coefficients[k]);
    sides.push_back(static_cast<std::uint8_t>(one.side));
    bits.insert(bits.end(), one.bits.begin(), one.bits.end());
    colors.insert(colors.end(), one.color.begin(), one.color.end());
  }
  s.setTrimMaps(sides, bits);
  if (colored) s.colors = std::move(colors);
}

/** What rounding may change, for a share of the RMS residual of the leaves. */
Tolerance toleranceOf(const SLIMSurface& s, double share) {
  constexpr double kLeast = 1e-9;  // of the diagonal: below float's resolution
  constexpr double kTilt = 0.3;    // of a leaf's tolerance, on heights of a tenth of its radius
  double residual = 0.0, radius = 0.0;
  for (std::size_t i = 0; i < s.size(); ++i) {
    if (!s.isLeaf(i)) continue;
    residual += double{s.error[i]} * s.error[i];
    radius += double{s.radius[i]} * s.radius[i];
  }
  const auto leaves = static_cast<double>(std::max<std::size_t>(1, s.numLeaves()));
  Tolerance tolerance;
  tolerance.shift = std::max(share * std::sqrt(residual / leaves), kLeast * s.info.diagonal);
  const double steps = kTilt * std::sqrt(radius / leaves) / tolerance.shift;
  tolerance.normals = 127;
  while (tolerance.normals < steps && tolerance.normals < (1u << 20))
    tolerance.normals = 2 * tolerance.normals + 1;
  tolerance.colored = s.hasColors();
  return tolerance;
}

}  // namespace

std::vector<std::uint32_t> packingOrder(const SLIMSurface& s) {
  const auto cell = [](float x) {
    return static_cast<std::uint32_t>(std::clamp(x + 1.0f, 0.0f, 2.0f) * 0x1p20f);
  };
  std::vector<std::array<std::uint32_t, 3>> cells;
  std::vector<std::uint32_t> order;
  for (std::uint32_t i = 0; i < s.size(); ++i) {
    cells.push_back({cell(s.cx[i]), cell(s.cy[i]), cell(s.cz[i])});
    order.push_back(i);
  }
  std::sort(order.begin(), order.end(), [&](std::uint32_t i, std::uint32_t j) {
    if (s.isLeaf(i) != s.isLeaf(j)) return s.isLeaf(i);
    std::size_t axis = 0;  // that whose cells differ in the highest bit
    std::uint32_t most = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t differing = cells[i][k] ^ cells[j][k];
      if (most < differing && most < (most ^ differing)) {
        axis = k;
        most = differing;
      }
    }
    return most > 0 ? cells[i][axis] < cells[j][axis] : i < j;
  });
  return order;
}

std::vector<unsigned char> packSurfels(const SLIMSurface& surface, double share) {
  const Tolerance tolerance = toleranceOf(surface, share);
  RangeEncoder coder;
  SurfelCodec<RangeEncoder> codec(coder, tolerance);
  std::vector<Surfel> rounded;
  for (const std::uint32_t i : packingOrder(surface)) {
    rounded.push_back(surfelOf(surface, i));
    codec.code(rounded.back());
  }
  SLIMSurface copy;
  copy.info = surface.info;
  setColumns(rounded, tolerance.colored, copy);
  if (codec.overflowed() || copy.validate()) return {};
  ByteWriter out;
  out.putDouble(tolerance.shift);
  out.putUnsigned(tolerance.normals);
  out.putUnsigned(static_cast<std::uint8_t>(tolerance.colored ? 1 : 0));
  out.putBytes(coder.finish());
  return std::move(out.bytes);
}

Error unpackSurfels(const unsigned char* bytes, std::size_t size, std::uint64_t surfels,
                    SLIMSurface& surface) {
  if (size < kHeadBytes) return contradictorySlim();
  ByteReader in(bytes);
  Tolerance tolerance;
  tolerance.shift = in.getDouble();
  tolerance.normals = in.getUnsigned<std::uint32_t>();
  tolerance.colored = in.getUnsigned<std::uint8_t>() != 0;
  if (!(tolerance.shift > 0.0) || !(tolerance.shift < 1e300) || tolerance.normals < 1 ||
      tolerance.normals > (1u << 22))
    return contradictorySlim();
  RangeDecoder coder(bytes + kHeadBytes, size - kHeadBytes);
  SurfelCodec<RangeDecoder> codec(coder, tolerance);
  std::vector<Surfel> read;
  for (std::uint64_t i = 0; i < surfels; ++i) {
    Surfel one;
    codec.code(one);
    if (codec.overflowed() || coder.failed() || !plausible(one, surface.info.degree))
      return contradictorySlim();
    read.push_back(std::move(one));
  }
  if (!coder.done()) return contradictorySlim();
  setColumns(read, tolerance.colored, surface);
  return {};
}

}  // namespace pcl_slim::detail
