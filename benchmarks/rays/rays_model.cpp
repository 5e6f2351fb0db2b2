// SPDX-License-Identifier: BSD-3-Clause
// Writes the generated surface, finely sampled, to be fitted by hundreds of thousands of leaves.
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include "common/options.h"
#include "pcl_slim/core/parallel.h"
#include "rays/generated_surface.h"

using namespace pcl_slim;

namespace {

using bench::generatedDirection;
using bench::generatedNormal;
using bench::generatedPoint;

int write(const std::string& path, std::size_t count, int threads) {
  std::vector<float> values(6 * count);
  parallelFor(count, resolveThreads(threads), 4096, [&](std::size_t i, int) {
    const Vector3 d = generatedDirection(i, count), p = generatedPoint(d), n = generatedNormal(d);
    for (std::size_t a = 0; a < 3; ++a) {
      values[6 * i + a] = static_cast<float>(p[a]);
      values[6 * i + 3 + a] = static_cast<float>(n[a]);
    }
  });
  std::ofstream file(path, std::ios::binary);
  file << "ply\nformat binary_little_endian 1.0\nelement vertex " << count
       << "\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\n"
          "property float ny\nproperty float nz\nend_header\n";
  file.write(reinterpret_cast<const char*>(values.data()),
             static_cast<std::streamsize>(values.size() * sizeof(float)));
  if (file.flush()) return kExitDone;
  std::fprintf(stderr, "rays_model: cannot write '%s'\n", path.c_str());
  return kExitFailed;
}

}  // namespace

int main(int argc, char** argv) {
  std::string path;
  int count = 3000000, threads = 0;
  OptionTable table("rays_model", "", "Writes a finely sampled surface with normals.");
  table.positional("OUT.ply", &path, "points");
  table.integer("points", &count, 1000, 100000000, "number of points");
  table.integer("threads", &threads, 0, 256, "threads, 0: all cores");
  if (const auto status = table.parse(argc, argv)) return *status;
  return write(path, static_cast<std::size_t>(count), threads);
}
