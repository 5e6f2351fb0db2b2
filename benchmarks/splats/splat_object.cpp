// SPDX-License-Identifier: BSD-3-Clause
// splat_object: writes the painted object on which splats are measured, as a point cloud.
#include <cstdio>
#include <cstring>
#include <random>
#include <string>

#include "common/options.h"
#include "pcl_slim/core/file_access.h"
#include "pcl_slim/filters/io/point_file.h"
#include "support/lab/painted_object.h"

namespace {

using namespace pcl_slim;

PointFile fileOf(const measure::PaintedObject& object, bool normals) {
  PointFile file;
  PointTable& cloud = file.cloud;
  for (const char* name : {"x", "y", "z", "rgb", "normal_x", "normal_y", "normal_z"}) {
    if (name[0] == 'n' && !normals) break;
    addField(cloud, name, kFloat32);
  }
  cloud.resize(object.rgb.size());
  for (std::size_t i = 0; i < object.rgb.size(); ++i) {
    unsigned char* at = cloud.data.data() + i * cloud.point_step;
    std::memcpy(at, &object.xyz[3 * i], 12);
    std::memcpy(at + 12, &object.rgb[i], 4);
    if (normals) std::memcpy(at + 16, &object.normals[3 * i], 12);
  }
  return file;
}

/** Moves the points by isotropic noise. */
void addNoise(double sigma, std::uint64_t seed, measure::PaintedObject& object) {
  std::mt19937_64 random(seed + 1);
  std::normal_distribution<float> step(0, static_cast<float>(sigma));
  for (float& x : object.xyz) x += step(random);
}

}  // namespace

int main(int argc, char** argv) {
  std::string output;
  std::uint64_t points = 346733, seed = 1;
  double noise = 0;
  OptionTable options("splat_object", "1",
                      "Writes a duck with stripes and eyes: points with normals and colours.");
  options.positional("OUT.pcd|.ply", &output, "x y z, rgb and, without noise, the normal");
  options.integer("points", &points, 100, 100000000, "points, even over the area");
  options.number("noise", &noise, 0, 1,
                 "standard deviation of the points' error; the object is 2 long");
  options.integer("seed", &seed, 0, 1000000000, "start of the random numbers");
  if (const auto status = options.parse(argc, argv)) return *status;
  measure::PaintedObject object = measure::paintDuck(points, seed);
  if (noise > 0) addNoise(noise, seed, object);
  if (const Error error = savePointFile(output, fileOf(object, noise == 0))) {
    std::fprintf(stderr, "splat_object: %s\n", error.message.c_str());
    return kExitFailed;
  }
  const auto eye = measure::duckEye();
  std::printf("%zu points; the eye is at %.4f,%.4f,%.4f\n", object.rgb.size(), eye[0], eye[1],
              eye[2]);
  return kExitDone;
}
