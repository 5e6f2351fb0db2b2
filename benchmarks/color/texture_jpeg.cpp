// SPDX-License-Identifier: BSD-3-Clause
#include "color/texture_jpeg.h"

#include <algorithm>
#include <cmath>
#include <cstdio>  // which jpeglib.h needs
#include <cstdlib>
#include <cstring>
#include <numeric>
#include <vector>

#include <jpeglib.h>

namespace pcl_slim::measure {
namespace {

constexpr int kBestQuality = 100;

struct Picture {
  int width = 0, height = 0;
  std::vector<JSAMPLE> rgb;

  JSAMPLE* row(int y) {
    return rgb.data() + 3 * static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
  }
};

/** All textures in rows of one picture, tall ones first; places without a texture repeat the last. */
Picture atlasOf(const SLIMSurface& surface) {
  std::vector<std::size_t> order(surface.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return surface.texture(a).side > surface.texture(b).side;
  });
  const auto texels = static_cast<double>(surface.textureStatistics().texels);
  Picture atlas;
  atlas.width = std::max(static_cast<int>(std::sqrt(texels)), +SurfelTexture::kMostSide);
  int x = 0, top = 0;
  for (const std::size_t i : order) {
    const SurfelTexture texture = surface.texture(i);
    if (texture.empty()) break;
    if (x + texture.side > atlas.width) x = 0, top = atlas.height;
    if (x == 0) {
      atlas.height = top + texture.side;
      const JSAMPLE last = atlas.rgb.empty() ? JSAMPLE{0} : atlas.rgb.back();
      atlas.rgb.resize(
          3 * static_cast<std::size_t>(atlas.width) * static_cast<std::size_t>(atlas.height), last);
    }
    for (int y = 0; y < texture.side; ++y) {
      std::memcpy(atlas.row(top + y) + 3 * x, texture.at(0, y),
                  3 * static_cast<std::size_t>(texture.side));
    }
    x += texture.side;
  }
  return atlas;
}

std::vector<unsigned char> encode(Picture& picture, int quality) {
  jpeg_compress_struct state;
  jpeg_error_mgr errors;
  state.err = jpeg_std_error(&errors);
  jpeg_create_compress(&state);
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&state, &bytes, &size);
  state.image_width = static_cast<JDIMENSION>(picture.width);
  state.image_height = static_cast<JDIMENSION>(picture.height);
  state.input_components = 3;
  state.in_color_space = JCS_RGB;
  jpeg_set_defaults(&state);
  jpeg_set_quality(&state, quality, TRUE);
  state.optimize_coding = TRUE;
  for (int c = 0; c < 3; ++c)
    state.comp_info[c].h_samp_factor = state.comp_info[c].v_samp_factor = 1;
  jpeg_start_compress(&state, TRUE);
  for (int y = 0; y < picture.height; ++y) {
    JSAMPROW row = picture.row(y);
    jpeg_write_scanlines(&state, &row, 1);
  }
  jpeg_finish_compress(&state);
  jpeg_destroy_compress(&state);
  std::vector<unsigned char> encoded(bytes, bytes + size);
  std::free(bytes);
  return encoded;
}

double rmsError(Picture& picture, const std::vector<unsigned char>& encoded) {
  jpeg_decompress_struct state;
  jpeg_error_mgr errors;
  state.err = jpeg_std_error(&errors);
  jpeg_create_decompress(&state);
  jpeg_mem_src(&state, encoded.data(), static_cast<unsigned long>(encoded.size()));
  jpeg_read_header(&state, TRUE);
  state.out_color_space = JCS_RGB;
  jpeg_start_decompress(&state);
  std::vector<JSAMPLE> decoded(3 * static_cast<std::size_t>(picture.width));
  double sum = 0;
  for (int y = 0; y < picture.height; ++y) {
    JSAMPROW row = decoded.data();
    jpeg_read_scanlines(&state, &row, 1);
    const JSAMPLE* own = picture.row(y);
    for (std::size_t k = 0; k < decoded.size(); ++k) {
      const double difference = static_cast<double>(own[k]) - decoded[k];
      sum += difference * difference;
    }
  }
  jpeg_finish_decompress(&state);
  jpeg_destroy_decompress(&state);
  return std::sqrt(sum / static_cast<double>(picture.rgb.size()));
}

}  // namespace

std::optional<std::size_t> jpegBytes(const SLIMSurface& surface, double rms) {
  Picture atlas = atlasOf(surface);
  std::size_t best = 0;
  for (int low = 1, high = kBestQuality; low <= high;) {
    const int quality = (low + high) / 2;
    const auto encoded = encode(atlas, quality);
    if (rmsError(atlas, encoded) <= rms) {
      best = encoded.size();
      high = quality - 1;
    } else {
      low = quality + 1;
    }
  }
  return best;
}

}  // namespace pcl_slim::measure
