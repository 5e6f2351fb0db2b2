// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/surface/surface_io.h"

#include <cmath>
#include <cstring>
#include <numeric>

#include "pcl_slim/core/file_access.h"
#include "pcl_slim/surface/oct_normal.h"

// Layout, little-endian: the header (kHeaderBytes), then columns of n values each: degree, level,
// flags (1 byte); centre x, y, z, radius, normal a, b, error, confidence (float); then for each
// coefficient k the values of those surfels that store it: as many as their degree has, but only
// the first where the flag byte's bit kPlaneOnly says that the normal is the plane's own.

namespace pcl_slim {

namespace {

// Like PNG's: catches files mangled as text, and is not valid text itself.
constexpr unsigned char kMagic[8] = {0x89, 'S', 'L', 'I', 'M', '\r', '\n', 0x1a};
constexpr std::uint32_t kVersion = 1;
constexpr std::size_t kChecksumAt = 24;
constexpr std::size_t kHeaderBytes = 136;
constexpr std::uint8_t kPlaneOnly = 0x80;  // set in files only
constexpr std::size_t kFixedBytesPerSurfel = 3 + 8 * sizeof(float);

class Writer {
 public:
  template <typename Unsigned>
  void putUnsigned(Unsigned value)
  {
    for (std::size_t i = 0; i < sizeof(value); ++i) {
      bytes.push_back(static_cast<unsigned char>(value >> (8 * i)));
    }
  }

  void putFloat(float value)
  {
    std::uint32_t bits;
    std::memcpy(&bits, &value, sizeof(bits));
    putUnsigned(bits);
  }

  void putDouble(double value)
  {
    std::uint64_t bits;
    std::memcpy(&bits, &value, sizeof(bits));
    putUnsigned(bits);
  }

  void putFloats(const std::vector<float>& column)
  {
    for (const float value : column) putFloat(value);
  }

  void putBytes(const std::vector<std::uint8_t>& c)
  {
    bytes.insert(bytes.end(), c.begin(), c.end());
  }

  std::vector<unsigned char> bytes;
};

/** Reads what Writer wrote; the caller has checked that enough bytes are there. */
class Reader {
 public:
  explicit Reader(const unsigned char* bytes) : at_(bytes) {}

  template <typename Unsigned>
  Unsigned getUnsigned()
  {
    Unsigned value = 0;
    for (std::size_t i = 0; i < sizeof(value); ++i) {
      value = static_cast<Unsigned>(value | static_cast<Unsigned>(*at_++) << (8 * i));
    }
    return value;
  }

  float getFloat()
  {
    const auto bits = getUnsigned<std::uint32_t>();
    float value;
    std::memcpy(&value, &bits, sizeof(value));
    return value;
  }

  double getDouble()
  {
    const auto bits = getUnsigned<std::uint64_t>();
    double value;
    std::memcpy(&value, &bits, sizeof(value));
    return value;
  }

  void getFloats(std::vector<float>& column)
  {
    for (float& value : column) value = getFloat();
  }

  void getBytes(std::vector<std::uint8_t>& column)
  {
    for (std::uint8_t& value : column) value = *at_++;
  }

 private:
  const unsigned char* at_;
};

/** FNV-1a over everything but the checksum's own eight bytes: each step is a bijection of the
 * state, so any single changed byte changes the result. */
std::uint64_t
checksum(const unsigned char* bytes, std::size_t size)
{
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (std::size_t i = 0; i < size; ++i) {
    if (i == kChecksumAt) i += sizeof(hash);
    if (i >= size) break;
    hash = (hash ^ bytes[i]) * 0x100000001b3u;
  }
  return hash;
}

Error
bad(const std::string& what)
{
  return {ErrorCode::kBadInput, what};
}

void
putHeader(const SLIMSurface& surface, std::uint64_t payload, Writer& out)
{
  const SurfaceInfo& info = surface.info;
  out.bytes.insert(out.bytes.end(), kMagic, kMagic + sizeof(kMagic));
  out.putUnsigned(kVersion);
  out.putUnsigned(static_cast<std::uint32_t>(kHeaderBytes));
  out.putUnsigned(payload);
  out.putUnsigned(std::uint64_t{0});  // the checksum, known at the end
  out.putUnsigned(static_cast<std::uint64_t>(surface.size()));
  out.putUnsigned(info.num_points);
  out.putUnsigned(static_cast<std::uint8_t>(info.degree));
  out.putUnsigned(static_cast<std::uint8_t>(info.fit_kernel));
  out.putUnsigned(static_cast<std::uint8_t>(info.blend_kernel));
  out.putUnsigned(static_cast<std::uint8_t>((info.oriented ? 1 : 0) | (info.paper_mode ? 2 : 0)));
  out.putUnsigned(std::uint32_t{0});
  for (const double value :
       {info.origin[0], info.origin[1], info.origin[2], info.scale, info.diagonal, info.lambda,
        info.penalty, info.t_mdl, info.cover_radius, info.cover_threshold}) {
    out.putDouble(value);
  }
}

/** Header after its checksum: the number of surfels and what SurfaceInfo holds. */
std::uint64_t
getHeader(Reader& in, SurfaceInfo& info)
{
  const auto count = in.getUnsigned<std::uint64_t>();
  info.num_points = in.getUnsigned<std::uint64_t>();
  info.degree = in.getUnsigned<std::uint8_t>();
  info.fit_kernel = static_cast<WeightKernel>(in.getUnsigned<std::uint8_t>());
  info.blend_kernel = static_cast<WeightKernel>(in.getUnsigned<std::uint8_t>());
  const auto switches = in.getUnsigned<std::uint8_t>();
  info.oriented = (switches & 1) != 0;
  info.paper_mode = (switches & 2) != 0;
  in.getUnsigned<std::uint32_t>();
  for (double* value :
       {&info.origin[0], &info.origin[1], &info.origin[2], &info.scale, &info.diagonal,
        &info.lambda, &info.penalty, &info.t_mdl, &info.cover_radius, &info.cover_threshold}) {
    *value = in.getDouble();
  }
  return count;
}

/** Names what is wrong with a file before anything is allocated for it. */
Error
checkFrame(const unsigned char* bytes, std::size_t size)
{
  if (size < sizeof(kMagic) || std::memcmp(bytes, kMagic, sizeof(kMagic)) != 0) {
    return bad("not a .slim file: it starts otherwise; name a file written by saveSlim");
  }
  if (size < kHeaderBytes)
    return bad("the .slim file is truncated inside its header; copy it again");
  Reader in(bytes + sizeof(kMagic));
  const auto version = in.getUnsigned<std::uint32_t>();
  if (version > kVersion) {
    return bad("the .slim file has format version " + std::to_string(version) +
               ", newer than the " + std::to_string(kVersion) +
               " this program reads; use a newer pcl_slim");
  }
  const auto header_bytes = in.getUnsigned<std::uint32_t>();
  const auto payload = in.getUnsigned<std::uint64_t>();
  if (version == 0 || header_bytes != kHeaderBytes) {
    return bad("the .slim file's header is corrupted; copy it again");
  }
  if (size - kHeaderBytes != payload) {
    const bool shorter = size - kHeaderBytes < payload;
    return bad("the .slim file is " +
               std::string(shorter ? "truncated" : "followed by other data") + ": " +
               std::to_string(size - kHeaderBytes) + " bytes of surfels where " +
               std::to_string(payload) + " are announced; copy it again");
  }
  if (in.getUnsigned<std::uint64_t>() != checksum(bytes, size)) {
    return bad("the .slim file is corrupted: its checksum does not match; copy it again");
  }
  return {};
}

bool
plausible(const SurfaceInfo& info)
{
  const auto known = [](WeightKernel k) {
    return k == WeightKernel::kPower2 || k == WeightKernel::kPower4 || k == WeightKernel::kPower7 ||
           k == WeightKernel::kGaussian;
  };
  return info.degree >= 1 && info.degree <= kMaxDegree && known(info.fit_kernel) &&
         known(info.blend_kernel) && std::isfinite(info.scale) && info.scale > 0.0 &&
         std::isfinite(info.origin[0]) && std::isfinite(info.origin[1]) &&
         std::isfinite(info.origin[2]);
}

/** Coefficients each surfel stores; nothing where a degree is out of range. */
std::optional<std::vector<std::uint8_t>>
storedCoefficients(const SLIMSurface& surface, const std::vector<std::uint8_t>& flags)
{
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

std::uint64_t
coefficientBytes(const std::vector<std::uint8_t>& counts)
{
  return sizeof(float) * std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
}

/** The flags as the file has them. */
std::vector<std::uint8_t>
fileFlags(const SLIMSurface& surface)
{
  std::vector<std::uint8_t> flags = surface.flags;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const float* c = surface.coefficientsOf(i);
    if (surface.degree[i] == 1 && c[1] == 0.0f && c[2] == 0.0f) flags[i] |= kPlaneOnly;
  }
  return flags;
}

void
getNormals(Reader& in, SLIMSurface& surface)
{
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

void
putNormals(const SLIMSurface& surface, Writer& out)
{
  std::vector<float> b(surface.size());
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const OctNormal code = encodeNormal({surface.nx[i], surface.ny[i], surface.nz[i]});
    out.putFloat(code.a);
    b[i] = code.b;
  }
  out.putFloats(b);
}

/** Calls visit(index into coefficients) in the file's order: by coefficient, then by surfel. */
template <typename Visit>
void
forEachCoefficient(const SLIMSurface& surface, const std::vector<std::uint8_t>& counts,
                   const Visit& visit)
{
  const auto stride = static_cast<std::size_t>(surface.stride());
  for (std::size_t k = 0; k < stride; ++k) {
    for (std::size_t i = 0; i < surface.size(); ++i) {
      if (k < counts[i]) visit(i * stride + k);
    }
  }
}

}  // namespace

std::vector<unsigned char>
encodeSlim(const SLIMSurface& surface)
{
  Writer out;
  const std::size_t n = surface.size();
  const std::vector<std::uint8_t> flags = fileFlags(surface);
  const auto counts = storedCoefficients(surface, flags);
  if (!counts) return {};
  const std::uint64_t payload = n * kFixedBytesPerSurfel + coefficientBytes(*counts);
  out.bytes.reserve(kHeaderBytes + payload);
  putHeader(surface, payload, out);
  for (const auto* column : {&surface.degree, &surface.level, &flags}) out.putBytes(*column);
  for (const auto* column : {&surface.cx, &surface.cy, &surface.cz, &surface.radius}) {
    out.putFloats(*column);
  }
  putNormals(surface, out);
  out.putFloats(surface.error);
  out.putFloats(surface.effective_count);
  forEachCoefficient(surface, *counts,
                     [&](std::size_t k) { out.putFloat(surface.coefficients[k]); });

  Writer sum;
  sum.putUnsigned(checksum(out.bytes.data(), out.bytes.size()));
  std::memcpy(out.bytes.data() + kChecksumAt, sum.bytes.data(), sum.bytes.size());
  return out.bytes;
}

Result<SLIMSurface>
decodeSlim(const unsigned char* bytes, std::size_t size)
{
  if (Error error = checkFrame(bytes, size)) return error;
  const Error corrupted = bad("the .slim file's contents contradict each other; write it again");
  Reader in(bytes + kChecksumAt + sizeof(std::uint64_t));
  SLIMSurface surface;
  const std::uint64_t count = getHeader(in, surface.info);
  const std::uint64_t payload = size - kHeaderBytes;
  if (!plausible(surface.info) || count > payload / kFixedBytesPerSurfel) return corrupted;

  surface.resize(static_cast<std::size_t>(count));
  for (auto* column : {&surface.degree, &surface.level, &surface.flags}) in.getBytes(*column);
  const auto counts = storedCoefficients(surface, surface.flags);
  if (!counts || count * kFixedBytesPerSurfel + coefficientBytes(*counts) != payload)
    return corrupted;
  for (std::uint8_t& flags : surface.flags) flags &= static_cast<std::uint8_t>(~kPlaneOnly);
  for (auto* column : {&surface.cx, &surface.cy, &surface.cz, &surface.radius}) {
    in.getFloats(*column);
  }
  getNormals(in, surface);
  in.getFloats(surface.error);
  in.getFloats(surface.effective_count);
  forEachCoefficient(surface, *counts,
                     [&](std::size_t k) { surface.coefficients[k] = in.getFloat(); });

  if (Error error = surface.validate()) return error;
  surface.buildLinks();
  return surface;
}

Error
saveSlim(const std::string& path, const SLIMSurface& surface)
{
  if (Error error = surface.validate()) return error;
  const std::vector<unsigned char> bytes = encodeSlim(surface);
  return writeFile(path, bytes.data(), bytes.size());
}

Result<SLIMSurface>
loadSlim(const std::string& path)
{
  const Result<std::vector<unsigned char>> bytes = readFile(path);
  if (!bytes) return bytes.error();
  Result<SLIMSurface> surface = decodeSlim(bytes->data(), bytes->size());
  if (surface) return surface;
  return Error{surface.error().code, "'" + path + "': " + surface.error().message};
}

}  // namespace pcl_slim
