// SPDX-License-Identifier: BSD-3-Clause
#include "render/camera_file.h"

#include <cstdio>
#include <vector>

#include "common/options.h"
#include "pcl_slim/core/file_access.h"

namespace pcl_slim {
namespace {

const std::string kParallel = ",parallel";

}  // namespace

std::string cameraText(const Camera& camera) {
  const bool parallel = camera.projection == Camera::Projection::kOrthographic;
  std::string text;
  const auto add = [&](double value) {
    char number[40];
    std::snprintf(number, sizeof number, "%.17g", value);
    text += (text.empty() ? "" : ",") + std::string(number);
  };
  for (const auto* vector : {&camera.position, &camera.look_at, &camera.up}) {
    for (const double value : *vector) add(value);
  }
  add(parallel ? camera.view_height : camera.fov);
  return parallel ? text + kParallel : text;
}

bool looksLikeCamera(const std::string& text) {
  return text.find(',') != std::string::npos &&
         text.find_first_not_of("0123456789+-.,eEparl") == std::string::npos;
}

Result<Camera> cameraFromText(const std::string& text, double fov) {
  const bool parallel =
      text.size() > kParallel.size() &&
      text.compare(text.size() - kParallel.size(), kParallel.size(), kParallel) == 0;
  std::vector<double> v;
  const bool read =
      parseNumberList(parallel ? text.substr(0, text.size() - kParallel.size()) : text, v);
  if (!read || (v.size() != 10 && (v.size() != 9 || parallel))) {
    return Error{ErrorCode::kBadArgument,
                 "-camera takes auto, a file of -save_camera, or nine or ten numbers separated by "
                 "commas: position, target, upward direction and, if wanted, the field of view"};
  }
  Camera camera;
  camera.position = {v[0], v[1], v[2]};
  camera.look_at = {v[3], v[4], v[5]};
  camera.up = {v[6], v[7], v[8]};
  if (parallel) {
    camera.projection = Camera::Projection::kOrthographic;
    camera.view_height = v[9];
  } else {
    camera.fov = v.size() == 10 ? v[9] : fov;
  }
  if (Error error = camera.validate()) return error;
  return camera;
}

Error saveCamera(const std::string& path, const Camera& camera) {
  const std::string line = cameraText(camera) + "\n";
  return writeFile(path, line.data(), line.size());
}

Result<Camera> loadCamera(const std::string& path) {
  const auto bytes = readFile(path);
  if (!bytes) return bytes.error();
  std::string text(bytes->begin(), bytes->end());
  text.erase(std::min(text.find_last_not_of(" \r\n") + 1, text.size()));
  Result<Camera> camera = cameraFromText(text, Camera().fov);
  if (camera) return camera;
  return Error{ErrorCode::kBadInput,
               "'" + path +
                   "' holds no camera; -save_camera of "
                   "pcl_slim_render and the key c of pcl_slim_view write one"};
}

}  // namespace pcl_slim
