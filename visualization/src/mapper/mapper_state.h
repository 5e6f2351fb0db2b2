// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vtkLookupTable.h>
#include <vtkNew.h>

#include "frame/cached_frame.h"
#include "frame/frame_textures.h"
#include "frame/vtk_view.h"
#include "pcl_slim/visualization/g_buffer_mapper.h"

namespace pcl_slim {

/** \brief A mapper's settings and what it keeps of the last frame. */
struct GBufferMapper::State {
  DisplayMode mode = DisplayMode::kShaded;
  double range = 0.0, budget = 50.0;
  VisibleSides sides = VisibleSides::kAuto;
  int threads = 0;
  FrameStatistics statistics;
  Error error;

  std::array<double, 6> bounds{1.0, -1.0, 1.0, -1.0, 1.0, -1.0};
  std::uint64_t object = 0;  ///< counts changes of the object

  detail::VtkView view;
  std::vector<HalfSpace> planes;
  std::array<int, 4> viewport{};
  detail::CachedFrame frame;
  FrameRequest request;        ///< what it was made with
  bool uploaded = false;       ///< textures contain the frame
  bool lines_current = false;  ///< and its lines
  detail::FrameTextures textures;

  vtkNew<vtkLookupTable> table;
  bool table_current = false;
  vtkMTimeType table_time = 0;  ///< of the table whose texture there is
};

}  // namespace pcl_slim
