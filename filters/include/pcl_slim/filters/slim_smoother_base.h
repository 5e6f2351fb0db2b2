// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl/PCLPointField.h>
#include <pcl/PointIndices.h>
#include <pcl/point_cloud.h>
#include <pcl/surface/mls.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "pcl_slim/core/export.h"
#include "pcl_slim/filters/cloud_description.h"
#include "pcl_slim/filters/slim_projection_base.h"

namespace pcl_slim {

/** \brief The parameters that SLIMProjectionSmoother shares with pcl::MovingLeastSquares, by the
 * same names, and what they mean here; they do not depend on the point types.
 *
 * Values are checked when process() runs. No setter changes what another one has set. */
class PCL_SLIM_EXPORT SLIMSmootherBase : public SLIMProjectionBase {
 public:
  // Where points come out ------------------------------------------------------------------------

  /** \brief Which points are projected onto the surface; values as in pcl::MovingLeastSquares. */
  enum UpsamplingMethod {
    NONE,                    ///< the input's own (default)
    DISTINCT_CLOUD,          ///< those of setDistinctCloud()
    SAMPLE_LOCAL_PLANE,      ///< a grid within setUpsamplingRadius() about each input point
    RANDOM_UNIFORM_DENSITY,  ///< as many around each input point as setPointDensity() sets
    VOXEL_GRID_DILATION      ///< the corners of voxels about the input points
  };

  /** \brief Which points are projected (default NONE). */
  void setUpsamplingMethod(UpsamplingMethod method) { upsampling_ = method; }
  UpsamplingMethod getUpsamplingMethod() const { return upsampling_; }

  /** \brief SAMPLE_LOCAL_PLANE: radius of the disc about each point, in the cloud's units. */
  void setUpsamplingRadius(double radius) { upsampling_radius_ = radius; }
  double getUpsamplingRadius() const { return upsampling_radius_; }
  /** \brief SAMPLE_LOCAL_PLANE: width of the grid in the disc, in the cloud's units. */
  void setUpsamplingStepSize(double step) { upsampling_step_ = step; }
  double getUpsamplingStepSize() const { return upsampling_step_; }

  /** \brief RANDOM_UNIFORM_DENSITY: points wanted within the search radius of each point. */
  void setPointDensity(int points) { point_density_ = points; }
  int getPointDensity() const { return point_density_; }

  /** \brief VOXEL_GRID_DILATION: edge of a voxel, in the cloud's units. */
  void setDilationVoxelSize(float size) { voxel_size_ = size; }
  float getDilationVoxelSize() const { return voxel_size_; }
  /** \brief VOXEL_GRID_DILATION: how often every voxel is joined by its neighbours. */
  void setDilationIterations(int iterations) { dilations_ = iterations; }
  int getDilationIterations() const { return dilations_; }

  /** \brief The input point that each output point belongs to: itself, or the nearest one. Null
   * before the first run. */
  pcl::PointIndicesPtr getCorrespondingIndices() const { return corresponding_; }

  // How smooth -----------------------------------------------------------------------------------

  /** \brief No detail finer than this radius is kept, in the cloud's units; 0 (default): what is
   * detail is measured.
   *
   * Sets the least radius of the surface's balls to the one at which a fit averages the noise as
   * much as pcl::MovingLeastSquares with this radius and order 2 does: 1.42 radii up to degree 3,
   * 1.97 for degree 4. Wider balls are chosen as without it. */
  void setSearchRadius(double radius) { search_radius_ = radius; }
  double getSearchRadius() const { return search_radius_; }

  /** \brief Accepted and unused, of which process() warns: the weights' width follows from each
   * ball's radius. */
  void setSqrGaussParam(double value) { sqr_gauss_param_ = value; }
  double getSqrGaussParam() const;

  // Output ---------------------------------------------------------------------------------------

  /** \brief Whether to write the surface's normals, and curvatures, where PointOutT has fields for
   * them: curvature (see setCurvature()), and mean_curvature, gaussian_curvature, k1 and k2 as in
   * PointCurvature. On by default. Off, those fields are copied like others.
   *
   * A normal points to the side of the input's normal at that point, if there is one; otherwise
   * towards the viewpoint, if one is set, or what findSideEvidence() finds; otherwise outward.
   * A point that no surfel supports has its input's normal or, if it has none, that of its
   * neighbours, on their side; curvatures other than the surface variation are NaN there. Where
   * there is no normal either, at NaN points and in clouds of fewer than three, all is NaN and
   * is_dense is false. */
  void setComputeNormals(bool compute) { compute_normals_ = compute; }
  bool getComputeNormals() const { return compute_normals_; }

  // Curvature ------------------------------------------------------------------------------------

  /** \brief What the output's field curvature contains. */
  enum Curvature {
    kMean,             ///< (k1 + k2) / 2, 1/length, positive where the surface bends away from the
                       ///< normal
    kGaussian,         ///< k1 k2, 1/length^2
    kMaximum,          ///< k1, the larger principal curvature, 1/length
    kMinimum,          ///< k2, 1/length
    kSurfaceVariation  ///< what PCL's classes write and read (default), without unit, 0 to 1/3: the
                       ///< least eigenvalue's share of the covariance of the output's about 30
                       ///< nearest points, as pcl::NormalEstimation computes it with setKSearch(30)
  };

  /** \brief Chooses it. Filters and pcl::RegionGrowing expect kSurfaceVariation: about (r k)^2 / 24
   * where the surface's curvature is k and the 30 points fill a disc of radius r, .08 at a right
   * angle. */
  void setCurvature(Curvature curvature) { curvature_ = curvature; }
  Curvature getCurvature() const { return curvature_; }

  // Of MovingLeastSquares, without a meaning here
  // --------------------------------------------------

  /** \brief Accepted and unused, of which process() warns if it is on: the surface itself is the
   * result that is kept (getFittedSurface()). */
  void setCacheMLSResults(bool cache) { cache_results_ = cache; }
  bool getCacheMLSResults() const { return cache_results_; }
  /** \brief None are made: empty. */
  const std::vector<pcl::MLSResult>& getMLSResults() const { return mls_results_; }

  /** \brief Accepted and unused, of which process() warns: points go to their foot on the surface
   * (equations 6 and 7 of Ohtake, Belyaev, Alexa 2005). */
  void setProjectionMethod(pcl::MLSResult::ProjectionMethod method) { projection_method_ = method; }
  pcl::MLSResult::ProjectionMethod getProjectionMethod() const { return projection_method_; }

 protected:
  SLIMSmootherBase() : SLIMProjectionBase(true) {}
  ~SLIMSmootherBase() = default;

  static constexpr std::size_t kNoField = static_cast<std::size_t>(-1);

  /** \brief The input as bytes: points of any type. */
  struct Source {
    const unsigned char* points = nullptr;
    std::size_t step = 0;                   ///< bytes from one point to the next
    const pcl::Indices* indices = nullptr;  ///< null: all points
    CloudView view;                         ///< what is fitted to
    CloudView distinct;                     ///< of the distinct cloud; empty: there is none
  };

  /** \brief Bytes that a point of one type and a point of another have in common. */
  struct CommonBytes {
    std::size_t from, to, count;
  };

  /** \brief The output as bytes; offsets of its fields within a point, or kNoField. Three floats
   * each of positions and normals, one of curvatures. */
  struct Target {
    std::size_t step = 0, position = 0, normal = kNoField, curvature = kNoField;
    std::size_t mean = kNoField, gaussian = kNoField, k1 = kNoField, k2 = kNoField;

    bool hasCurvatures() const {
      return mean != kNoField || gaussian != kNoField || k1 != kNoField || k2 != kNoField;
    }

    std::vector<pcl::PCLPointField> fields;
    std::vector<CommonBytes> copies;                    ///< the fields that both types have
    std::function<unsigned char*(std::size_t)> resize;  ///< makes room for this many points
    pcl::PCLHeader* header = nullptr;
    Eigen::Vector4f* sensor_origin = nullptr;
    Eigen::Quaternionf* sensor_orientation = nullptr;
    std::uint32_t *width = nullptr, *height = nullptr;
    bool* is_dense = nullptr;
  };

  /** \brief What copies the fields that two point types have by the same names, rgb and rgba being
   * one. */
  static std::vector<CommonBytes> commonFields(const std::vector<pcl::PCLPointField>& from,
                                               const std::vector<pcl::PCLPointField>& to);
  template <typename PointT, typename Field>
  static std::size_t floatField();
  /** \brief Describes a pcl::PointCloud<PointT>. */
  template <typename PointT>
  static Target targetOf(void* cloud);
  /** \brief Runs, and gives the output the input's header, sensor and, where its points are the
   * input's, rows. \param[in] distinct may be null \param[in] target_of the targetOf() of the
   * output's type \param[in] same whether that is the input's */
  template <typename PointT>
  void smoothInput(const CloudInput<PointT>& input,
                   typename pcl::PointCloud<PointT>::ConstPtr distinct, void* output,
                   Target (*target_of)(void*), bool same);
  /** \brief Performs a run into a cloud apart, because output may be the input, and prints what it
   * has to say. Output is empty after an error. */
  template <typename PointT>
  void processApart(void (*perform)(SLIMSmootherBase&, pcl::PointCloud<PointT>&),
                    pcl::PointCloud<PointT>& output);
  /** \brief Prints the error of a run, or its warning, if there is any. */
  void complain() const;

  /** \brief Names the first parameter that a run cannot work with. \param[in] has_distinct whether
   * a distinct cloud is set. */
  Error checkSmoother(bool has_distinct) const;
  /** \brief Smooths or upsamples, and writes the points. \param[out] dense whether all are finite.
   * \return whether they are the input's own; getError() gives the reason if there are none. */
  bool run(const Source& source, const Target& target, bool& dense);

  bool compute_normals_ = true;
  pcl::PointIndicesPtr corresponding_;
  double search_radius_ = 0.0;
  UpsamplingMethod upsampling_ = NONE;
  double upsampling_radius_ = 0.0, upsampling_step_ = 0.0;
  int point_density_ = 0;
  float voxel_size_ = 1.0f;
  int dilations_ = 0;
  Curvature curvature_ = kSurfaceVariation;

 private:
  struct Candidates;

  /** \brief Fits with the least radius of balls for the search radius, and projects; see
   * SLIMProjectionBase::project(). */
  bool smooth(const CloudView& points, const ProjectionParams& requested,
              CloudProjection& projection);
  /** \brief What of a projection is written. */
  ProjectionParams requestedBy(const Target& target) const;
  /** \brief The points of the upsampling method, and their projection; those that are not
   * supported stay out. \param[in] own the projection of the input. \param[in] distinct for
   * DISTINCT_CLOUD. */
  bool projectCandidates(const CloudView& points, const ProjectionParams& requested,
                         const CloudProjection& own, const CloudView& distinct,
                         Candidates& candidates, CloudProjection& projection);
  /** \brief A candidate's foot on the surface, on the side of its input point's. */
  ProjectedPoint upsampled(const Candidates& candidates, const CloudProjection& projection,
                           std::size_t i) const;
  /** \brief The value of the field curvature. */
  float curvatureOf(const ProjectedPoint& point) const;
  /** \return whether all places and normals are finite. */
  bool write(const Source& source, const CloudProjection& projection, const Target& target);
  void upsample(const Source& source, const CloudProjection& own, const Target& target);
  void put(const ProjectedPoint& point, const Target& target, unsigned char* to) const;
  void putNormal(const ProjectedPoint& point, const Target& target, unsigned char* to) const;
  void sampleAround(const CloudView& points, const CloudProjection& own,
                    Candidates& candidates) const;
  bool collect(const CloudView& points, const CloudProjection& own, const CloudView& distinct,
               Candidates& candidates);
  double sqr_gauss_param_ = 0.0;
  bool cache_results_ = false;
  pcl::MLSResult::ProjectionMethod projection_method_ = pcl::MLSResult::SIMPLE;
  std::vector<pcl::MLSResult> mls_results_;

  /** \brief Warns of setters that were called and have no effect. */
  void warnUnused();
};

}  // namespace pcl_slim
