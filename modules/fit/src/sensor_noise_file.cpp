// SPDX-License-Identifier: BSD-3-Clause
// A sensor's noise as JSON.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <utility>
#include <vector>

#include "pcl_slim/core/file_access.h"
#include "pcl_slim/fit/sensor_noise.h"

namespace pcl_slim {

namespace {

constexpr const char* kKind = "pcl_slim sensor noise";  ///< value of the member "kind"

/** One member of the file: its name and its numbers in SensorNoise. */
struct Member {
  const char* name;
  std::vector<double> values;
  bool is_list;
};

std::vector<Member> membersOf(const SensorNoise& noise) {
  return {{"error", {noise.error.begin(), noise.error.end()}, true},
          {"along_rays", {noise.along_rays ? 1.0 : 0.0}, false},
          {"relative_error", {noise.relative_error}, false},
          {"correlation", {noise.correlation}, false},
          {"correlation_error", {noise.correlation_error}, false},
          {"dependence", {noise.dependence}, false},
          {"step", {noise.step}, false},
          {"line", {static_cast<double>(noise.line)}, false},
          {"neighbors", {static_cast<double>(noise.neighbors)}, false},
          {"residual", {noise.residual.begin(), noise.residual.end()}, true},
          {"residual_error", {noise.residual_error.begin(), noise.residual_error.end()}, true},
          {"columns", {static_cast<double>(noise.columns)}, false},
          {"rows", {static_cast<double>(noise.rows)}, false}};
}

std::string numberText(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

/** A number, or a list of them. A truth is 0 or 1. */
struct Numbers {
  std::vector<double> values;
  bool is_list = false;
};

/** Numbers and texts of the members of a JSON object, by name: all that such a file has. */
struct FlatObject {
  std::map<std::string, Numbers> numbers;
  std::map<std::string, std::string> texts;
};

/** Reads a JSON object whose members are texts without escapes, truths, numbers and lists of
 * numbers. */
class FlatReader {
 public:
  explicit FlatReader(const std::string& text) : next_(text.c_str()) {}

  bool read(FlatObject& object) {
    if (!take('{')) return false;
    do {
      std::string name, text;
      Numbers numbers;
      if (!readText(name) || !take(':')) return false;
      if (readText(text)) {
        object.texts[name] = text;
      } else if (readNumbers(numbers)) {
        object.numbers[name] = numbers;
      } else {
        return false;
      }
    } while (take(','));
    return take('}') && take('\0');
  }

 private:
  bool take(char expected) {
    while (*next_ == ' ' || *next_ == '\n' || *next_ == '\r' || *next_ == '\t') ++next_;
    if (*next_ != expected) return false;
    if (expected != '\0') ++next_;
    return true;
  }

  bool readText(std::string& text) {
    if (!take('"')) return false;
    while (*next_ != '\0' && *next_ != '"' && *next_ != '\\') text += *next_++;
    return take('"');
  }

  bool takeWord(const std::string& word) {
    take('\1');  // skips white space: no text contains this character there
    if (std::string(next_).compare(0, word.size(), word) != 0) return false;
    next_ += word.size();
    return true;
  }

  bool readNumber(double& number) {
    if (takeWord("true") || takeWord("false")) {
      number = next_[-2] == 'u' ? 1 : 0;
      return true;
    }
    const bool starts = *next_ == '-' || (*next_ >= '0' && *next_ <= '9');
    char* end = nullptr;
    number = starts ? std::strtod(next_, &end) : 0;
    if (end == nullptr || end == next_ || !std::isfinite(number)) return false;
    next_ = end;
    return true;
  }

  bool readNumbers(Numbers& numbers) {
    numbers.is_list = take('[');
    do {
      if (!readNumber(numbers.values.emplace_back())) return false;
    } while (numbers.is_list && take(','));
    return !numbers.is_list || take(']');
  }

  const char* next_;
};

bool isWhole(double value, double most) {
  return value >= 0 && value <= most && value == std::floor(value);
}

Error bad(const std::string& what) {
  return {ErrorCode::kBadInput, "a sensor's noise " + what + "; measure it again"};
}

}  // namespace

bool operator==(const SensorNoise& a, const SensorNoise& b) {
  const std::vector<Member> first = membersOf(a), second = membersOf(b);
  return std::equal(first.begin(), first.end(), second.begin(),
                    [](const Member& x, const Member& y) { return x.values == y.values; });
}

Error SensorNoise::validate() const {
  for (const Member& member : membersOf(*this)) {
    for (const double value : member.values) {
      if (!(value >= 0) || !std::isfinite(value))
        return bad(std::string("has a negative or infinite ") + member.name);
    }
  }
  if (!(error[0] + error[1] + error[2] > 0)) return bad("has no error");
  if (!along_rays && error[1] + error[2] > 0) return bad("varies by range, but is not along rays");
  if (!(correlation >= 1) || !(dependence >= 1)) return bad("is shared by less than one point");
  constexpr std::uint64_t kLeastPatch =
      20;  // points of the smallest patch that noise is measured on
  if (neighbors < kLeastPatch) return bad("is of patches of fewer than 20 points");
  if (!(residual[1] > 0)) return bad("has no residual to compare with");
  return {};
}

std::string toJson(const SensorNoise& noise) {
  std::string text = std::string("{\n  \"kind\": \"") + kKind + "\"";
  for (const Member& member : membersOf(noise)) {
    text += std::string(",\n  \"") + member.name + "\": " + (member.is_list ? "[" : "");
    for (std::size_t i = 0; i < member.values.size(); ++i)
      text += (i > 0 ? ", " : "") + numberText(member.values[i]);
    if (member.is_list) text += "]";
  }
  return text + "\n}\n";
}

Result<SensorNoise> sensorNoiseFromJson(const std::string& text, const std::string& name) {
  const auto refused = [&](const std::string& why) {
    return badInput("'" + name + "' " + why + "; -save_noise writes such a file");
  };
  FlatObject object;
  if (!FlatReader(text).read(object) || object.texts["kind"] != kKind)
    return refused("is no file of a sensor's noise");
  SensorNoise noise;
  std::vector<Member> members = membersOf(noise);
  for (Member& member : members) {
    const auto found = object.numbers.find(member.name);
    if (found == object.numbers.end() || found->second.is_list != member.is_list ||
        found->second.values.size() != member.values.size())
      return refused(std::string("lacks the member '") + member.name + "' of a sensor's noise");
    member.values = found->second.values;
  }
  const auto number = [&](std::size_t i) { return members[i].values[0]; };
  constexpr double kMostWhole = 4294967295.0;
  for (const std::size_t i : {7u, 8u, 11u, 12u}) {
    if (!isWhole(number(i), kMostWhole))
      return refused(std::string("has a '") + members[i].name + "' that is no whole number");
  }
  std::copy_n(members[0].values.begin(), 3, noise.error.begin());
  noise.along_rays = number(1) != 0;
  noise.relative_error = number(2);
  noise.correlation = number(3);
  noise.correlation_error = number(4);
  noise.dependence = number(5);
  noise.step = number(6);
  noise.line = static_cast<std::uint64_t>(number(7));
  noise.neighbors = static_cast<std::uint64_t>(number(8));
  std::copy_n(members[9].values.begin(), 2, noise.residual.begin());
  std::copy_n(members[10].values.begin(), 2, noise.residual_error.begin());
  noise.columns = static_cast<std::uint32_t>(number(11));
  noise.rows = static_cast<std::uint32_t>(number(12));
  if (const Error error = noise.validate()) return badInput("'" + name + "': " + error.message);
  return noise;
}

Error saveSensorNoise(const std::string& path, const SensorNoise& noise) {
  const std::string text = toJson(noise);
  return writeFile(path, text.data(), text.size());
}

Result<SensorNoise> loadSensorNoise(const std::string& path) {
  const auto bytes = readFile(path);
  if (!bytes) return bytes.error();
  return sensorNoiseFromJson({bytes->begin(), bytes->end()}, path);
}

}  // namespace pcl_slim
