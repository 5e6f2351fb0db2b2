// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fit_plan.h"
#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/core/error.h"

namespace pcl_slim::detail {

/** \brief A cloud's errors as given by the user or measured: lambda, the noise profile, the normal
 * bound and what normals weigh as data. \return an error where normals are to be data and there are none. */
Result<CloudMeasures>
measureCloud(const PointStore& store, const FitParams& params, const FitConstants& constants,
             int threads, FitStatistics& stats);

}  // namespace pcl_slim::detail
