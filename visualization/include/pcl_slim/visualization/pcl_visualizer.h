// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <string>

#include "pcl_slim/core/export.h"
#include "pcl_slim/splat/splat_set.h"
#include "pcl_slim/surface/surface.h"
#include "pcl_slim/visualization/display_mode.h"

namespace pcl::visualization {
class PCLVisualizer;
}

/** \file
 * Surfaces and splats in a pcl::visualization::PCLVisualizer, as its own add, update and remove
 * do it: known by an id, false where that is taken or unknown. They are shapes to it: contains(),
 * removeShape(), removeAllShapes(), setShapeRenderingProperties() (colour, opacity) and
 * saveScreenshot() work on them.
 */
namespace pcl_slim {

class SLIMMapper;
class SplatMapper;

/** \brief Adds a surface, in its world coordinates. The surface is copied.
 * \param[in] viewport as PCLVisualizer numbers them; 0: all.
 * \return false when the id is taken or the surface does not pass validate(). */
PCL_SLIM_EXPORT bool addSLIMSurface(pcl::visualization::PCLVisualizer& viewer,
                                    const SLIMSurface& surface, const std::string& id = "slim",
                                    int viewport = 0);

/** \brief Puts another surface in its place; colours, mode and properties stay. */
PCL_SLIM_EXPORT bool updateSLIMSurface(pcl::visualization::PCLVisualizer& viewer,
                                       const SLIMSurface& surface, const std::string& id = "slim");

/** \brief Removes a surface that addSLIMSurface() added, with its scalar bar if there is one. */
PCL_SLIM_EXPORT bool removeSLIMSurface(pcl::visualization::PCLVisualizer& viewer,
                                       const std::string& id = "slim");

/** \brief What draws a surface: modes, range, frame budget, picking; null for an unknown id. */
PCL_SLIM_EXPORT SLIMMapper* getSLIMMapper(pcl::visualization::PCLVisualizer& viewer,
                                          const std::string& id = "slim");

/** \brief Chooses what a surface's colours show. With a mode that shows numbers a scalar bar
 * appears in the surface's viewports, its text light or dark as their background is not; with
 * another it goes. \param[in] range curvature of full colour; 0: automatic. */
PCL_SLIM_EXPORT bool setSLIMSurfaceMode(pcl::visualization::PCLVisualizer& viewer, DisplayMode mode,
                                        double range = 0.0, const std::string& id = "slim");

/** \brief Adds discs: PCL's surfels with colours (rgba), in the cloud's coordinates. Those with a
 * value that is not finite, a radius below 0 or no normal are left out. */
PCL_SLIM_EXPORT bool addSplats(pcl::visualization::PCLVisualizer& viewer,
                               const pcl::PointCloud<pcl::PointSurfel>& splats,
                               const std::string& id = "splats", int viewport = 0);

/** \brief Adds splats as the colour octree makes them, with gradients where they have them. */
PCL_SLIM_EXPORT bool addSplats(pcl::visualization::PCLVisualizer& viewer, const SplatSet& splats,
                               const std::string& id = "splats", int viewport = 0);

/** \brief Puts other splats in their place. */
PCL_SLIM_EXPORT bool updateSplats(pcl::visualization::PCLVisualizer& viewer, const SplatSet& splats,
                                  const std::string& id = "splats");
/** \brief The same for PCL's surfels. */
PCL_SLIM_EXPORT bool updateSplats(pcl::visualization::PCLVisualizer& viewer,
                                  const pcl::PointCloud<pcl::PointSurfel>& splats,
                                  const std::string& id = "splats");

/** \brief Takes splats out of the window. \return false for an unknown id. */
PCL_SLIM_EXPORT bool removeSplats(pcl::visualization::PCLVisualizer& viewer,
                                  const std::string& id = "splats");

/** \brief What draws splats; null for an unknown id. */
PCL_SLIM_EXPORT SplatMapper* getSplatMapper(pcl::visualization::PCLVisualizer& viewer,
                                            const std::string& id = "splats");

/** \brief PCL's surfels as discs, those that cannot be drawn left out. O(splats). */
PCL_SLIM_EXPORT SplatSet splatsFrom(const pcl::PointCloud<pcl::PointSurfel>& cloud);

}  // namespace pcl_slim
