# SPDX-License-Identifier: BSD-3-Clause
# For machines without Python: package.xml is well-formed and has CMake's version.
#   cmake -DPACKAGE_XML= -DVERSION= -DXMLLINT= -P package_xml_test.cmake
execute_process(COMMAND ${XMLLINT} --noout ${PACKAGE_XML} RESULT_VARIABLE status)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "${PACKAGE_XML} is not well-formed XML")
endif()
foreach(query_and_answer
    "string(/package/@format)=3" "string(/package/name)=pcl_slim"
    "string(/package/version)=${VERSION}" "count(/package/license)=1"
    "string(/package/buildtool_depend)=cmake" "string(/package/export/build_type)=cmake"
    "starts-with(/package/url, 'http')=true"
    "string(contains(/package/maintainer/@email, '@'))=true")
  string(REGEX MATCH "^(.*\\))=([^=]*)$" matched "${query_and_answer}")
  set(query "${CMAKE_MATCH_1}")
  set(answer "${CMAKE_MATCH_2}")
  execute_process(COMMAND ${XMLLINT} --xpath "${query}" ${PACKAGE_XML}
    OUTPUT_VARIABLE found OUTPUT_STRIP_TRAILING_WHITESPACE)
  if(NOT found STREQUAL answer)
    message(FATAL_ERROR "${PACKAGE_XML}: ${query} is '${found}', not '${answer}'")
  endif()
endforeach()
