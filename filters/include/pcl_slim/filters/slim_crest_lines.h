// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pcl_slim/features/crest_lines.h"
#include "pcl_slim/filters/given_surface.h"
#include "pcl_slim/filters/point_crest.h"
#include "pcl_slim/filters/slim_fit.h"

namespace pcl_slim {

/** \brief Parameters and results of SLIMCrestLines that do not depend on the point type;
 * CrestParams documents each. Values are checked when compute() runs. */
class SLIMCrestLinesBase : public GivenSurface {
 public:
  /** \brief All parameters of the tracing together; threads are those of setNumberOfThreads(). */
  void setCrestParams(const CrestParams& params) { crest_ = params; }
  const CrestParams& getCrestParams() const { return crest_; }

  /** \brief Which lines to trace (default both). */
  void setLineTypes(bool ridges, bool ravines) {
    crest_.ridges = ridges;
    crest_.ravines = ravines;
  }
  bool getRidges() const { return crest_.ridges; }
  bool getRavines() const { return crest_.ravines; }

  /** \brief Least prominence of a line in deviations of the noise, everywhere and somewhere
   * (default 2 and 5). */
  void setSignificance(double everywhere, double somewhere) {
    crest_.significance = everywhere;
    crest_.peak_significance = somewhere;
  }
  double getSignificance() const { return crest_.significance; }
  double getPeakSignificance() const { return crest_.peak_significance; }

  /** \brief Least integral of |k| ds of a line, without unit (default 0): how important it must be.
   */
  void setMinStrength(double strength) { crest_.min_strength = strength; }
  double getMinStrength() const { return crest_.min_strength; }

  /** \brief Least length in radii of the surface's balls (default .3). */
  void setMinLength(double radii) { crest_.min_length = radii; }
  double getMinLength() const { return crest_.min_length; }

  /** \brief Distance of vertices in radii of the surface's balls, .02 to .5 (default .15). */
  void setStep(double radii) { crest_.step = radii; }
  double getStep() const { return crest_.step; }

  /** \brief What the last run traced and left out. */
  const CrestStatistics& getCrestStatistics() const { return crest_statistics_; }

 protected:
  SLIMCrestLinesBase() = default;
  ~SLIMCrestLinesBase() = default;

  CrestParams crest_;
  CrestStatistics crest_statistics_;
};

/** \brief Ridges and ravines of a raw cloud as polylines, traced on the SLIM surface fitted to it.
 *
 * \code
 * pcl_slim::SLIMCrestLines<pcl::PointXYZ> crest;
 * crest.setInputCloud(cloud);
 * pcl_slim::CrestLines lines;
 * if (!crest.compute(lines)) std::cerr << crest.getError().message << "\n";
 * \endcode
 *
 * Every setter of SLIMFit is there: input, indices, normals, the fit's parameters, threads,
 * progress, cancel. Lines are in the cloud's coordinates and units, strongest first. Which lines
 * are ridges and which ravines depends on the side the normals face. Lines need polynomials of
 * degree 4, the default; of degree 2 there are few.
 *
 * A missing or empty cloud, one without a finite point, indices out of range and parameters out of
 * range are errors; the output is cleared first. The result is the same for any number of threads.
 *
 * Compiled for PointXYZ, XYZI, XYZRGB, XYZRGBA, PointNormal, XYZINormal and XYZRGBNormal. For
 * another type include pcl_slim/filters/impl/slim_crest_lines.hpp where you use it.
 */
template <typename PointT>
class SLIMCrestLines : public SLIMFit<PointT>, public SLIMCrestLinesBase {
 public:
  using Ptr = pcl::shared_ptr<SLIMCrestLines<PointT>>;
  using ConstPtr = pcl::shared_ptr<const SLIMCrestLines<PointT>>;

  /** \brief Lines need no trim maps: none are made unless requested. */
  SLIMCrestLines() { this->setTrimming(false); }

  /** \brief Traces the lines. \return false with getError() and no lines when it cannot. O(points)
   * for the fit and the seeds, then by the length of the lines. */
  bool compute(CrestLines& lines);

  /** \brief The same as points, with the cloud's header; coordinates are rounded to float. */
  bool compute(pcl::PointCloud<PointCrest>& vertices);

 protected:
  using pcl::PCLBase<PointT>::input_;
};

}  // namespace pcl_slim

#ifdef PCL_NO_PRECOMPILE
#include "pcl_slim/filters/impl/slim_crest_lines.hpp"
#endif
