// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "benchmark/runs.h"
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
  int threads() const { return threads_; }

  // What claims take from the lists given.
  const std::vector<std::string>& claims() const { return claim_list_; }
  const std::vector<std::string>& shapes() const { return shape_list_; }
  const std::vector<double>& noises() const { return noise_list_; }
  const std::vector<double>& degrees() const { return degree_list_; }
  const std::vector<double>& kappas() const { return kappa_list_; }
  const std::vector<double>& tMdls() const { return t_mdl_list_; }
  std::vector<std::size_t> pointCounts() const;
  /** \brief MLS at every order and radius. */
  std::vector<Setting> mlsSettings() const;
  /** \brief Files of the folder of scans, by name. */
  const std::vector<std::string>& scans() const { return scan_list_; }

 private:
  void addSlim(const Scene& scene, std::vector<Setting>& settings) const;
  Error finishFiles();
  Error finishClaims(const OptionTable& options);

  std::string shapes_ = "sphere,torus,bumpy,relief,cube", noises_ = "0,0.001,0.005,0.01";
  std::string points_ = "100000", methods_ = "slim,mls,normals", normals_ = "both";
  std::string degrees_ = "1,2,3,4", kappas_ = "0,1,8", t_mdls_ = "0.003,0.01";
  std::string orders_ = "1,2,3", neighbours_ = "30,60,100,200,400";
  std::string normal_neighbours_ = "20,50,100";
  std::string input_, truth_, pairs_, claims_, scans_;
  bool sharp_ = true, robust_ = false, compact_ = false, data_ = false;
  int threads_ = 2, repeats_ = 3;

  struct FilePair {
    std::string name, input, truth;
  };
  std::vector<std::string> shape_list_, method_list_, claim_list_, scan_list_;
  std::vector<double> noise_list_, point_list_, degree_list_, kappa_list_, t_mdl_list_;
  std::vector<double> order_list_, neighbour_list_, normal_neighbour_list_;
  std::vector<FilePair> files_;
};

}  // namespace pcl_slim::comparison
