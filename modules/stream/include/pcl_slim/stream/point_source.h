// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>

#include "pcl_slim/cloud/cloud_view.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"

namespace pcl_slim {

/** \brief A cloud that is read in pieces, as often as it takes, and need not fit into memory. */
class PointSource {
 public:
  /** \brief Takes a piece, which is valid during the call; an error ends the pass. */
  using Visit = std::function<Error(const CloudView& piece)>;

  virtual ~PointSource() = default;

  /** \brief Number of points. */
  virtual std::uint64_t size() const = 0;
  /** \brief Whether the points have normals. */
  virtual bool hasNormals() const = 0;
  /** \brief The type that stores the coordinates without loss. */
  virtual CloudView::Scalar scalar() const = 0;
  /** \brief World position that the points were seen from, where that is known. */
  virtual std::optional<std::array<double, 3>> sensor() const { return {}; }

  /** \brief Whether each point has its own sensor position, which a fit by tiles refuses. */
  virtual bool hasSensors() const { return false; }

  /** \brief Whether points are numbered by frames, which a fit by tiles refuses. */
  virtual bool hasFrameNumbers() const { return false; }

  /** \brief Reads the points from the first to the last. \return an error of the visitor, or of a
   * file that cannot be read or has become shorter. */
  virtual Error pass(const Visit& visit) = 0;
};

/** \brief A cloud in memory as a source. */
class PCL_SLIM_EXPORT CloudSource : public PointSource {
 public:
  /** \param[in] cloud without more than 2^32 - 2 points; must outlive this. */
  explicit CloudSource(const CloudView& cloud) : cloud_(cloud) {}

  std::uint64_t size() const override { return cloud_.count(); }
  bool hasNormals() const override { return cloud_.normal != nullptr; }
  CloudView::Scalar scalar() const override { return cloud_.scalar; }
  std::optional<std::array<double, 3>> sensor() const override { return cloud_.sensor; }
  bool hasSensors() const override { return cloud_.sensors != nullptr; }
  bool hasFrameNumbers() const override { return cloud_.frame_numbers != nullptr; }
  Error pass(const Visit& visit) override;

 private:
  CloudView cloud_;
};

}  // namespace pcl_slim
