# SPDX-License-Identifier: BSD-3-Clause
"""The table of docs/python.md: six scans by pcl_slim, Open3D and PCL's programs. beside.sh runs it.

    python3 beside.py EXACT_SURFACE DATA OUT COMMAND...

EXACT_SURFACE: that program; DATA: the folder of fandisk and julius; OUT gets the scans, the results and table.md. COMMAND runs
methods.py where OUT is the working folder. Results that OUT has are not computed again.
"""
import json
import os
import subprocess
import sys

import numpy as np

POINTS = 50000
# Scan: noise as a share of the box diagonal, or a mesh with its noisy twin.
SHAPES = {"sphere": 0.005, "torus": 0.0, "bumpy": 0.003, "relief": 0.001}
MESHES = ("julius_02", "fandisk_03")
NEIGHBOURS = (15, 30, 60, 120, 240, 480, 960)
DEPTHS = (5, 6, 7, 8, 9)
ITERATIONS = (1, 3, 10, 30, 100)
USUAL_NEIGHBOURS = 30  # of Open3D's tutorials
CREASE = np.cos(np.radians(30))  # vertices whose triangles differ by more have no normal
PLY_TYPES = {"float": "<f4", "double": "<f8", "uchar": "u1", "int": "<i4", "uint": "<u4"}


def read_mesh(path):
    """Vertices and triangles of a binary PLY file."""
    with open(path, "rb") as file:
        head, _, body = file.read().partition(b"end_header\n")
    found = {}
    for element in head.decode().split("element ")[1:]:
        name, count = element.split()[:2]
        fields = [line.split()[1:] for line in element.splitlines() if line.startswith("property")]
        if fields[0][0] == "list":
            kinds = [("n", PLY_TYPES[fields[0][1]]), ("corners", PLY_TYPES[fields[0][2]], (3,))]
        else:
            kinds = [(field[-1], PLY_TYPES[field[0]]) for field in fields]
        rows = np.dtype(kinds)
        found[name] = np.frombuffer(body, rows, int(count))
        body = body[rows.itemsize * int(count):]
    vertices = np.stack([found["vertex"][axis] for axis in "xyz"], axis=1).astype(float)
    return vertices, found["face"]["corners"].astype(np.uint32)


def write_pcd(path, points):
    count = len(points)
    with open(path, "wb") as file:
        file.write((f"VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH {count}\nHEIGHT 1\n"
                    f"VIEWPOINT 0 0 0 1 0 0 0\nPOINTS {count}\nDATA binary\n").encode() + points.astype("<f4").tobytes())


def vertex_normals(vertices, triangles):
    """Normals by the triangles' area, NaN on creases."""
    corners = vertices[triangles]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals = np.zeros_like(vertices)
    for corner in range(3):
        np.add.at(normals, triangles[:, corner], across)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    least = np.ones(len(vertices))
    for corner in range(3):
        np.minimum.at(least, triangles[:, corner], np.sum(across * normals[triangles[:, corner]], axis=1))
    normals[least < CREASE] = np.nan
    return normals


class Scan:
    """A scan's files in OUT, and what is true of its points."""

    def __init__(self, name, program, data, out):
        self.name, self.program, self.path = name, program, os.path.join(out, name)
        self.mesh = name in MESHES
        if self.mesh:
            clean, triangles = read_mesh(os.path.join(data, name + "_original.ply"))
            points, _ = read_mesh(os.path.join(data, name + "_noisy.ply"))
            clean.tofile(self.path + ".vertices")
            triangles.tofile(self.path + ".corners")
            np.save(self.path + ".triangles.npy", triangles.astype(np.int32))
        else:
            self.exact(name, self.path + ".points", "-make", POINTS, "-noise", SHAPES[name])
            points = np.fromfile(self.path + ".points").reshape(-1, 3)
        self.points = points.astype(np.float32).astype(float)  # PCL's type
        np.save(self.path + ".npy", self.points)
        write_pcd(self.path + ".pcd", self.points)
        self.diagonal = np.linalg.norm(np.ptp(self.points, axis=0))
        truth = self.truth(self.points)
        self.normals, self.curvature, self.inside = truth[:, 1:4], truth[:, 4], truth[:, 5] == 0
        if self.mesh:
            self.normals = vertex_normals(clean, triangles)
        self.spacing = self.median_spacing()

    def exact(self, *arguments):
        subprocess.run([self.program, *map(str, arguments)], check=True)

    def truth(self, points):
        np.ascontiguousarray(points, float).tofile(self.path + ".moved")
        mesh = ("-triangles", self.path + ".corners") if self.mesh else ()
        surface = self.path + ".vertices" if self.mesh else self.name
        self.exact(surface, self.path + ".moved", "-truth", self.path + ".truth", *mesh)
        return np.fromfile(self.path + ".truth").reshape(-1, 6)

    def median_spacing(self):
        """sqrt(area of a point), from the tenth neighbour of some points."""
        some = self.points[:: max(1, len(self.points) // 500)]
        tenth = [np.sort(np.sum((self.points - point) ** 2, axis=1))[10] for point in some]
        return float(np.sqrt(np.median(tenth) * np.pi / 10))

    def radius(self, neighbours):
        """Of a disc with this number of points."""
        return self.spacing * np.sqrt(neighbours / np.pi)

    def distance(self, points):
        """RMS distance from the surface, in 1e-4 of the box diagonal; places that are not finite count as far."""
        truth = self.truth(np.where(np.isfinite(points), points, 1e3 * self.diagonal))
        return 1e4 * np.sqrt(np.mean(truth[truth[:, 5] == 0, 0] ** 2)) / self.diagonal

    def angle(self, normals):
        """RMS angle [degrees] to the true normals whatever the side, and the share of wrong sides [%]."""
        judged = self.inside & np.isfinite(self.normals).all(axis=1)
        cosines = np.sum(normals[judged] * self.normals[judged], axis=1)
        cosines = np.nan_to_num(cosines / np.linalg.norm(normals[judged], axis=1))  # none: 90 degrees
        angles = np.degrees(np.arccos(np.minimum(np.abs(cosines), 1)))
        wrong = np.mean(cosines < 0)
        return np.sqrt(np.mean(angles ** 2)), 100 * min(wrong, 1 - wrong)

    def bend(self, curvature):
        """RMS error of mean curvature, in % of the RMS true one; a surface turned inside out counts as the other."""
        found, true = np.nan_to_num(curvature[self.inside]), self.curvature[self.inside]
        errors = [np.sqrt(np.mean((sign * found - true) ** 2)) for sign in (1, -1)]
        return 100 * min(errors) / np.sqrt(np.mean(true ** 2))


class Runs:
    """Runs of methods.py, each once."""

    def __init__(self, out, command):
        self.out, self.command = out, command

    def get(self, name, scan, *given):
        """What a method returned, and its seconds of CPU time and lines; None where it failed."""
        run = "_".join([name, scan.name, *map(str, given)])
        path = os.path.join(self.out, run)
        if not os.path.exists(path + ".json"):
            done = subprocess.run([*self.command, name, scan.name, run, *map(str, given)], check=False, stdout=subprocess.DEVNULL)
            if done.returncode != 0:
                with open(path + ".json", "w", encoding="utf-8") as file:
                    json.dump({"failed": done.returncode}, file)
        with open(path + ".json", encoding="utf-8") as file:
            report = json.load(file)
        if "failed" in report:
            print(run, "failed")
            return None
        return np.load(path + ".npy"), report["cpu"], report["lines"]


def cell(errors, seconds, number=None):
    text = ", ".join(f"{error:.3g}" for error in errors) + f"; {seconds:.2g} s"
    return text + (f" ({number})" if number is not None else "")


def swept(runs, scan, name, numbers, judge, usual=None, given=lambda number: number):
    """Cells of a method's usual number and of the best one, by the first of its errors."""
    rows = {}
    for number in numbers:
        run = runs.get(name, scan, given(number))
        if run is not None:
            rows[number] = (judge(run[0]), run[1])
    best = min(rows, key=lambda number: rows[number][0][0])
    cells = [cell(*rows[usual]) if usual in rows else "fails"] if usual is not None else []
    return cells + [cell(*rows[best], best)]


def table(head, rows):
    yield "| " + " | ".join(head) + " |"
    yield "|---" * len(head) + "|"
    for row in rows:
        yield "| " + " | ".join(row) + " |"
    yield ""


def mls_radius(scan):
    return lambda neighbours: round(scan.radius(neighbours), 9)


def mls_angle(scan):
    """pcl_mls_smoothing leaves out points with too few neighbours; then its rows are not the scan's."""
    return lambda rows: scan.angle(rows[:, 3:]) if len(rows) == len(scan.points) else (np.inf, np.inf)


def normals(runs, scans):
    for scan in scans:
        slim, seconds, _ = runs.get("pcl_slim_normals", scan)
        yield [scan.name, cell(scan.angle(slim), seconds),
               *swept(runs, scan, "open3d_normals", NEIGHBOURS, scan.angle, USUAL_NEIGHBOURS),
               *swept(runs, scan, "pcl_normals", NEIGHBOURS, scan.angle),
               *swept(runs, scan, "pcl_smooth", NEIGHBOURS, mls_angle(scan), given=mls_radius(scan))]


def smoothing(runs, scans):
    def judge_of(scan):
        return lambda rows: (scan.distance(rows[:, :3]),)

    for scan in scans:
        judge = judge_of(scan)
        slim, seconds, _ = runs.get("pcl_slim_smooth", scan)
        taubin = ["–"]
        if scan.mesh:
            taubin = swept(runs, scan, "open3d_taubin", ITERATIONS, judge)
        yield [scan.name, f"{scan.distance(scan.points):.3g}", cell(judge(slim), seconds),
               *swept(runs, scan, "open3d_poisson", DEPTHS, judge), *taubin,
               *swept(runs, scan, "pcl_smooth", NEIGHBOURS, judge, given=mls_radius(scan))]


def curvature(runs, scans):
    for scan in scans:
        if not scan.mesh:
            slim, seconds, _ = runs.get("pcl_slim_curvature", scan)
            yield [scan.name, cell((scan.bend(slim),), seconds), "–", "–"]


def lines(runs, scan):
    """Of each function; the number of a run is any that was made."""
    for name, given in (("pcl_slim_normals", []), ("pcl_slim_smooth", []), ("open3d_normals", NEIGHBOURS[:1]),
                        ("open3d_poisson", DEPTHS[:1]), ("open3d_taubin", ITERATIONS[:1])):
        yield f"{name} {runs.get(name, scan, *given)[2]}"


def main():
    program, data, out = sys.argv[1:4]
    runs = Runs(out, sys.argv[4:])
    scans = [Scan(name, program, data, out) for name in (*SHAPES, *MESHES)]
    text = [
        *table(["scan", "`pcl_slim.normals`", "Open3D, 30 neighbours", "Open3D, best number", "`pcl_normal_estimation`, best number",
                "`pcl_mls_smoothing`, best number"], normals(runs, scans)),
        *table(["scan", "as scanned", "`pcl_slim.smooth`", "Open3D, Poisson, best depth", "Open3D, Taubin, best number",
                "`pcl_mls_smoothing`, best number"], smoothing(runs, scans)),
        *table(["scan", "`pcl_slim.curvature`", "Open3D", "PCL's programs"], curvature(runs, scans)),
        "Lines: " + ", ".join(lines(runs, scans[-1])),
    ]
    with open(os.path.join(out, "table.md"), "w", encoding="utf-8") as file:
        file.write("\n".join(text) + "\n")


main()
