# SPDX-License-Identifier: BSD-3-Clause
"""Makes the wheel of pcl_slim from CMakeLists.txt beside it. CMAKE_PREFIX_PATH or PCL_SLIM_PREFIX may name an
installed pcl_slim, whose modules are linked; else they are compiled, which takes some minutes."""
import os
import re
import sys

try:
    from skbuild import setup
except ImportError:
    from scikit_build_core.setuptools.wrapper import setup

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(HERE)


def read(*path):
    with open(os.path.join(ROOT, *path), encoding="utf-8") as file:
        return file.read()


version = re.search(r'define PCL_SLIM_VERSION "([^"]+)"', read("modules", "core", "include", "pcl_slim", "version.h"))[1]
prefix = os.environ.get("PCL_SLIM_PREFIX")

setup(
    name="pcl_slim",
    version=version,
    description="SLIM surfaces of point clouds: sparse sets of local polynomials, fitted without parameters",
    long_description=read("README.md"),
    long_description_content_type="text/markdown",
    license="BSD-3-Clause",
    packages=["pcl_slim"],
    package_data={"pcl_slim": ["py.typed", "*.pyi"]},
    python_requires=">=3.8",
    install_requires=["numpy"],
    cmake_source_dir=".",
    cmake_args=["-DPython_EXECUTABLE=" + sys.executable, "-DPCL_SLIM_BUILD_TESTS=OFF", "-DPCL_SLIM_INSTALL=OFF"]
    + (["-Dpcl_slim_ROOT=" + prefix] if prefix else []),
    classifiers=["License :: OSI Approved :: BSD License", "Operating System :: POSIX :: Linux",
                 "Programming Language :: C++", "Topic :: Scientific/Engineering"],
    zip_safe=False,
)
