# SPDX-License-Identifier: BSD-3-Clause
"""Compares the version in version.h with every other file that names it: python3 tests/versions_test.py ROOT

CHANGELOG.md has a section a release, newest first, each with its date; only the first may be unreleased. Names marked
by PCL_SLIM_DEPRECATED are gone in the version that is to remove them. Prints each defect; exits 1 if there is one.
"""
import json
import os
import re
import sys


def main():
    root = sys.argv[1]
    defects = []

    def text(path):
        with open(os.path.join(root, path), encoding="utf-8") as file:
            return file.read()

    def found(path, pattern):
        match = re.search(pattern, text(path), re.MULTILINE)
        return match[1] if match else "nothing"

    version = found("modules/core/include/pcl_slim/version.h", r'^#define PCL_SLIM_VERSION "(.*)"')
    numbers = [found("modules/core/include/pcl_slim/version.h", r"^#define PCL_SLIM_VERSION_%s (\d+)" % part)
               for part in ("MAJOR", "MINOR", "PATCH")]
    for path, other in (
            ("modules/core/include/pcl_slim/version.h", ".".join(numbers)),
            ("package.xml", found("package.xml", r"<version>(.*)</version>")),
            ("CHANGELOG.md", found("CHANGELOG.md", r"^## (\S+)")),
            ("packaging/debian/changelog", found("packaging/debian/changelog", r"^pcl-slim \((.*)-\d+\)")),
            ("packaging/vcpkg/vcpkg.json", json.loads(text("packaging/vcpkg/vcpkg.json"))["version"]),
            ("packaging/conda/meta.yaml", found("packaging/conda/meta.yaml", r'set version = "(.*)"'))):
        if other != version:
            defects.append("%s has version %s, version.h %s" % (path, other, version))

    # The name of a package of shared libraries has their SONAME's version.
    package = "libpcl-slim" + ".".join(numbers[:2])
    for path in ("packaging/debian/control", "packaging/debian/rules", "scripts/package.sh", "scripts/package_test.sh",
                 "docs/install.md"):
        for other in sorted(set(re.findall(r"libpcl-slim[0-9][0-9.]*[0-9]", text(path))) - {package}):
            defects.append("%s names %s, the libraries are %s" % (path, other, package))

    for top in ("modules", "filters", "visualization"):
        for folder, _, names in os.walk(os.path.join(root, top)):
            for name in names:
                path = os.path.relpath(os.path.join(folder, name), root)
                for major, minor in re.findall(r"PCL_SLIM_DEPRECATED\((\d+), *(\d+),", text(path)):
                    if (int(major), int(minor)) <= (int(numbers[0]), int(numbers[1])):
                        defects.append("%s: version %s.%s removes a deprecated name" % (path, major, minor))

    dates = []
    for place, heading in enumerate(re.findall(r"^## (.*)$", text("CHANGELOG.md"), re.MULTILINE)):
        match = re.fullmatch(r"\d+\.\d+\.\d+ \((\d{4}-\d\d-\d\d|unreleased)\)", heading)
        if not match or match[1] == "unreleased" and place > 0:
            defects.append("CHANGELOG.md: '%s' is not 'x.y.z (year-month-day)'" % heading)
        elif match[1] != "unreleased":
            dates.append(match[1])
    if dates != sorted(dates, reverse=True):
        defects.append("CHANGELOG.md: the newest release is not the first")

    for defect in defects:
        print(defect)
    return 1 if defects else 0


if __name__ == "__main__":
    sys.exit(main())
