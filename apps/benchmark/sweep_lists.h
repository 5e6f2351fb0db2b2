// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "benchmark/treat.h"
#include "common/options.h"

namespace pcl_slim::comparison {

/** \brief The lists on the command line that say what scenes are made and how they are treated. */
class SweepLists {
 public:
  // Options, in the order a program likes; the lists must outlive the table's parse().
  /** \brief Declares -shapes, -noises and -points. */
  void declareScenes(OptionTable& options);
  /** \brief Declares -degrees, -kappas and -t_mdls. */
  void declareSlim(OptionTable& options);
  /** \brief Declares -mls_orders and -mls_neighbours. */
  void declareMls(OptionTable& options);
  /** \brief Declares -threads. */
  void declareThreads(OptionTable& options);

  /** \brief Reads the lists given. \return the first mistake, with its remedy. */
  Error finish();

  const std::vector<double>& degrees() const { return degree_list_; }
  int threads() const { return threads_; }

  /** \brief Makes every scene of the lists, one after the other, and hands it over, until an
   * error. */
  Error forEachScene(const std::function<Error(const Scene&)>& treat) const;
  /** \brief SLIM at every penalty, then at every T, for one setting of all else. */
  std::vector<Setting> penaltySweep(Setting setting) const;
  /** \brief MLS at every order and radius. */
  std::vector<Setting> mlsSettings() const;

 private:
  std::string shapes_ = "sphere,torus,bumpy,relief,cube", noises_ = "0,0.001,0.005,0.01";
  std::string points_ = "100000", degrees_ = "1,2,3,4", kappas_ = "0,1,8";
  std::string t_mdls_ = "0.003,0.01", orders_ = "1,2,3", neighbours_ = "30,60,100,200,400";
  int threads_ = 2;

  std::vector<std::string> shape_list_;
  std::vector<double> noise_list_, point_list_, degree_list_, kappa_list_, t_mdl_list_;
  std::vector<double> order_list_, neighbour_list_;
};

/** \brief Words separated by commas, each one of those known; the error names them. */
Error
parseWords(const std::string& option, const std::string& text,
           const std::vector<std::string>& known, std::vector<std::string>& words);

}  // namespace pcl_slim::comparison
