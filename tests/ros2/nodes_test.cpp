// SPDX-License-Identifier: BSD-3-Clause
// The nodes, compiled and run against stand-ins for ROS's headers.
#include "nodes.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <condition_variable>
#include <fstream>
#include <random>
#include <regex>
#include <set>

#include "cloud_work.h"
#include "pcl_slim/filters/io/point_message.h"
#include "pcl_slim/filters/table/scan_work.h"
#include "table/message_clouds.h"

namespace pcl_slim_ros {
namespace {

using diagnostic_msgs::msg::DiagnosticArray;
using diagnostic_msgs::msg::DiagnosticStatus;
using lifecycle_msgs::msg::State;
using pcl_slim_test::bytesOf;
using pcl_slim_test::driverLayouts;
using pcl_slim_test::messageOf;
using pcl_slim_test::sphereTable;
using rclcpp::stand_in::Topics;
using sensor_msgs::msg::PointCloud2;

/** The messages of a topic, as they come. */
template <typename Message>
class Listener {
 public:
  explicit Listener(const std::string& topic, const rclcpp::QoS& qos = rclcpp::QoS(5))
      : subscription_(Topics::instance().subscribe<Message>(
            topic, qos, [this](std::unique_ptr<Message> message) {
              const std::lock_guard lock(mutex_);
              messages_.push_back(std::move(*message));
              changed_.notify_all();
            })) {}

  /** Waits for a number of messages; fewer where they take too long. */
  std::vector<Message> wait(std::size_t count) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, std::chrono::seconds(60), [&] { return messages_.size() >= count; });
    return messages_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<Message> messages_;
  typename rclcpp::Subscription<Message>::SharedPtr subscription_;
};

rclcpp::NodeOptions optionsWith(std::vector<rclcpp::Parameter> overrides, bool autostart = false) {
  overrides.emplace_back("autostart", rclcpp::ParameterValue(autostart));
  return rclcpp::NodeOptions().parameter_overrides(overrides);
}

PointCloud2 cloudOf(const pcl_slim::PointTable& table, std::uint32_t padding = 0) {
  auto message = messageOf<PointCloud2>(table, padding);
  message.header.frame_id = "velodyne";
  message.header.stamp = {12, 34};
  return message;
}

void send(const PointCloud2& message) {
  Topics::instance().publish("input", rclcpp::SensorDataQoS(), message);
}

template <typename Condition>
void waitUntil(const Condition& condition) {
  for (int i = 0; i < 6000 && !condition(); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
}

TEST(RosNodes, TheSmootherPublishesWhatTheLibraryMakes) {
  Listener<PointCloud2> output("output");
  for (const auto& layout : driverLayouts()) {
    SmootherNode node(optionsWith({}));
    ASSERT_EQ(node.configure().id(), State::PRIMARY_STATE_INACTIVE);
    ASSERT_EQ(node.activate().id(), State::PRIMARY_STATE_ACTIVE);
    const auto table = sphereTable(layout, 1500, 10);
    const std::size_t before = output.wait(0).size();
    send(cloudOf(table, 5));
    const auto messages = output.wait(before + 1);
    ASSERT_EQ(messages.size(), before + 1) << layout.name;
    const PointCloud2& made = messages.back();
    EXPECT_EQ(made.header.frame_id, "velodyne");
    EXPECT_EQ(made.header.stamp.sec, 12);
    EXPECT_EQ(made.header.stamp.nanosec, 34u);
    EXPECT_TRUE(made.is_dense) << layout.name;
    auto scan = pcl_slim::ScanTable::from(table);
    ASSERT_TRUE(scan);
    scan->sensor = {0, 0, 0};
    const auto expected = pcl_slim::smoothScan(*scan, {});
    ASSERT_TRUE(expected) << layout.name;
    EXPECT_EQ(made.data, expected->points.data) << layout.name;
    EXPECT_EQ(made.height, 10u);
    EXPECT_EQ(made.row_step, made.width * made.point_step);
    EXPECT_EQ(made.fields.size(), expected->points.fields.size());
  }
}

TEST(RosNodes, TheNoiseOfTheSensorIsKept) {
  const auto frame = [](unsigned seed) {  // a wall three metres away, noise along the view
    auto table = sphereTable(driverLayouts()[0], 20000, 100);
    std::mt19937 random(seed);
    std::normal_distribution<double> noise(0, 0.004);
    for (std::size_t i = 0; i < 20000; ++i) {
      const double x = 0.01 * static_cast<double>(i % 200) - 1,
                   y = 0.01 * static_cast<double>(i / 200);
      pcl_slim_test::store(table, i, "x", x);
      pcl_slim_test::store(table, i, "y", y);
      pcl_slim_test::store(table, i, "z",
                           3 + 0.05 * std::sin(3 * x) * std::cos(2 * y) + noise(random));
    }
    return table;
  };
  const auto first = frame(1), second = frame(2);
  const auto made = [](const CloudWork& work, const pcl_slim::PointTable& points) {
    const auto done = work.process(points, nullptr);
    EXPECT_TRUE(done) << done.error().message;
    return done->points.data;
  };
  const auto keeping = makeWork(makeSmoothing, {}),
             measuring = makeWork(makeSmoothing, {{"keep_noise", false}}),
             given = makeWork(makeSmoothing, {{"noise", 2.0}});
  ASSERT_TRUE(keeping && measuring && given);
  EXPECT_EQ(made(**keeping, first), made(**measuring, first));
  EXPECT_NE(made(**keeping, second), made(**measuring, second));
  const auto once = made(**given, second);
  EXPECT_EQ(made(**given, second), once) << "a noise that is given stays";
}

TEST(RosNodes, NormalsAndSplatsArePublished) {
  const auto table = sphereTable(driverLayouts()[2], 1500);
  Listener<PointCloud2> output("output");
  {
    NormalsNode node(optionsWith({{"curvatures", rclcpp::ParameterValue(true)}}));
    node.configure();
    node.activate();
    send(cloudOf(table));
    const auto messages = output.wait(1);
    ASSERT_EQ(messages.size(), 1u);
    const auto made = pcl_slim::tableOf(messages[0]);
    ASSERT_TRUE(made) << made.error().message;
    for (const auto& field : table.fields)
      EXPECT_EQ(bytesOf(*made, field.name), bytesOf(table, field.name)) << field.name;
    EXPECT_GE(pcl_slim::findField(*made, "normal_x"), 0);
    EXPECT_GE(pcl_slim::findField(*made, "k1"), 0);
  }
  SplatNode node(optionsWith({{"max_splats", rclcpp::ParameterValue(200)}}));
  node.configure();
  node.activate();
  send(cloudOf(table));
  const auto messages = output.wait(2);
  ASSERT_EQ(messages.size(), 2u);
  EXPECT_GT(messages[1].width, 20u);
  EXPECT_LE(messages[1].width, 200u);
  EXPECT_EQ(messages[1].header.frame_id, "velodyne");
}

TEST(RosNodes, ANodeStartsByItselfUnlessToldOtherwise) {
  SmootherNode node(optionsWith({}, true)), managed(optionsWith({}));
  EXPECT_EQ(node.get_current_state().id(), State::PRIMARY_STATE_UNCONFIGURED);
  rclcpp::stand_in::fireTimers();
  EXPECT_EQ(node.get_current_state().id(), State::PRIMARY_STATE_ACTIVE);
  EXPECT_EQ(managed.get_current_state().id(), State::PRIMARY_STATE_UNCONFIGURED);
  rclcpp::stand_in::fireTimers();
  EXPECT_EQ(node.get_current_state().id(), State::PRIMARY_STATE_ACTIVE);
}

TEST(RosNodes, OnlyAnActiveNodeTakesMessages) {
  Listener<PointCloud2> output("output");
  SmootherNode node(optionsWith({}));
  const PointCloud2 cloud = cloudOf(sphereTable(driverLayouts()[0], 500));
  send(cloud);
  node.configure();
  send(cloud);
  EXPECT_EQ(node.counts().received, 0u);
  for (std::size_t run = 1; run <= 2; ++run) {
    ASSERT_EQ(node.activate().id(), State::PRIMARY_STATE_ACTIVE);
    send(cloud);
    EXPECT_EQ(output.wait(run).size(), run);
    EXPECT_EQ(node.counts().received, 1u);
    ASSERT_EQ(node.deactivate().id(), State::PRIMARY_STATE_INACTIVE);
    send(cloud);
    EXPECT_EQ(node.counts().received, 1u);
  }
  EXPECT_EQ(node.cleanup().id(), State::PRIMARY_STATE_UNCONFIGURED);
  EXPECT_EQ(node.shutdown().id(), State::PRIMARY_STATE_FINALIZED);
}

TEST(RosNodes, TheNewestMessageIsKeptAndDropsAreCounted) {
  Listener<PointCloud2> output("output");
  SmootherNode node(optionsWith({{"threads", rclcpp::ParameterValue(1)}}));
  node.configure();
  node.activate();
  const auto table = sphereTable(driverLayouts()[0], 20000);
  constexpr std::uint32_t kSent = 5;
  for (std::uint32_t i = 0; i < kSent; ++i) {
    PointCloud2 cloud = cloudOf(table);
    cloud.header.stamp.nanosec = i;
    send(cloud);
  }
  waitUntil([&] {
    const WorkCounts counts = node.counts();
    return counts.published + counts.dropped == kSent;
  });
  const WorkCounts counts = node.counts();
  EXPECT_EQ(counts.received, kSent);
  EXPECT_EQ(counts.published + counts.dropped, kSent);
  EXPECT_EQ(counts.points, counts.published * 20000);
  EXPECT_GT(counts.microsecondsPerPoint(), 0);
  const auto messages = output.wait(counts.published);
  ASSERT_EQ(messages.size(), counts.published);
  EXPECT_EQ(messages.back().header.stamp.nanosec, kSent - 1) << "the newest is not the dropped one";
}

TEST(RosNodes, DiagnosticsNameErrorsAndCosts) {
  Listener<DiagnosticArray> diagnostics("/diagnostics");
  Listener<PointCloud2> output("output");
  SmootherNode node(optionsWith({}));
  node.configure();
  node.activate();
  const auto report = [&] {
    const std::size_t before = diagnostics.wait(0).size();
    rclcpp::stand_in::fireTimers();
    return diagnostics.wait(before + 1).at(before).status.at(0);
  };
  EXPECT_EQ(report().level, DiagnosticStatus::OK);
  const auto table = sphereTable(driverLayouts()[0], 500);
  send(cloudOf(table));
  output.wait(1);
  const DiagnosticStatus good = report();
  EXPECT_EQ(good.name, "/slim_smoother: clouds");
  EXPECT_EQ(good.level, DiagnosticStatus::OK);
  std::set<std::string> keys;
  for (const auto& [key, value] : good.values) {
    keys.insert(key);
    EXPECT_TRUE(key != "published" || value == "1") << value;
    EXPECT_TRUE(key != "us a point, last cloud" || std::stod(value) > 0) << value;
  }
  for (const char* key : {"received", "published", "dropped", "failed", "us a point, last cloud"})
    EXPECT_EQ(keys.count(key), 1u) << key;

  PointCloud2 wrong = cloudOf(table);
  wrong.is_bigendian = true;
  send(wrong);
  waitUntil([&] { return node.counts().failed == 1; });
  const DiagnosticStatus bad = report();
  EXPECT_EQ(bad.level, DiagnosticStatus::ERROR);
  EXPECT_NE(bad.message.find("big-endian"), std::string::npos) << bad.message;

  send(cloudOf(sphereTable(driverLayouts()[0], 2)));
  output.wait(2);
  EXPECT_EQ(report().level, DiagnosticStatus::WARN) << "two points are no surface";
}

TEST(RosNodes, AClosedNodeCancelsItsWork) {
  auto node = std::make_unique<SmootherNode>(optionsWith({}));
  node->configure();
  node->activate();
  send(cloudOf(sphereTable(driverLayouts()[0], 100000)));
  node.reset();
  SUCCEED();
}

TEST(RosNodes, ParametersAreTheProgramsOptionsWithDescriptionsAndRanges) {
  SmootherNode node(optionsWith({}));
  for (const auto& row : pcl_slim::fitParameters()) {
    if (row.group == pcl_slim::FitOption::kNone || row.group == pcl_slim::FitOption::kTrim)
      continue;
    const auto descriptor = node.describe_parameter(row.name);
    EXPECT_FALSE(descriptor.description.empty()) << row.name;
    EXPECT_FALSE(std::regex_search(descriptor.description, std::regex("(^| )-[a-z]")))
        << descriptor.description;
    const auto type = node.get_parameter(row.name).get_type();
    const bool real = type == rclcpp::PARAMETER_DOUBLE, whole = type == rclcpp::PARAMETER_INTEGER;
    EXPECT_EQ(descriptor.floating_point_range.size(), real ? 1u : 0u) << row.name;
    EXPECT_EQ(descriptor.integer_range.size(), whole ? 1u : 0u) << row.name;
  }
  const auto degree = node.describe_parameter("degree").integer_range.at(0);
  EXPECT_EQ(degree.from_value, 0);
  EXPECT_EQ(degree.to_value, 4);
}

TEST(RosNodes, WrongParametersAreRefusedWithTheReason) {
  SmootherNode node(optionsWith({}));
  const auto set = [&](const char* name, const rclcpp::ParameterValue& value) {
    return node.set_parameter(rclcpp::Parameter(name, value));
  };
  using Numbers = std::vector<double>;
  using rclcpp::ParameterValue;
  EXPECT_FALSE(set("degree", ParameterValue(7)).successful);
  EXPECT_FALSE(set("normal_error", ParameterValue(.1)).successful) << "needs normals_as_data";
  EXPECT_NE(set("viewpoint", ParameterValue(Numbers{1, 2})).reason.find("give 3"),
            std::string::npos);
  EXPECT_NE(set("correlation", ParameterValue("some")).reason.find("auto"), std::string::npos);
  EXPECT_NE(set("local_noise", ParameterValue("maybe")).reason.find("auto|on|off"),
            std::string::npos);
  EXPECT_TRUE(set("penalty", ParameterValue(5.0)).successful);
  EXPECT_NE(set("t_mdl", ParameterValue(.1)).reason.find("penalty and t_mdl"), std::string::npos);
  EXPECT_TRUE(set("penalty", ParameterValue(0.0)).successful);
  EXPECT_TRUE(set("t_mdl", ParameterValue(.1)).successful);
  EXPECT_TRUE(set("viewpoint", ParameterValue(Numbers{1, 2, 3})).successful);
  EXPECT_FALSE(set("autostart", ParameterValue(true)).successful) << "read-only";
  EXPECT_THROW(SmootherNode(optionsWith({{"degree", ParameterValue(9)}})),
               rclcpp::exceptions::InvalidParameterValueException);
}

TEST(RosNodes, WrongOverridesLeaveANodeUnconfigured) {
  SmootherNode node(optionsWith(
      {{"noise", rclcpp::ParameterValue(.1)}, {"lambda", rclcpp::ParameterValue(1e-6)}}));
  EXPECT_EQ(node.configure().id(), State::PRIMARY_STATE_UNCONFIGURED);
  const auto& log = rclcpp::stand_in::Process::instance().log;
  ASSERT_FALSE(log.empty());
  EXPECT_NE(log.back().find("noise and lambda"), std::string::npos) << log.back();
}

TEST(RosNodes, ParametersOfRclcppItselfAreNoneOfTheirs) {
  SmootherNode node(optionsWith(
      {{"noise", rclcpp::ParameterValue(.1)}, {"lambda", rclcpp::ParameterValue(1e-6)}}));
  node.declare_parameter("use_sim_time", rclcpp::ParameterValue(false));
  EXPECT_TRUE(node.set_parameter({"use_sim_time", rclcpp::ParameterValue(true)}).successful);
}

TEST(RosNodes, ChangedParametersWorkFromTheNextMessageOn) {
  Listener<PointCloud2> output("output");
  SmootherNode node(optionsWith({}));
  node.configure();
  node.activate();
  const auto table = sphereTable(driverLayouts()[0], 1000);
  send(cloudOf(table));
  EXPECT_EQ(output.wait(1).at(0).fields.size(), 7u);
  ASSERT_TRUE(node.set_parameter({"normals", rclcpp::ParameterValue(false)}).successful);
  send(cloudOf(table));
  EXPECT_EQ(output.wait(2).at(1).fields.size(), 3u);
  ASSERT_TRUE(node.set_parameter({"curvatures", rclcpp::ParameterValue(true)}).successful);
  send(cloudOf(table));
  EXPECT_EQ(output.wait(3).at(2).fields.size(), 7u);
}

TEST(RosNodes, ComponentsAreRegisteredAsLaunchAndCMakeNameThem) {
  const std::string folder = PCL_SLIM_ROS_PACKAGE;
  const auto textOf = [](const std::string& path) {
    std::ifstream file(path);
    return std::string(std::istreambuf_iterator<char>(file), {});
  };
  const std::string cmake = textOf(folder + "/CMakeLists.txt");
  const auto& components = rclcpp::stand_in::Process::instance().components;
  EXPECT_EQ(components.size(), 3u);
  for (const auto& [name, make] : components) {
    EXPECT_NE(cmake.find("PLUGIN " + name + " "), std::string::npos) << name;
    EXPECT_TRUE(make(optionsWith({}))) << name;
  }
}

TEST(RosNodes, FilesOfParametersNameParametersAndTheirTypes) {
  const auto check = [](const std::string& file, rclcpp_lifecycle::LifecycleNode& node) {
    std::ifstream text(std::string(PCL_SLIM_ROS_PACKAGE) + "/config/" + file);
    std::size_t count = 0;
    const std::regex entry("^    ([a-z_]+): (\\S+)$");
    for (std::string line; std::getline(text, line);) {
      std::smatch match;
      if (!std::regex_match(line, match, entry)) continue;
      ++count;
      const auto type = node.get_parameter(match[1]).get_type();
      const std::string value = match[2];
      const bool number = std::isdigit(static_cast<unsigned char>(value[0])) != 0;
      const bool point = value.find('.') != std::string::npos;
      const auto expected = value == "true" || value == "false" ? rclcpp::PARAMETER_BOOL
                            : !number                           ? rclcpp::PARAMETER_STRING
                            : point                             ? rclcpp::PARAMETER_DOUBLE
                                                                : rclcpp::PARAMETER_INTEGER;
      EXPECT_EQ(type, expected) << file << ": " << line;
    }
    EXPECT_GT(count, 3u) << file;
  };
  SmootherNode smoother(optionsWith({}));
  SplatNode splats(optionsWith({}));
  check("smoother.yaml", smoother);
  check("splats.yaml", splats);
}

}  // namespace
}  // namespace pcl_slim_ros
