// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/filters/io/trajectory.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>

#include "support/temporary_folder.h"

namespace {

using namespace pcl_slim;

class TrajectoryTest : public ::testing::Test {
 protected:
  Result<Trajectory> read(const std::string& text, const std::string& name = "path.txt") {
    const std::string path = folder_ / name;
    std::ofstream(path) << text;
    return loadTrajectory(path);
  }

  void refuses(const std::string& text, const char* why) {
    const auto made = read(text);
    ASSERT_FALSE(made) << text;
    EXPECT_NE(made.error().message.find(why), std::string::npos) << made.error().message;
    EXPECT_NE(made.error().message.find("path.txt"), std::string::npos) << made.error().message;
  }

  pcl_slim_test::TemporaryFolder folder_;
};

/** Points at (i, 0, 0) with times in fields. */
template <typename Time>
PointFile timedPoints(const std::vector<Time>& times, const std::string& name, std::uint8_t type) {
  PointFile file;
  PointTable& cloud = file.cloud;
  for (const char* axis : {"x", "y", "z"}) addField(cloud, axis, kFloat32);
  addField(cloud, name, type);
  cloud.resize(times.size());
  for (std::size_t i = 0; i < times.size(); ++i) {
    const float x = static_cast<float>(i);
    std::memcpy(&cloud.data[i * cloud.point_step], &x, 4);
    std::memcpy(&cloud.data[i * cloud.point_step + 12], &times[i], sizeof(Time));
  }
  return file;
}

TEST_F(TrajectoryTest, ReadsTumAndCsv) {
  const char* const texts[] = {
      "# timestamp tx ty tz qx qy qz qw\n100 1 2 3 0 0 0 1\n101.5 4 5 6 0 0 0 1\n",
      "100 1 2 3\n101.5 4 5 6\n",
      "time,x,y,z\n101.5,4,5,6\n100,1,2,3\n",  // in any order
      "GpsTime [s];Easting;Northing;Height;roll\n100;1;2;3;9\n101.5;4;5;6;9\n",
      "name,Timestamp,px,py,pz\na,100,1,2,3\nb,101.5,4,5,6\n",
      "time,x,y,z\n100,1,2,3\n100,1,2,3\n101.5,4,5,6\n"};
  for (const char* text : texts) {
    const auto made = read(text);
    ASSERT_TRUE(made) << made.error().message << "\n" << text;
    EXPECT_EQ(made->time, (std::vector<double>{100, 101.5})) << text;
    ASSERT_EQ(made->place.size(), 2u);
    EXPECT_EQ(made->place[0], (std::array<double, 3>{1, 2, 3}));
    EXPECT_EQ(made->place[1], (std::array<double, 3>{4, 5, 6}));
  }
}

TEST_F(TrajectoryTest, RefusesWhatIsNone) {
  refuses("", "no points");
  refuses("1 2 3\n2 3 4\n", "3 columns");
  refuses("a,b,c,d\n1,2,3,4\n2,3,4,5\n", "named a, b, c, d");
  refuses("time,x,y,z\n1,2,3,4\n", "fewer than two");
  refuses("time,x,y,z\n1,2,3,4\n1,2,3,5\n", "two places at time 1");
  refuses("1 2 3 4\n2 nan 4 5\n", "lacks a number");
  refuses("1 2 3 4\n2 3 4\n", "line 2");
  EXPECT_FALSE(loadTrajectory(folder_ / "missing.txt"));
}

TEST_F(TrajectoryTest, GivesPlacesBetweenPlaces) {
  const auto path = read("1e9 0 0 0\n1000000002 2 4 500000.25\n1000000003 2 4 500001.25\n");
  ASSERT_TRUE(path);
  PointFile file =
      timedPoints<double>({1e9, 1e9 + 0.5, 1e9 + 2, 1e9 + 3, 1e9 + 1}, "gps_time", kFloat64);
  const float nan = std::nanf("");
  std::memcpy(&file.cloud.data[4 * file.cloud.point_step + 4], &nan, 4);
  const auto places = sensorPlaces(*path, file);
  ASSERT_TRUE(places) << places.error().message;
  const std::vector<double> expected = {0, 0, 0,         0.5, 1, 125000.0625,
                                        2, 4, 500000.25, 2,   4, 500001.25};
  for (std::size_t k = 0; k < expected.size(); ++k) EXPECT_EQ((*places)[k], expected[k]) << k;
  EXPECT_TRUE(std::isnan((*places)[12])) << "a point that is nowhere";
  // The same by a field of another name, whole numbers, and an offset.
  PointFile ticks = timedPoints<std::int32_t>({0, 2}, "ticks", kInt32);
  EXPECT_FALSE(sensorPlaces(*path, ticks));
  const auto moved = sensorPlaces(*path, ticks, "ticks", 1e9);
  ASSERT_TRUE(moved) << moved.error().message;
  EXPECT_EQ((*moved)[5], 500000.25);
}

TEST_F(TrajectoryTest, NamesWhatIsWrongWithTheTimes) {
  const auto path = read("10 0 0 0\n10.1 1 0 0\n10.2 2 0 0\n");
  ASSERT_TRUE(path);
  const auto refused = [&](const PointFile& file, const char* field, const char* why) {
    const auto places = sensorPlaces(*path, file, field);
    ASSERT_FALSE(places);
    EXPECT_NE(places.error().message.find(why), std::string::npos) << places.error().message;
  };
  refused(timedPoints<double>({10, 10.3, 9}, "time", kFloat64), "", "2 of 3 points");
  refused(timedPoints<double>({10, 10.3, 9}, "time", kFloat64), "", "from 9 to 10.3");
  refused(timedPoints<double>({10, std::nan("")}, "time", kFloat64), "", "1 of 2 points");
  refused(timedPoints<double>({10}, "when", kFloat64), "", "-time_field");
  refused(timedPoints<double>({10}, "when", kFloat64), "stamp", "no field 'stamp'");
  PointFile two = timedPoints<double>({10}, "time", kFloat64);
  two.cloud.fields[2].name = "t";
  refused(two, "", "fields t and time");
  const auto far = read("1e9 0 0 0\n1000000000.1 1 0 0\n1000000000.2 2 0 0\n");
  ASSERT_TRUE(far);
  const PointFile coarse = timedPoints<float>({1e9f}, "time", kFloat32);
  const auto places = sensorPlaces(*far, coarse);
  ASSERT_FALSE(places);
  EXPECT_NE(places.error().message.find("32-bit floats, 64 apart"), std::string::npos)
      << places.error().message;
}

}  // namespace
