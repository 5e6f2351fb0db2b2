// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/surface/surface_io.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <string>

#include "file/slim_file.h"
#include "pcl_slim/core/file_access.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/surface/detail/luma_texel.h"
#include "pcl_slim/surface/oct_normal.h"
#include "pcl_slim/surface/surfel_color.h"

// Layout, little-endian: the header (file/slim_file.h), then columns of n values each: degree,
// level, flags (1 byte); centre x, y, z, radius, normal a, b, error, confidence (float); then for
// each coefficient k the values of those surfels that store it: as many as their degree has, but
// only the first where the flag byte's bit kPlaneOnly is set: the normal is the plane's own; then,
// from version 2 on, the trim maps of those surfels whose flags announce one: side (1 byte) and
// bits; then, in version 4, the bytes of all surfels' colours (surfel_color.h). Versions 5 and 6 are
// described in file/slim_file.h.

namespace pcl_slim::detail {

namespace {

// Like PNG's: catches files mangled as text, and is not valid text itself.
constexpr unsigned char kMagic[8] = {0x89, 'S', 'L', 'I', 'M', '\r', '\n', 0x1a};
constexpr std::uint32_t kNewest = kSlimTexturesVersion;
constexpr std::size_t kVersionAt = sizeof(kMagic);
constexpr std::size_t kChecksumAt = 24;

/** Sets a header's checksum. */
void setSlimChecksum(std::uint64_t sum, std::vector<unsigned char>& bytes) {
  ByteWriter out;
  out.putUnsigned(sum);
  std::memcpy(bytes.data() + kChecksumAt, out.bytes.data(), out.bytes.size());
}

/** Names what is wrong with a file before anything is allocated for it: its magic, version,
 * sizes and checksum. */
Error checkSlimFrame(const unsigned char* bytes, std::size_t size) {
  if (!isSlim(bytes, size)) {
    return badInput("not a .slim file: it starts otherwise; name a file written by saveSlim");
  }
  if (size < kSlimHeaderBytes)
    return badInput("the .slim file is truncated inside its header; copy it again");
  ByteReader in(bytes + sizeof(kMagic));
  const auto version = in.getUnsigned<std::uint32_t>();
  if (version > kNewest) {
    return badInput("the .slim file has format version " + std::to_string(version) +
                    ", newer than the " + std::to_string(kNewest) +
                    " this program reads; use a newer pcl_slim");
  }
  const auto header_bytes = in.getUnsigned<std::uint32_t>();
  const auto payload = in.getUnsigned<std::uint64_t>();
  if (version == 0 || version == kSlimBlocksVersion || header_bytes != kSlimHeaderBytes) {
    return badInput("the .slim file's header is corrupted; copy it again");
  }
  if (size - kSlimHeaderBytes != payload) {
    const bool shorter = size - kSlimHeaderBytes < payload;
    return badInput("the .slim file is " +
                    std::string(shorter ? "truncated" : "followed by other data") + ": " +
                    std::to_string(size - kSlimHeaderBytes) + " bytes of surfels where " +
                    std::to_string(payload) + " are announced; copy it again");
  }
  if (in.getUnsigned<std::uint64_t>() != slimChecksum(bytes, size)) {
    return badInput("the .slim file is corrupted: its checksum does not match; copy it again");
  }
  return {};
}

}  // namespace

/** Each step is a bijection of the state. */
std::uint64_t slimChecksum(const unsigned char* bytes, std::size_t size) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (std::size_t i = 0; i < size; ++i) {
    if (i == kChecksumAt) i += sizeof(hash);
    if (i >= size) break;
    hash = (hash ^ bytes[i]) * 0x100000001b3u;
  }
  return hash;
}

std::uint32_t slimVersionOf(const unsigned char* bytes, std::size_t size) {
  const bool slim = size >= kSlimHeaderBytes && std::memcmp(bytes, kMagic, sizeof(kMagic)) == 0;
  return slim ? ByteReader(bytes + kVersionAt).getUnsigned<std::uint32_t>() : 0;
}

std::uint64_t announcedChecksum(const unsigned char* bytes) {
  return ByteReader(bytes + kChecksumAt).getUnsigned<std::uint64_t>();
}

void putSlimHeader(const SurfaceInfo& info, std::uint32_t version, std::uint64_t surfels,
                   std::uint64_t payload, ByteWriter& out) {
  out.bytes.insert(out.bytes.end(), kMagic, kMagic + sizeof(kMagic));
  out.putUnsigned(version);
  out.putUnsigned(static_cast<std::uint32_t>(kSlimHeaderBytes));
  out.putUnsigned(payload);
  out.putUnsigned(std::uint64_t{0});  // the checksum, which is known at the end
  out.putUnsigned(surfels);
  out.putUnsigned(info.num_points);
  out.putUnsigned(static_cast<std::uint8_t>(info.degree));
  out.putUnsigned(static_cast<std::uint8_t>(info.fit_kernel));
  out.putUnsigned(static_cast<std::uint8_t>(info.blend_kernel));
  out.putUnsigned(static_cast<std::uint8_t>((info.oriented ? 1 : 0) | (info.paper_mode ? 2 : 0) |
                                            (info.sides_in_doubt ? 4 : 0)));
  // 0 for independent errors, as in files of the time when no correlation was stored.
  out.putFloat(info.correlation > 1 ? static_cast<float>(info.correlation) : 0.0f);
  for (const double value :
       {info.origin[0], info.origin[1], info.origin[2], info.scale, info.diagonal, info.lambda,
        info.penalty, info.t_mdl, info.cover_radius, info.cover_threshold}) {
    out.putDouble(value);
  }
}

void sealSlim(std::vector<unsigned char>& bytes) {
  setSlimChecksum(slimChecksum(bytes.data(), bytes.size()), bytes);
}

Result<std::uint64_t> getSlimHeader(const unsigned char* bytes, SurfaceInfo& info) {
  ByteReader in(bytes + kChecksumAt + sizeof(std::uint64_t));
  const auto count = in.getUnsigned<std::uint64_t>();
  info.num_points = in.getUnsigned<std::uint64_t>();
  info.degree = in.getUnsigned<std::uint8_t>();
  info.fit_kernel = static_cast<WeightKernel>(in.getUnsigned<std::uint8_t>());
  info.blend_kernel = static_cast<WeightKernel>(in.getUnsigned<std::uint8_t>());
  const auto switches = in.getUnsigned<std::uint8_t>();
  info.oriented = (switches & 1) != 0;
  info.paper_mode = (switches & 2) != 0;
  info.sides_in_doubt = (switches & 4) != 0;
  info.correlation = std::max(1.0, double{in.getFloat()});
  for (double* value :
       {&info.origin[0], &info.origin[1], &info.origin[2], &info.scale, &info.diagonal,
        &info.lambda, &info.penalty, &info.t_mdl, &info.cover_radius, &info.cover_threshold}) {
    *value = in.getDouble();
  }
  if (Error error = info.validate()) return error;
  return count;
}

Error contradictorySlim() {
  return badInput("the .slim file's contents contradict each other; write it again");
}

}  // namespace pcl_slim::detail

namespace pcl_slim {

using namespace detail;

namespace {

constexpr std::uint8_t kPlaneOnly = 0x80;  // set in files only
constexpr std::size_t kFixedBytesPerSurfel = 3 + 8 * sizeof(float);

/** Coefficients each surfel stores; nothing where a degree is out of range. */
std::optional<std::vector<std::uint8_t>> storedCoefficients(
    const SLIMSurface& surface, const std::vector<std::uint8_t>& flags) {
  std::vector<std::uint8_t> counts(surface.size());
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const int degree = surface.degree[i];
    const bool plane_only = (flags[i] & kPlaneOnly) != 0;
    if (degree < 1 || degree > surface.info.degree || (plane_only && degree > 1))
      return std::nullopt;
    counts[i] = static_cast<std::uint8_t>(plane_only ? 1 : numCoefficients(degree));
  }
  return counts;
}

/** Bytes of all columns of surfels that store a number of coefficients each. */
std::uint64_t payloadBytes(const std::vector<std::uint8_t>& counts) {
  return counts.size() * kFixedBytesPerSurfel +
         sizeof(float) * std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
}

/** The flags as the file has them. */
std::vector<std::uint8_t> fileFlags(const SLIMSurface& surface) {
  std::vector<std::uint8_t> flags = surface.flags;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const float* c = surface.coefficientsOf(i);
    if (surface.degree[i] == 1 && c[1] == 0.0f && c[2] == 0.0f) flags[i] |= kPlaneOnly;
  }
  return flags;
}

void getNormals(ByteReader& in, SLIMSurface& surface) {
  std::vector<float> a(surface.size()), b(surface.size());
  in.getFloats(a);
  in.getFloats(b);
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const std::array<float, 3> normal = decodeNormal({a[i], b[i]});
    surface.nx[i] = normal[0];
    surface.ny[i] = normal[1];
    surface.nz[i] = normal[2];
  }
}

void putNormals(const SLIMSurface& surface, ByteWriter& out) {
  std::vector<float> b(surface.size());
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const OctNormal code = encodeNormal({surface.nx[i], surface.ny[i], surface.nz[i]});
    out.putFloat(code.a);
    b[i] = code.b;
  }
  out.putFloats(b);
}

/** Reads the trim maps of the surfels whose flags announce them, which must be all remaining bytes.
 */
Error getTrimMaps(const unsigned char* at, std::uint64_t left, SLIMSurface& surface) {
  std::vector<std::uint8_t> sides(surface.size()), bits;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    if (!surface.isOpen(i)) continue;
    const int side = left > 0 ? *at : 0;
    const std::size_t bytes = TrimMap::numBytes(side);
    if (side < TrimMap::kLeastSide || side > TrimMap::kMostSide || left < 1 + bytes)
      return contradictorySlim();
    sides[i] = static_cast<std::uint8_t>(side);
    bits.insert(bits.end(), at + 1, at + 1 + bytes);
    at += 1 + bytes;
    left -= 1 + bytes;
  }
  if (left != 0) return contradictorySlim();
  surface.setTrimMaps(sides, bits);
  return {};
}

/** Calls visit(index into coefficients) in the file's order: by coefficient, then by surfel. */
template <typename Visit>
void forEachCoefficient(const SLIMSurface& surface, const std::vector<std::uint8_t>& counts,
                        const Visit& visit) {
  const auto stride = static_cast<std::size_t>(surface.stride());
  for (std::size_t k = 0; k < stride; ++k) {
    for (std::size_t i = 0; i < surface.size(); ++i) {
      if (k < counts[i]) visit(i * stride + k);
    }
  }
}

/** What follows a file's header. */
struct Payload {
  std::uint32_t version = kSlimVersion;
  std::vector<unsigned char> bytes;
};

Payload encodeFloats(const SLIMSurface& surface) {
  const std::vector<std::uint8_t> flags = fileFlags(surface);
  const auto counts = storedCoefficients(surface, flags);
  if (!counts) return {};
  ByteWriter out;
  out.bytes.reserve(payloadBytes(*counts) + surface.trim_maps.size() + surface.colors.size());
  for (const auto* column : {&surface.degree, &surface.level, &flags}) out.putBytes(*column);
  for (const auto* column : {&surface.cx, &surface.cy, &surface.cz, &surface.radius}) {
    out.putFloats(*column);
  }
  putNormals(surface, out);
  out.putFloats(surface.error);
  out.putFloats(surface.effective_count);
  forEachCoefficient(surface, *counts,
                     [&](std::size_t k) { out.putFloat(surface.coefficients[k]); });
  out.putBytes(surface.trim_maps);
  out.putBytes(surface.colors);
  return {surface.hasColors()     ? kSlimColorsVersion
          : surface.hasTrimMaps() ? kSlimMapsVersion
                                  : kSlimVersion,
          std::move(out.bytes)};
}

/** A payload followed by the textures of the surfels in an order. */
Payload withTextures(const Payload& surfels, const SLIMSurface& surface,
                     const std::vector<std::uint32_t>& order, int color_error) {
  ByteWriter out;
  out.putUnsigned(surfels.version);
  out.putUnsigned(std::uint64_t{surfels.bytes.size()});
  out.putBytes(surfels.bytes);
  out.putBytes(packTextures(surface, order, color_error));
  return {kSlimTexturesVersion, std::move(out.bytes)};
}

/** The surfels of a payload of floats. */
Error getFloats(std::uint32_t version, std::uint64_t count, const unsigned char* bytes,
                std::uint64_t size, SLIMSurface& surface) {
  if (count > size / kFixedBytesPerSurfel) return contradictorySlim();
  surface.resize(static_cast<std::size_t>(count));
  ByteReader in(bytes);
  for (auto* column : {&surface.degree, &surface.level, &surface.flags}) in.getBytes(*column);
  const auto counts = storedCoefficients(surface, surface.flags);
  const std::uint64_t columns = counts ? payloadBytes(*counts) : 0;
  const std::uint64_t colors = version == kSlimColorsVersion ? count * kColorBytes : 0;
  if (!counts || columns + colors > size) return contradictorySlim();
  if (columns < size && version == kSlimVersion) return contradictorySlim();
  for (std::uint8_t& flags : surface.flags) flags &= static_cast<std::uint8_t>(~kPlaneOnly);
  for (auto* column : {&surface.cx, &surface.cy, &surface.cz, &surface.radius}) {
    in.getFloats(*column);
  }
  getNormals(in, surface);
  in.getFloats(surface.error);
  in.getFloats(surface.effective_count);
  forEachCoefficient(surface, *counts,
                     [&](std::size_t k) { surface.coefficients[k] = in.getFloat(); });
  const std::uint64_t maps = size - columns - colors;
  if (Error error = getTrimMaps(bytes + columns, maps, surface)) return error;
  surface.colors.assign(bytes + size - colors, bytes + size);
  return {};
}

/** The surfels of a payload of any version. */
Error getSurfels(std::uint32_t version, std::uint64_t count, const unsigned char* bytes,
                 std::uint64_t size, SLIMSurface& surface) {
  constexpr std::uint64_t kHead = sizeof(std::uint32_t) + sizeof(std::uint64_t);
  if (version == kSlimRoundedVersion)
    return unpackSurfels(bytes, static_cast<std::size_t>(size), count, surface);
  if (version != kSlimTexturesVersion) return getFloats(version, count, bytes, size, surface);
  if (size < kHead) return contradictorySlim();
  ByteReader in(bytes);
  const auto inner = in.getUnsigned<std::uint32_t>();
  const auto surfels = in.getUnsigned<std::uint64_t>();
  if ((inner != kSlimColorsVersion && inner != kSlimRoundedVersion) || surfels > size - kHead)
    return contradictorySlim();
  if (Error error = getSurfels(inner, count, bytes + kHead, surfels, surface)) return error;
  return unpackTextures(bytes + kHead + surfels, static_cast<std::size_t>(size - kHead - surfels),
                        surface);
}

}  // namespace

std::vector<unsigned char> encodeSlim(const SLIMSurface& surface, const SlimRounding& rounding) {
  Payload payload;
  std::vector<std::uint32_t> order;
  if (rounding.share > 0.0 && !surface.empty())
    payload = {kSlimRoundedVersion, packSurfels(surface, rounding.share)};
  const bool rounded = !payload.bytes.empty();
  if (!rounded) payload = encodeFloats(surface);
  if (payload.bytes.empty() && !surface.empty()) return {};
  if (surface.hasTextures()) {
    std::vector<std::uint32_t> own(surface.size());
    std::iota(own.begin(), own.end(), 0u);
    payload =
        withTextures(payload, surface, rounded ? packingOrder(surface) : own, rounding.color_error);
  }
  ByteWriter out;
  out.bytes.reserve(kSlimHeaderBytes + payload.bytes.size());
  putSlimHeader(surface.info, payload.version, surface.size(), payload.bytes.size(), out);
  out.putBytes(payload.bytes);
  sealSlim(out.bytes);
  return out.bytes;
}

Result<SLIMSurface> detail::decodeSlimBlock(const unsigned char* bytes, std::size_t size) {
  if (Error error = checkSlimFrame(bytes, size)) return error;
  SLIMSurface surface;
  const Result<std::uint64_t> count = getSlimHeader(bytes, surface.info);
  if (!count) return count.error();
  if (Error error = getSurfels(slimVersionOf(bytes, size), *count, bytes + kSlimHeaderBytes,
                               size - kSlimHeaderBytes, surface))
    return error;
  if (Error error = surface.validate()) return error;
  return surface;
}

Result<SLIMSurface> decodeSlim(const unsigned char* bytes, std::size_t size) {
  const bool blocks = slimVersionOf(bytes, size) == kSlimBlocksVersion;
  Result<SLIMSurface> surface =
      blocks ? decodeSlimBlocks(bytes, size) : decodeSlimBlock(bytes, size);
  if (!surface) return surface;
  surface->buildLinks();
  if (Error error = surface->checkOverlap()) return error;
  return surface;
}

Error saveSlim(const std::string& path, const SLIMSurface& surface, const SlimRounding& rounding) {
  if (Error error = surface.validate()) return error;
  if (rounding.color_error < 0 || rounding.color_error > kMostColorError)
    return {ErrorCode::kBadArgument, "the error of colours must be 0 to 32 of 255"};
  const std::vector<unsigned char> bytes = encodeSlim(surface, rounding);
  return writeFile(path, bytes.data(), bytes.size());
}

bool isSlim(const unsigned char* bytes, std::size_t size) {
  return size >= sizeof(kMagic) && std::memcmp(bytes, kMagic, sizeof(kMagic)) == 0;
}

Result<SLIMSurface> loadSlim(const std::string& path) {
  const Result<std::vector<unsigned char>> bytes = readFile(path);
  if (!bytes) return bytes.error();
  Result<SLIMSurface> surface = decodeSlim(bytes->data(), bytes->size());
  if (surface) return surface;
  return Error{surface.error().code, "'" + path + "': " + surface.error().message};
}

}  // namespace pcl_slim
