#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# pcl_slim and its nodes in a workspace of colcon: test.sh ROOT WORK_DIR [PREFIX]
#
# Checks that colcon finds both packages, in order. With ament_cmake, builds the package of the nodes by colcon against
# PREFIX, where pcl_slim is installed, and stand-ins for ROS's packages; without PREFIX pcl_slim is built, too, which
# takes minutes. Exits 77, skipped, without colcon.
set -euo pipefail
root=$(cd -- "$1" && pwd) work=$2 prefix=${3-}
colcon list --help >/dev/null 2>&1 || exit 77
export COLCON_DEFAULTS_FILE=/dev/null COLCON_LOG_PATH=$work/log COLCON_HOME=$work/colcon

fail() {
  printf '%s\n' "$*" >&2
  exit 1
}

rm -rf -- "$work"
mkdir -p "$work/src"
ln -s "$root" "$work/src/pcl_slim"
cd -- "$work"
folders=(--base-paths src src/pcl_slim/ros2)

# colcon does not look for packages in packages: the folder ros2 has to be named.
[ "$(colcon list --names-only --base-paths src)" = pcl_slim ] || fail "colcon list: not pcl_slim alone"
order=$(colcon list --names-only --topological-order "${folders[@]}" | tr '\n' ' ')
[ "$order" = "pcl_slim pcl_slim_ros " ] || fail "colcon's order: $order"
types=$(colcon list "${folders[@]}" | grep -o '(.*)' | tr '\n' ' ')
[ "$types" = "(ros.cmake) (ros.ament_cmake) " ] || fail "colcon's types of packages: $types"

if [ ! -f /usr/share/ament_cmake/cmake/ament_cmakeConfig.cmake ]; then
  echo "Found by colcon; not built: there is no ament_cmake"
  exit 0
fi

# Packages of ROS, as far as the nodes' CMakeLists.txt needs them, with the headers of the stand-ins.
stand_ins=$root/tests/ros2/stand_ins
for package in rclcpp rclcpp_components rclcpp_lifecycle diagnostic_msgs lifecycle_msgs rcl_interfaces sensor_msgs; do
  case $package in rclcpp_components) target=component ;; *) target=$package ;; esac
  folder=$work/ros/share/$package/cmake
  mkdir -p "$folder"
  cat >"$folder/${package}Config.cmake" <<CMAKE
if(NOT TARGET $package::$target)
  add_library($package::$target INTERFACE IMPORTED)
  target_include_directories($package::$target INTERFACE $stand_ins)
  set(${package}_TARGETS $package::$target)
endif()
CMAKE
done
cat >>"$work/ros/share/rclcpp_components/cmake/rclcpp_componentsConfig.cmake" <<'CMAKE'
# As ROS's: a program that starts the component alone. The stand-in's has no executor and only makes the node.
function(rclcpp_components_register_node target)
  cmake_parse_arguments(arg "" "PLUGIN;EXECUTABLE" "" ${ARGN})
  if(NOT TARGET ${target} OR NOT arg_PLUGIN OR NOT arg_EXECUTABLE)
    message(FATAL_ERROR "rclcpp_components_register_node: ${ARGV}")
  endif()
  set(source ${CMAKE_CURRENT_BINARY_DIR}/${arg_EXECUTABLE}.cpp)
  file(WRITE ${source} "#include <dlfcn.h>\n#include <rclcpp/rclcpp.hpp>\n"
    "int main(int, char** argv) {\n"
    "  if (dlopen(argv[1], RTLD_NOW | RTLD_GLOBAL) == nullptr) return 2;\n"
    "  const auto& all = rclcpp::stand_in::Process::instance().components;\n"
    "  const auto at = all.find(\"${arg_PLUGIN}\");\n"
    "  return at != all.end() && at->second({}) ? 0 : 1;\n}\n")
  add_executable(${arg_EXECUTABLE} ${source})
  target_link_libraries(${arg_EXECUTABLE} PRIVATE rclcpp::rclcpp ${CMAKE_DL_LIBS})
  set_target_properties(${arg_EXECUTABLE} PROPERTIES ENABLE_EXPORTS ON)
  install(TARGETS ${arg_EXECUTABLE} DESTINATION lib/${PROJECT_NAME})
endfunction()
CMAKE

# A package of the workspace that is installed elsewhere would be one that is not built.
[ -z "$prefix" ] || folders=(--base-paths src/pcl_slim/ros2)
export CMAKE_PREFIX_PATH=$work/ros${prefix:+:$prefix} MAKEFLAGS=-j${JOBS:-2}
# Nothing runs but constructors: what is quick to compile will do.
colcon build "${folders[@]}" --executor sequential --event-handlers console_direct- --cmake-args \
  -DCMAKE_BUILD_TYPE=Debug "-DCMAKE_CXX_FLAGS_DEBUG=-O0 -DHWY_COMPILE_ONLY_STATIC" \
  -DPCL_SLIM_BUILD_TESTS=OFF -DPCL_SLIM_BUILD_APPS=OFF -DPCL_SLIM_BUILD_MPI=OFF -DPCL_SLIM_BUILD_VISUALIZATION=OFF \
  -DPython3_EXECUTABLE=/usr/bin/python3 --no-warn-unused-cli ||
  fail "colcon build failed: $(tail -n 40 "$work"/log/latest_build/*/stderr.log 2>/dev/null)"

installed=$work/install/pcl_slim_ros
for file in launch/smoother.launch.py config/smoother.yaml config/splats.yaml package.xml; do
  [ -f "$installed/share/pcl_slim_ros/$file" ] || fail "not installed: $file"
done
for node in smoother_node normals_node splat_node; do
  "$installed/lib/pcl_slim_ros/$node" "$installed/lib/libpcl_slim_ros_nodes.so" || fail "$node does not start"
done
python3 -c 'import ast, sys; ast.parse(open(sys.argv[1]).read())' "$installed/share/pcl_slim_ros/launch/smoother.launch.py"
echo "Built by colcon: $(colcon list --names-only --topological-order "${folders[@]}" | tr '\n' ' ')"
