# SPDX-License-Identifier: BSD-3-Clause
include(GNUInstallDirs)

# Settings that every target of this project shares.
#
# Contraction into fused multiply-adds is the compiler's whim unless forbidden; kernels that want
# one say so, so results depend on the source alone. No math function's errno and no floating-point
# trap is ever read, and saying so changes speed, not results. -march stays the user's: a program
# built for another alignment than the distribution's PCL crashes.
function(pcl_slim_set_defaults target)
  target_compile_features(${target} PUBLIC cxx_std_17)
  set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF POSITION_INDEPENDENT_CODE ON
    CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  target_compile_options(${target} PRIVATE
    $<$<COMPILE_LANG_AND_ID:CXX,GNU,Clang,AppleClang>:-ffp-contract=off -fno-math-errno
      -fno-trapping-math -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual
      $<$<BOOL:${PCL_SLIM_WARNINGS_AS_ERRORS}>:-Werror>>)
endfunction()

# pcl_slim_precompile(target header...)
#
# Parses large headers of other libraries once for all sources of a target. Sources include what they
# use all the same: builds with a compiler launcher, such as ccache, do without.
function(pcl_slim_precompile target)
  if(PCL_SLIM_PRECOMPILE_HEADERS)
    target_precompile_headers(${target} PRIVATE ${ARGN})
  endif()
endfunction()

# pcl_slim_spare_sanitized(file...)
#
# Kernels that are not optimised where sanitizers watch them: Clang's optimiser takes longer over one of
# them than over all the rest once every access is checked.
function(pcl_slim_spare_sanitized)
  if(PCL_SLIM_SANITIZE AND CMAKE_CXX_COMPILER_ID MATCHES Clang)
    set_source_files_properties(${ARGN} PROPERTIES COMPILE_OPTIONS -O0)
  endif()
endfunction()

# pcl_slim_add_library(name [PUBLIC lib...] [PRIVATE lib...] [BUILD_ONLY lib...] [HEADERS module...]
#   [SOURCES pattern...] [WITHOUT pattern...])
#
# Adds pcl_slim::<name> (target pcl_slim_lib_<name>, as programs have the plain names; the file is
# libpcl_slim_<name>) from src/*.cpp and include/ below the current folder, and installs it as a
# component of the package. BUILD_ONLY is for header-only libraries that only our own sources
# include: whoever uses the installed package does not need them. HEADERS names modules of which types are
# all that is used: whoever links the library neither builds nor links them. SOURCES and WITHOUT name sources
# relative to src/, to take instead of all and to leave out: those of another library below the same folder,
# or of two that answer for an optional library the one that is not wanted.
function(pcl_slim_add_library name)
  cmake_parse_arguments(arg "" "" "PUBLIC;PRIVATE;BUILD_ONLY;HEADERS;SOURCES;WITHOUT" ${ARGN})
  set(target pcl_slim_lib_${name})
  if(NOT arg_SOURCES)
    set(arg_SOURCES *.cpp)
  endif()
  list(TRANSFORM arg_SOURCES PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/src/)
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${arg_SOURCES})
  if(arg_WITHOUT)
    list(TRANSFORM arg_WITHOUT PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/src/)
    file(GLOB_RECURSE left_out CONFIGURE_DEPENDS ${arg_WITHOUT})
    list(REMOVE_ITEM sources ${left_out})
  endif()
  set(includes
    $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  foreach(module IN LISTS arg_HEADERS)
    list(APPEND includes $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/modules/${module}/include>)
  endforeach()
  if(sources)
    add_library(${target} ${sources})
    pcl_slim_set_defaults(${target})
    target_include_directories(${target} PUBLIC ${includes}
      PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}/src)
    target_link_libraries(${target} PUBLIC ${arg_PUBLIC} PRIVATE ${arg_PRIVATE})
    if(hwy::hwy IN_LIST arg_PRIVATE)
      # Kernels use Highway's operators, which its vectors of a length unknown to the compiler (SVE, RISC-V) do
      # not have: those processors take NEON or plain code. So do those with SSSE3, but without SSE 4.1 (2006 to
      # 2008). All files leave out the same sets: unoptimised builds share Highway's index of sets among them.
      set(skipped "")
      if(PCL_SLIM_SKIP_INSTRUCTION_SETS)
        set(skipped "|${PCL_SLIM_SKIP_INSTRUCTION_SETS}")
      endif()
      target_compile_definitions(${target} PRIVATE
        "HWY_DISABLED_TARGETS=(HWY_SVE|HWY_SVE2|HWY_SVE_256|HWY_SVE2_128|HWY_RVV|HWY_SSSE3${skipped})")
    endif()
    foreach(library IN LISTS arg_BUILD_ONLY)
      target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:${library}>)
    endforeach()
    set_target_properties(${target} PROPERTIES
      OUTPUT_NAME pcl_slim_${name} DEFINE_SYMBOL ""
      VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}
      INSTALL_RPATH $ORIGIN)
    if(BUILD_SHARED_LIBS)
      pcl_slim_set_exports(${target})
    endif()
  else()
    add_library(${target} INTERFACE)
    target_include_directories(${target} INTERFACE ${includes})
    target_link_libraries(${target} INTERFACE ${arg_PUBLIC})
  endif()
  add_library(pcl_slim::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  set_property(GLOBAL APPEND PROPERTY PCL_SLIM_COMPONENTS ${name})
  if(PCL_SLIM_INSTALL)
    pcl_slim_install_library(${name})
  endif()
endfunction()

# pcl_slim_set_exports(target): names of pcl_slim are all that a shared library exports.
function(pcl_slim_set_exports target)
  if(UNIX AND NOT APPLE)
    set(map ${PROJECT_BINARY_DIR}/exports.map)
    configure_file(${PROJECT_SOURCE_DIR}/cmake/exports.map.in ${map} @ONLY)
    target_link_options(${target} PRIVATE LINKER:--version-script=${map})
    set_property(TARGET ${target} APPEND PROPERTY LINK_DEPENDS ${map})
    pcl_slim_drop_unused_libraries(${target})
  endif()
endfunction()

# Each component of the package has an export set of its own, so that finding one never looks for another's needs. Install
# components are runtime (shared libraries), development, programs and documentation.
function(pcl_slim_install_library name)
  install(TARGETS pcl_slim_lib_${name} EXPORT pcl_slim_${name}
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development
    LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT runtime NAMELINK_COMPONENT development
    RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT runtime)
  install(DIRECTORY include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development
    FILES_MATCHING PATTERN *.h PATTERN *.hpp PATTERN detail EXCLUDE)
  install(EXPORT pcl_slim_${name} NAMESPACE pcl_slim:: FILE pcl_slim_${name}-targets.cmake
    DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/pcl_slim COMPONENT development)
endfunction()

# pcl_slim_add_program(target source... [LINK lib...])
#
# Adds and installs a program with its manual page and its completion for bash, which it prints itself
# once it is linked. PCL's imported targets name all of VTK; only what is called is kept.
function(pcl_slim_add_program target)
  cmake_parse_arguments(arg "" "" "LINK" ${ARGN})
  add_executable(${target} ${arg_UNPARSED_ARGUMENTS})
  pcl_slim_set_defaults(${target})
  pcl_slim_drop_unused_libraries(${target})
  target_link_libraries(${target} PRIVATE ${arg_LINK})
  file(RELATIVE_PATH to_libraries ${CMAKE_INSTALL_FULL_BINDIR} ${CMAKE_INSTALL_FULL_LIBDIR})
  set_target_properties(${target} PROPERTIES INSTALL_RPATH $ORIGIN/${to_libraries})
  set(page ${PROJECT_BINARY_DIR}/share/man/man1/${target}.1)
  set(script ${PROJECT_BINARY_DIR}/share/bash-completion/completions/${target})
  set(prints TRUE)
  if(CMAKE_CROSSCOMPILING AND NOT CMAKE_CROSSCOMPILING_EMULATOR)
    set(prints FALSE)
  endif()
  if(prints)
    file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/share/man/man1
      ${PROJECT_BINARY_DIR}/share/bash-completion/completions)
    add_custom_command(TARGET ${target} POST_BUILD
      COMMAND ${CMAKE_CROSSCOMPILING_EMULATOR} $<TARGET_FILE:${target}> --help-man > ${page}
      COMMAND ${CMAKE_CROSSCOMPILING_EMULATOR} $<TARGET_FILE:${target}> --help-completion > ${script}
      BYPRODUCTS ${page} ${script} VERBATIM)
  endif()
  if(PCL_SLIM_INSTALL)
    install(TARGETS ${target} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT programs)
    if(prints)
      install(FILES ${page} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT programs)
      install(FILES ${script} DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
        COMPONENT programs)
    endif()
  endif()
endfunction()

function(pcl_slim_drop_unused_libraries target)
  if(UNIX AND NOT APPLE)
    target_link_options(${target} PRIVATE LINKER:--as-needed)
  endif()
endfunction()
