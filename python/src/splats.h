// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

#include <memory>

#include "pcl_slim/splat/splat_sampling.h"

namespace pcl_slim::python {

namespace py = pybind11;

/** \brief Discs that Python holds. */
struct Splats {
  SplatSet set;
  SplatStatistics statistics;
};
using SplatsPointer = std::shared_ptr<Splats>;

void bindSplats(py::module_& m, py::class_<Splats, SplatsPointer>& type);

}  // namespace pcl_slim::python
