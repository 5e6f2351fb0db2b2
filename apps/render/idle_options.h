// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "common/options.h"
#include "render/line_request.h"
#include "render/picture_request.h"

namespace pcl_slim {

/** \brief What decides which options of a picture or page have an effect. */
struct DrawnThing {
  bool is_splats, is_page, trim;
  const PictureRequest& picture;
  const LineRequest& lines;
  const ShadingParams& shading;
};

/** \brief A line for each option that was given and changes nothing. */
std::vector<std::string>
idleOptions(const OptionTable& table, const DrawnThing& drawn);

}  // namespace pcl_slim
