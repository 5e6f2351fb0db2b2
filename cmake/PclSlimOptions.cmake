# SPDX-License-Identifier: BSD-3-Clause
# What is built. A project that pulls this one in by add_subdirectory gets the libraries only.
option(PCL_SLIM_BUILD_FILTERS "Build the classes that take PCL clouds (needs PCL)" ON)
option(PCL_SLIM_BUILD_VISUALIZATION
  "Build mappers for VTK and PCLVisualizer, where VTK's rendering and PCL's visualization are" ON)
option(PCL_SLIM_BUILD_APPS "Build the programs" ${PROJECT_IS_TOP_LEVEL})
option(PCL_SLIM_BUILD_TESTS "Build the tests" ${PROJECT_IS_TOP_LEVEL})
option(PCL_SLIM_BUILD_EXAMPLES "Build the examples" OFF)
option(PCL_SLIM_BUILD_BENCHMARKS "Build the benchmarks (needs nanoflann)" OFF)
option(PCL_SLIM_BUILD_MPI "Build pcl_slim_fit_mpi where MPI is found" ON)
option(PCL_SLIM_BUILD_PYTHON "Build the Python package where pybind11 and Python's headers are found"
  ${PROJECT_IS_TOP_LEVEL})
option(PCL_SLIM_WITH_PNG "Read and write .png pictures (needs libpng)" ON)
option(PCL_SLIM_WITH_VTP "Read and write .vtp (needs VTK's IOXML)" ON)
option(PCL_SLIM_WITH_LAZ "Read .laz where LASzip's library is found" ON)
option(PCL_SLIM_INSTALL "Make install rules" ${PROJECT_IS_TOP_LEVEL})
if(CMAKE_CXX_COMPILER_LAUNCHER)
  set(precompile OFF)  # most caches keep nothing of sources with precompiled headers
else()
  set(precompile ON)
endif()
option(PCL_SLIM_PRECOMPILE_HEADERS "Parse large headers of other libraries once for each target" ${precompile})
option(PCL_SLIM_UNITY_TESTS "Several sources of a test program are compiled as one" ON)
option(PCL_SLIM_DISCOVER_TESTS "Each test of GoogleTest is one of ctest, found by name" OFF)
set(PCL_SLIM_SKIP_INSTRUCTION_SETS "" CACHE STRING
  "Sets of Highway for which no kernels are compiled, as 'HWY_SSE4|HWY_AVX3': builds are faster, processors take another")
mark_as_advanced(PCL_SLIM_SKIP_INSTRUCTION_SETS)
option(PCL_SLIM_WARNINGS_AS_ERRORS "Stop at compiler warnings (continuous integration)" OFF)
set(PCL_SLIM_SANITIZE "" CACHE STRING
  "Value of -fsanitize= for everything built here, as 'address,undefined' or 'thread'")

if(NOT PCL_SLIM_BUILD_FILTERS)
  foreach(part VISUALIZATION APPS EXAMPLES BENCHMARKS)
    if(PCL_SLIM_BUILD_${part})
      message(STATUS "PCL_SLIM_BUILD_${part} is off: it needs PCL_SLIM_BUILD_FILTERS")
      set(PCL_SLIM_BUILD_${part} OFF)
    endif()
  endforeach()
endif()

# CTest's own option, which packagers give to every project. It is declared here, as CGAL's package, for benchmarks, declares
# it off.
if(PROJECT_IS_TOP_LEVEL)
  option(BUILD_TESTING "Build the tests" ON)
endif()
if(PCL_SLIM_BUILD_TESTS AND DEFINED BUILD_TESTING AND NOT BUILD_TESTING)
  message(STATUS "PCL_SLIM_BUILD_TESTS is off: BUILD_TESTING is")
  set(PCL_SLIM_BUILD_TESTS OFF)
endif()

# Shared libraries hide what benchmarks of single kernels call. Tests link cmake/PclSlimStaticCopies.cmake's copies there.
if(BUILD_SHARED_LIBS AND PCL_SLIM_BUILD_BENCHMARKS)
  message(STATUS "PCL_SLIM_BUILD_BENCHMARKS is off: it needs static libraries")
  set(PCL_SLIM_BUILD_BENCHMARKS OFF)
endif()

# An interpreter without sanitizers cannot load what is built with them.
if(PCL_SLIM_SANITIZE AND PCL_SLIM_BUILD_PYTHON)
  message(STATUS "PCL_SLIM_BUILD_PYTHON is off: sanitizers are on")
  set(PCL_SLIM_BUILD_PYTHON OFF)
endif()

if(PROJECT_IS_TOP_LEVEL)
  get_property(is_multi_config GLOBAL PROPERTY GENERATOR_IS_MULTI_CONFIG)
  if(NOT is_multi_config AND NOT CMAKE_BUILD_TYPE)
    set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
  endif()
  set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin)
  set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
  set_property(GLOBAL PROPERTY USE_FOLDERS ON)
  # A fast linker, if there is one, where symbols are linked again and again.
  if(CMAKE_BUILD_TYPE STREQUAL "Debug" AND NOT PCL_SLIM_SANITIZE AND UNIX AND NOT APPLE)
    find_program(PCL_SLIM_FAST_LINKER NAMES ld.mold ld.lld)
    mark_as_advanced(PCL_SLIM_FAST_LINKER)
    if(PCL_SLIM_FAST_LINKER MATCHES "ld\\.(mold|lld)$")
      add_link_options(-fuse-ld=${CMAKE_MATCH_1})
    endif()
  endif()
endif()

if(PCL_SLIM_SANITIZE)
  add_compile_options(-fsanitize=${PCL_SLIM_SANITIZE} -fno-omit-frame-pointer
    -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${PCL_SLIM_SANITIZE})
  # GCC's address sanitizer makes Eigen align memory by itself, which PCL's libraries then free() wrongly.
  add_compile_definitions(EIGEN_MALLOC_ALREADY_ALIGNED=1)
endif()
