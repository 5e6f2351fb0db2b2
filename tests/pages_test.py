# SPDX-License-Identifier: BSD-3-Clause
"""Runs what pages show: every fenced block of commands, in order, in one folder a page.

    python3 tests/pages_test.py [--slow] [--prefix PREFIX] BIN_DIR WORK_DIR DATA_DIR PAGE...

BIN_DIR has the programs, WORK_DIR/NAME becomes the folder of the page NAME.md, DATA_DIR is a folder of real scans ("":
none). --slow also runs blocks marked slow. --prefix also configures CMake blocks against the package installed there and
compiles C++ blocks, in order as one function. Prints each defect and each block that did not run; exits 1 if there is a
defect. In blocks without a language
  - a line that begins with "$ ", with a program, a script or a known tool is a command. The lines below it, up to the
    next command, are its output; a block without commands is the output of one command of the block before;
  - output is compared with all that the command prints. "…" stands for any text, a line "…" for any lines. Numbers may
    differ by 2 % or by 1 in the last digit shown, times by any amount;
  - an input that is not there is made from the demo's scan (STAND_INS).
Counts of points, leaves, splats, lines and triangles in the alt text and the caption of a picture, and in paragraphs
marked so, must be among those that the page's commands printed. Marks are comments, above the block:
  <!-- test: skip, REASON -->            is not run (in a block of several commands: SKIPPED)
  <!-- test: slow, REASON -->            is run by --slow only
  <!-- test: data SCAN as FILE -->       FILE is a scan of DATA_DIR; without it commands that need it are skipped
  <!-- test: demo FILE -->               FILE is made from the demo's scan again
  <!-- test: needs PROGRAM -->           the block, or the next hidden commands, are skipped where PROGRAM is not built
  <!-- test: needs module NAME -->       the Python block is skipped where there is no module of this name
  <!-- test: run COMMANDS -->            commands that the page does not show, each on a line
  <!-- test: slow run COMMANDS -->
  <!-- test: lines of FILE -->           each line of the block is one of FILE
  <!-- test: counts -->                  checks the counts of the next paragraph
  <!-- test: with DECLARATIONS -->       what a C++ block uses and its reader has (READER is always there)
Blocks ```python run in order as one program, with the package beside BIN_DIR and the modules of python/examples.
A block ```text is neither.
"""
import argparse
import os
import re
import shutil
import struct
import subprocess
import sys

TOLERANCE = 0.02
READER = (("pcl_slim/filters/", "pcl::PointCloud<pcl::PointXYZ>::Ptr cloud;"),
          ("pcl_slim/", "pcl_slim::SLIMSurface surface;"))
SKIPPED = {
    "sudo": "installs packages",
    "scripts/test.sh": "builds the project and runs this test",
    "sbatch": "needs a cluster with Slurm",
    "plan=$(sbatch": "needs a cluster with Slurm",
    "fit=$(sbatch": "needs a cluster with Slurm",
}
TOOLS = ("export", "cat", "mkdir", "cmake", "montage", "mpirun", "g++", "xvfb-run", "scripts/demo.sh", "scripts/paper.sh",
         "benchmarks/", "build/release/bin/", "paper_bench")
# Programs that some builds do not have.
OPTIONAL = ("pcl_slim_view", "pcl_slim_fit_mpi", "pcl_slim_example_")
STAND_INS = {
    "scan.pcd": "pcl_slim_demo_scan scan.pcd",
    "scan.ply": None,
    "scan.csv": None,
    "mine.cpp": None,
    "surface.slim": "pcl_slim_fit scan.pcd surface.slim",
    "surface.pcd": "pcl_slim_fit scan.pcd surface.pcd",
    "splats.pcd": "pcl_color_splat_sampling scan.pcd splats.pcd -max_splats 20000",
    "splats.ply": "pcl_color_splat_sampling scan.pcd splats.ply -max_splats 20000",
    "mesh.ply": "pcl_slim_mesh scan.pcd mesh.ply -max_triangles 20000",
    "lines.ply": "pcl_slim_lines scan.pcd lines.ply",
    "survey.las": "pcl_slim_curvature scan.pcd survey.las",
}
UNITS = {"points": "points", "leaves": "leaves", "balls": "leaves", "patches": "leaves", "ones": "any",
         "splats": "splats", "discs": "splats", "triangles": "triangles", "lines": "lines", "surfels": "surfels"}
NUMBER = r"\d+\.?\d*(?:e[-+]?\d+)?|\.\d+"


class Skip(Exception):
    pass


def blocks_of(text):
    """(line, kind, content) of marks, fenced blocks, pictures with their captions and paragraphs, in order."""
    lines, at = text.splitlines(), 0

    def take(ends):
        """Lines up to the first that ends the part, that one too."""
        nonlocal at
        begin = at
        while at < len(lines) and not ends(lines[at]):
            at += 1
        at += 1
        return lines[begin:at]

    while at < len(lines):
        line = at + 1
        stripped = lines[at].strip()
        if stripped.startswith("<!-- test:"):
            content = "\n".join(take(lambda text: "-->" in text)).strip()
            yield line, "mark", content[len("<!-- test:"):-len("-->")].strip()
        elif stripped.startswith("```"):
            indent = len(lines[at]) - len(lines[at].lstrip())
            at += 1
            content = take(lambda text: text.strip() == "```")[:-1]
            yield line, stripped[3:] or "shell", "\n".join(text[indent:] for text in content)
        elif stripped.startswith("!["):
            content = take(lambda text: not text.strip())
            if at < len(lines) and re.match(r"\*[^* ]", lines[at]):
                content += take(lambda text: not text.strip())
            yield line, "picture", "\n".join(content)
        elif stripped:
            yield line, "paragraph", "\n".join(take(lambda text: not text.strip() or text.lstrip().startswith("```")))
            if at <= len(lines) and lines[at - 1].lstrip().startswith("```"):
                at -= 1
        else:
            at += 1


def numbers_agree(shown, real):
    if shown == real:
        return True
    digits = re.sub(r"e.*", "", shown)
    last = 10.0 ** -len(digits.partition(".")[2])
    if "e" in shown:
        last *= 10.0 ** int(shown.partition("e")[2])
    return abs(float(shown) - float(real)) <= 1.0001 * max(TOLERANCE * abs(float(real)), last)


def lines_agree(shown, real):
    """Equal but for numbers within the tolerance, times and what the page leaves out."""
    pattern, numbers = "", []
    timeless = re.sub(r"\[done, [^:]* :", "[done, … :", re.sub(r"(?:" + NUMBER + r") ms\b", "… ms", shown.rstrip()))
    for part in re.split(r"(…|" + NUMBER + ")", timeless):
        if part == "…":
            pattern += ".*?"
        elif re.fullmatch(NUMBER, part):
            pattern += "(" + NUMBER + ")"
            numbers.append(part)
        else:
            pattern += re.escape(part)
    match = re.fullmatch(pattern, real.rstrip())
    return bool(match) and all(numbers_agree(a, b) for a, b in zip(numbers, match.groups()))


def output_agrees(shown, real):
    """All lines of the output, or those around lines "…"."""
    if not shown:
        return not real
    if shown[0].strip() == "…":
        return any(output_agrees(shown[1:], real[start:]) for start in range(len(real) + 1))
    return bool(real) and lines_agree(shown[0], real[0]) and output_agrees(shown[1:], real[1:])


def split_block(content, programs, hidden=False):
    """[(command, lines of output)] of a block; a command of None if it begins with output. Hidden: commands alone."""
    if hidden:
        return [(line, []) for line in content.replace("\\\n", " ").splitlines()]
    dollars = any(line.startswith("$ ") for line in content.splitlines())
    steps, continued = [], False
    for line in content.splitlines():
        words = line.split()
        first = words[0] if words else ""
        if continued:
            steps[-1][0] += "\n" + line
        elif dollars and line.startswith("$ "):
            steps.append([line[2:], []])
        elif not dollars and not line.startswith((" ", ">")) and (
                first in programs or first in SKIPPED or first.startswith(TOOLS) or first.startswith(OPTIONAL)):
            steps.append([line, []])
        elif line.strip() or steps and steps[-1][1]:
            if not steps:
                steps.append([None, []])
            steps[-1][1].append(line)
        continued = bool(steps) and steps[-1][0] is not None and not steps[-1][1] and line.endswith("\\")
    for step in steps:
        while step[1] and not step[1][-1].strip():
            step[1].pop()
    return steps


def counts_in(text, shown):
    """{(count, unit)} of a program's output, or of a page's text, where a number may have its unit further on."""
    text = text if not shown else re.sub(r"`[^`]*`|\([^)]*\.png\)|\d+ x \d+", " ", re.sub(r"(?<=\d)[ ,](?=\d{3}\b)", "", text))
    counts, waiting, last = set(), [], None
    for word in re.findall(r"(?<![\w.])\d+(?![\w.]*\d|[A-Za-z]| million)(?: (?:mm|ms|px|pixels|m|%)\b)?|[a-z]+", text.replace("\n", " ")):
        if word.isdigit() and int(word) >= 100:
            waiting.append(int(word))
        elif word in UNITS:
            last = UNITS[word]
            counts.update((count, last) for count in waiting)
            waiting = []
        elif not shown and word not in ("x", "uniform", "coloured"):
            waiting = []
    if shown and last:
        counts.update((count, last) for count in waiting)
    return counts


class Page:
    def __init__(self, path, options):
        self.path, self.options = path, options
        self.name = os.path.basename(path)
        self.folder = os.path.join(os.path.abspath(options.work), os.path.splitext(self.name)[0])
        self.programs = set(os.listdir(options.bin))
        self.defects, self.skipped = [], []
        self.missing = {}    # files that skipped commands would have made, and why
        self.outputs = []    # (command, lines) of the block before
        self.counts = set()  # what all commands printed
        self.shown = []      # (line, text) whose counts are checked
        self.code = []       # (line, declarations, C++)
        self.python = []     # (line, Python)
        self.done = {"commands": 0, "outputs": 0, "counts": 0, "CMake blocks": 0, "C++ blocks": 0, "Python blocks": 0}
        root = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
        self.root = root
        shutil.rmtree(self.folder, ignore_errors=True)
        os.makedirs(self.folder)
        for name in ("scripts", "examples"):
            shutil.copytree(os.path.join(root, name), os.path.join(self.folder, name))
        os.makedirs(os.path.join(self.folder, "build/release"))
        os.symlink(os.path.abspath(options.bin), os.path.join(self.folder, "build/release/bin"))
        os.symlink(os.path.join(root, "benchmarks"), os.path.join(self.folder, "benchmarks"))
        self.environment = dict(os.environ, BIN_DIR=os.path.abspath(options.bin), LC_ALL="C.UTF-8",
                                PATH=os.path.abspath(options.bin) + os.pathsep + os.environ["PATH"])
        # As a root, and with more ranks than cores.
        self.environment.update(OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1",
                                OMPI_MCA_rmaps_base_oversubscribe="1", PCL_SLIM_DATA=os.path.abspath(options.data or "."))
        if options.prefix:
            folders = [os.path.join(top, "pkgconfig") for top, _, _ in os.walk(os.path.abspath(options.prefix))
                       if os.path.isdir(os.path.join(top, "pkgconfig"))]
            self.environment["PKG_CONFIG_PATH"] = os.pathsep.join(folders)

    def defect(self, line, text):
        self.defects.append("%s:%d: %s" % (self.path, line, text))

    def skip(self, line, what, why):
        self.skipped.append("%s:%d: not run: %s (%s)" % (self.path, line, what.split("\n")[0], why))

    def shell(self, command):
        done = subprocess.run(["bash", "-e", "-o", "pipefail", "-c", command], cwd=self.folder, env=self.environment,
                              stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              timeout=3600 if self.options.slow else 120)
        text = done.stdout.decode("utf-8", "replace")
        return done.returncode, [line.rpartition("\r")[2] for line in text.splitlines()]

    def stand_in(self, name):
        """Makes an input that the reader has himself."""
        if name not in STAND_INS or os.path.exists(os.path.join(self.folder, name)):
            return
        if name == "mine.cpp":
            with open(os.path.join(self.folder, name), "w", encoding="utf-8") as file:
                file.write("int main() {}\n")
            return
        scan = os.path.join(os.path.abspath(self.options.work), "scan.pcd")
        if not os.path.exists(scan):
            self.shell("pcl_slim_demo_scan '%s'" % scan)
        if name in ("scan.pcd", "scan.ply", "scan.csv"):
            self.convert_scan(scan, name)
        else:
            status, lines = self.shell(STAND_INS[name].replace(" scan.pcd ", " '%s' " % scan))
            if status:
                raise RuntimeError("%s: %s" % (STAND_INS[name], " ".join(lines[-2:])))

    def convert_scan(self, scan, name):
        """The demo's binary x y z rgb as .pcd, .ply or .csv."""
        if name.endswith(".pcd"):
            shutil.copyfile(scan, os.path.join(self.folder, name))
            return
        with open(scan, "rb") as file:
            head, _, body = file.read().partition(b"DATA binary\n")
        count = int(re.search(rb"POINTS (\d+)", head)[1])
        with open(os.path.join(self.folder, name), "wb") as file:
            if name.endswith(".ply"):
                file.write(b"ply\nformat binary_little_endian 1.0\nelement vertex %d\n" % count)
                for field in (b"float x", b"float y", b"float z", b"uchar blue", b"uchar green", b"uchar red", b"uchar alpha"):
                    file.write(b"property " + field + b"\n")
                file.write(b"end_header\n" + body[:16 * count])
            else:
                for x, y, z, b, g, r, _ in struct.iter_unpack("<3f4B", body[:16 * count]):
                    file.write(b"%.6f,%.6f,%.6f,%d,%d,%d\n" % (x, y, z, r, g, b))

    def run(self, line, command):
        """Runs one command; its lines of output, or Skip."""
        plain = re.sub(r"\s+#\s.*", "", command, flags=re.M)
        words = plain.split()
        program = words[0]
        files = [part for word in words[1:] for part in word.split(",") if re.search(r"\w\.\w+$", part)]
        ours = next((i for i, word in enumerate(words) if word.rpartition("/")[2] in self.programs), None)
        place = None if ours is None else ours + (3 if words[ours] == "pcl_slim" else 2)
        made = [] if place is None else words[place:place + 1]
        try:
            if program in SKIPPED:
                raise Skip(SKIPPED[program])
            for name in files:
                if name in self.missing and name not in made:
                    raise Skip(self.missing[name])
            if program.startswith(OPTIONAL) and program not in self.programs:
                raise Skip(program + " is not built")
            if program.startswith("build/release/bin/") and not os.path.exists(os.path.join(self.folder, program)):
                raise Skip(program + " is not built")
            if program in ("montage", "mpirun", "xvfb-run") and not shutil.which(program):
                raise Skip(program + " is not installed")
            if program == "g++" and not self.options.prefix:
                raise Skip("only with --prefix")
            if program.startswith(("pcl_slim_view", "pcl_slim_example_")):
                if not shutil.which("xvfb-run"):
                    raise Skip("xvfb-run is not installed")
                command = "xvfb-run -a -s '-screen 0 1600x1200x24' " + plain
                # A picture in place of a window.
                if program == "pcl_slim_view" and "-screenshot" not in words:
                    command += " -screenshot view.png"
                elif program != "pcl_slim_view" and not plain.strip().endswith(".png"):
                    command += " window.png"
            if "$PCL_SLIM_DATA" in plain and not self.options.data:
                raise Skip("no data folder")
        except Skip:
            for name in files:
                if not os.path.exists(os.path.join(self.folder, name)):
                    self.missing.setdefault(name, "needs %s, which was not made" % name)
            raise
        for name in files:
            if name not in made:
                self.stand_in(name)
        status, lines = self.shell(command)
        self.done["commands"] += 1
        self.counts |= counts_in("\n".join(lines), False)
        for name in files:
            if name.endswith(".json") and os.path.exists(os.path.join(self.folder, name)):
                with open(os.path.join(self.folder, name), encoding="utf-8") as file:
                    self.counts |= {(int(n), UNITS.get(k, k)) for k, n in re.findall(r'"(\w+)": (\d+),', file.read())}
        return status, lines

    def run_block(self, line, content, hidden=False):
        steps = split_block(content, self.programs, hidden)
        if not steps:
            return
        if steps[0][0] is None:
            if len(steps) > 1:
                self.defect(line, "this block begins with output; begin it with its command")
            self.compare_block(line, steps[0][1])
            return
        self.outputs = []
        for command, shown in steps:
            if command.split()[0].startswith("#"):
                continue
            try:
                status, lines = self.run(line, command)
            except Skip as why:
                self.skip(line, command, why)
                self.outputs.append((command, None))
                continue
            except (RuntimeError, subprocess.TimeoutExpired) as error:
                self.defect(line, str(error))
                continue
            self.outputs.append((command, lines))
            failed = any(re.search(r"failed\]", text) for text in shown)
            if (status != 0) != failed:
                self.defect(line, "%s\n    ended with status %d:\n    %s" % (command, status, "\n    ".join(lines[-6:])))
            elif shown:
                self.compare(line, command, shown, lines)

    def compare(self, line, command, shown, lines):
        self.done["outputs"] += 1
        if not output_agrees(shown, lines):
            self.defect(line, "%s\n  page:\n    %s\n  program:\n    %s" % (
                command, "\n    ".join(shown), "\n    ".join(lines)))

    def compare_block(self, line, shown):
        real = [(command, lines) for command, lines in self.outputs if lines is not None]
        if not self.outputs:
            self.defect(line, "neither commands nor the output of the block before; ```text if it is neither")
        elif any(output_agrees(shown, lines) for _, lines in real):
            self.done["outputs"] += 1
        elif not real:
            self.skip(line, shown[0], "the output of a command that did not run")
        else:
            command, lines = real[0]
            self.compare(line, command, shown, lines)

    def lines_of(self, line, name, content):
        if name in self.missing:
            self.skip(line, "lines of " + name, self.missing[name])
            return
        with open(os.path.join(self.folder, name), encoding="utf-8") as file:
            real = [text.strip() for text in file]
        self.done["outputs"] += 1
        for shown in content.splitlines():
            found = next((i for i, text in enumerate(real) if lines_agree(shown.strip(), text)), None)
            if found is None:
                near = [text for text in real if text.split(" ")[0] == shown.split()[0]]
                self.defect(line, "%s has no line %s %s" % (name, shown.strip(), near))

    def check_counts(self, line, text):
        for count, unit in sorted(counts_in(text, True)):
            self.done["counts"] += 1
            known = sorted(number for number, kind in self.counts if unit in (kind, "any"))
            if any(abs(count - number) <= TOLERANCE * number for number in known):
                continue
            if self.skipped and any(re.search("data folder|slow|not built|not made", reason) for reason in self.skipped):
                self.skip(line, "%d %s" % (count, unit), "a command that counts them did not run")
            else:
                self.defect(line, "%d %s: no command of the page printed that many (%s)" % (
                    count, unit, ", ".join(map(str, known)) or "none"))

    def built(self, marks):
        return all(word != "needs" or rest in self.programs for word, rest in marks)

    def data(self, line, scan, name):
        source = os.path.join(self.options.data, scan) if self.options.data else ""
        if not source or not os.path.exists(source):
            self.missing[name] = "no %s in the data folder" % scan
            return
        target = os.path.join(self.folder, name)
        if os.path.lexists(target):
            os.remove(target)
        os.symlink(os.path.abspath(source), target)
        self.missing.pop(name, None)

    def configure(self, line, content):
        if not self.options.prefix:
            self.skip(line, "a CMake block", "only with --prefix")
            return
        folder = os.path.join(self.folder, "cmake_%d" % line)
        os.makedirs(folder)
        if "project(" not in content:
            content = "project(page LANGUAGES CXX)\n" + content
        if "cmake_minimum_required(" not in content:
            content = "cmake_minimum_required(VERSION 3.22)\n" + content
        target = re.search(r"target_link_libraries\((\w+)", content)
        if target and "add_executable(" not in content:
            content = re.sub(r"(?=target_link_libraries\()", "add_executable(%s mine.cpp)\n" % target[1], content, count=1)
        with open(os.path.join(folder, "CMakeLists.txt"), "w", encoding="utf-8") as file:
            file.write(content)
        for name in re.findall(r"\w+\.cpp", content):
            with open(os.path.join(folder, name), "w", encoding="utf-8") as file:
                file.write("int main() {}\n")
        os.symlink(self.root, os.path.join(folder, "pcl_slim"))
        status, lines = self.shell("cmake -S cmake_%d -B cmake_%d/build -DCMAKE_PREFIX_PATH='%s'" % (
            line, line, os.path.abspath(self.options.prefix)))
        self.done["CMake blocks"] += 1
        if status:
            self.defect(line, "CMake refuses the block\n    " + "\n    ".join(lines[-12:]))

    def compile(self):
        """All C++ blocks as one function, each in the scope of those before it."""
        if not self.code:
            return
        if not self.options.prefix:
            self.skip(self.code[0][0], "C++ blocks", "only with --prefix")
            return
        includes, body = ["#include <iostream>", "#include <memory>", "#include <vector>",
                          "#include <pcl_slim/surface/surface.h>"], []
        code = "\n".join(content for _, _, content in self.code)
        body += [text for header, text in READER if header in code]
        for line, declarations, content in self.code:
            body.append("{")
            for text in declarations.splitlines() + ["#line %d \"%s\"" % (line + 1, self.path)] + content.splitlines():
                if text.startswith("#include"):
                    includes.append(text)
                    text = ""
                body.append(text)
        source = os.path.join(self.folder, "page.cpp")
        with open(source, "w", encoding="utf-8") as file:
            file.write("\n".join(sorted(set(includes))) + "\nstatic pcl_slim::Error page() {\n" + "\n".join(body) +
                       "\n" + "}" * len(self.code) + "\nreturn {};\n}\nint main() { page(); }\n")
        flags = "$(pkg-config --cflags pcl_slim_filters)"
        for top in sorted(os.listdir("/usr/include")):
            if re.match(r"vtk-|pcl-", top):
                flags += " -isystem /usr/include/" + top
        status, lines = self.shell("g++ -std=c++17 -fsyntax-only -w -include pcl_slim/core/error.h %s page.cpp" % flags)
        self.done["C++ blocks"] += len(self.code)
        if status:
            self.defect(self.code[0][0], "C++ blocks do not compile\n    " + "\n    ".join(lines[:12]))

    def interpret(self):
        """All Python blocks as one program, in the folder of the page."""
        if not self.python:
            return
        package = os.path.join(os.path.dirname(os.path.abspath(self.options.bin)), "python")
        if not os.path.exists(os.path.join(package, "pcl_slim")):
            self.skip(self.python[0][0], "Python blocks", "the package is not built")
            return
        for _, content in self.python:
            for name in re.findall(r'"([\w.]+\.las)"', content):
                self.stand_in(name)
        # Each block has the lines of the page, for messages.
        text = "".join("exec(compile(%r, %r, 'exec'))\n" % ("\n" * line + content, self.path) for line, content in self.python)
        with open(os.path.join(self.folder, "page.py"), "w", encoding="utf-8") as file:
            file.write(text)
        path = os.pathsep.join([package, os.path.join(self.root, "python", "examples")])
        status, lines = self.shell("PYTHONDONTWRITEBYTECODE=1 PYTHONPATH='%s' '%s' page.py" % (path, self.interpreter()))
        self.done["Python blocks"] += len(self.python)
        self.counts |= counts_in("\n".join(lines), False)
        if status:
            self.defect(self.python[0][0], "Python blocks fail\n    " + "\n    ".join(lines[-8:]))

    @staticmethod
    def interpreter():
        """The distribution's own, which the package is built for."""
        return "/usr/bin/python3" if os.path.exists("/usr/bin/python3") else sys.executable

    def has_module(self, name):
        return self.shell("'%s' -c 'import %s'" % (self.interpreter(), name))[0] == 0

    def test(self):
        with open(self.path, encoding="utf-8") as file:
            text = file.read()
        marks = []
        for line, kind, content in blocks_of(text):
            if kind == "mark":
                word, rest = (re.split(r"\s", content, maxsplit=1) + [""])[:2]
                if word == "data":
                    self.data(line, *rest.split(" as "))
                elif word == "demo":
                    os.remove(os.path.join(self.folder, rest))
                elif word == "run" and not self.built(marks):
                    self.skip(line, rest, dict(marks)["needs"] + " is not built")
                    marks = []
                elif word == "run" or rest.startswith("run") and word == "slow":
                    if word == "slow" and not self.options.slow:
                        self.skip(line, rest[4:].strip(), "slow")
                    else:
                        self.run_block(line, rest.strip() if word == "run" else rest[4:].strip(), True)
                else:
                    marks.append((word.rstrip(","), rest))
                continue
            if kind == "picture":
                self.shown.append((line, re.sub(r"\]\([^)]*\)", " ", content)))
            elif kind == "paragraph":
                if marks and marks[-1][0] == "counts":
                    self.shown.append((line, content))
                    marks.pop()
                continue
            elif kind == "text":
                pass
            elif any(word == "skip" for word, _ in marks):
                self.skip(line, content, dict(marks)["skip"])
            elif kind == "python":
                module = dict(marks).get("needs", "").rpartition("module ")[2]
                if module and not self.has_module(module):
                    self.skip(line, content, "there is no module " + module)
                else:
                    self.python.append((line, content))
            elif not self.built(marks):
                self.skip(line, content, dict(marks)["needs"] + " is not built")
            elif any(word == "slow" for word, _ in marks) and not self.options.slow:
                self.skip(line, content, "slow: " + dict(marks)["slow"])
            elif any(word == "lines" for word, _ in marks):
                self.lines_of(line, dict(marks)["lines"].split()[-1], content)
            elif kind == "cmake":
                self.configure(line, content)
            elif kind in ("cpp", "c++"):
                self.code.append((line, "\n".join(rest for word, rest in marks if word == "with"), content))
            elif kind in ("shell", "sh", "bash", "console"):
                self.run_block(line, content)
            else:
                self.defect(line, "unknown language %s" % kind)
            marks = []
        self.interpret()
        for line, content in self.shown:
            self.check_counts(line, content)
        self.compile()
        print("%s: %s" % (self.path, ", ".join("%d %s" % (n, what) for what, n in self.done.items() if n) or "nothing"))
        print("".join("  %s\n" % text for text in self.skipped) + "".join(text + "\n" for text in self.defects), end="")
        sys.stdout.flush()
        return not self.defects


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--slow", action="store_true")
    parser.add_argument("--prefix", default="")
    parser.add_argument("bin")
    parser.add_argument("work")
    parser.add_argument("data")
    parser.add_argument("pages", nargs="+")
    options = parser.parse_args()
    sys.exit(0 if all([Page(path, options).test() for path in options.pages]) else 1)


if __name__ == "__main__":
    main()
