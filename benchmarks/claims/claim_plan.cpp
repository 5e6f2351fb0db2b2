// SPDX-License-Identifier: BSD-3-Clause
#include "claims/claim_plan.h"

#include <algorithm>
#include <filesystem>

#include "claims/claims.h"
#include "pcl_slim/core/file_access.h"

namespace pcl_slim::comparison {

namespace {

/** Every .pcd and .ply of a folder, by name. */
Error
findScans(const std::string& folder, std::vector<std::string>& scans)
{
  std::error_code code;
  for (const auto& entry : std::filesystem::directory_iterator(folder, code)) {
    const std::string extension = lowerExtension(entry.path().string());
    if (extension == ".pcd" || extension == ".ply") scans.push_back(entry.path().string());
  }
  std::sort(scans.begin(), scans.end());
  if (!scans.empty()) return {};
  return {ErrorCode::kBadInput, "'" + folder + "' has no .pcd or .ply; name another folder"};
}

}  // namespace

void
ClaimPlan::declareOptions(OptionTable& options)
{
  options.text("claims", &claims_, "NAME,...",
               "rims, normals, zones, sheets, moves, peers, default; all: moves with -scans only");
  options.text("scans", &scans_, "FOLDER", "claim moves: every .pcd and .ply of a folder");
  lists_.declareScenes(options);
  lists_.declareSlim(options);
  lists_.declareMls(options);
  lists_.declareThreads(options);
}

Error
ClaimPlan::finishOptions()
{
  if (Error error = lists_.finish()) return error;
  if (claims_ == "all") {
    claim_list_ = claimNames();
    if (scans_.empty()) {
      claim_list_.erase(std::remove(claim_list_.begin(), claim_list_.end(), "moves"),
                        claim_list_.end());
    }
  } else if (Error error = parseWords("claims", claims_, claimNames(), claim_list_)) {
    return error;
  }
  const bool moves = std::count(claim_list_.begin(), claim_list_.end(), "moves") > 0;
  if (moves == scans_.empty()) {
    return {ErrorCode::kBadArgument, "claim moves and -scans belong together; give both"};
  }
  return moves ? findScans(scans_, scan_list_) : Error();
}

}  // namespace pcl_slim::comparison
