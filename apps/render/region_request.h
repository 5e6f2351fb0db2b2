// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>
#include <vector>

#include "common/options.h"
#include "pcl_slim/render/bounding_spheres.h"
#include "pcl_slim/render/render_params.h"
#include "pcl_slim/surface/slim_blocks.h"

namespace pcl_slim {

/** \brief A box of interest: everything outside is neither drawn nor looked at by the camera. */
struct RegionRequest {
  std::string text = "all";
  std::vector<HalfSpace> sides;  ///< of text, world coordinates; empty: no box

  /** \brief x0, x1, y0, y1, z0, z1 of the box, once parse() has gone well; an object's own without one. */
  std::array<double, 6> bounds(const BoundingSpheres& object) const;

  /** \brief Its corners, once parse() has gone well; only where there is a box. */
  WorldBox box() const;

  /** \brief Adds -region. The request must outlive the table's parse(). */
  void declare(OptionTable& table);

  /** \brief Reads text. */
  Error parse();

  /** \brief What a camera has to look at. \param[in] whole where the object is, if only a part of it is given
   * \return an error that gives the object's position when the box contains nothing of it */
  Result<BoundingSpheres> within(const BoundingSpheres& object,
                                 const WorldBox* whole = nullptr) const;
};

}  // namespace pcl_slim
