#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Checks package.xml as ROS tools would: package_xml_test.py PACKAGE_XML CMAKE_VERSION LICENSE ROSDEP_RULES [BUILD_TYPE]

Uses catkin_pkg, the parser behind colcon and rosdep, where it is installed, and in any case checks
what a plain CMake package needs. Exit 0 when all is well; otherwise 1 and one line per defect.
"""
import os
import re
import sys
import xml.etree.ElementTree as ElementTree

DEPENDENCY_TAGS = {
    "depend", "build_depend", "build_export_depend", "buildtool_depend", "buildtool_export_depend",
    "exec_depend", "test_depend", "doc_depend",
}
# Keys of rosdep's own list; any other needs a rule in packaging/rosdep.
ROSDEP_KEYS = {
    "cmake", "eigen", "libgtest-dev", "libpcl-all-dev", "libpng-dev", "nlohmann-json-dev", "tbb", "zlib",
} | {"libpcl-" + part for part in ("common", "features", "filters", "io", "search", "surface", "visualization")}
ROSDEP_KEYS |= {  # packages of ROS 2, and ours
    "ament_cmake", "diagnostic_msgs", "launch", "launch_ros", "lifecycle_msgs", "pcl_slim", "rcl_interfaces", "rclcpp",
    "rclcpp_components", "rclcpp_lifecycle", "sensor_msgs",
}
OTHER_TAGS = {
    "name", "version", "description", "maintainer", "license", "url", "author", "conflict",
    "replace", "group_depend", "member_of_group", "export",
}


def text(root, tag):
    """Text of the only child called tag, or an empty string."""
    found = root.findall(tag)
    return (found[0].text or "").strip() if len(found) == 1 else ""


def check_by_hand(path, cmake_version, keys, build_type):
    """Defects against REP 149 (format 3) that need no ROS tool to find."""
    try:
        root = ElementTree.parse(path).getroot()
    except (OSError, ElementTree.ParseError) as error:
        return [f"{path}: {error}"]
    defects = []

    def require(condition, defect):
        if not condition:
            defects.append(f"{path}: {defect}")

    require(root.tag == "package" and root.get("format") == "3", 'root is not <package format="3">')
    require(re.fullmatch(r"[a-z][a-z0-9_-]*", text(root, "name")), "needs one lower-case <name>")
    require(re.fullmatch(r"\d+\.\d+\.\d+", text(root, "version")), "<version> is not x.y.z")
    require(text(root, "version") == cmake_version,
            f"<version> is {text(root, 'version')}, CMakeLists.txt says {cmake_version}")
    require(len(root.findall("description")) == 1, "needs one <description>")
    require(root.findall("license"), "needs a <license>")
    require(root.findall("maintainer"), "needs a <maintainer>")
    require(re.fullmatch(r"https?://\S+", text(root, "url")), "needs one <url>")
    for person in root.findall("maintainer"):
        require(re.fullmatch(r"[^@\s]+@[^@\s]+\.[^@\s]+", person.get("email") or ""),
                "a <maintainer> has no valid email")
    for child in root:
        require(child.tag in DEPENDENCY_TAGS | OTHER_TAGS, f"<{child.tag}> is not known to format 3")
        if child.tag in DEPENDENCY_TAGS:
            require(re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9_+.-]*", (child.text or "").strip()),
                    f"<{child.tag}> names no package")
            require((child.text or "").strip() in keys,
                    f"rosdep knows no {(child.text or '').strip()}: add a rule to packaging/rosdep")
    tools = [(child.text or "").strip() for child in root.findall("buildtool_depend")]
    require(tools == [build_type], f"a package of {build_type} needs that alone to build, not {tools}")
    require([t.text for t in root.findall("export/build_type")] == [build_type],
            f"<export> needs one <build_type>{build_type}</build_type>")
    return defects


def check_with_catkin(path, build_type):
    """Defects that catkin_pkg finds; None when it is not installed."""
    try:
        from catkin_pkg.package import InvalidPackage, parse_package
    except ImportError:
        return None
    warnings = []
    try:
        package = parse_package(path, warnings=warnings)
        package.validate(warnings=warnings)
    except InvalidPackage as error:
        return [str(error)]
    defects = [f"{path}: {warning}" for warning in warnings]
    if package.get_build_type() != build_type:
        defects.append(f"{path}: build type is {package.get_build_type()}, not {build_type}")
    return defects


def main():
    """Runs both checks and reports."""
    path, cmake_version, license_path, rules = sys.argv[1:5]
    with open(rules, encoding="utf-8") as file:
        keys = ROSDEP_KEYS | set(re.findall(r"^([a-z][\w.+-]*):", file.read(), re.MULTILINE))
    build_type = sys.argv[5] if len(sys.argv) > 5 else "cmake"
    defects = check_by_hand(path, cmake_version, keys, build_type)
    if not os.path.isfile(license_path):
        defects.append(f"{license_path}: the licence that package.xml names is not there")
    from_catkin = check_with_catkin(path, build_type)
    defects += from_catkin or []
    for defect in defects:
        print(defect)
    how = "checked by hand: no catkin_pkg" if from_catkin is None else "checked with catkin_pkg"
    print(f"{path}: {len(defects)} defects ({how})")
    return 1 if defects else 0


if __name__ == "__main__":
    sys.exit(main())
