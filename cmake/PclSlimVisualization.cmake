# SPDX-License-Identifier: BSD-3-Clause
# Looks for what visualization/ needs: VTK's rendering and PCL's visualization. Where something is
# missing, PCL_SLIM_HAS_VISUALIZATION is off, and the rest is built without it.
set(PCL_SLIM_VTK_RENDERING_COMPONENTS CommonCore CommonDataModel CommonExecutionModel CommonMath
  CommonTransforms FiltersSources InteractionStyle InteractionWidgets RenderingAnnotation RenderingCore
  RenderingFreeType RenderingOpenGL2 glew opengl)

# PCL's own component would bring Qt along; the library and its header are all that is called.
function(pcl_slim_find_visualization result)
  set(${result} OFF PARENT_SCOPE)
  find_package(VTK QUIET OPTIONAL_COMPONENTS ${PCL_SLIM_VTK_RENDERING_COMPONENTS})
  set(missing "")
  foreach(component IN LISTS PCL_SLIM_VTK_RENDERING_COMPONENTS)
    if(NOT TARGET VTK::${component})
      list(APPEND missing VTK::${component})
    endif()
  endforeach()
  find_library(PCL_SLIM_PCL_VISUALIZATION pcl_visualization HINTS ${PCL_LIBRARY_DIRS})
  find_path(PCL_SLIM_PCL_VISUALIZER_HEADER pcl/visualization/pcl_visualizer.h
    HINTS ${PCL_INCLUDE_DIRS})
  mark_as_advanced(PCL_SLIM_PCL_VISUALIZATION PCL_SLIM_PCL_VISUALIZER_HEADER)
  foreach(name IN ITEMS PCL_SLIM_PCL_VISUALIZATION PCL_SLIM_PCL_VISUALIZER_HEADER)
    if(NOT ${name})
      list(APPEND missing "PCL's visualization")
    endif()
  endforeach()
  if(missing)
    list(REMOVE_DUPLICATES missing)
    list(JOIN missing ", " missing)
    message(STATUS "pcl_slim::visualization is left out: ${missing} not found")
    return()
  endif()
  set(${result} ON PARENT_SCOPE)
endfunction()
