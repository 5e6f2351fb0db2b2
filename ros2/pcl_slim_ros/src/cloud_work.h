// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <pcl_slim/core/error.h>
#include <pcl_slim/core/progress.h>
#include <pcl_slim/filters/io/point_table.h>

#include "node_parameter.h"

namespace pcl_slim_ros {

/** \brief Points to publish. */
struct CloudOutput {
  pcl_slim::PointTable points;
  bool is_dense = true;
  std::string warning;  ///< what a user may want otherwise, or empty
};

/** \brief What a node does with a cloud, without ROS. Not for several threads at once. */
class CloudWork {
 public:
  virtual ~CloudWork() = default;

  /** \brief The parameters, whose values go into this object. */
  virtual NodeParameters parameters() = 0;
  /** \brief What parameters demand of each other. */
  virtual pcl_slim::Error validate() const = 0;
  /** \brief Works on the points of one message. */
  virtual pcl_slim::Result<CloudOutput> process(pcl_slim::PointTable points,
                                                pcl_slim::Progress* progress) const = 0;
};

/** \brief Makes a work with its default parameters. */
using MakeWork = std::unique_ptr<CloudWork> (*)();

std::unique_ptr<CloudWork> makeSmoothing();
std::unique_ptr<CloudWork> makeNormals();
std::unique_ptr<CloudWork> makeSplats();

/** \brief A work with these values; the parameters that have none keep their defaults. \return an
 * error of the first value that is of another type, of a value or of all together. */
using NamedValues = std::vector<std::pair<std::string, Value>>;
pcl_slim::Result<std::shared_ptr<const CloudWork>> makeWork(MakeWork make,
                                                            const NamedValues& values);

}  // namespace pcl_slim_ros
