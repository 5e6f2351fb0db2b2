// SPDX-License-Identifier: BSD-3-Clause
#include "file/slim_file.h"
#include "file/texture_codec.h"

namespace pcl_slim::detail {

std::vector<unsigned char> packTextures(const SLIMSurface& surface,
                                        const std::vector<std::uint32_t>& order, int color_error) {
  RangeEncoder coder;
  TextureCodec<RangeEncoder> codec(coder, color_error);
  std::vector<std::uint8_t> rgb;
  for (const std::uint32_t i : order) {
    const SurfelTexture texture = surface.texture(i);
    int side = texture.side;
    rgb.assign(texture.rgb, texture.rgb + SurfelTexture::numBytes(side));
    codec.code(side, rgb);
  }
  std::vector<unsigned char> bytes = coder.finish();
  bytes.insert(bytes.begin(), static_cast<unsigned char>(color_error));
  return bytes;
}

Error unpackTextures(const unsigned char* bytes, std::size_t size, SLIMSurface& surface) {
  if (size == 0 || bytes[0] > kMostColorError || !surface.hasColors()) return contradictorySlim();
  RangeDecoder coder(bytes + 1, size - 1);
  TextureCodec<RangeDecoder> codec(coder, bytes[0]);
  std::vector<std::uint8_t> sides, texels, rgb;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    int side = 0;
    codec.code(side, rgb);
    // A small file may announce more texels than offsets of 32 bits reach.
    if (coder.failed() || texels.size() + rgb.size() > 0xffffffffu - surface.size())
      return contradictorySlim();
    sides.push_back(static_cast<std::uint8_t>(side));
    texels.insert(texels.end(), rgb.begin(), rgb.end());
  }
  if (!coder.done()) return contradictorySlim();
  surface.setTextures(sides, texels);
  return {};
}

}  // namespace pcl_slim::detail
