// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "benchmark/treat.h"
#include "common/options.h"

namespace pcl_slim::comparison {

/** \brief What pcl_slim_benchmark measures: scenes, and the ways each is treated. */
class Plan {
 public:
  /** \brief Adds the options; the plan must outlive the table's parse(). */
  void declareOptions(OptionTable& options);

  /** \brief Reads the lists given. \return the first mistake, with its remedy. */
  Error finishOptions(const OptionTable& options);

  /** \brief Makes or loads one scene after the other and hands it over, until an error. */
  Error forEachScene(const std::function<Error(const Scene&)>& treat) const;

  /** \brief Every way to treat a scene. */
  std::vector<Setting> settingsFor(const Scene& scene) const;

  int repeats() const { return repeats_; }

 private:
  void addSlim(const Scene& scene, std::vector<Setting>& settings) const;
  Error finishFiles();

  std::string shapes_ = "sphere,torus,bumpy,relief,cube", noises_ = "0,0.001,0.005,0.01";
  std::string points_ = "100000", degrees_ = "1,2,3,4", kappas_ = "0,1,8";
  std::string t_mdls_ = "0.003,0.01", orders_ = "1,2,3", neighbours_ = "30,60,100,200,400";
  std::string methods_ = "slim,mls,normals", normals_ = "both", normal_neighbours_ = "20,50,100";
  std::string input_, truth_, pairs_, vectors_ = "best";
  bool sharp_ = true, robust_ = false, compact_ = false, data_ = false;
  int threads_ = 2, repeats_ = 3;

  struct FilePair {
    std::string name, input, truth;
  };
  std::vector<std::string> shape_list_, method_list_;
  std::vector<double> noise_list_, point_list_, degree_list_, kappa_list_, t_mdl_list_;
  std::vector<double> order_list_, neighbour_list_, normal_neighbour_list_;
  std::vector<FilePair> files_;
};

}  // namespace pcl_slim::comparison
