// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "common/options.h"
#include "pcl_slim/render/bounding_spheres.h"
#include "pcl_slim/render/render_params.h"
#include "render/model.h"

namespace pcl_slim {

/** \brief A box of interest: what lies outside is neither drawn nor looked at by the camera. */
struct RegionRequest {
  std::string text = "all";
  std::vector<HalfSpace> sides;  ///< of text, world coordinates; empty: no box

  /** \brief Adds -region. The request must outlive the table's parse(). */
  void declare(OptionTable& table);

  /** \brief Reads text. */
  Error parse();

  /** \brief Drops a model's splats outside of the box; what remains of a model for the camera to look at.
   * \return an error that tells where the model lies when the box holds nothing of it */
  Result<BoundingSpheres> apply(Model& model) const;
};

}  // namespace pcl_slim
