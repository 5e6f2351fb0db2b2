// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/filters/io/trajectory.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numeric>

#include "io/text/text.h"
#include "pcl_slim/core/file_access.h"
#include "pcl_slim/core/order_statistics.h"

namespace pcl_slim {

namespace {

constexpr const char* kTimeNames[] = {"t", "time", "timestamp", "stamp", "gps_time", "gpstime"};
constexpr const char* kPlaceNames[][3] = {{"x", "y", "z"},
                                          {"tx", "ty", "tz"},
                                          {"px", "py", "pz"},
                                          {"pos_x", "pos_y", "pos_z"},
                                          {"position_x", "position_y", "position_z"},
                                          {"easting", "northing", "height"},
                                          {"easting", "northing", "elevation"},
                                          {"easting", "northing", "altitude"}};

bool isTimeName(const std::string& name) {
  const std::string plain = plainColumnName(name);
  return std::find(std::begin(kTimeNames), std::end(kTimeNames), plain) != std::end(kTimeNames);
}

/** Columns of the time and of x y z. */
using Columns = std::array<std::size_t, 4>;

Result<Columns> namedColumns(const TextTable& table) {
  std::vector<std::string> names;
  std::string written;
  for (const TextColumn& column : table.columns) {
    names.push_back(column.numeric ? plainColumnName(column.name) : "");
    written += (written.empty() ? "" : ", ") + column.name;
  }
  Columns columns{};
  const auto time = std::find_if(names.begin(), names.end(), isTimeName);
  columns[0] = static_cast<std::size_t>(time - names.begin());
  for (const auto& triple : kPlaceNames) {
    std::size_t found = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      const auto at = std::find(names.begin(), names.end(), triple[a]);
      columns[a + 1] = static_cast<std::size_t>(at - names.begin());
      found += at != names.end();
    }
    if (found == 3 && time != names.end()) return columns;
  }
  return badInput("its columns are named " + written.substr(0, 200) +
                  "; name four of numbers time, x, y and z");
}

Result<Columns> columnsOf(const TextTable& table) {
  if (table.named_by != ColumnNames::kNobody) return namedColumns(table);
  if (table.columns.size() == 4 || table.columns.size() == 8) return Columns{0, 1, 2, 3};
  return badInput(
      "it has " + std::to_string(table.columns.size()) +
      " columns without names: give t x y z, or t x y z qx qy qz qw, or a line of names");
}

std::string numberText(double value, int digits = 12) {
  char text[40];
  std::snprintf(text, sizeof(text), "%.*g", digits, value);
  return text;
}

Result<Trajectory> trajectoryOf(const TextTable& table) {
  const Result<Columns> columns = columnsOf(table);
  if (!columns) return columns.error();
  std::vector<std::size_t> order(table.rows());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto timeOf = [&](std::size_t row) { return table.at(row, (*columns)[0]); };
  for (const std::size_t row : order) {
    for (const std::size_t column : *columns) {
      if (!std::isfinite(table.at(row, column)))
        return badInput("place " + std::to_string(row + 1) + " lacks a number: mend or drop it");
    }
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return timeOf(a) < timeOf(b); });
  Trajectory made;
  for (const std::size_t row : order) {
    std::array<double, 3> place;
    for (std::size_t a = 0; a < 3; ++a) place[a] = table.at(row, (*columns)[a + 1]);
    if (made.time.empty() || timeOf(row) > made.time.back()) {
      made.time.push_back(timeOf(row));
      made.place.push_back(place);
    } else if (place != made.place.back()) {
      return badInput("it has two places at time " + numberText(timeOf(row)) + "; drop one");
    }
  }
  if (made.time.size() > 1) return made;
  return badInput("it has places at fewer than two times; give more");
}

/** The field with the points' times. */
Result<const PointField*> timeField(const PointTable& cloud, const std::string& asked) {
  const PointField* found = nullptr;
  std::string names;
  for (const PointField& field : cloud.fields) {
    names += (names.empty() ? "" : " ") + field.name;
    if (!asked.empty() ? field.name != asked : !isTimeName(field.name)) continue;
    if (found != nullptr) {
      return badInput("fields " + found->name + " and " + field.name +
                      " may both be the points' times: name one with -time_field");
    }
    found = &field;
  }
  if (found != nullptr) return found;
  return badInput((asked.empty() ? "no field of the points is named as a time"
                                 : "the points have no field '" + asked + "'") +
                  (" (there are " + names + "): name theirs with -time_field"));
}

/** Checks that floats of this magnitude separate the trajectory's positions. */
Error checkResolution(const PointField& field, double largest, const Trajectory& trajectory) {
  if (field.datatype != kFloat32) return {};
  std::vector<double> steps;
  for (std::size_t k = 1; k < trajectory.time.size(); ++k)
    steps.push_back(trajectory.time[k] - trajectory.time[k - 1]);
  const double step = median(std::move(steps));
  const auto top = static_cast<float>(largest);
  const double resolved = std::nextafter(top, std::numeric_limits<float>::infinity()) - top;
  if (!(resolved > step)) return {};
  return badInput("field '" + field.name + "' holds times as 32-bit floats, " +
                  numberText(resolved, 3) + " apart where the trajectory's places are " +
                  numberText(step, 3) +
                  ": write it as double, or less a constant that -time_offset adds again");
}

std::array<double, 3> placeAt(const Trajectory& trajectory, double time) {
  const auto after = std::upper_bound(trajectory.time.begin(), trajectory.time.end() - 1, time);
  const auto k =
      static_cast<std::size_t>(std::max<std::ptrdiff_t>(1, after - trajectory.time.begin()));
  const auto &a = trajectory.place[k - 1], &b = trajectory.place[k];
  const double share =
      (time - trajectory.time[k - 1]) / (trajectory.time[k] - trajectory.time[k - 1]);
  std::array<double, 3> place;
  for (std::size_t axis = 0; axis < 3; ++axis) place[axis] = a[axis] + share * (b[axis] - a[axis]);
  return place;
}

}  // namespace

Result<Trajectory> loadTrajectory(const std::string& path) {
  const auto bytes = readFile(path);
  if (!bytes) return bytes.error();
  const Result<TextTable> table = parseTextTable(*bytes);
  Result<Trajectory> made = table ? trajectoryOf(*table) : Result<Trajectory>(table.error());
  if (made) return made;
  return Error{made.error().code, "trajectory '" + path + "': " + made.error().message};
}

Result<std::vector<double>> sensorPlaces(const Trajectory& trajectory, const PointFile& file,
                                         const std::string& time_field, double offset) {
  const PointTable& cloud = file.cloud;
  if (Error error = checkPointTable(cloud)) return error;
  const auto field = timeField(cloud, time_field);
  if (!field) return field.error();
  const PointField* axes[3];
  const char* const names[3] = {"x", "y", "z"};
  for (std::size_t a = 0; a < 3; ++a) {
    const int at = findField(cloud, names[a]);
    if (at < 0) return badInput("the points have no fields x y z");
    axes[a] = &cloud.fields[static_cast<std::size_t>(at)];
  }
  std::vector<double> places(3 * numPoints(cloud), std::numeric_limits<double>::quiet_NaN());
  std::size_t outside = 0, finite = 0;
  double least = std::numeric_limits<double>::infinity(), most = -least, largest = 0;
  for (std::size_t i = 0; i < numPoints(cloud); ++i) {
    bool there = true;
    for (const auto* axis : axes) there = there && std::isfinite(fieldValue(cloud, i, *axis));
    if (!there) continue;
    ++finite;
    const double stored = fieldValue(cloud, i, **field), time = stored + offset;
    largest = std::max(largest, std::abs(stored));
    least = std::min(least, time);
    most = std::max(most, time);
    if (!(time >= trajectory.time.front() && time <= trajectory.time.back())) {
      ++outside;
      continue;
    }
    const auto place = placeAt(trajectory, time);
    std::copy(place.begin(), place.end(), places.begin() + static_cast<std::ptrdiff_t>(3 * i));
  }
  if (outside > 0) {
    return badInput(std::to_string(outside) + " of " + std::to_string(finite) +
                    " points have no time within the trajectory's " +
                    numberText(trajectory.time.front()) + " to " +
                    numberText(trajectory.time.back()) + ": field '" + (*field)->name +
                    "' runs from " + numberText(least) + " to " + numberText(most) +
                    "; give the whole trajectory, or -time_offset");
  }
  if (Error error = checkResolution(**field, largest, trajectory)) return error;
  return places;
}

}  // namespace pcl_slim
