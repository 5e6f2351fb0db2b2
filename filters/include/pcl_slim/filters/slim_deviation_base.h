// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl/PolygonMesh.h>

#include <Eigen/Core>
#include <memory>
#include <optional>

#include "pcl_slim/compare/deviation.h"
#include "pcl_slim/compare/deviation_summary.h"
#include "pcl_slim/compare/place_columns.h"
#include "pcl_slim/compare/registration.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/filters/given_surface.h"
#include "pcl_slim/filters/slim_fit_base.h"

namespace pcl_slim {

/** \brief Parameters and results of SLIMDeviation that do not depend on the point type. */
class PCL_SLIM_EXPORT SLIMDeviationBase : public SLIMFitBase, public GivenSurface {
 public:
  // Parameters -----------------------------------------------------------------------------------

  /** \brief Where the points are compared: where the surface fitted to them is (default), or as
   * measured, with the cloud's noise as their error. */
  void setPlaces(ScanPlaces places) { places_kind_ = places; }
  ScanPlaces getPlaces() const { return places_kind_; }

  /** \brief Standard error of the alignment of cloud and reference, cloud units; it raises the level
   * of detection. 0 (default): none. */
  void setRegistrationError(double error) { deviation_.registration_error = error; }
  double getRegistrationError() const { return deviation_.registration_error; }

  /** \brief No counterpart beyond this distance, cloud units; 0 (default): no limit. */
  void setMaxDistance(double distance) { deviation_.feet.max_distance = distance; }
  double getMaxDistance() const { return deviation_.feet.max_distance; }

  /** \brief Whether the points are moved by the motion that remains between cloud and reference
   * before they are compared (default off). */
  void setAlign(bool align) { align_ = align; }
  bool getAlign() const { return align_; }

  /** \brief Deviations that are allowed, low < high, for DeviationSummary::passes. */
  void setTolerance(double low, double high) {
    summary_params_.has_tolerance = true;
    summary_params_.tolerance_low = low;
    summary_params_.tolerance_high = high;
  }
  void clearTolerance() { summary_params_.has_tolerance = false; }

  // Results --------------------------------------------------------------------------------------

  /** \brief The motion that remains between cloud and reference, with standard errors. Its modes are
   * none where it could not be estimated; getWarning() then says why. */
  const Registration& getRegistration() const { return registration_; }
  /** \brief The motion that was applied to the points, for column vectors (x, y, z, 1); the identity
   * without setAlign(true). */
  const Eigen::Matrix4d& getTransformation() const { return transformation_; }
  /** \brief Mean, RMS, quantiles, significant area and volume: each point has the same share of the
   * area of the cloud's surface, and all are one component. */
  const DeviationSummary& getSummary() const { return summary_; }
  /** \brief The surface that the last run fitted to a reference cloud, or null. */
  const SurfaceConstPtr& getFittedReference() const { return fitted_reference_; }

 protected:
  /** \brief Points move alike with trim maps and without, but a reference ends at its borders. */
  SLIMDeviationBase() = default;
  ~SLIMDeviationBase() = default;

  /** \brief Forgets the last run. */
  void clearResults();
  /** \brief Fits what needs a fit, aligns and measures.
   * \param[in] points to compare \param[in] reference a cloud to fit the reference to, or null: a
   * surface or a mesh is set \param[out] places where the points were compared \param[out]
   * deviations one for each point. */
  bool compare(const CloudView& points, const CloudView* reference, PlaceColumns& places,
               Deviations& deviations);

  /** \brief What a reference is that no surface is fitted to; both null: a cloud, or none. */
  struct GivenReference {
    SurfaceConstPtr surface;
    pcl::PolygonMesh::ConstPtr mesh;
  };
  GivenReference given_reference_;

 private:
  /** \brief What setters have set when a run begins: callbacks may set other values. */
  struct Settings {
    FitParams fit;
    ScanPlaces places = ScanPlaces::kMoved;
    DeviationParams deviation;
    DeviationSummaryParams summary;
    bool align = false;
    SurfaceConstPtr surface;
    GivenReference reference;
  };
  Error run(const Settings& settings, const CloudView& points, const CloudView* reference,
            PlaceColumns& places, Deviations& deviations);
  /** \brief The points' surface and where they are compared. */
  Error place(const Settings& settings, const CloudView& points, SurfaceConstPtr& surface,
              PlaceColumns& places);
  /** \brief \param[out] owner keeps what the reference refers to. */
  Result<DeviationReference> makeReference(const Settings& settings, const CloudView* cloud,
                                           SurfaceConstPtr& owner);
  Error sumUp(const Settings& settings, const SLIMSurface& surface, const Deviations& deviations);

  ScanPlaces places_kind_ = ScanPlaces::kMoved;
  DeviationParams deviation_;
  DeviationSummaryParams summary_params_;
  bool align_ = false;
  Registration registration_;
  Eigen::Matrix4d transformation_ = Eigen::Matrix4d::Identity();
  DeviationSummary summary_;
  SurfaceConstPtr fitted_reference_;
};

}  // namespace pcl_slim
