// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "pcl_slim/surface/oct_normal.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim_test {

/** Surfels on a sphere of radius .3 L: mixed degrees up to the given one, two levels, snapped
 * normals, centres on a 2^-15 grid and a scale and origin that float holds exactly. */
inline pcl_slim::SLIMSurface
sphereSurface(int degree, std::size_t count)
{
  using namespace pcl_slim;
  SLIMSurface surface;
  SurfaceInfo& info = surface.info;
  info.degree = degree;
  info.fit_kernel = WeightKernel::kPower2;
  info.oriented = true;
  info.origin = {100.0, -50.5, 3.25};
  info.scale = 4.0;
  info.diagonal = 0.6 * std::sqrt(3.0) + 1e-17;
  info.lambda = 1.0 / 3e8;
  info.penalty = 2.1;
  info.t_mdl = 0.01;
  info.num_points = 123456789012345u;
  surface.resize(count);
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  const auto grid = [](double v) { return static_cast<float>(std::round(v * 32768.0) / 32768.0); };
  for (std::size_t i = 0; i < count; ++i) {
    const auto n = snapNormal({normal(random), normal(random), normal(random)});
    surface.cx[i] = grid(0.3 * n[0]);
    surface.cy[i] = grid(0.3 * n[1]);
    surface.cz[i] = grid(0.3 * n[2]);
    surface.nx[i] = n[0];
    surface.ny[i] = n[1];
    surface.nz[i] = n[2];
    surface.radius[i] = static_cast<float>(0.05 + 0.03 * std::abs(normal(random)));
    surface.degree[i] = static_cast<std::uint8_t>(1 + (i % static_cast<std::size_t>(degree)));
    surface.level[i] = static_cast<std::uint8_t>(i % 5 == 0 ? 1 : 2);
    surface.flags[i] = static_cast<std::uint8_t>(i % 5 == 0 ? 0 : i % 7 == 0 ? 3 : 1);
    surface.error[i] = static_cast<float>(1e-4 * std::abs(normal(random)));
    surface.effective_count[i] = static_cast<float>(20.0 + std::abs(normal(random)));
    for (int k = 0; k < numCoefficients(surface.degree[i]); ++k) {
      surface.coefficients[i * static_cast<std::size_t>(surface.stride()) +
                           static_cast<std::size_t>(k)] = static_cast<float>(0.1 * normal(random));
    }
  }
  surface.buildLinks();
  return surface;
}

inline std::vector<unsigned char>
fileBytes(const std::string& path)
{
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

inline void
writeBytes(const std::string& path, const std::vector<unsigned char>& bytes)
{
  std::filesystem::remove(path);  // some file systems flush a file that is truncated and rewritten
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
}

inline void
writeText(const std::string& path, const std::string& text)
{
  writeBytes(path, std::vector<unsigned char>(text.begin(), text.end()));
}

/** A folder of this test's own, removed with the object. */
class TemporaryFolder {
 public:
  TemporaryFolder()
  {
    std::random_device random;
    path_ = std::filesystem::temp_directory_path() / ("pcl_slim_test_" + std::to_string(random()));
    std::filesystem::create_directories(path_);
  }
  ~TemporaryFolder()
  {
    std::error_code code;
    std::filesystem::remove_all(path_, code);
  }
  std::string operator/(const std::string& name) const { return (path_ / name).string(); }

  std::size_t numFiles() const
  {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(path_), {}));
  }

 private:
  std::filesystem::path path_;
};

}  // namespace pcl_slim_test
