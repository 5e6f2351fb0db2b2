// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vtkSmartPointer.h>

#include <string>

#include "pcl_slim/core/export.h"
#include "pcl_slim/visualization/display_mode.h"

class vtkRenderer;
class vtkScalarBarActor;

namespace pcl_slim {

class GBufferMapper;

/** \brief "mean curvature", "radius" ...: the quantity of a mode's colours. */
PCL_SLIM_EXPORT std::string titleOf(DisplayMode mode);

/** \brief The unit of a mode's numbers: "1/mm", "mm"; empty for what has none. \param[in] length
 * name of the unit of length; empty: curvatures are in "1/length", lengths have no unit. */
PCL_SLIM_EXPORT std::string unitOf(DisplayMode mode, const std::string& length);

/** \brief A scalar bar of a mapper's colours at the right of the window, with title, unit and round
 * numbers. It follows the mapper's range; make another for another mode. \param[in] unit of length: "mm", or
 * nothing. */
PCL_SLIM_EXPORT vtkSmartPointer<vtkScalarBarActor> makeScalarBar(GBufferMapper& mapper,
                                                                 const std::string& unit = "");

/** \brief Makes a bar's text light on a dark background of a renderer, dark on a light one. */
PCL_SLIM_EXPORT void contrastWith(vtkRenderer* renderer, vtkScalarBarActor* bar);

/** \brief Sets the size of a bar's letters in pixels; 13 unless set. */
PCL_SLIM_EXPORT void setLetters(vtkScalarBarActor* bar, int pixels);

}  // namespace pcl_slim
