// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "pcl_slim/core/export.h"
#include "pcl_slim/splat/splat_set.h"
#include "pcl_slim/visualization/g_buffer_mapper.h"

namespace pcl_slim {

/** \brief Draws coloured discs in any VTK renderer, those that overlap blended per pixel.
 *
 * As SLIMMapper in all else. Discs have no curvatures and no levels. What a clipping plane cuts
 * away is left out disc by disc, and the discs on the plane pixel by pixel.
 */
class PCL_SLIM_EXPORT SplatMapper : public GBufferMapper {
 public:
  static SplatMapper* New();
  vtkTypeMacro(SplatMapper, GBufferMapper)

  /** \brief The splats to draw, shared and not copied; null: none. They must not change while they
   * are here. Splats that do not pass validateDiscs() are refused: false. O(splats). */
  bool setSplats(std::shared_ptr<const SplatSet> splats);
  const std::shared_ptr<const SplatSet>& getSplats() const { return splats_; }

  bool supports(DisplayMode mode) const override;

 protected:
  SplatMapper() = default;
  ~SplatMapper() override = default;

  Error rasterize(const Camera& camera, const FrameRequest& request, GBuffer& buffer) override;
  double lengthScale() const override { return 1.0; }
  std::array<double, 2> automaticRange(DisplayMode mode) const override;

 private:
  SplatMapper(const SplatMapper&) = delete;
  void operator=(const SplatMapper&) = delete;

  std::shared_ptr<const SplatSet> splats_;
};

}  // namespace pcl_slim
