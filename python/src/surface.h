// SPDX-License-Identifier: BSD-3-Clause
// What Python holds: a fitted surface, and what was said about its fit.
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/fit/fit.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim::python {

namespace py = pybind11;

/** \brief A SLIM surface, which never changes, so that threads share it. */
class Surface {
 public:
  explicit Surface(SLIMSurface surface)
      : surface_(std::make_shared<const SLIMSurface>(std::move(surface))) {}

  const std::shared_ptr<const SLIMSurface>& shared() const { return surface_; }
  const SLIMSurface& get() const { return *surface_; }

  /** \brief The surface without components of fewer points, as it is drawn and sampled; the last
   * such surface is kept. O(surfels log surfels) the first time. */
  std::shared_ptr<const SLIMSurface> drawn(double min_component, int threads) const;

  std::vector<std::string> notes;  ///< what a user may want otherwise, a sentence each
  py::dict statistics;             ///< of the fit; empty of a surface that was loaded

 private:
  std::shared_ptr<const SLIMSurface> surface_;
  mutable std::mutex mutex_;
  mutable std::shared_ptr<const SLIMSurface> drawn_;
  mutable double drawn_min_component_ = -1;
};

using SurfacePointer = std::shared_ptr<Surface>;

/** \brief Records what a fit came to. */
void describeFit(const PointStore& store, const FitParams& params, const FitStatistics& fit,
                 Surface& surface);

void bindSurface(py::module_& m, py::class_<Surface, SurfacePointer>& type);
void bindFit(py::module_& m);
void bindScanFunctions(py::module_& m, py::class_<Surface, SurfacePointer>& type);
void bindLines(py::module_& m, py::class_<Surface, SurfacePointer>& type);
void bindPaint(py::class_<Surface, SurfacePointer>& type);

}  // namespace pcl_slim::python
