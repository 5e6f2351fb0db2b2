# SPDX-License-Identifier: BSD-3-Clause
# Rules of the house that a compiler does not check: cmake -DROOT=<checkout> -P layout_test.cmake
#   every source starts with its licence; headers guard themselves; modules neither print nor know
#   PCL or VTK, and include along the arrows core <- cloud, core <- surface,
#   {cloud, surface} <- {fit, query}, cloud <- splat, {query, splat} <- render only; programs include
#   and build nothing of benchmarks/.
file(GLOB_RECURSE sources RELATIVE ${ROOT}
  ${ROOT}/modules/*.h ${ROOT}/modules/*.hpp ${ROOT}/modules/*.cpp
  ${ROOT}/filters/*.h ${ROOT}/filters/*.hpp ${ROOT}/filters/*.cpp
  ${ROOT}/apps/*.h ${ROOT}/apps/*.cpp ${ROOT}/tests/*.h ${ROOT}/tests/*.cpp
  ${ROOT}/examples/*.cpp ${ROOT}/benchmarks/*.h ${ROOT}/benchmarks/*.cpp)

set(above_core "cloud|surface|fit|query|splat|render|filters")
set(above_cloud "surface|fit|query|splat|render|filters")
set(above_surface "cloud|fit|query|splat|render|filters")
set(above_fit "query|splat|render|filters")
set(above_query "fit|splat|render|filters")
set(above_splat "surface|fit|query|render|filters")
set(above_render "fit|filters")

set(defects "")
foreach(source IN LISTS sources)
  file(READ ${ROOT}/${source} text)
  if(NOT text MATCHES "^// SPDX-License-Identifier: BSD-3-Clause\n")
    string(APPEND defects "${source}: does not start with its SPDX line\n")
  endif()
  # Highway's *-inl.h files are included once per instruction set and cannot use the pragma.
  if(source MATCHES "\\.(h|hpp)$" AND NOT source MATCHES "-inl\\.h$"
      AND NOT text MATCHES "\n#pragma once\n")
    string(APPEND defects "${source}: has no #pragma once\n")
  endif()
  if(source MATCHES "^apps/" AND text MATCHES "#include [<\"](claims|fit|splats)/")
    string(APPEND defects "${source}: a program includes ${CMAKE_MATCH_1}/ of benchmarks/\n")
  endif()
  if(source MATCHES "^modules/([a-z]+)/")
    set(module ${CMAKE_MATCH_1})
    if(text MATCHES "#include [<\"](pcl|vtk)[/A-Z]")
      string(APPEND defects "${source}: a module includes PCL or VTK\n")
    endif()
    if(text MATCHES "#include [<\"]pcl_slim/(${above_${module}})/")
      string(APPEND defects "${source}: includes ${CMAKE_MATCH_1}, which stands above it\n")
    endif()
    if(text MATCHES "#include <iostream>|[^a-z_]f?printf\\(|std::(cout|cerr|clog)")
      string(APPEND defects "${source}: a module prints\n")
    endif()
  endif()
endforeach()

file(GLOB_RECURSE lists RELATIVE ${ROOT} ${ROOT}/apps/CMakeLists.txt)
foreach(source IN LISTS lists)
  file(READ ${ROOT}/${source} text)
  string(REGEX REPLACE "#[^\n]*" "" text "${text}")
  if(text MATCHES "benchmarks/|/benchmarks")
    string(APPEND defects "${source}: builds something of benchmarks/\n")
  endif()
endforeach()

list(LENGTH sources count)
if(defects OR count EQUAL 0)
  message(FATAL_ERROR "${count} sources\n${defects}")
endif()
message(STATUS "${count} sources keep the rules")
