// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fit_settings.h"
#include "pcl_slim/cloud/point_store.h"

namespace pcl_slim::detail {

/** \brief First level whose median ball holds a small share of the points: the box's size says
 * nothing about the object's where one far point can stretch it. 1 in paper mode. */
int
startLevel(const PointStore& store, const FitSettings& settings);

}  // namespace pcl_slim::detail
