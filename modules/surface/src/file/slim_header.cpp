// SPDX-License-Identifier: BSD-3-Clause
#include "file/slim_header.h"

#include <cmath>
#include <string>

#include "pcl_slim/core/vector3.h"

namespace pcl_slim::detail {

namespace {

// Like PNG's: catches files mangled as text, and is not valid text itself.
constexpr unsigned char kMagic[8] = {0x89, 'S', 'L', 'I', 'M', '\r', '\n', 0x1a};
constexpr std::uint32_t kNewest = kSlimRoundedVersion;
constexpr std::size_t kVersionAt = sizeof(kMagic);
constexpr std::size_t kChecksumAt = 24;

bool
plausible(const SurfaceInfo& info)
{
  const auto known = [](WeightKernel k) {
    return k == WeightKernel::kPower2 || k == WeightKernel::kPower4 || k == WeightKernel::kPower7 ||
           k == WeightKernel::kGaussian;
  };
  return info.degree >= 1 && info.degree <= kMaxDegree && known(info.fit_kernel) &&
         known(info.blend_kernel) && std::isfinite(info.scale) && info.scale > 0.0 &&
         isFinite(info.origin);
}

}  // namespace

/** Each step is a bijection of the state. */
std::uint64_t
slimChecksum(const unsigned char* bytes, std::size_t size)
{
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (std::size_t i = 0; i < size; ++i) {
    if (i == kChecksumAt) i += sizeof(hash);
    if (i >= size) break;
    hash = (hash ^ bytes[i]) * 0x100000001b3u;
  }
  return hash;
}

void
setSlimChecksum(std::uint64_t sum, std::vector<unsigned char>& bytes)
{
  ByteWriter out;
  out.putUnsigned(sum);
  std::memcpy(bytes.data() + kChecksumAt, out.bytes.data(), out.bytes.size());
}

std::uint32_t
slimVersionOf(const unsigned char* bytes, std::size_t size)
{
  const bool slim = size >= kSlimHeaderBytes && std::memcmp(bytes, kMagic, sizeof(kMagic)) == 0;
  return slim ? ByteReader(bytes + kVersionAt).getUnsigned<std::uint32_t>() : 0;
}

std::uint64_t
announcedChecksum(const unsigned char* bytes)
{
  return ByteReader(bytes + kChecksumAt).getUnsigned<std::uint64_t>();
}

void
putSlimHeader(const SurfaceInfo& info, std::uint32_t version, std::uint64_t surfels,
              std::uint64_t payload, ByteWriter& out)
{
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
  out.putUnsigned(std::uint32_t{0});
  for (const double value :
       {info.origin[0], info.origin[1], info.origin[2], info.scale, info.diagonal, info.lambda,
        info.penalty, info.t_mdl, info.cover_radius, info.cover_threshold}) {
    out.putDouble(value);
  }
}

void
sealSlim(std::vector<unsigned char>& bytes)
{
  setSlimChecksum(slimChecksum(bytes.data(), bytes.size()), bytes);
}

Error
checkSlimFrame(const unsigned char* bytes, std::size_t size)
{
  if (size < sizeof(kMagic) || std::memcmp(bytes, kMagic, sizeof(kMagic)) != 0) {
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

bool
holdsTrimMaps(const unsigned char* bytes)
{
  return ByteReader(bytes + kVersionAt).getUnsigned<std::uint32_t>() > kSlimVersion;
}

bool
holdsColors(const unsigned char* bytes)
{
  return ByteReader(bytes + kVersionAt).getUnsigned<std::uint32_t>() == kSlimColorsVersion;
}

Result<std::uint64_t>
getSlimHeader(const unsigned char* bytes, SurfaceInfo& info)
{
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
  in.getUnsigned<std::uint32_t>();
  for (double* value :
       {&info.origin[0], &info.origin[1], &info.origin[2], &info.scale, &info.diagonal,
        &info.lambda, &info.penalty, &info.t_mdl, &info.cover_radius, &info.cover_threshold}) {
    *value = in.getDouble();
  }
  if (!plausible(info)) return contradictorySlim();
  return count;
}

Error
contradictorySlim()
{
  return badInput("the .slim file's contents contradict each other; write it again");
}

}  // namespace pcl_slim::detail
