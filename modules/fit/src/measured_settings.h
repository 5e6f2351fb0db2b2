// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fit_settings.h"
#include "pcl_slim/cloud/point_store.h"

namespace pcl_slim::detail {

/** \brief Settles lambda, the noise profile and what normals weigh as data: what the user states,
 * or what the cloud shows. \return an error where normals are to be data and there are none. */
Error
measureSettings(const PointStore& store, const FitParams& params, int threads,
                FitSettings& settings, FitStatistics& stats);

}  // namespace pcl_slim::detail
