# SPDX-License-Identifier: BSD-3-Clause
"""Rules of the house that a compiler does not check.

    python3 tests/layout_test.py ROOT            prints each breach; exits 1 if there is one
    python3 tests/layout_test.py ROOT --figures  prints the distribution of lengths as well
    python3 tests/layout_test.py ROOT --pcl DIR  DIR, of PCL's headers: none that is included is deprecated

Every source starts with its licence, headers guard themselves, modules and the Python package neither print nor know
PCL or VTK, programs include no header of PCL or Eigen, themselves or through ours, includes between folders
follow ARROWS and make no cycle, nor do those between the folders of one module, private headers keep
their names in a namespace of their own, no two types have one name, files and functions are short.
Links of the documents lead to files and headings that are there.
"""
import collections
import os
import re
import sys

SOURCES = ("modules", "filters", "visualization", "apps", "python", "ros2", "tests", "examples", "benchmarks")
MOST_LINES_IN_FILE = 600
MOST_LINES_IN_FUNCTION = 60

# What a folder may include, itself apart.
MODULES = ("core", "cloud", "leaf", "surface", "fit", "stream", "mpi", "query", "features", "scan", "mesh",
           "compare", "splat", "render", "web")
ARROWS = {
    "core": (),
    "cloud": ("core",),
    "leaf": ("core",),
    "surface": ("core", "leaf"),
    "fit": ("core", "cloud", "leaf", "surface"),
    "stream": ("core", "cloud", "surface", "fit"),
    "mpi": ("core", "stream"),
    "query": ("core", "cloud", "leaf", "surface"),
    "features": ("core", "cloud", "surface", "query"),
    "scan": ("core", "cloud", "surface", "fit", "query", "features"),
    "mesh": ("core", "cloud", "surface", "fit", "query", "scan"),
    "compare": ("core", "cloud", "leaf", "surface", "query", "mesh", "scan"),
    "splat": ("core", "cloud"),
    "render": ("core", "cloud", "leaf", "surface", "query", "splat", "mesh"),
    "web": ("core", "cloud", "leaf", "surface", "query", "splat", "render"),
    "filters": tuple(m for m in MODULES if m not in ("mpi", "render", "web")),
    "visualization": MODULES + ("filters",),
    "apps": MODULES + ("filters", "visualization"),
    "python": tuple(m for m in MODULES if m not in ("stream", "mpi")),
    "ros2": MODULES + ("filters",),
    "lab": MODULES,
    "comparison": MODULES + ("filters", "apps", "lab"),
    "demo_scan": MODULES + ("filters", "apps"),
    "examples": MODULES + ("filters", "visualization"),
    "benchmarks": MODULES + ("filters", "visualization", "apps", "lab", "comparison"),
    "tests": MODULES + ("filters", "visualization", "apps", "ros2", "lab", "comparison"),
}
# Folders that are rooms of their own in one that may include other things.
OWN_ROOMS = ("tests/support/lab/", "benchmarks/comparison/", "examples/demo_scan/")


def sources(root):
    for top in SOURCES:
        for folder, folders, names in os.walk(os.path.join(root, top)):
            folders.sort()
            for name in sorted(names):
                if name.endswith((".h", ".hpp", ".cpp")):
                    yield os.path.relpath(os.path.join(folder, name), root).replace(os.sep, "/")


def room_of(path):
    """modules/fit/src/ball/x.h -> fit; apps/common/x.h -> apps; tests/support/lab/x.h -> lab."""
    parts = path.split("/")
    for own in OWN_ROOMS:
        if path.startswith(own):
            return own.split("/")[-2]
    return parts[1] if parts[0] == "modules" else parts[0]


def folder_of(path):
    """modules/render/src/fast/setup/x.h -> modules/render/src/fast, apps/scan/x.h -> apps/scan; None for what
    is in src or apps itself, which ties the folders together, and for other places."""
    parts = path.split("/")
    depth = parts.index("src") + 1 if "src" in parts else 1 if parts[0] == "apps" else len(parts)
    return "/".join(parts[:depth + 1]) if len(parts) > depth + 1 else None


def included(path, text, by_name):
    """The project's own files that a source includes."""
    for name in re.findall(r'^#include "([^"]+)"', text, re.M):
        beside = os.path.normpath(os.path.join(os.path.dirname(path), name)).replace(os.sep, "/")
        candidates = by_name.get(name, ())
        if beside in by_name["/paths"]:
            yield beside
        elif candidates:
            own = [c for c in candidates if room_of(c) == room_of(path)]
            yield (own or list(candidates))[0]


def index(paths):
    by_name = collections.defaultdict(list)
    by_name["/paths"] = set(paths)
    for path in paths:
        parts = path.split("/")
        for i in range(len(parts)):
            by_name["/".join(parts[i:])].append(path)
    return by_name


BLANKS = re.compile(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])\'|^\s*#(?:[^\n]*\\\n)*[^\n]*',
                    re.S | re.M)


def blanked(text):
    """The text without comments, strings and preprocessor lines; line breaks stay."""
    return BLANKS.sub(lambda match: "\n" * match[0].count("\n") or " ", text)


def function_lengths(text):
    """(first line, length) of every function, from the line of its name to its closing brace. A function's opening
    brace is in a namespace or a class and follows a parameter list."""
    text = blanked(text)
    stack, begin, start = [], 0, None
    for match in re.finditer(r"[{};]", text):
        begin = max(begin, text.rfind("\n\n", begin, match.start()) + 1)
        head = text[begin:match.start()]
        if match[0] == "{":
            inside = "function" in stack or head.count("(") > head.count(")")
            if inside or re.search(r"[:,]\s*[\w:]+(<[^()]*>)?\s*$", head) and ")" in head or stack[-1:] == ["value"]:
                stack.append("value")  # a block or an initialiser
                if "function" not in stack:
                    continue  # a constructor's members: its head goes on
            elif re.match(r"\s*(template\s*<.*>\s*)?(class|struct|enum|union|namespace|extern)\b", head, re.S) or not head.strip():
                stack.append("scope")
            elif "(" in head and not re.search(r"=\s*$", head):
                stack.append("function")
                first = begin + head.rfind("\n", 0, head.index("(") + 1) + 1 if "\n" in head[:head.index("(")] else begin
                start = text.count("\n", 0, first) + (1 if text[first:first + 1] != "\n" else 2)
            else:
                stack.append("value")
        elif match[0] == "}" and stack:
            kind = stack.pop()
            if kind == "function":
                yield start, text.count("\n", 0, match.start()) + 1 - start + 1
            elif kind == "value" and "function" not in stack:
                continue  # what follows an initialiser belongs to its statement
        begin = match.end()


BRACES = re.compile(r"namespace\s*([\w:]*)\s*\{|"
                    r"(?<![<,] )(?<!<)\b(?:struct|class|enum)\s+(?:class\s+)?(?:[A-Z0-9_]+\s+)*([\w:]+)[^;{}()]*\{|[{}]")


def types_of(text):
    """Names of the types that a text defines in named namespaces. Two types of one name in a program are
    one to the linker: their members' code is taken for each other's."""
    stack = []
    for match in BRACES.finditer(blanked(text)):
        if match[0] == "}":
            del stack[-1:]
        elif match[0].startswith("namespace"):
            stack.append(match[1])
        else:
            name = match[2]
            if name and "::" not in name and all(stack):
                yield "::".join(stack + [name])
            stack.append("")


def cycle(graph):
    """Some cycle of a directed graph, as a list of nodes, or None."""
    state, stack = {}, []

    def visit(node):
        state[node] = 1
        stack.append(node)
        for other in sorted(graph.get(node, ())):
            if state.get(other) == 1:
                return stack[stack.index(other):] + [other]
            if other not in state:
                found = visit(other)
                if found:
                    return found
        state[node] = 2
        stack.pop()
        return None

    for node in sorted(graph):
        if node not in state:
            found = visit(node)
            if found:
                return found
    return None


def breaches_of_file(path, text):
    if not text.startswith("// SPDX-License-Identifier: BSD-3-Clause\n"):
        yield "does not start with its SPDX line"
    header = path.endswith((".h", ".hpp"))
    # Highway's *-inl.h files are included once per instruction set and cannot use the pragma.
    if header and not path.endswith("-inl.h") and "\n#pragma once\n" not in text:
        yield "has no #pragma once"
    if "\n#include" in text.split("\n#pragma once\n")[0] and "\n#pragma once\n" in text:
        yield "includes something above #pragma once"
    count = text.count("\n")
    if count > MOST_LINES_IN_FILE:
        yield f"has {count} lines: split it (limit {MOST_LINES_IN_FILE})"
    for line, length in function_lengths(text):
        if length > MOST_LINES_IN_FUNCTION:
            yield f"function at line {line} has {length} lines (limit {MOST_LINES_IN_FUNCTION})"
    if not path.startswith(("modules/", "python/")):
        return
    if re.search(r'#include [<"](pcl/|vtk)', text):
        yield "a module includes PCL or VTK"
    if re.search(r"#include <iostream>|[^a-z_]f?printf\(|std::(cout|cerr|clog)", text):
        yield "a module prints"
    if "hn::Compress" in text and not path.endswith("core/detail/lane_packing-inl.h"):
        yield "calls hn::Compress, whose table is copied at every call: use LanePacking"
    if path.startswith("python/"):
        return
    private = header and ("/src/" in path or "/detail/" in path)
    if private and re.search(r"^namespace pcl_slim(::(?!detail\b)\w+)* \{", text, re.M):
        yield "a private header declares names outside pcl_slim::detail"


def heavy_includes(path, files, texts):
    """PCL's and Eigen's headers that a source includes, itself or through the project's files: (file, header)."""
    seen, stack = {path}, [path]
    while stack:
        name = stack.pop()
        for header in re.findall(r'^ *#include [<"]((?:pcl|Eigen)/[^>"]+)', texts[name], re.M):
            yield name, header
        for other in files[name] - seen:
            seen.add(other)
            stack.append(other)


def breaches(root, paths):
    texts = {p: open(os.path.join(root, p), encoding="utf-8").read() for p in paths}
    by_name = index(paths)
    rooms, folders, files = collections.defaultdict(set), collections.defaultdict(set), {}
    for path in paths:
        for what in breaches_of_file(path, texts[path]):
            yield f"{path}: {what}"
        files[path] = set(included(path, texts[path], by_name))
        if "/impl/" in path:  # a template's body comes with its header, either way in
            files[path].discard(path.replace("/impl/", "/").replace(".hpp", ".h"))
        for other in files[path]:
            room, its = room_of(path), room_of(other)
            if room == its:
                folder, its = folder_of(path), folder_of(other)
                if folder and its and folder != its:
                    folders[folder].add(its)
                continue
            if its not in ARROWS[room]:
                yield f"{path}: includes {other}, against the arrows of CONTRIBUTING"
            if path.startswith("modules/"):
                folder = "/".join(other.split("/")[:3])
                if folder.endswith("/src"):
                    yield f"{path}: includes {other}, a private part of another module"
            rooms[room].add(its)
    for path in paths:
        if path.startswith("apps/"):
            for name, header in heavy_includes(path, files, texts):
                yield f"{path}: includes <{header}> of {name}: programs do without PCL and Eigen"
    for graph, what in ((files, "files"), (folders, "folders of a module"), (rooms, "modules")):
        found = cycle(graph)
        if found:
            yield f"{what} include each other in a cycle: " + " -> ".join(found)
    defined = collections.defaultdict(list)
    for path in paths:
        if path.startswith(("modules/", "filters/", "visualization/", "ros2/")):
            for name in types_of(texts[path]):
                defined[name].append(path)
    for name, where in sorted(defined.items()):
        if len(set(where)) > 1:
            yield f"{name} is defined in " + " and ".join(sorted(set(where)))
    lengths = sorted(n for p in paths for _, n in function_lengths(texts[p]))
    if "--figures" in sys.argv:
        print(f"{len(lengths)} functions: median {lengths[len(lengths) // 2]}, "
              f"p90 {lengths[len(lengths) * 9 // 10]}, longest {lengths[-1]}")


def deprecated_headers(root, paths, folder):
    """PCL's headers that a later version of PCL drops: it marks them two versions before."""
    for path in paths:
        text = open(os.path.join(root, path), encoding="utf-8").read()
        for header in re.findall(r"^ *#include <(pcl/[^>]+)>", text, re.M):
            name = os.path.join(folder, header)
            if not os.path.exists(name):
                yield f"{path}: includes {header}, which this PCL does not have"
            elif re.search(r"^PCL_DEPRECATED_HEADER\(", open(name, encoding="utf-8").read(), re.M):
                yield f"{path}: includes {header}, which PCL has deprecated"


def documents(root):
    """Path and text, without its code, of each Markdown file that is not made by a build."""
    for folder, folders, names in os.walk(root):
        folders[:] = sorted(f for f in folders if not f.startswith(".") and f not in ("build", "shared"))
        for name in sorted(names):
            if name.endswith(".md"):
                path = os.path.join(folder, name)
                text = open(path, encoding="utf-8").read()
                yield os.path.relpath(path, root), re.sub(r"^```.*?^```", "", text, flags=re.M | re.S)


def anchor(heading):
    """What a link names a heading by."""
    heading = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", heading)
    return re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-")


def dead_links(root):
    texts = dict(documents(root))
    anchors = {p: {anchor(h) for h in re.findall(r"^#+ (.*)$", t, re.M)} for p, t in texts.items()}
    for path, text in texts.items():
        for link in re.findall(r"\]\(([^)\s]+)\)", text):
            name, _, heading = link.partition("#")
            target = os.path.normpath(os.path.join(os.path.dirname(path), name)) if name else path
            if re.match(r"[a-z]+:", link):
                continue
            if not os.path.exists(os.path.join(root, target)):
                yield f"{path}: links to {link}, which is not there"
            elif "#" in link and heading not in anchors.get(target, ()):
                yield f"{path}: links to {link}, a heading that is not there"


def main():
    root = sys.argv[1]
    paths = list(sources(root))
    found = list(breaches(root, paths)) + list(dead_links(root))
    if "--pcl" in sys.argv:
        found += deprecated_headers(root, paths, sys.argv[sys.argv.index("--pcl") + 1])
    for line in found:
        print(line)
    if not paths:
        print("no sources below", root)
    print(f"{len(paths)} sources, {len(found)} breaches")
    return 1 if found or not paths else 0


if __name__ == "__main__":
    sys.exit(main())
