// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "pcl_slim/surface/surface.h"

namespace pcl_slim {

/** \brief A surface to use in place of a fit, and the one that a run fitted: what every class has
 * that needs a surface. */
class GivenSurface {
 public:
  using SurfaceConstPtr = std::shared_ptr<const SLIMSurface>;

  /** \brief Uses a surface in place of a fit; null: fit (default). It is shared, not copied, and
   * kept as long as this object or a copy of it has it; it must not change while a run uses it.
   *
   * It may come from another cloud of the same object in the same coordinates. Parameters of the
   * fit are then unused, except for sharp features, the viewpoint and the number of threads. */
  void setSurface(const SurfaceConstPtr& surface) { given_surface_ = surface; }
  /** \brief The same with a copy: the argument may change or end afterwards. */
  void setSurface(const SLIMSurface& surface) {
    given_surface_ = std::make_shared<const SLIMSurface>(surface);
  }
  /** \brief The surface set, or null. */
  const SurfaceConstPtr& getSurface() const { return given_surface_; }

  /** \brief The surface that the last run fitted; null when it used a given one or failed. */
  const SurfaceConstPtr& getFittedSurface() const { return fitted_surface_; }

 protected:
  GivenSurface() = default;
  ~GivenSurface() = default;

  SurfaceConstPtr given_surface_, fitted_surface_;
};

}  // namespace pcl_slim
