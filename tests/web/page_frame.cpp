// SPDX-License-Identifier: BSD-3-Clause
#include "web/page_frame.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>

#include <unistd.h>

namespace pcl_slim::test {
namespace {

/** \brief The columns that gbuffer.mjs writes, in local units. */
void fillBuffer(const float* columns, std::size_t pixels, double unit, GBuffer& buffer) {
  const float *geometry = columns, *attributes = columns + 4 * pixels,
              *named = columns + 8 * pixels;
  for (std::size_t i = 0; i < pixels; ++i) {
    if (geometry[4 * i + 3] == 0.0f) continue;
    buffer.surfel[i] = 0;
    buffer.depth[i] = static_cast<float>(unit * std::abs(geometry[4 * i + 3]));
    for (std::size_t k = 0; k < 3; ++k) buffer.normal[i][k] = geometry[4 * i + k];
    for (std::size_t k = 0; k < 2; ++k) {
      buffer.principal[i][k] = static_cast<float>(attributes[4 * i + k] / unit);
    }
    buffer.level[i] = static_cast<std::uint8_t>(named[4 * i + 3]);
    buffer.radius[i] = static_cast<float>(unit * named[4 * i + 2]);
  }
}

}  // namespace

std::string whyNoBrowser() {
  if (std::string(PCL_SLIM_NODE).empty()) return "node is not installed: pages are not drawn";
  if (std::string(PCL_SLIM_CHROMIUM).empty())
    return "Chromium is not installed: pages are not drawn";
  return "";
}

std::string runScript(const std::string& script, const std::string& arguments) {
  const std::string command = std::string(PCL_SLIM_NODE) + " " + PCL_SLIM_WEB_TESTS + "/" + script +
                              " '" + PCL_SLIM_CHROMIUM + "' " + arguments + " 2>&1";
  FILE* pipe = popen(command.c_str(), "r");
  if (!pipe) return "FAILED";
  std::string text;
  char part[4096];
  while (const std::size_t read = std::fread(part, 1, sizeof part, pipe)) text.append(part, read);
  return pclose(pipe) == 0 ? text : "FAILED " + text;
}

PageFrame drawPage(const std::string& script, const std::string& page, const SLIMSurface& surface,
                   const ImageSize& size, double lod, const std::vector<std::string>& modes,
                   bool exact) {
  const std::string out = page + ".frame";
  std::string arguments = page + " " + out + " " + std::to_string(size.width) + " " +
                          std::to_string(size.height) + " " + std::to_string(lod) +
                          (exact ? " 1" : " 0");
  for (const std::string& mode : modes) arguments += " " + mode;
  EXPECT_EQ(runScript(script, arguments), "");
  std::ifstream file(out, std::ios::binary);
  const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
  const auto pixels = static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height);
  const std::size_t columns = 3 * sizeof(double), pictures = columns + 12 * pixels * sizeof(float);
  PageFrame frame;
  if (bytes.size() != pictures + 4 * pixels * modes.size()) return frame;
  double units[3];
  std::memcpy(units, bytes.data(), sizeof units);
  frame.buffer.resize(size.width, size.height);
  std::vector<float> floats(12 * pixels);
  std::memcpy(floats.data(), bytes.data() + columns, 12 * pixels * sizeof(float));
  fillBuffer(floats.data(), pixels, units[0] / surface.info.scale, frame.buffer);
  for (std::size_t k = 0; k < modes.size(); ++k) {
    const auto begin = bytes.begin() + static_cast<std::ptrdiff_t>(pictures + 4 * pixels * k);
    frame.pictures.emplace_back(begin, begin + static_cast<std::ptrdiff_t>(4 * pixels));
  }
  std::remove(out.c_str());
  return frame;
}

}  // namespace pcl_slim::test
