# SPDX-License-Identifier: BSD-3-Clause
# pcl_slim_find_python(found)
#
# Looks for Python's headers and pybind11. The distribution's own Python is the one that its packages belong to; another
# is taken by -DPython_EXECUTABLE=... A message says what is missing.
macro(pcl_slim_find_python found)
  if(NOT DEFINED Python_EXECUTABLE)
    find_program(PCL_SLIM_PYTHON NAMES python3 PATHS /usr/bin NO_DEFAULT_PATH)
    find_program(PCL_SLIM_PYTHON NAMES python3)
    mark_as_advanced(PCL_SLIM_PYTHON)
    if(PCL_SLIM_PYTHON)
      set(Python_EXECUTABLE ${PCL_SLIM_PYTHON})
    endif()
  endif()
  find_package(Python 3.8 QUIET COMPONENTS Interpreter Development.Module)
  set(${found} OFF)
  if(Python_Development.Module_FOUND)
    # A pybind11 of pip's is no system folder; it knows where its CMake files are.
    if(NOT pybind11_DIR)
      execute_process(COMMAND ${Python_EXECUTABLE} -c "import pybind11; print(pybind11.get_cmake_dir())"
        OUTPUT_VARIABLE PCL_SLIM_PYBIND11_DIR OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
    endif()
    find_package(pybind11 2.9 QUIET CONFIG HINTS ${PCL_SLIM_PYBIND11_DIR})
    set(${found} ${pybind11_FOUND})
  endif()
endmacro()
