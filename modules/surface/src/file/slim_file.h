// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/surface/slim_blocks.h"
#include "pcl_slim/surface/surface.h"

// A .slim file's header: magic (8 bytes), version and header size (4 each), size of the payload,
// checksum (8 each), then the members of SurfaceInfo. Version 2 has trim maps behind the columns,
// version 4 behind these colours; files without any are written as version 1. Version 3 consists of
// blocks, each a file of one of the other versions. Version 5 is a rounded surface.
//
// Version 3: header; blocks; directory: offset, bytes, surfels, first and end key (8 each), box (6
// floats) a block; its offset and the number of blocks (8 each).
//
// Version 6 is a surface with textures: header; version (4 bytes) and bytes (8) of the payload that
// follows, one of version 4 or 5; greatest error of a colour (1 byte) and the textures, range coded.
//
// Version 5: header; tolerance (double, local units), steps of a normal's
// coordinate (4 bytes), whether there are colours (1 byte), and the surfels, range coded.

namespace pcl_slim::detail {

/** \brief Appends numbers to a list of bytes, little-endian on every machine. */
class ByteWriter {
 public:
  template <typename Unsigned>
  void putUnsigned(Unsigned value) {
    for (std::size_t i = 0; i < sizeof(value); ++i) {
      bytes.push_back(static_cast<unsigned char>(value >> (8 * i)));
    }
  }

  void putFloat(float value) { putBitsOf<std::uint32_t>(value); }
  void putDouble(double value) { putBitsOf<std::uint64_t>(value); }

  void putFloats(const std::vector<float>& column) {
    for (const float value : column) putFloat(value);
  }

  void putBytes(const std::vector<std::uint8_t>& column) {
    bytes.insert(bytes.end(), column.begin(), column.end());
  }

  std::vector<unsigned char> bytes;

 private:
  template <typename Bits, typename Value>
  void putBitsOf(Value value) {
    static_assert(sizeof(Bits) == sizeof(Value));
    Bits bits;
    std::memcpy(&bits, &value, sizeof(bits));
    putUnsigned(bits);
  }
};

/** \brief Reads what ByteWriter wrote; the caller has checked that enough bytes are there. */
class ByteReader {
 public:
  explicit ByteReader(const unsigned char* bytes) : at_(bytes) {}

  template <typename Unsigned>
  Unsigned getUnsigned() {
    Unsigned value = 0;
    for (std::size_t i = 0; i < sizeof(value); ++i) {
      value = static_cast<Unsigned>(value | static_cast<Unsigned>(*at_++) << (8 * i));
    }
    return value;
  }

  float getFloat() { return getBitsAs<float, std::uint32_t>(); }
  double getDouble() { return getBitsAs<double, std::uint64_t>(); }

  void getFloats(std::vector<float>& column) {
    for (float& value : column) value = getFloat();
  }

  void getBytes(std::vector<std::uint8_t>& column) {
    for (std::uint8_t& value : column) value = *at_++;
  }

 private:
  template <typename Value, typename Bits>
  Value getBitsAs() {
    static_assert(sizeof(Bits) == sizeof(Value));
    const auto bits = getUnsigned<Bits>();
    Value value;
    std::memcpy(&value, &bits, sizeof(value));
    return value;
  }

  const unsigned char* at_;
};

constexpr std::size_t kSlimHeaderBytes = 136;
constexpr std::uint32_t kSlimVersion = 1;        ///< one surface without trim maps
constexpr std::uint32_t kSlimMapsVersion = 2;    ///< one surface with trim maps
constexpr std::uint32_t kSlimBlocksVersion = 3;  ///< blocks of such surfaces
constexpr std::uint32_t kSlimColorsVersion =
    4;  ///< one surface with colours, and maps where it has any
constexpr std::uint32_t kSlimRoundedVersion = 5;   ///< one rounded surface
constexpr std::uint32_t kSlimTexturesVersion = 6;  ///< one surface with textures

/** \brief Writes the header of a number of surfels that take payload bytes; the checksum is left 0,
 * for sealSlim. */
void putSlimHeader(const SurfaceInfo& info, std::uint32_t version, std::uint64_t surfels,
                   std::uint64_t payload, ByteWriter& out);

/** \brief FNV-1a over the bytes of a header, but for its checksum, and of what is behind them: any
 * single changed byte changes the result. */
std::uint64_t slimChecksum(const unsigned char* bytes, std::size_t size);

/** \brief The format version that bytes announce; 0 where they are no .slim file. */
std::uint32_t slimVersionOf(const unsigned char* bytes, std::size_t size);

/** \brief The checksum that a header announces. */
std::uint64_t announcedChecksum(const unsigned char* bytes);

/** \brief Writes the checksum into a complete file. */
void sealSlim(std::vector<unsigned char>& bytes);

/** \brief Reads the header of a file that checkSlimFrame passed.
 * \return the number of surfels, or an error where a value cannot be. */
Result<std::uint64_t> getSlimHeader(const unsigned char* bytes, SurfaceInfo& info);

/** \brief The error of a file whose numbers contradict each other. */
Error contradictorySlim();

/** \brief Leaves before internal surfels, each along a Morton curve: the order of rounded files. */
std::vector<std::uint32_t> packingOrder(const SLIMSurface& surface);

/** \brief The textures of surfels in an order. \param[in] color_error greatest error of a channel */
std::vector<unsigned char> packTextures(const SLIMSurface& surface,
                                        const std::vector<std::uint32_t>& order, int color_error);

/** \brief Gives the surfels of a surface, in its order, the textures that were packed. */
Error unpackTextures(const unsigned char* bytes, std::size_t size, SLIMSurface& surface);

/** \brief The surfels of a surface, rounded so that it moves by a share of the RMS residual of its
 * leaves.
 * \return nothing where a number is out of proportion to that; store such surfaces as floats. */
std::vector<unsigned char> packSurfels(const SLIMSurface& surface, double share);

/** \brief Inverse of packSurfels, without links. \param[in,out] surface its info is that of the
 * header */
Error unpackSurfels(const unsigned char* bytes, std::size_t size, std::uint64_t surfels,
                    SLIMSurface& surface);

/** \brief The surface of a file of any version but 3, without links. */
Result<SLIMSurface> decodeSlimBlock(const unsigned char* bytes, std::size_t size);

/** \brief The surfels of all blocks of a file of version 3, without links. */
Result<SLIMSurface> decodeSlimBlocks(const unsigned char* bytes, std::size_t size);

}  // namespace pcl_slim::detail
