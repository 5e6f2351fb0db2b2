// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "io/scalar_type.h"
#include "pcl_slim/filters/io/surface_conversion.h"

namespace pcl_slim {

namespace {

constexpr int kMetadataVersion = 1;
constexpr const char* kPrefix = "pcl_slim";

std::string
formatted(const std::array<double, 3>& v)
{
  return formatScalar(v[0]) + " " + formatScalar(v[1]) + " " + formatScalar(v[2]);
}

bool
parse(const std::string& word, double& value)
{
  return parseScalar(word.data(), word.data() + word.size(), kFloat64,
                     reinterpret_cast<std::uint8_t*>(&value)) &&
         std::isfinite(value);
}

bool
parse(const std::string& word, std::uint64_t& value)
{
  return parseScalar(word.data(), word.data() + word.size(), kUInt64,
                     reinterpret_cast<std::uint8_t*>(&value));
}

bool
parse(const std::string& word, bool& value)
{
  value = word == "1";
  return value || word == "0";
}

bool
parse(const std::string& word, WeightKernel& kernel)
{
  std::uint64_t value = 0;
  if (!parse(word, value)) return false;
  kernel = static_cast<WeightKernel>(value);
  return value == 2 || value == 4 || value == 7 || value == 16;
}

bool
parse(const std::string& word, int& value)
{
  std::uint64_t whole = 0;
  if (!parse(word, whole) || whole > 1000000) return false;
  value = static_cast<int>(whole);
  return true;
}

bool
parse(const std::vector<std::string>& words, std::array<double, 3>& v)
{
  return words.size() == 5 && parse(words[2], v[0]) && parse(words[3], v[1]) &&
         parse(words[4], v[2]);
}

/** Sets the value of one line. Unknown keys are ignored: they are of other versions. */
bool
parseLine(const std::vector<std::string>& words, SurfaceMetadata& metadata, int& version)
{
  SurfaceInfo& info = metadata.info;
  const std::string& key = words[1];
  if (key == "origin") return parse(words, info.origin);
  if (key == "shift") return parse(words, metadata.shift);
  if (words.size() != 3) return false;
  const std::string& value = words[2];
  if (key == "version") return parse(value, version);
  if (key == "degree")
    return parse(value, info.degree) && info.degree >= 1 && info.degree <= kMaxDegree;
  if (key == "fit_kernel") return parse(value, info.fit_kernel);
  if (key == "blend_kernel") return parse(value, info.blend_kernel);
  if (key == "oriented") return parse(value, info.oriented);
  if (key == "sides_in_doubt") return parse(value, info.sides_in_doubt);
  if (key == "paper_mode") return parse(value, info.paper_mode);
  if (key == "scale") return parse(value, info.scale) && info.scale > 0.0;
  if (key == "diagonal") return parse(value, info.diagonal);
  if (key == "lambda") return parse(value, info.lambda);
  if (key == "penalty") return parse(value, info.penalty);
  if (key == "t_mdl") return parse(value, info.t_mdl);
  if (key == "alpha") return parse(value, info.cover_radius);
  if (key == "gamma") return parse(value, info.cover_threshold);
  if (key == "num_points") return parse(value, info.num_points);
  return true;
}

}  // namespace

std::vector<std::string>
toComments(const SurfaceMetadata& metadata)
{
  const SurfaceInfo& info = metadata.info;
  std::vector<std::string> lines;
  const auto add = [&lines](const char* key, const std::string& value) {
    lines.push_back(std::string(kPrefix) + " " + key + " " + value);
  };
  add("version", std::to_string(kMetadataVersion));
  add("degree", std::to_string(info.degree));
  add("fit_kernel", std::to_string(static_cast<int>(info.fit_kernel)));
  add("blend_kernel", std::to_string(static_cast<int>(info.blend_kernel)));
  add("oriented", info.oriented ? "1" : "0");
  add("sides_in_doubt", info.sides_in_doubt ? "1" : "0");
  add("paper_mode", info.paper_mode ? "1" : "0");
  add("origin", formatted(info.origin));
  add("scale", formatScalar(info.scale));
  add("diagonal", formatScalar(info.diagonal));
  add("lambda", formatScalar(info.lambda));
  add("penalty", formatScalar(info.penalty));
  add("t_mdl", formatScalar(info.t_mdl));
  add("alpha", formatScalar(info.cover_radius));
  add("gamma", formatScalar(info.cover_threshold));
  add("num_points", std::to_string(info.num_points));
  add("shift", formatted(metadata.shift));
  return lines;
}

Error
fromComments(const std::vector<std::string>& comments, SurfaceMetadata& metadata, bool& found)
{
  found = false;
  int version = 0;
  for (const std::string& comment : comments) {
    const std::vector<std::string> words = splitWords(comment);
    if (words.size() < 3 || words[0] != kPrefix) continue;
    found = true;
    if (!parseLine(words, metadata, version)) {
      return {ErrorCode::kBadInput,
              "the comment line '" + comment + "' has no usable value; write the file again"};
    }
    if (version > kMetadataVersion) {
      return {ErrorCode::kBadInput, "its surfels have format version " + std::to_string(version) +
                                        ", newer than the " + std::to_string(kMetadataVersion) +
                                        " this program reads; use a newer pcl_slim"};
    }
  }
  return {};
}

}  // namespace pcl_slim
