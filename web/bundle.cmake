# SPDX-License-Identifier: BSD-3-Clause
# Makes the viewer of pages one text without comments and indentation: page.html, the scripts, and the shader texts
# that pages share with visualization/. The build runs it (modules/web/CMakeLists.txt), by hand:
#   cmake -DHTML=viewer.html -DCPP=viewer_text.cpp -P web/bundle.cmake
# CPP: the same text as an array of bytes, as compilers need not accept a string literal of more than 64 KB.
# Whoever includes this file gets PCL_SLIM_VIEWER_SOURCES, the files that it reads; nothing is made then.
# Texts pass through "${...}" alone: no lists, as those split at ';' and join what is in '[ ]'.
set(web ${CMAKE_CURRENT_LIST_DIR})
set(scripts vectors box pieces textures surface rays camera views shaders frames tracer renderer splats viewer numbers legend pointers measure clip
  corner link ui)
set(window ${web}/../visualization/src)
set(shaders ${window}/glsl/root_glsl.cpp ${window}/glsl/pass_glsl.cpp ${window}/glsl/color_glsl.cpp
  ${window}/frame/light_glsl.cpp)

set(PCL_SLIM_VIEWER_SOURCES ${CMAKE_CURRENT_LIST_FILE} ${web}/page.html ${shaders})
foreach(script IN LISTS scripts)
  list(APPEND PCL_SLIM_VIEWER_SOURCES ${web}/${script}.js)
endforeach()
if(NOT CMAKE_SCRIPT_MODE_FILE)
  return()
endif()
cmake_minimum_required(VERSION 3.22)

# Takes comments, indentation and empty lines out of the text in a variable. Strings in web/ contain no comment marks.
function(strip name)
  set(text "\n${${name}}")
  string(REGEX REPLACE "/\\*([^*]|\\*+[^*/])*\\*+/" "" text "${text}")
  string(REGEX REPLACE "\n[ \t]*//[^\n]*" "\n" text "${text}")
  string(REGEX REPLACE " +// [^\n]*" "" text "${text}")
  string(REGEX REPLACE "\n[ \t\n]+" "\n" text "${text}")
  string(REGEX REPLACE "^\n" "" text "${text}")
  set(${name} "${text}" PARENT_SCOPE)
endfunction()

# The raw strings of the shaders' files as members of an object, by their names.
function(read_shaders name)
  set(members "")
  foreach(source IN LISTS shaders)
    file(READ ${source} rest)
    while(rest MATCHES "char\\* const (k[A-Za-z]+) = R\"\\(")
      set(id ${CMAKE_MATCH_1})
      string(FIND "${rest}" "${CMAKE_MATCH_0}" begin)
      string(LENGTH "${CMAKE_MATCH_0}" length)
      math(EXPR begin "${begin} + ${length}")
      string(SUBSTRING "${rest}" ${begin} -1 rest)
      string(FIND "${rest}" ")\";" end)
      string(SUBSTRING "${rest}" 0 ${end} text)
      strip(text)
      if(members)
        string(APPEND members ",\n")
      endif()
      string(APPEND members "${id}: `${text}`")
    endwhile()
  endforeach()
  set(${name} "${members}" PARENT_SCOPE)
endfunction()

set(code "\n")
foreach(script IN LISTS scripts)
  file(READ ${web}/${script}.js text)
  string(APPEND code "${text}\n")
endforeach()
string(REGEX REPLACE "\nimport [^\n]*" "\n" code "${code}")
string(REPLACE "\nexport " "\n" code "${code}")
strip(code)
read_shaders(shared)
file(READ ${web}/page.html page)
string(REPLACE "/*viewer*/" "VIEWER" page "${page}")
strip(page)
string(REPLACE "VIEWER" "'use strict';(()=>{\nconst SHARED={${shared}};\n${code}})();" page "${page}")
file(WRITE ${HTML} "${page}")

file(READ ${HTML} bytes HEX)
string(REGEX REPLACE "(..)" "0x\\1," bytes "${bytes}")
file(WRITE ${CPP} "// Made by web/bundle.cmake.
#include <cstddef>

namespace pcl_slim::detail {

extern const unsigned char kViewer[];
extern const std::size_t kViewerBytes;

const unsigned char kViewer[] = {${bytes}};
const std::size_t kViewerBytes = sizeof kViewer;

}  // namespace pcl_slim::detail
")
