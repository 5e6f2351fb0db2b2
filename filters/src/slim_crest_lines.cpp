// SPDX-License-Identifier: BSD-3-Clause
#define PCL_SLIM_PCL_POINTS_ONLY
#include "pcl_slim/filters/impl/slim_crest_lines.hpp"

#include "input_types.h"

PCL_SLIM_FOR_INPUT_TYPES(PCL_SLIM_INSTANTIATE_SLIMCrestLines)
