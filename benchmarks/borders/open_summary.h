// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace pcl_slim::borders {

/** \brief What counts of a row; lengths in spacings. */
struct RowOutcome {
  bool mesh = false, picture = false;           ///< meet all their targets
  bool has_picture = false;                     ///< else picture and what belongs to it are unset
  double beyond = 0.0, missing = 0.0;           ///< of the mesh
  double seen_beyond = 0.0, unseen = 0.0;       ///< the same of the picture
  std::size_t to_keep = 0, kept = 0, open = 0;  ///< holes: of the truth, the mesh, the picture
  bool loops = false;                           ///< the mesh has as many as the truth
};

/** \brief Rows by kind of scene and by noise, a method at a time. */
class OpenSummary {
 public:
  void add(const std::string& method, const std::string& scene, double noise,
           const RowOutcome& row);

  /** \brief As rows of a table of markdown. */
  void print() const;

 private:
  struct Sum {
    std::size_t rows = 0, meshes = 0, pictures = 0, both = 0, loops = 0;
    std::size_t to_keep = 0, kept = 0, open = 0;
    double beyond = 0.0, missing = 0.0, seen_beyond = 0.0, unseen = 0.0;  ///< the largest ones
    bool has_picture = false;
  };

  Sum& group(const std::string& method, const std::string& name);

  std::vector<std::pair<std::string, std::string>> order_;  ///< of groups: method, name
  std::map<std::pair<std::string, std::string>, Sum> sums_;
};

}  // namespace pcl_slim::borders
