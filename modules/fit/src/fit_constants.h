// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "radius/radius_constants.h"

namespace pcl_slim::detail {

/** \brief Every tuning constant of the fit; nothing else decides. Paragraphs are those of
 * docs/theory.md. */
struct FitConstants {
  RadiusConstants radius;
};

}  // namespace pcl_slim::detail
