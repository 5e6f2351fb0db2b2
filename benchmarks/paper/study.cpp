// SPDX-License-Identifier: BSD-3-Clause
#include "paper/study.h"

#include <cmath>
#include <cstdio>
#include <cstring>

#include "pcl_slim/core/file_access.h"
#include "scan/cloud_file.h"
#include "support/lab/bench.h"

namespace pcl_slim::paper {

CloudView Model::view() const {
  CloudView made;
  made.xyz = points.data();
  made.xyz_stride = sizeof(Vector3);
  made.scalar = CloudView::Scalar::kDouble;
  made.size = points.size();
  if (normals.empty()) return made;
  made.normal = normals.data();
  made.normal_stride = 3 * sizeof(float);
  return made;
}

Result<Model> loadModel(const StudySettings& settings, const std::string& file) {
  const auto cloud = loadCloudFile(settings.data + "/" + file);
  if (!cloud) return cloud.error();
  const CloudView view = cloud->view();
  Model model;
  model.name = file.substr(0, file.find('.'));
  for (std::size_t i = 0; i < view.size; ++i) {
    const auto* at = static_cast<const unsigned char*>(view.xyz) + i * view.xyz_stride;
    Vector3 p;
    if (view.scalar == CloudView::Scalar::kDouble) {
      std::memcpy(p.data(), at, sizeof(p));
    } else {
      float q[3];
      std::memcpy(q, at, sizeof(q));
      p = {q[0], q[1], q[2]};
    }
    model.points.push_back(p);
    if (view.normal == nullptr) continue;
    float n[3];
    std::memcpy(n, static_cast<const unsigned char*>(view.normal) + i * view.normal_stride,
                sizeof(n));
    model.normals.insert(model.normals.end(), n, n + 3);
  }
  return model;
}

Result<Fitted> fitModel(const Model& model, const FitParams& params) {
  Fitted made;
  const double begin = measure::cpuSeconds();
  auto store = PointStore::build(model.view(), params.threads);
  if (!store) return store.error();
  made.store = std::move(*store);
  if (Error error = fitSurface(made.store, params, made.surface, &made.statistics)) return error;
  made.seconds = measure::cpuSeconds() - begin;
  ProjectionParams how;
  how.curvature = true;
  how.threads = params.threads;
  if (Error error = projectPoints(made.store, made.surface, how, made.projection)) return error;
  return made;
}

double projectionError(const Fitted& fitted) {
  double sum = 0;
  for (std::size_t i = 0; i < fitted.store.size(); ++i) {
    const Vector3 step = subtract(fitted.projection.position[i], fitted.store.position(i));
    sum += dot(step, step);
  }
  return std::sqrt(sum / static_cast<double>(fitted.store.size())) / fitted.store.diagonal();
}

int floatsOf(int degree) {
  constexpr int kFloats[] = {0, 7, 12, 16, 21};
  return kFloats[degree];
}

double LeafSweep::leavesAt(double wanted) const {
  for (std::size_t i = 0; i + 1 < error.size(); ++i) {
    if (error[i] < wanted || error[i + 1] > wanted || error[i] == error[i + 1]) continue;
    const double share = std::log(error[i] / wanted) / std::log(error[i] / error[i + 1]);
    return leaves[i] * std::pow(leaves[i + 1] / leaves[i], share);
  }
  return -1;
}

std::string number(const char* format, double value) {
  char text[64];
  std::snprintf(text, sizeof(text), format, value);
  return text;
}

Table::Table(std::string title, std::vector<std::string> columns) : text_("# " + title + "\n\n") {
  row(columns);
  row(std::vector<std::string>(columns.size(), "---"));
}

void Table::row(const std::vector<std::string>& cells) {
  std::string line = "|";
  for (const std::string& cell : cells) line += " " + cell + " |";
  std::printf("%s\n", line.c_str());
  std::fflush(stdout);
  text_ += line + "\n";
}

Error Table::save(const StudySettings& settings, const std::string& name) const {
  return writeFile(settings.out + "/" + name + ".md", text_.data(), text_.size());
}

}  // namespace pcl_slim::paper
