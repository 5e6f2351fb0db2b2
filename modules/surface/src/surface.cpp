// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/surface/surface.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "pcl_slim/surface/surfel_color.h"

namespace pcl_slim {

namespace {

// Local lengths are shares of a box of about 1. Within these bounds squares, and products of four
// coefficients, are normal floats, and centres in cells of the least radius fit into 64 bits.
constexpr float kMostLength = 0x1p20f;    ///< of a coordinate or a radius, local units
constexpr float kLeastRadius = 0x1p-40f;  ///< local units
constexpr double kMostWorldLength =
    0x1p1000;                              ///< of origin and scale: world coordinates are finite
constexpr double kLeastScale = 0x1p-1000;  ///< its inverse is finite

/** Whether a value is in [low, high], which no NaN does. */
template <typename T>
bool within(T value, T low, T high) {
  return value >= low && value <= high;
}

bool isKernel(WeightKernel kernel) {
  return kernel == WeightKernel::kPower2 || kernel == WeightKernel::kPower4 ||
         kernel == WeightKernel::kPower7 || kernel == WeightKernel::kGaussian;
}

/** Checks the numbers of one surfel. */
Error checkSurfel(const SLIMSurface& s, std::size_t i) {
  const auto bad = [i](const std::string& what, const char* how) {
    return badInput(what + " of surfel " + std::to_string(i) + how);
  };
  if (s.degree[i] < 1 || s.degree[i] > s.info.degree) return bad("degree", " is out of range");
  if (!(s.radius[i] > 0.0f)) return bad("radius", " is not positive");
  if (!within(s.radius[i], kLeastRadius, kMostLength))
    return bad("radius", " is out of proportion to the surface");
  const float length_sq = s.nx[i] * s.nx[i] + s.ny[i] * s.ny[i] + s.nz[i] * s.nz[i];
  if (!(std::abs(length_sq - 1.0f) < 1e-3f)) return bad("normal", " has not unit length");
  for (const float c : {s.cx[i], s.cy[i], s.cz[i]}) {
    if (!std::isfinite(c)) return bad("centre", " is not finite");
    if (!within(c, -kMostLength, kMostLength))
      return bad("centre", " is out of proportion to the surface");
  }
  const float* c = s.coefficientsOf(i);
  for (int k = 0; k < s.stride(); ++k) {
    if (!std::isfinite(c[k])) return bad("a coefficient", " is not finite");
    if (!within(c[k], -kMostCoefficient, kMostCoefficient))
      return bad("a coefficient", " is too large for a polynomial in a unit ball");
  }
  const bool measured = within(s.error[i], 0.0f, kMostLength) && s.effective_count[i] >= 0.0f &&
                        std::isfinite(s.effective_count[i]);
  return measured ? Error() : bad("error or confidence", " is negative or not finite");
}

/** Turns a map, side and bits, over in v: the rows of a surfel whose normal is turned. */
void mirrorTrimMap(std::uint8_t* map) {
  const int side = map[0];
  const std::vector<std::uint8_t> copy(map + 1, map + 1 + TrimMap::numBytes(side));
  const TrimMap old{side, copy.data()};
  std::fill_n(map + 1, copy.size(), std::uint8_t{0});
  for (int k = 0; k < side * side; ++k) {
    const bool inside = old.at(k % side, side - 1 - k / side);
    map[1 + (k >> 3)] |= static_cast<std::uint8_t>(inside << (k & 7));
  }
}

/** Turns a texture, side and texels, over in v. */
void mirrorTexture(std::uint8_t* texture) {
  const std::ptrdiff_t side = texture[0], row = 3 * side;
  std::uint8_t* const texels = texture + 1;
  for (std::ptrdiff_t low = 0, high = side - 1; low < high; ++low, --high)
    std::swap_ranges(texels + low * row, texels + (low + 1) * row, texels + high * row);
}

/** Names what is wrong with a surface's textures: offsets or sides. */
Error checkTextures(const SLIMSurface& surface) {
  const auto& begin = surface.texture_begin;
  const std::size_t n = surface.size();
  if (begin.empty() && surface.textures.empty()) return {};
  if (!surface.hasColors() || begin.size() != n + 1 || begin[0] != 0 ||
      begin[n] != surface.textures.size()) {
    return badInput("the textures do not belong to the surfels");
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (begin[i] == begin[i + 1]) continue;
    const bool there = begin[i] < begin[i + 1] && begin[i + 1] <= surface.textures.size();
    const int side = there ? surface.textures[begin[i]] : 0;
    if (side == 0 || begin[i + 1] - begin[i] != 1 + SurfelTexture::numBytes(side))
      return badInput("the texture of surfel " + std::to_string(i) + " has another size");
  }
  return {};
}

/** Names what is wrong with a surface's trim maps: offsets, flags or sides. */
Error checkTrimMaps(const SLIMSurface& surface) {
  const auto& begin = surface.trim_begin;
  const std::size_t n = surface.size();
  if (!begin.empty() &&
      (begin.size() != n + 1 || begin[0] != 0 || begin[n] != surface.trim_maps.size())) {
    return badInput("the trim maps do not belong to the surfels");
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (!surface.isOpen(i) && (begin.empty() || begin[i] == begin[i + 1])) continue;
    const bool there = surface.isOpen(i) && !begin.empty() && begin[i] < begin[i + 1] &&
                       begin[i + 1] <= surface.trim_maps.size();
    const int side = there ? surface.trim_maps[begin[i]] : 0;
    if (side < TrimMap::kLeastSide || side > TrimMap::kMostSide ||
        begin[i + 1] - begin[i] != 1 + TrimMap::numBytes(side)) {
      return badInput("the trim map of surfel " + std::to_string(i) + " has another size");
    }
  }
  return {};
}

}  // namespace

std::size_t SLIMSurface::numLeaves() const {
  return static_cast<std::size_t>(
      std::count_if(flags.begin(), flags.end(), [](std::uint8_t f) { return f & kSurfelLeaf; }));
}

std::vector<std::uint32_t> SLIMSurface::leaves() const {
  std::vector<std::uint32_t> leaves;
  for (std::uint32_t i = 0; i < size(); ++i) {
    if (isLeaf(i)) leaves.push_back(i);
  }
  return leaves;
}

std::size_t SLIMSurface::numLevels() const {
  std::array<bool, 256> seen{};
  for (const std::uint8_t k : level) seen[k] = true;
  return static_cast<std::size_t>(std::count(seen.begin(), seen.end(), true));
}

float SLIMSurface::varianceWeight(std::size_t i) const {
  constexpr double kNegligible = 1e-3;  // of r: smaller residuals are no defect of a leaf
  const double r = radius[i], e = error[i];
  const double expected = std::max(0.0, info.lambda) * info.diagonal * info.diagonal +
                          kNegligible * kNegligible * r * r;
  return static_cast<float>(expected / (expected + e * e));
}

TextureStatistics SLIMSurface::textureStatistics() const {
  TextureStatistics sum;
  for (std::size_t i = 0; i < size() && hasTextures(); ++i) {
    const int side = texture(i).side;
    if (side == 0 || !isLeaf(i)) continue;
    const double width = 2 * SurfelTexture::kReach * info.scale * radius[i] / side;
    sum.finest = sum.leaves == 0 ? width : std::min(sum.finest, width);
    ++sum.leaves;
    sum.texels += static_cast<std::uint64_t>(side) * static_cast<std::uint64_t>(side);
    sum.limited += side == SurfelTexture::kMostSide;
  }
  return sum;
}

void SLIMSurface::clear() {
  resize(0);
  child_begin.clear();
  children.clear();
  roots.clear();
  root_ball = {};
}

void SLIMSurface::resize(std::size_t count) {
  for (auto* column : {&cx, &cy, &cz, &radius, &nx, &ny, &nz, &error, &effective_count}) {
    column->resize(count);
  }
  coefficients.resize(count * static_cast<std::size_t>(stride()));
  for (auto* column : {&degree, &level, &flags}) column->resize(count);
  colors.clear();
  dropTextures();
  dropTrimMaps();
}

void SLIMSurface::setTrimMaps(const std::vector<std::uint8_t>& sides,
                              const std::vector<std::uint8_t>& bits) {
  dropTrimMaps();
  if (std::all_of(sides.begin(), sides.end(), [](std::uint8_t side) { return side == 0; })) return;
  trim_begin.resize(size() + 1);
  trim_maps.reserve(bits.size() + sides.size());
  auto next = bits.begin();
  for (std::size_t i = 0; i < size(); ++i) {
    trim_begin[i] = static_cast<std::uint32_t>(trim_maps.size());
    if (sides[i] == 0) continue;
    const auto end = next + static_cast<std::ptrdiff_t>(TrimMap::numBytes(sides[i]));
    trim_maps.push_back(sides[i]);
    trim_maps.insert(trim_maps.end(), next, end);
    flags[i] |= kSurfelOpen;
    next = end;
  }
  trim_begin[size()] = static_cast<std::uint32_t>(trim_maps.size());
  trim_maps.shrink_to_fit();
}

void SLIMSurface::dropTrimMaps() {
  trim_begin.clear();
  trim_maps.clear();
  for (std::uint8_t& flag : flags) flag &= static_cast<std::uint8_t>(~kSurfelOpen);
}

void SLIMSurface::setTextures(const std::vector<std::uint8_t>& sides,
                              const std::vector<std::uint8_t>& texels) {
  constexpr std::size_t kMostBytes = 0xffffffffu;  // offsets have 32 bits
  dropTextures();
  if (texels.size() > kMostBytes - sides.size()) return;
  if (std::all_of(sides.begin(), sides.end(), [](std::uint8_t side) { return side == 0; })) return;
  texture_begin.resize(size() + 1);
  textures.reserve(texels.size() + sides.size());
  auto next = texels.begin();
  for (std::size_t i = 0; i < size(); ++i) {
    texture_begin[i] = static_cast<std::uint32_t>(textures.size());
    if (sides[i] == 0) continue;
    const auto end = next + static_cast<std::ptrdiff_t>(SurfelTexture::numBytes(sides[i]));
    textures.push_back(sides[i]);
    textures.insert(textures.end(), next, end);
    next = end;
  }
  texture_begin[size()] = static_cast<std::uint32_t>(textures.size());
  textures.shrink_to_fit();
}

void SLIMSurface::dropTextures() {
  texture_begin.clear();
  textures.clear();
}

void SLIMSurface::flip(std::size_t i) {
  nx[i] = -nx[i];
  ny[i] = -ny[i];
  nz[i] = -nz[i];
  flipCoefficients(degree[i], coefficients.data() + i * static_cast<std::size_t>(stride()));
  if (isOpen(i)) mirrorTrimMap(trim_maps.data() + trim_begin[i]);
  if (hasColors()) flipColor(colors.data() + i * kColorBytes);
  if (!texture(i).empty()) mirrorTexture(textures.data() + texture_begin[i]);
}

Error SurfaceInfo::validate() const {
  if (degree < 1 || degree > kMaxDegree) return badInput("surface degree is not 1..4");
  if (!isKernel(fit_kernel) || !isKernel(blend_kernel))
    return badInput("the surface's kernel is none of this library's; fit it again");
  for (const double o : origin) {
    if (!within(o, -kMostWorldLength, kMostWorldLength))
      return badInput("the surface's origin is not finite or too far away; fit it again");
  }
  if (!within(scale, kLeastScale, kMostWorldLength))
    return badInput("the surface's scale is not a usable positive number; fit it again");
  if (!within(diagonal, 0.0, double{kMostLength}) || !within(lambda, 0.0, 0x1p40))
    return badInput("the surface's diagonal or noise variance is out of range; fit it again");
  if (!within(correlation, 1.0, 0x1p100))
    return badInput(
        "the surface's correlation of the noise is not a number from 1 on; fit it again");
  if (!within(penalty, 0.0, 0x1p100) || !within(t_mdl, 0.0, 0x1p100))
    return badInput("the surface's penalty or T_MDL is negative or not finite; fit it again");
  const auto isShare = [](double value) { return value > 0.0 && value <= 1.0; };
  if (!isShare(cover_radius) || !isShare(cover_threshold))
    return badInput("the surface's cover radius or threshold is not within 0 to 1; fit it again");
  return {};
}

Error SLIMSurface::validate() const {
  const std::size_t n = size();
  if (Error defect = info.validate()) return defect;
  for (const auto* column : {&cy, &cz, &radius, &nx, &ny, &nz, &error, &effective_count}) {
    if (column->size() != n) return badInput("surface columns have different lengths");
  }
  if (degree.size() != n || level.size() != n || flags.size() != n ||
      coefficients.size() != n * static_cast<std::size_t>(stride()) ||
      (hasColors() && colors.size() != n * kColorBytes)) {
    return badInput("surface columns have different lengths");
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (Error defect = checkSurfel(*this, i)) return defect;
  }
  if (Error defect = checkTextures(*this)) return defect;
  return checkTrimMaps(*this);
}

Error SLIMSurface::checkOverlap() const {
  constexpr std::size_t kMost = 2000, kLooked = 16;
  constexpr float kInner = 0.5f;  // of a radius
  std::vector<std::size_t> leaves;
  for (std::size_t i = 0; i < size(); ++i)
    if (isLeaf(i)) leaves.push_back(i);
  if (leaves.size() <= kMost) return {};
  std::size_t crowded = 0, most = 0;
  for (std::size_t k = 0; k < kLooked; ++k) {
    const std::size_t at = leaves[k * leaves.size() / kLooked];
    std::size_t over = 0;
    for (const std::size_t i : leaves) {
      const float dx = cx[i] - cx[at], dy = cy[i] - cy[at], dz = cz[i] - cz[at];
      const float reach = kInner * radius[i];
      over += dx * dx + dy * dy + dz * dz < reach * reach ? 1 : 0;
    }
    crowded += over > kMost ? 1 : 0;
    most = std::max(most, over);
  }
  if (2 * crowded <= kLooked) return {};
  return badInput("up to " + std::to_string(most) +
                  " leaves of the surface overlap at one place, as no fit makes them; fit the scan "
                  "again");
}

namespace {

template <typename T>
void appendTo(std::vector<T>& column, const std::vector<T>& more) {
  column.insert(column.end(), more.begin(), more.end());
}

/** Appends rows of any length of bytes; surfels without any have empty ones. */
void appendRows(const std::vector<std::uint32_t>& more_begin, const std::vector<std::uint8_t>& more,
                std::size_t count, std::size_t before, std::vector<std::uint32_t>& begin,
                std::vector<std::uint8_t>& rows) {
  if (begin.empty() && more_begin.empty()) return;
  const auto bytes = static_cast<std::uint32_t>(rows.size());
  begin.resize(before + 1, bytes);
  begin.pop_back();
  for (std::size_t i = 0; i <= count; ++i)
    begin.push_back(bytes + (more_begin.empty() ? 0 : more_begin[i]));
  appendTo(rows, more);
}

template <typename T>
std::vector<T> part(const std::vector<T>& column, std::size_t begin, std::size_t end) {
  return {column.begin() + static_cast<std::ptrdiff_t>(begin),
          column.begin() + static_cast<std::ptrdiff_t>(end)};
}

/** Some of the rows of any length; none where all of them are empty. */
void takeRows(const std::vector<std::uint32_t>& all_begin, const std::vector<std::uint8_t>& all,
              std::size_t first, std::size_t end, std::vector<std::uint32_t>& begin,
              std::vector<std::uint8_t>& rows) {
  if (all_begin.empty() || all_begin[first] == all_begin[end]) return;
  begin = part(all_begin, first, end + 1);
  rows = part(all, all_begin[first], all_begin[end]);
  for (std::uint32_t& at : begin) at -= all_begin[first];
}

}  // namespace

SLIMSurface SLIMSurface::slice(std::size_t begin, std::size_t end) const {
  const auto width = static_cast<std::size_t>(stride());
  SLIMSurface some;
  some.info = info;
  some.cx = part(cx, begin, end);
  some.cy = part(cy, begin, end);
  some.cz = part(cz, begin, end);
  some.radius = part(radius, begin, end);
  some.nx = part(nx, begin, end);
  some.ny = part(ny, begin, end);
  some.nz = part(nz, begin, end);
  some.coefficients = part(coefficients, begin * width, end * width);
  some.error = part(error, begin, end);
  some.effective_count = part(effective_count, begin, end);
  some.degree = part(degree, begin, end);
  some.level = part(level, begin, end);
  some.flags = part(flags, begin, end);
  takeRows(trim_begin, trim_maps, begin, end, some.trim_begin, some.trim_maps);
  takeRows(texture_begin, textures, begin, end, some.texture_begin, some.textures);
  if (hasColors()) some.colors = part(colors, begin * kColorBytes, end * kColorBytes);
  return some;
}

void SLIMSurface::append(const SLIMSurface& more) {
  if (empty()) info = more.info;
  const std::size_t before = size();
  appendRows(more.trim_begin, more.trim_maps, more.size(), before, trim_begin, trim_maps);
  const bool colored = more.hasColors() && (before == 0 || hasColors());
  if (colored) {
    appendTo(colors, more.colors);
    appendRows(more.texture_begin, more.textures, more.size(), before, texture_begin, textures);
  } else {
    colors.clear();
    dropTextures();
  }
  appendTo(cx, more.cx);
  appendTo(cy, more.cy);
  appendTo(cz, more.cz);
  appendTo(radius, more.radius);
  appendTo(nx, more.nx);
  appendTo(ny, more.ny);
  appendTo(nz, more.nz);
  appendTo(coefficients, more.coefficients);
  appendTo(error, more.error);
  appendTo(effective_count, more.effective_count);
  appendTo(degree, more.degree);
  appendTo(level, more.level);
  appendTo(flags, more.flags);
  child_begin.clear();
  children.clear();
  roots.clear();
}

}  // namespace pcl_slim
