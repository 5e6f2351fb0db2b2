// SPDX-License-Identifier: BSD-3-Clause
// Whether a LAS file's coordinate system has degrees: ASPRS, LAS 1.4 R15, "Coordinate Reference System
// Variable Length Records".
#include <algorithm>
#include <cctype>
#include <cstring>
#include <string>

#include "io/las/las.h"

namespace pcl_slim {

namespace {

constexpr char kUser[] = "LASF_Projection";
constexpr std::uint16_t kWkt = 2112, kGeoKeys = 34735;
constexpr std::uint16_t kModelType = 1024, kGeographic = 2;
constexpr std::size_t kShortHead = 54, kLongHead = 60;  ///< of a VLR and of one behind the points

/** What the records of a coordinate system say. */
struct Systems {
  std::string wkt;
  bool geographic_keys = false;
};

void takeKeys(const unsigned char* at, std::size_t bytes, Systems& found) {
  constexpr std::size_t kKeyBytes = 8;
  for (std::size_t k = kKeyBytes; k + kKeyBytes <= bytes; k += kKeyBytes) {
    const bool model = getLas<std::uint16_t>(at + k) == kModelType;
    if (model) found.geographic_keys = getLas<std::uint16_t>(at + k + 6) == kGeographic;
  }
}

/** Reads records one after another. */
void findSystems(const unsigned char* at, const unsigned char* end, std::uint32_t count,
                 bool long_heads, Systems& found) {
  const std::size_t head = long_heads ? kLongHead : kShortHead;
  for (; count > 0 && static_cast<std::size_t>(end - at) >= head; --count) {
    const std::uint64_t bytes =
        long_heads ? getLas<std::uint64_t>(at + 20) : getLas<std::uint16_t>(at + 20);
    if (bytes > static_cast<std::size_t>(end - at) - head) return;
    const auto id = getLas<std::uint16_t>(at + 18);
    const bool projection = std::memcmp(at + 2, kUser, sizeof(kUser)) == 0;
    const auto* content = at + head;
    const auto size = static_cast<std::size_t>(bytes);
    if (projection && id == kWkt) found.wkt.assign(reinterpret_cast<const char*>(content), size);
    if (projection && id == kGeoKeys) takeKeys(content, size, found);
    at = content + size;
  }
}

/** Whether a system in well-known text, of either version, has angles: no projection, and no Cartesian
 * axes from the earth's centre. */
bool isGeographic(std::string wkt) {
  std::transform(wkt.begin(), wkt.end(), wkt.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  const auto has = [&wkt](const char* word) { return wkt.find(word) != std::string::npos; };
  if (has("PROJCS") || has("PROJCRS") || has("PROJECTEDCRS") || has("GEOCCS") || has("CARTESIAN"))
    return false;
  return has("GEOGCS") || has("GEOGCRS") || has("GEOGRAPHICCRS") || has("GEODCRS") ||
         has("GEODETICCRS");
}

}  // namespace

bool hasDegrees(const std::vector<unsigned char>& head, const std::vector<unsigned char>& tail,
                std::uint64_t tail_at) {
  Systems found;
  const unsigned char* p = head.data();
  const auto header = getLas<std::uint16_t>(p + LasAt::kHeaderBytes);
  if (header < head.size()) {
    findSystems(p + header, p + head.size(), getLas<std::uint32_t>(p + LasAt::kNumVlrs), false,
                found);
  }
  if (p[LasAt::kVersion + 1] >= 4 && header >= kLasHeaderBytes) {
    const auto at = getLas<std::uint64_t>(p + LasAt::kEvlrs);
    if (at >= tail_at && at - tail_at < tail.size()) {
      findSystems(tail.data() + (at - tail_at), tail.data() + tail.size(),
                  getLas<std::uint32_t>(p + LasAt::kNumEvlrs), true, found);
    }
  }
  return found.wkt.empty() ? found.geographic_keys : isGeographic(found.wkt);
}

}  // namespace pcl_slim
