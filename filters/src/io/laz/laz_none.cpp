// SPDX-License-Identifier: BSD-3-Clause
// Builds without LASzip's library: .laz is refused.
#include <algorithm>

#include "io/laz/laz.h"

namespace pcl_slim {

Error checkLaz(const std::string& path) {
  std::string plain = path.substr(0, path.size() - std::min<std::size_t>(path.size(), 4)) + ".las";
  if (plain == path) plain.insert(plain.size() - 4, "_plain");
  return {ErrorCode::kBadArgument,
          "'" + path +
              "' is compressed, and this build has no LASzip (liblaszip-dev of Debian 13); convert "
              "it: pip "
              "install 'laspy[lazrs]', then python3 -c \"import laspy; laspy.read('" +
              path + "').write('" + plain + "')\""};
}

Result<std::vector<unsigned char>> unpackLaz(const std::vector<unsigned char>&) {
  return checkLaz("IN.laz");
}

}  // namespace pcl_slim
