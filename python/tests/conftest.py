# SPDX-License-Identifier: BSD-3-Clause
"""Clouds with a known surface, and what reads the programs' files.

PYTHONPATH names the folder of the package; PCL_SLIM_BIN, if it is set, that of the programs."""
import os
import re
import subprocess

import numpy as np
import pytest

PROGRAMS = os.environ.get("PCL_SLIM_BIN", "")
TYPES = {(b"F", 4): "<f4", (b"F", 8): "<f8", (b"U", 1): "u1", (b"U", 2): "<u2", (b"U", 4): "<u4", (b"I", 4): "<i4",
         (b"I", 1): "i1", (b"I", 2): "<i2"}
PLY_TYPES = {"float": "<f4", "double": "<f8", "uchar": "u1", "uint": "<u4", "int": "<i4", "ushort": "<u2", "char": "i1"}


def sphere(count=20000, noise=0.002, seed=1):
    """Points about the unit sphere, and their directions."""
    random = np.random.default_rng(seed)
    directions = random.normal(size=(count, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    return directions * (1 + noise * random.normal(size=(count, 1))), directions


def torus(count=40000, noise=0.0005, seed=2, radii=(1.0, 0.4)):
    """Points about a torus round the z axis, evenly, and their normals."""
    random = np.random.default_rng(seed)
    large, small = radii
    u = random.uniform(0, 2 * np.pi, 3 * count)
    v = random.uniform(0, 2 * np.pi, 3 * count)
    kept = random.uniform(0, large + small, 3 * count) < large + small * np.cos(v)
    u, v = u[kept][:count], v[kept][:count]
    normals = np.stack([np.cos(u) * np.cos(v), np.sin(u) * np.cos(v), np.sin(v)], axis=1)
    centers = large * np.stack([np.cos(u), np.sin(u), 0 * u], axis=1)
    return centers + normals * (small + noise * random.normal(size=(len(u), 1))), normals


def bumps(count=30000, noise=0.001, seed=3):
    """A sphere with bumps, which has ridges and ravines, and its colours."""
    points, directions = sphere(count, 0.0, seed)
    x, y, z = directions.T
    radius = 1 + 0.1 * np.sin(5 * x) * np.sin(5 * y) * np.cos(5 * z)
    points = directions * (radius + noise * np.random.default_rng(seed).normal(size=count))[:, None]
    return points, np.stack([127 + 120 * np.sin(7 * x), 200 - 50 * y, 90 + 60 * z], axis=1).astype(np.uint8)


def write_pcd(path, points, colors=None, normals=None):
    """A binary PCD file of points in their own type."""
    fields = [("xyz", points)]
    header = [("x y z".split(), points.dtype.itemsize, "F")]
    if normals is not None:
        header.append(("normal_x normal_y normal_z".split(), 4, "F"))
        fields.append(("normals", normals.astype("<f4")))
    if colors is not None:
        header.append((["rgb"], 4, "U"))
        packed = colors.astype(np.uint32)
        fields.append(("rgb", (packed[:, 0] << 16 | packed[:, 1] << 8 | packed[:, 2]).astype("<u4")))
    names = [name for group, _, _ in header for name in group]
    sizes = [str(size) for group, size, _ in header for _ in group]
    types = [kind for group, _, kind in header for _ in group]
    record = np.zeros(len(points), dtype=[(name, array.dtype, array.shape[1:]) for name, array in fields])
    for name, array in fields:
        record[name] = array
    with open(path, "wb") as file:
        file.write(("VERSION .7\nFIELDS %s\nSIZE %s\nTYPE %s\nCOUNT %s\nWIDTH %d\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\n"
                    "POINTS %d\nDATA binary\n" % (" ".join(names), " ".join(sizes), " ".join(types),
                                                   " ".join("1" * len(names)), len(points), len(points))).encode())
        file.write(record.tobytes())


def read_pcd(path):
    """The fields of a binary PCD file, a structured array."""
    with open(path, "rb") as file:
        head, _, body = file.read().partition(b"DATA binary\n")
    rows = {line.split()[0]: line.split()[1:] for line in head.splitlines() if line.strip()}
    dtype = [(name.decode(), TYPES[kind, int(size)])
             for name, kind, size in zip(rows[b"FIELDS"], rows[b"TYPE"], rows[b"SIZE"])]
    return np.frombuffer(body, dtype=dtype, count=int(rows[b"POINTS"][0]))


def read_ply(path):
    """Vertices and triangles of a binary PLY file."""
    with open(path, "rb") as file:
        head, _, body = file.read().partition(b"end_header\n")
    elements = re.split(r"element ", head.decode())[1:]
    found = {}
    for element in elements:
        name, count = element.split()[:2]
        fields = re.findall(r"property (.*)", element)
        if fields and fields[0].startswith("list"):
            dtype = np.dtype([("n", PLY_TYPES[fields[0].split()[1]]), ("v", PLY_TYPES[fields[0].split()[2]], (3,))])
        else:
            dtype = np.dtype([(field.split()[1], PLY_TYPES[field.split()[0]]) for field in fields])
        found[name] = np.frombuffer(body, dtype=dtype, count=int(count))
        body = body[dtype.itemsize * int(count):]
    return found["vertex"], found["face"]["v"]


def columns(fields, names):
    return np.stack([fields[name] for name in names.split()], axis=1)


@pytest.fixture
def program(tmp_path):
    """Runs a program in an empty folder; the test is skipped where the programs are not built."""
    def run(name, *arguments):
        done = subprocess.run([os.path.join(PROGRAMS, name), *map(str, arguments)], cwd=tmp_path,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
        assert done.returncode == 0, done.stdout.decode()
    if not os.path.exists(os.path.join(PROGRAMS, "pcl_slim_fit")):
        pytest.skip("the programs are not built, or PCL_SLIM_BIN does not name their folder")
    return run
