// SPDX-License-Identifier: BSD-3-Clause
// docs/theory.md, "Degree at features".
#pragma once

#include "radius/trial_fits.h"

namespace pcl_slim::detail {

/** \brief Whether a fit leaves more than noise and than any smooth surface would: a feature is
 * near. */
bool
liesBesideFeature(const TrialFits& trials, const Trial& trial);

/** \brief The fit of a low degree in a smaller ball that beats a trial by its expected error.
 *
 * Across an edge no degree fits, and a lower one needs less room. \return an unsupported trial
 * where none does. Up to feature_steps fits. */
Trial
fitBesideFeature(TrialFits& trials, const Trial& trial);

}  // namespace pcl_slim::detail
