# SPDX-License-Identifier: BSD-3-Clause
# Untested: no vcpkg has built this port. There is no release to fetch yet; whoever publishes one sets REPO and SHA512.
vcpkg_from_github(
  OUT_SOURCE_PATH SOURCE_PATH
  REPO pcl-slim/pcl_slim
  REF "v${VERSION}"
  SHA512 0
  HEAD_REF main)

vcpkg_check_features(OUT_FEATURE_OPTIONS FEATURE_OPTIONS
  FEATURES
    tools PCL_SLIM_BUILD_APPS
    vtp PCL_SLIM_WITH_VTP)

vcpkg_cmake_configure(
  SOURCE_PATH "${SOURCE_PATH}"
  OPTIONS
    ${FEATURE_OPTIONS}
    -DBUILD_TESTING=OFF
    -DPCL_SLIM_BUILD_MPI=OFF
    -DPCL_SLIM_BUILD_VISUALIZATION=OFF
    -DPCL_SLIM_WITH_LAZ=OFF)
vcpkg_cmake_install()
vcpkg_cmake_config_fixup(CONFIG_PATH lib/cmake/pcl_slim)
vcpkg_fixup_pkgconfig()

if("tools" IN_LIST FEATURES)
  vcpkg_copy_tools(
    TOOL_NAMES pcl_slim_fit pcl_slim_mesh pcl_slim_smooth pcl_slim_curvature pcl_slim_lines pcl_slim_sample pcl_slim_compare
      pcl_slim_render pcl_slim_benchmark pcl_slim_demo_scan pcl_color_splat_sampling
    AUTO_CLEAN)
endif()
file(REMOVE_RECURSE
  "${CURRENT_PACKAGES_DIR}/debug/include"
  "${CURRENT_PACKAGES_DIR}/debug/share"
  "${CURRENT_PACKAGES_DIR}/share/doc")
vcpkg_install_copyright(FILE_LIST
  "${SOURCE_PATH}/LICENSE"
  "${SOURCE_PATH}/modules/render/src/text/LICENSE.dejavu")
