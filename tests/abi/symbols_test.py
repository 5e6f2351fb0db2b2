# SPDX-License-Identifier: BSD-3-Clause
"""Compares what shared libraries export with lists: python3 tests/abi/symbols_test.py [--renew] LISTS LIBRARY...

LISTS has a file for each library, libpcl_slim_fit.txt for libpcl_slim_fit.so: one demangled name a line, with the number of
instances of a template for PCL's types of points before it. Every name is one of pcl_slim; those of pcl_slim::detail, which
the libraries call in each other, have a version of their own and are not listed. Prints each difference and exits 1 if there
is one. --renew writes the lists instead: a name that is gone, or has another type, is a new SONAME.
"""
import argparse
import collections
import os
import re
import subprocess
import sys

# Types of points, as template arguments and in the types that follow from them.
STRING = re.compile(r"std::__cxx11::basic_string<char, std::char_traits<char>, std::allocator<char> >(?!::)")
POINT = re.compile(r"\bpcl::(?:Point(?!Cloud|Indices)|Normal|InterestPoint|Axis|Intensity|RGB|PrincipalCurvatures)\w*|\bpcl_slim::PointSLIM\b")


def exported(library):
    """Demangled names of the public version, and a defect for each name that is not ours."""
    # Two constructors of one name, complete and base, are one for a reader.
    out = subprocess.run(["nm", "--dynamic", "--defined-only", "--with-symbol-versions", library], check=True,
                         capture_output=True, text=True).stdout
    mangled = []
    for line in out.splitlines():
        kind, name = line.split()[-2:]
        name, _, version = name.partition("@")
        if kind != "A" and "PRIVATE" not in version:
            mangled.append(name)
    names = set(subprocess.run(["c++filt"], input="\n".join(mangled), check=True, capture_output=True,
                               text=True).stdout.splitlines())
    folded = collections.Counter(POINT.sub("P", STRING.sub("std::string", name)) for name in names)
    defects = ["%s exports %s, which is none of its interface" % (os.path.basename(library), name) for name in sorted(names)
               if "pcl_slim::" not in name or "pcl_slim::detail::" in name.partition("(")[0]]
    return ["%s%s" % ("" if count == 1 else "%d x " % count, name) for name, count in sorted(folded.items())], defects


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--renew", action="store_true")
    parser.add_argument("lists")
    parser.add_argument("libraries", nargs="+")
    options = parser.parse_args()
    failed = False
    for library in options.libraries:
        names, defects = exported(library)
        path = os.path.join(options.lists, os.path.basename(library).partition(".so")[0] + ".txt")
        if options.renew:
            with open(path, "w", encoding="utf-8") as file:
                file.write("".join(name + "\n" for name in names))
            continue
        listed = []
        if os.path.exists(path):
            with open(path, encoding="utf-8") as file:
                listed = file.read().splitlines()
        defects += ["%s: gone: %s" % (path, name) for name in sorted(set(listed) - set(names))]
        defects += ["%s: new:  %s" % (path, name) for name in sorted(set(names) - set(listed))]
        print("".join(defect + "\n" for defect in defects), end="")
        failed = failed or bool(defects)
    if failed:
        print("If this is meant: cmake --build BUILD --target pcl_slim_renew_symbols; CONTRIBUTING.md, \"Versions and "
              "deprecation\", says what follows from it")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
