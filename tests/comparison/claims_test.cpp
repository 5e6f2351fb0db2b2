// SPDX-License-Identifier: BSD-3-Clause
// Claims of benchmarks/README.md, on fewer points.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "claims/claims.h"
#include "support/temporary_folder.h"

namespace {

using namespace pcl_slim;
using comparison::ClaimRow;
using comparison::ClaimTable;

/** A claim's rows under options as on the command line. */
std::vector<ClaimRow>
rowsOf(const std::string& claim, std::vector<const char*> arguments)
{
  comparison::ClaimPlan plan;
  OptionTable options("claims", "1", "");
  plan.declareOptions(options);
  arguments.insert(arguments.begin(), {"claims", "-threads", "1", "-claims", claim.c_str()});
  EXPECT_FALSE(options.parse(static_cast<int>(arguments.size()), arguments.data()));
  const Error error = plan.finishOptions();
  EXPECT_FALSE(error) << error.message;
  Console console(true);
  const Result<ClaimTable> table = measureClaim(claim, plan, console);
  EXPECT_TRUE(table) << table.error().message;
  return table ? table->rows : std::vector<ClaimRow>();
}

/** The rows of one quantity. */
std::vector<ClaimRow>
only(const std::vector<ClaimRow>& rows, const std::string& quantity)
{
  std::vector<ClaimRow> chosen;
  for (const ClaimRow& row : rows) {
    if (row.quantity == quantity) chosen.push_back(row);
  }
  return chosen;
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
  // Without normals, with them, and with them as data.
  const auto whole_rim = only(rows, "RMS position of the rim, all");
  ASSERT_EQ(whole_rim.size(), 3u);
  for (const ClaimRow& row : whole_rim) {
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
  const pcl_slim_test::TemporaryFolder folder;
  std::vector<std::string> scans;
  for (const char* name : {"kinect_mosd_learn13.pcd", "lone_star_geyser_tls.pcd",
                           "angel_real_scan.ply", "stanford_dragon_res2.ply"}) {
    const auto file = std::filesystem::path(data) / name;
    if (!std::filesystem::exists(file)) continue;
    std::filesystem::copy(file, folder / name);
    scans.push_back(file.stem().string());
  }
  if (scans.empty()) GTEST_SKIP() << "none of the scans is there";
  const std::string place = folder / "";
  const auto rows = rowsOf("moves", {"-scans", place.c_str()});
  for (const std::string& scan : scans) {
    for (const char* quantity : {"moved more than 3 spacings, %", "farthest, spacings"}) {
      const auto found = only(rows, quantity);
      EXPECT_TRUE(std::any_of(found.begin(), found.end(),
                              [&](const ClaimRow& row) { return row.scene == scan; }))
          << "no row tells of " << scan << ": " << quantity;
    }
  }
  for (const ClaimRow& row : rows) {
    EXPECT_TRUE(row.met()) << row.scene << ": " << row.quantity << " " << row.value;
  }
}

}  // namespace
