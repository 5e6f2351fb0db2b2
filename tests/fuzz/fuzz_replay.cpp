// SPDX-License-Identifier: BSD-3-Clause
// pcl_slim_fuzz_replay CORPUS: past failures and a few good inputs through the fuzzers' targets, in
// the suite, by any compiler and on every set of instructions. With -seeds it writes the good
// inputs instead.
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "fuzz/fuzz_targets.h"
#include "pcl_slim/filters/io/surface_files.h"
#include "pcl_slim/fit/fit.h"
#include "support/instruction_sets.h"

namespace {

using namespace pcl_slim_test;
using Bytes = std::vector<std::uint8_t>;

struct Target {
  const char* folder;
  int (*run)(const std::uint8_t*, std::size_t);
};

constexpr Target kTargets[] = {{"slim", fuzzSlim}, {"pcd", fuzzPcd},       {"ply", fuzzPly},
                               {"las", fuzzLas},   {"text", fuzzText},     {"mesh", fuzzMesh},
                               {"vtp", fuzzVtp},   {"camera", fuzzCamera}, {"clouds", fuzzClouds}};

/** A hundred floats of a wave, as fuzzClouds() reads them. */
Bytes waveBytes() {
  std::vector<float> values;
  for (int i = 0; i < 144; ++i) {
    const float x = static_cast<float>(i % 12) / 12.0f, y = static_cast<float>(i / 12) / 12.0f;
    values.insert(values.end(), {x, y, 0.1f * std::sin(6 * x) * std::cos(5 * y)});
  }
  Bytes bytes(2 + 4 * values.size());
  bytes[1] = 2;
  std::memcpy(bytes.data() + 2, values.data(), 4 * values.size());
  return bytes;
}

/** A surface of that wave in every format that stores one. */
bool writeSeeds(const std::filesystem::path& corpus) {
  const Bytes wave = waveBytes();
  std::ofstream(corpus / "clouds" / "wave", std::ios::binary)
      .write(reinterpret_cast<const char*>(wave.data()), static_cast<std::streamsize>(wave.size()));
  pcl_slim::CloudView view;
  view.xyz = wave.data() + 2;
  view.xyz_stride = 12;
  view.size = 144;
  const auto store = pcl_slim::PointStore::build(view, 1);
  pcl_slim::SLIMSurface surface;
  if (!store || fitSurface(*store, {}, surface)) return false;
  for (const char* format : {"slim", "pcd", "ply", "vtp"}) {
    const auto path = corpus / format / (std::string("wave.") + format);
    if (saveSurface(path.string(), surface)) return false;
  }
  return true;
}

std::size_t replay(const Target& target, const std::filesystem::path& folder) {
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    std::ifstream file(entry.path(), std::ios::binary);
    const Bytes bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    forEachInstructionSet([&](const char*) { target.run(bytes.data(), bytes.size()); });
    ++files;
  }
  return files;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) return 2;
  const std::filesystem::path corpus(argv[1]);
  if (argc > 2 && std::string(argv[2]) == "-seeds") return writeSeeds(corpus) ? 0 : 1;
  for (const Target& target : kTargets) {
    const std::size_t files = replay(target, corpus / target.folder);
    std::printf("%s: %zu\n", target.folder, files);
    if (files == 0) return 1;
  }
  return 0;
}
