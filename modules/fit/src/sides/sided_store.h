// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "cloud_measures.h"
#include "pcl_slim/cloud/point_store.h"

namespace pcl_slim::detail {

/** \brief A store that a fit may give sides: the caller's own, or a copy where that is const. */
class SidedStore {
 public:
  explicit SidedStore(PointStore& store) : store_(&store), own_(&store) { store.clearSides(); }
  explicit SidedStore(const PointStore& store) : store_(&store)
  {
    if (!store.hasSides() || store.hasNormals()) return;
    own().clearSides();
  }

  const PointStore& store() const { return *store_; }
  /** \brief Whether the sides are set in the caller's store itself, not in a copy. */
  bool isKept() const { return own_ != nullptr && !copy_; }
  void setSides(const std::vector<std::array<float, 3>>& normals) { own().setSides(normals); }
  /** \brief Sets sides for the cover, in whose place endCover() sets those for orientation and trim maps. */
  void setSidesForCover(const std::vector<std::array<float, 3>>& normals,
                        std::vector<std::array<float, 3>> after)
  {
    own().setSides(normals);
    after_cover_ = std::move(after);
  }
  void endCover()
  {
    own().setSides(after_cover_);
    after_cover_.clear();
  }
  void moveTo(const std::vector<std::array<double, 3>>& positions, int threads)
  {
    own().moveTo(positions, threads);
  }
  void clearSides()
  {
    if (store_->hasSides() && !store_->hasNormals()) own().clearSides();
  }

 private:
  PointStore& own()
  {
    if (own_ == nullptr) {
      copy_ = *store_;
      store_ = own_ = &*copy_;
    }
    return *own_;
  }

  const PointStore* store_;
  PointStore* own_ = nullptr;
  std::optional<PointStore> copy_;
  std::vector<std::array<float, 3>> after_cover_;
};

/** \brief Gives the points of a cloud without normals sides where balls would meet both sides of thin
 * parts, and measures the cloud anew with them (docs/theory.md, "Sides before the cover"). The
 * store and the measures stay as they are elsewhere.
 * \param[in,out] measures those made without sides */
Error
giveSides(const FitConstants& constants, const FitParams& params, SidedStore& sided,
          CloudMeasures& measures, FitStatistics& stats);

}  // namespace pcl_slim::detail
