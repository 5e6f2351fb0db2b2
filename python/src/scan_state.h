// SPDX-License-Identifier: BSD-3-Clause
// A scan on its way to its surface: what smooth(), curvature(), normals(), covariances() and lines()
// have in common.
#pragma once

#include <memory>

#include "arrays.h"
#include "options.h"
#include "pcl_slim/query/cloud_projection.h"
#include "pcl_slim/scan/scan.h"
#include "surface.h"
#include "work.h"

namespace pcl_slim::python {

/** \brief A scan with its surface, made or given. */
struct ScanState {
  Scan scan;
  FitParams params;
  FittedScan fitted;
  KeptNoisePointer sensor_noise;  ///< null: none is kept
  std::shared_ptr<const SLIMSurface> given;
  ProjectionParams wanted;
  CloudProjection projection;
  bool no_surface = false;

  const SLIMSurface& surface() const { return given ? *given : fitted.surface; }
  const PointStore* store() const { return given ? nullptr : &fitted.store; }
  CloudView view() const { return scan.view(); }
};

/** \brief Reads what all functions of a scan take. \param[in] own the surface of a method, or null */
std::shared_ptr<ScanState> readState(const py::object& points, const py::object& normals,
                                     const SurfacePointer& own, Keywords& keywords);

/** \brief Fits, unless a surface is given, and projects the points. \param[in] keep go on with
 * points that are no surface: all of them keep their place */
Error fitAndProject(ScanState& state, bool keep, Work& work);

/** \brief A function of the module that is a method of surfaces, too; without a surface it fits. */
using ScanFunction = py::object (*)(const py::object& points, const py::object& normals,
                                    const SurfacePointer& own, const py::kwargs& given);

/** \brief Adds both. */
void define(py::module_& m, py::class_<Surface, SurfacePointer>& type, const char* name,
            ScanFunction function, const char* doc);

}  // namespace pcl_slim::python
