// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "pcl_slim/filters/slim_fit.h"

#ifndef PCL_SLIM_PCL_POINTS_ONLY
#include "pcl_slim/filters/impl/slim_fit.hpp"
#endif

namespace pcl_slim {

/** Describes a cloud's points and normals the way SLIMFit does, for classes that do more with
 * them. The view is valid while this object and the cloud live. */
template <typename PointT>
class CloudDescription : public SLIMFit<PointT> {
 public:
  CloudDescription(const typename pcl::PointCloud<PointT>::ConstPtr& cloud,
                   const pcl::IndicesConstPtr& indices, const FitParams& params,
                   const SensorPositions& sensors = nullptr, const FrameNumbers& frames = nullptr) {
    this->sensors_ = sensors;
    this->frames_ = frames;
    this->setInputCloud(cloud);
    if (indices) this->setIndices(indices);
    this->setParams(params);
  }

  /** \return whether the cloud can be used; getError() gives the reason if not. */
  bool describe() { return this->describeInput(view_) && this->describeNormals(view_, estimated_); }

  const CloudView& view() const { return view_; }

 private:
  CloudView view_;
  std::vector<float> estimated_;
};

}  // namespace pcl_slim
