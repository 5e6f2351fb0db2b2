# SPDX-License-Identifier: BSD-3-Clause
# The program of both projects.
add_executable(consumer ${CMAKE_CURRENT_LIST_DIR}/main.cpp)
target_link_libraries(consumer PRIVATE pcl_slim::fit pcl_slim::render)
if(CONSUMER_USES_FILTERS)
  target_link_libraries(consumer PRIVATE pcl_slim::filters)
  target_compile_definitions(consumer PRIVATE CONSUMER_USES_FILTERS)
endif()
