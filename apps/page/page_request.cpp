// SPDX-License-Identifier: BSD-3-Clause
#include "page/page_request.h"

#include "pcl_slim/core/file_access.h"
#include "pcl_slim/render/shading.h"

namespace pcl_slim {
namespace {

Error
refused(const std::string& option, const std::string& why)
{
  return {ErrorCode::kBadArgument, option + " " + why};
}

}  // namespace

void
PageRequest::declare(OptionTable& table)
{
  table.number("precision", &precision, 0.0, 65536.0,
               "of a page: steps of a coefficient per radius, 16 or more; 0: nothing is rounded");
}

bool
PageRequest::isPage(const std::string& output)
{
  const std::string extension = lowerExtension(output);
  return extension == ".html" || extension == ".htm";
}

Error
PageRequest::check(const OptionTable& table, const std::string& output, const std::string& mode)
{
  if (!isPage(output)) {
    return table.given("precision")
               ? refused("-precision", "is for pages: name an output that ends in .html")
               : Error{};
  }
  for (const char* name :
       {"size", "bar", "turntable", "region", "aa", "lines", "line_width", "line_curvature",
        "line_slope", "line_length", "skip", "repeat", "lights", "filtered"}) {
    if (table.given(name)) {
      return refused("-" + std::string(name), "means nothing in a page: leave it out");
    }
  }
  if (mode != "auto" && !shadingModeOf(mode)) {
    return refused("-mode " + mode, "cannot be shown in a page: name another mode");
  }
  return {};
}

std::string
PageRequest::titleOf(const std::string& input)
{
  const std::size_t folder = input.find_last_of('/');
  const std::string name = folder == std::string::npos ? input : input.substr(folder + 1);
  return name.substr(0, name.size() - lowerExtension(name).size());
}

}  // namespace pcl_slim
