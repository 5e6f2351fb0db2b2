// SPDX-License-Identifier: BSD-3-Clause
#include "staged_cloud.h"

#include <cstring>
#include <limits>

#include "painted_clouds.h"

namespace pcl_slim {
namespace {

/** Points of three floats, normal and colour in random order: more than are left where they are. */
struct Records {
  struct Record {
    float xyz[3], normal[3];
    unsigned char bgr[4];
  };
  std::vector<Record> all;

  explicit Records(std::size_t count, bool sorted = false) : all(count)
  {
    std::mt19937 random(2);
    for (std::size_t i = 0; i < count; ++i) {
      Record& r = all[i];
      for (float& v : r.xyz) v = static_cast<float>(random() % 100000) * 1e-4f;
      if (sorted) r.xyz[0] = r.xyz[1] = r.xyz[2] = static_cast<float>(i) * 1e-5f;
      r.normal[static_cast<std::size_t>(random() % 3)] = 1.0f;
      for (unsigned char& c : r.bgr) c = static_cast<unsigned char>(random());
    }
  }

  CloudView view() const
  {
    CloudView view;
    view.xyz = all[0].xyz;
    view.normal = all[0].normal;
    view.xyz_stride = view.normal_stride = sizeof(Record);
    view.size = all.size();
    return view;
  }
  ColorView colors() const { return {all[0].bgr, sizeof(Record)}; }
};

constexpr std::size_t kMany = (std::size_t{1} << 21) + 77;

TEST(StagedCloud, HoldsEveryPointOnceAndThreadsChangeNothing)
{
  Records records(kMany);
  records.all[5].xyz[1] = std::numeric_limits<float>::quiet_NaN();
  const auto one = StagedCloud::of(records.view(), records.colors(), 1);
  const auto many = StagedCloud::of(records.view(), records.colors(), 3);
  ASSERT_TRUE(one && many);
  ASSERT_EQ(one->view().size, kMany);
  std::vector<bool> seen(kMany, false);
  const auto at = [](const void* first, std::size_t stride, std::size_t i) {
    return static_cast<const unsigned char*>(first) + i * stride;
  };
  for (std::size_t i = 0; i < kMany; ++i) {
    const std::uint32_t input = one->input(i);
    ASSERT_EQ(many->input(i), input);
    ASSERT_FALSE(seen[input]);
    seen[input] = true;
    const auto& r = records.all[input];
    const CloudView view = one->view();
    ASSERT_EQ(std::memcmp(at(view.xyz, view.xyz_stride, i), r.xyz, sizeof(r.xyz)), 0);
    ASSERT_EQ(std::memcmp(at(view.normal, view.normal_stride, i), r.normal, sizeof(r.normal)), 0);
    ASSERT_EQ(std::memcmp(at(one->colors().bgr, one->colors().stride, i), r.bgr, 3), 0);
  }
}

TEST(StagedCloud, IsNotMadeWhereItWouldNotPay)
{
  EXPECT_FALSE(StagedCloud::of(Records(1000).view(), {}, 1));
  const Records sorted(kMany, true);
  EXPECT_FALSE(StagedCloud::of(sorted.view(), sorted.colors(), 1));
  const Records records(kMany);
  const std::int32_t indices[] = {1, 2};
  CloudView chosen = records.view();
  chosen.indices = indices;
  chosen.num_indices = 2;
  EXPECT_FALSE(StagedCloud::of(chosen, records.colors(), 1));
}

TEST(StagedCloud, SplatsNameThePointsOfTheInput)
{
  const Records records(kMany);
  SplatParams params;
  params.threads = 2;
  params.color = SplatColor::kOwn;
  params.initial_resolution = 12;
  params.max_depth = 0;
  SplatSet splats;
  ASSERT_FALSE(sampleSplats(records.view(), records.colors(), params, splats));
  ASSERT_GT(splats.size(), 1500u);
  double points = 0;
  for (std::size_t i = 0; i < splats.size(); ++i) {
    const auto& kept = records.all[splats.kept[i]];
    EXPECT_NEAR(splats.x[i] + splats.origin[0], kept.xyz[0], 10.0 / 12.0);
    EXPECT_EQ(splats.rgb[i],
              static_cast<std::uint32_t>(kept.bgr[2] << 16 | kept.bgr[1] << 8 | kept.bgr[0]));
    points += splats.confidence[i];
  }
  EXPECT_EQ(points, static_cast<double>(kMany));
}

}  // namespace
}  // namespace pcl_slim
