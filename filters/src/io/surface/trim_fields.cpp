// SPDX-License-Identifier: BSD-3-Clause
#include "io/surface/trim_fields.h"

#include <algorithm>

#include "pcl_slim/core/base64.h"

namespace pcl_slim {

namespace {

constexpr int kTrimSide = 8;               ///< nodes a side of the trim maps that points carry
constexpr std::size_t kBytesOfLine = 300;  ///< a multiple of 3: 400 characters of base64
const std::string kTrimLine = "pcl_slim trim_maps ";
const std::string kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

/** Appends what base64() made text of. false: it is none. */
bool
addBytes(const std::string& text, std::vector<std::uint8_t>& bytes)
{
  if (text.size() % 4 != 0) return false;
  for (std::size_t i = 0; i < text.size(); i += 4) {
    std::uint32_t group = 0;
    std::size_t count = 3;
    for (std::size_t k = 0; k < 4; ++k) {
      const std::size_t digit = kDigits.find(text[i + k]);
      if (digit == std::string::npos && text[i + k] != '=') return false;
      if (digit == std::string::npos && count > 0) --count;
      group = group << 6 | static_cast<std::uint32_t>(digit & 63);
    }
    for (std::size_t k = 0; k < count; ++k)
      bytes.push_back(static_cast<std::uint8_t>(group >> (16 - 8 * k)));
  }
  return true;
}

/** Sets the maps from bytes that contain them one after another, as SLIMSurface::trim_maps does. false: they are not
 * those of the surface's open surfels. */
bool
setMaps(const std::vector<std::uint8_t>& bytes, SLIMSurface& surface)
{
  std::vector<std::uint8_t> sides(surface.size()), bits;
  std::size_t at = 0;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    if (!surface.isOpen(i)) continue;
    const int side = at < bytes.size() ? bytes[at++] : 0;
    const std::size_t count = TrimMap::numBytes(side);
    if (side < TrimMap::kLeastSide || side > TrimMap::kMostSide || bytes.size() - at < count)
      return false;
    sides[i] = static_cast<std::uint8_t>(side);
    const auto first = bytes.begin() + static_cast<std::ptrdiff_t>(at);
    bits.insert(bits.end(), first, first + static_cast<std::ptrdiff_t>(count));
    at += count;
  }
  if (at != bytes.size()) return false;
  surface.setTrimMaps(sides, bits);
  return true;
}

bool
isOfCoarseSide(const SLIMSurface& surface, std::size_t i)
{
  return !surface.isOpen(i) || surface.trimMap(i).side == kTrimSide;
}

}  // namespace

std::array<std::uint32_t, 2>
coarseTrimMap(const SLIMSurface& surface, std::size_t i)
{
  std::array<std::uint32_t, 2> bits{};
  if (!surface.isOpen(i)) return bits;
  const TrimMap map = surface.trimMap(i);
  const auto coordinate = [](int node) { return 2.0 * node / (kTrimSide - 1) - 1.0; };
  for (int k = 0; k < kTrimSide * kTrimSide; ++k) {
    const int column = k % kTrimSide, row = k / kTrimSide;
    const bool inside = map.side == kTrimSide
                            ? map.at(column, row)
                            : outsideShare(map, coordinate(column), coordinate(row)) <= 0.5;
    bits[static_cast<std::size_t>(k >> 5)] |= static_cast<std::uint32_t>(inside) << (k & 31);
  }
  return bits;
}

void
setCoarseTrimMaps(const std::vector<std::array<std::uint32_t, 2>>& maps, SLIMSurface& surface)
{
  std::vector<std::uint8_t> sides(surface.size()), bits;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    if (!surface.isOpen(i)) continue;
    sides[i] = kTrimSide;
    for (const std::uint32_t half : maps[i]) {
      for (int byte = 0; byte < 4; ++byte)
        bits.push_back(static_cast<std::uint8_t>(half >> 8 * byte));
    }
  }
  surface.setTrimMaps(sides, bits);
}

void
addTrimComments(const SLIMSurface& surface, std::vector<std::string>& comments)
{
  bool exact = true;
  for (std::size_t i = 0; exact && i < surface.size(); ++i) exact = isOfCoarseSide(surface, i);
  if (exact) return;
  const std::vector<std::uint8_t>& maps = surface.trim_maps;
  for (std::size_t i = 0; i < maps.size(); i += kBytesOfLine)
    comments.push_back(kTrimLine +
                       base64(maps.data() + i, std::min(kBytesOfLine, maps.size() - i)));
}

void
takeTrimComments(const std::vector<std::string>& comments, SLIMSurface& surface)
{
  std::vector<std::uint8_t> bytes;
  for (const std::string& comment : comments) {
    if (comment.compare(0, kTrimLine.size(), kTrimLine) != 0) continue;
    if (!addBytes(comment.substr(kTrimLine.size()), bytes)) return;
  }
  if (bytes.empty() || !surface.hasTrimMaps()) return;
  SLIMSurface full = surface;
  if (!setMaps(bytes, full)) return;
  for (std::size_t i = 0; i < full.size(); ++i) {
    if (coarseTrimMap(full, i) != coarseTrimMap(surface, i)) return;
  }
  surface = std::move(full);
}

}  // namespace pcl_slim
