// SPDX-License-Identifier: BSD-3-Clause
// Claims of benchmarks/reports/comparison.md, on fewer points.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "claims/claims.h"

namespace {

using namespace pcl_slim;
using comparison::ClaimRow;
using comparison::ClaimTable;

/** A claim's rows under options as on the command line. */
std::vector<ClaimRow>
rowsOf(const std::string& claim, std::vector<const char*> arguments)
{
  comparison::Plan plan;
  OptionTable options("claims", "1", "");
  plan.declareOptions(options);
  arguments.insert(arguments.begin(), {"claims", "-threads", "1", "-claims", claim.c_str()});
  EXPECT_FALSE(options.parse(static_cast<int>(arguments.size()), arguments.data()));
  const Error error = plan.finishOptions(options);
  EXPECT_FALSE(error) << error.message;
  Console console(true);
  const Result<ClaimTable> table = measureClaim(claim, plan, console);
  EXPECT_TRUE(table) << table.error().message;
  return table ? table->rows : std::vector<ClaimRow>();
}

TEST(Claims, SheetsStayApart)
{
  const auto rows = rowsOf("sheets", {"-points", "60000"});
  ASSERT_EQ(rows.size(), 4u);
  for (const ClaimRow& row : rows) {
    EXPECT_TRUE(row.met()) << row.scene << ": " << row.run << " " << row.value << " %";
  }
}

TEST(Claims, BadNormalsDoLittleHarm)
{
  const auto rows = rowsOf("normals", {"-points", "20000", "-shapes", "sphere,torus,bumpy,relief",
                                       "-noises", "0.001,0.005"});
  ASSERT_EQ(rows.size(), 16u);
  for (const ClaimRow& row : rows) {
    EXPECT_TRUE(row.met()) << row.scene << ": " << row.quantity << " " << row.value;
  }
}

TEST(Claims, RimsAreBesideThoseOfMls)
{
  const auto rows = rowsOf("rims", {"-points", "20000", "-noises", "0.001", "-mls_orders", "2",
                                    "-mls_neighbours", "60,120,240"});
  ASSERT_EQ(rows.size(), 18u);
  for (const ClaimRow& row : rows) {
    if (row.quantity != "RMS position of the rim, all") continue;
    EXPECT_TRUE(row.met()) << row.run << ": " << row.value << " against " << row.goal;
  }
}

TEST(Claims, TheDefaultIsNearTheBestPenalty)
{
  const auto rows = rowsOf("default", {"-points", "20000", "-shapes", "bumpy,relief", "-noises",
                                       "0.001", "-kappas", "1,8", "-t_mdls", "0.01"});
  ASSERT_EQ(rows.size(), 4u);
  for (const ClaimRow& row : rows) EXPECT_TRUE(row.met()) << row.scene << ": " << row.value;
}

TEST(Claims, ScansAreMovedLittle)
{
  const char* data = std::getenv("PCL_SLIM_DATA");
  if (data == nullptr || !std::filesystem::is_directory(data)) GTEST_SKIP() << "no scans";
  const auto folder =
      std::filesystem::temp_directory_path() /
      ("pcl_slim_claims_" + std::to_string(reinterpret_cast<std::uintptr_t>(&data)));
  std::filesystem::create_directory(folder);
  for (const char* name : {"kinect_mosd_learn13.pcd", "lone_star_geyser_tls.pcd",
                           "angel_real_scan.ply", "stanford_dragon_res2.ply"}) {
    const auto file = std::filesystem::path(data) / name;
    if (std::filesystem::exists(file)) std::filesystem::copy(file, folder / name);
  }
  if (std::filesystem::is_empty(folder)) GTEST_SKIP() << "none of the scans is there";
  for (const ClaimRow& row : rowsOf("moves", {"-scans", folder.c_str()})) {
    EXPECT_TRUE(row.met()) << row.scene << ": " << row.quantity << " " << row.value;
  }
  std::filesystem::remove_all(folder);
}

}  // namespace
