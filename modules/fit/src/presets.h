// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fit_settings.h"
#include "pcl_slim/cloud/point_store.h"

namespace pcl_slim::detail {

/** \brief The choices of Ohtake et al. 2005 throughout. */
FitSettings
paperPreset(const FitConstants& constants);

/** \brief The default (docs/theory.md, "Where the default departs from the paper"). */
FitSettings
defaultPreset(const FitConstants& constants);

/** \brief A T_MDL given without the paper's other choices (docs/theory.md, "T given"). */
FitSettings
givenTPreset(const FitConstants& constants);

/** \brief The paper's choices with a T_MDL given: its own. */
FitSettings
paperGivenTPreset(const FitConstants& constants);

/** \brief Any preset with sharp features kept (docs/theory.md, "Sharp features"). */
FitSettings
sharpPreset(FitSettings preset);

/** \brief The penalty kappa where none is given. */
double
defaultKappa(const FitParams& params, const PresetConstants& constants);

/** \brief A user's parameters with degree and penalty settled. */
FitParams
resolvedParams(const FitParams& params, const PresetConstants& constants);

/** \brief The preset that a user's parameters name, with the cloud's measures and all that he sets
 * himself; noise and normals as data are measured apart (measured_settings.h). \param[in] params
 * resolved */
FitSettings
makeSettings(const PointStore& store, const FitParams& params, const FitConstants& constants);

}  // namespace pcl_slim::detail
