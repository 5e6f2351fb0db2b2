// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <filesystem>

#include "ablation/cases.h"
#include "fit_with_constants.h"
#include "measure/clocks.h"
#include "pcl_slim/query/projection.h"
#include "scan/cloud_file.h"

namespace pcl_slim::ablation {

namespace {

constexpr double kDegreesPerRadian = 57.29577951308232;

/** A scan, alone or beside the surface it was made from, vertex by vertex. */
class ScanCase : public Case {
 public:
  ScanCase(std::string name, PointStore store, const FitParams& params)
      : Case(std::move(name)), store_(std::move(store)), params_(params)
  {
  }

  void setTruth(CloudFile truth) { truth_ = std::make_unique<CloudFile>(std::move(truth)); }

  Result<Figures> measure(const detail::FitConstants& constants) const override
  {
    SLIMSurface surface;
    FitStatistics statistics;
    const double start = measure::cpuSeconds();
    if (Error error = detail::fitWithConstants(constants, store_, params_, surface, &statistics)) {
      return error;
    }
    Figures figures;
    figures.seconds = measure::cpuSeconds() - start;
    figures.leaves = static_cast<double>(statistics.leaves);
    figures.uncovered = static_cast<double>(statistics.uncovered);
    Projection projection;
    ProjectionParams params;
    params.threads = params_.threads;
    if (Error error = projectPoints(store_, surface, params, projection)) return error;
    figures.farthest = farthestMove(projection);
    if (truth_) compare(projection, figures);
    return figures;
  }

 private:
  double farthestMove(const Projection& projection) const
  {
    double most = 0;
    for (std::size_t i = 0; i < store_.size(); ++i) {
      const auto p = store_.position(i);
      double d_sq = 0;
      for (std::size_t a = 0; a < 3; ++a) d_sq += std::pow(projection.position[i][a] - p[a], 2);
      most = std::max(most, d_sq);
    }
    return std::sqrt(most) / store_.diagonal();
  }

  /** Distances from the planes of the original's vertices, and angles with their normals. */
  void compare(const Projection& projection, Figures& figures) const
  {
    const CloudView view = truth_->view();
    double position = 0, normal = 0;
    for (std::size_t i = 0; i < store_.size(); ++i) {
      const auto* n = reinterpret_cast<const float*>(static_cast<const char*>(view.normal) +
                                                     store_.orderOfStore()[i] * view.normal_stride);
      const auto at = coordinates(view, store_.orderOfStore()[i]);
      double height = 0, cosine = 0;
      for (std::size_t a = 0; a < 3; ++a) {
        const double p = store_.origin()[a] + store_.scale() * projection.position[i][a];
        height += (p - at[a]) * n[a];
        cosine += static_cast<double>(projection.normal[i][a]) * n[a];
      }
      const double angle = std::acos(std::min(1.0, std::abs(cosine)));
      position += height * height;
      normal += angle * angle;
    }
    const auto count = static_cast<double>(store_.size());
    figures.position = std::sqrt(position / count);
    figures.normal = kDegreesPerRadian * std::sqrt(normal / count);
  }

  static std::array<double, 3> coordinates(const CloudView& view, std::size_t i)
  {
    const char* p = static_cast<const char*>(view.xyz) + i * view.xyz_stride;
    std::array<double, 3> at{};
    for (std::size_t a = 0; a < 3; ++a) {
      at[a] = view.scalar == CloudView::Scalar::kDouble ? reinterpret_cast<const double*>(p)[a]
                                                        : reinterpret_cast<const float*>(p)[a];
    }
    return at;
  }

  PointStore store_;
  std::unique_ptr<CloudFile> truth_;
  FitParams params_;
};

Result<std::unique_ptr<Case>>
openCase(const std::filesystem::path& path, const std::string& kind, const FitParams& params)
{
  const auto cloud = loadCloudFile(path.string());
  if (!cloud) return cloud.error();
  auto store = PointStore::build(cloud->view(), params.threads);
  if (!store) return store.error();
  auto opened = std::make_unique<ScanCase>(path.stem().string() + kind, std::move(*store), params);
  std::string original = path.string();
  const std::size_t noisy = original.find("_noisy");
  if (noisy != std::string::npos) {
    auto truth = loadCloudFile(original.replace(noisy, 6, "_original"));
    if (!truth) return truth.error();
    if (truth->size() == cloud->size()) opened->setTruth(std::move(*truth));
  }
  return std::unique_ptr<Case>(std::move(opened));
}

Error
addCase(const std::filesystem::path& path, const std::string& kind, const FitParams& params,
        Cases& cases)
{
  auto opened = openCase(path, kind, params);
  if (!opened) return opened.error();
  cases.push_back(std::move(*opened));
  return {};
}

}  // namespace

Result<Cases>
scanCases(const CaseRequest& request)
{
  Cases cases;
  if (request.data.empty()) return cases;
  std::error_code failure;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(request.data, failure)) {
    const std::string kind = entry.path().extension().string();
    if (kind == ".pcd" || kind == ".ply") files.push_back(entry.path());
  }
  if (failure) return Error{ErrorCode::kIo, request.data + ": " + failure.message()};
  std::sort(files.begin(), files.end());
  for (const auto& file : files) {
    if (file.string().find("_original") != std::string::npos) continue;
    FitParams params;
    params.threads = request.threads;
    if (Error error = addCase(file, "", params, cases)) return error;
    if (file.string().find("_noisy") == std::string::npos) continue;
    params.sharp_features = true;
    if (Error error = addCase(file, ", sharp", params, cases)) return error;
    params.sharp_features = false;
    params.robust = true;
    if (Error error = addCase(file, ", robust", params, cases)) return error;
  }
  return cases;
}

}  // namespace pcl_slim::ablation
