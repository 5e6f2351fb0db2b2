# SPDX-License-Identifier: BSD-3-Clause
"""Every layout of an array, and every defect of one."""
import os
import subprocess
import sys
import tracemalloc

import numpy as np
import pytest
from conftest import sphere

import pcl_slim

POINTS, DIRECTIONS = sphere(3000)
SMOOTH = pcl_slim.smooth(POINTS)


def layouts():
    wide = np.zeros((3000, 8))
    wide[:, 3:6] = POINTS
    every_second = np.zeros((6000, 3))
    every_second[::2] = POINTS
    packed = np.zeros(3000, dtype=np.dtype([("tag", "u1"), ("x", "f8"), ("y", "f8"), ("z", "f8")]))
    record = np.zeros(3000, dtype=[("x", "f8"), ("y", "f8"), ("z", "f8"), ("intensity", "f4"), ("pad", "f4")])
    apart = np.zeros(3000, dtype=[("z", "f8"), ("label", "i8"), ("y", "f8"), ("x", "f8")])
    for fields in (packed, record, apart):
        for axis, name in enumerate("xyz"):
            fields[name] = POINTS[:, axis]
    frozen = POINTS.copy()
    frozen.setflags(write=False)
    return {"columns of a table": wide[:, 3:6], "every second row": every_second[::2],
            "Fortran order": np.asfortranarray(POINTS), "reversed twice": POINTS[::-1][::-1],
            "columns reversed twice": np.ascontiguousarray(POINTS[:, ::-1])[:, ::-1], "packed record": packed,
            "record": record, "fields apart": apart, "read-only": frozen, "other byte order": POINTS.astype(">f8"),
            "list": POINTS.tolist(), "masked": np.ma.masked_array(POINTS)}


@pytest.mark.parametrize("name", layouts())
def test_layouts_give_the_same(name):
    assert pcl_slim.smooth(layouts()[name]).tobytes() == SMOOTH.tobytes()


def test_rows_in_reverse():
    # Ties of equal keys follow the order of the points, so bytes may differ; the surface may not.
    assert np.abs(pcl_slim.smooth(POINTS[::-1])[::-1] - SMOOTH).max() < 1e-3


def test_broadcast_and_overlapping_rows():
    with pytest.raises(pcl_slim.NoSurfaceError):
        pcl_slim.fit(np.broadcast_to(np.ones(3), (1000, 3)))
    overlapping = np.lib.stride_tricks.as_strided(np.arange(3002.0), (3000, 3), (8, 8))
    with pytest.raises(RuntimeError):
        pcl_slim.fit(overlapping)  # one line


def test_floats_stay_floats():
    got = pcl_slim.smooth(POINTS.astype(np.float32))
    assert got.dtype == np.float32 and np.abs(got - SMOOTH).max() < 1e-3


def test_rows_with_nan_stay():
    points = POINTS.copy()
    points[::10, 1] = np.nan
    points[5] = np.inf
    got = pcl_slim.smooth(points)
    np.testing.assert_array_equal(got[::10], points[::10])
    assert np.all(np.isinf(got[5])) and got.shape == points.shape
    whole = pcl_slim.curvature(points)
    assert np.all(np.isnan(whole.k1[::10])) and np.isfinite(whole.k1[1])
    assert pcl_slim.fit(points).statistics["non_finite"] == 301
    masked = np.ma.masked_array(POINTS, np.zeros(POINTS.shape, bool))
    masked[::10, 1] = np.ma.masked
    assert pcl_slim.fit(masked).statistics["non_finite"] == 300
    surface = pcl_slim.fit(POINTS)
    nothing = surface.project(np.full((4, 3), np.nan))
    assert np.all(nothing.side == 0) and np.all(np.isnan(nothing.positions))


def test_inputs_are_not_changed():
    points, normals = POINTS.copy(), DIRECTIONS.copy()
    pcl_slim.fit(points, normals)
    pcl_slim.smooth(points, normals)
    assert points.tobytes() == POINTS.tobytes() and normals.tobytes() == DIRECTIONS.tobytes()


BAD_POINTS = [np.zeros((5, 2)), np.zeros((5, 4)), np.zeros(7), np.zeros((2, 3, 3)), np.zeros((5, 3), int),
              np.zeros((5, 3), complex), np.zeros((5, 3), object), np.zeros((5, 3), bool), np.zeros((5, 3), np.float16),
              np.zeros((5, 3), np.longdouble), np.zeros((5, 3), "U3"), np.zeros((5, 3), "M8[s]"), np.zeros((0, 3)), [], {},
              None, "points", 3.5, np.full((9, 3), np.nan), np.float64(1), [[1, 2], [3]], np.zeros(3, [("x", "f4"), ("y", "f4")]),
              np.zeros((3, 3), [("x", "f4"), ("y", "f4"), ("z", "f4")]), np.zeros(4, [("x", "U2"), ("y", "f4"), ("z", "f4")]),
              np.broadcast_to(np.ones(3), (1 << 33, 3))]


@pytest.mark.parametrize("bad", BAD_POINTS, ids=lambda bad: str(getattr(bad, "dtype", type(bad)))[:20])
def test_bad_points(bad):
    surface = pcl_slim.fit(POINTS)
    for function in (pcl_slim.fit, pcl_slim.smooth, pcl_slim.splats, pcl_slim.lines, pcl_slim.normals):
        with pytest.raises(ValueError) as error:
            function(bad)
        sentence = str(error.value)
        assert "\n" not in sentence and len(sentence) > 20 and ":" in sentence, sentence
    try:
        surface.project(bad)
    except ValueError:
        pass


@pytest.mark.parametrize("keywords", [
    {"threads": 100000}, {"threads": -1}, {"threads": 1.5}, {"threads": "two"}, {"degree": 7}, {"degree": "four"},
    {"noise": -1}, {"noise": float("nan")}, {"noise": 1, "lambda_": 1e-6}, {"penalty": 0}, {"penalty": 1, "target_error": 0.1},
    {"viewpoint": (1, 2)}, {"viewpoint": "here"}, {"viewpoint": (1, 2, float("inf"))}, {"sharp": "yes"}, {"max_surfels": 2.5},
    {"max_surfels": -3}, {"normals": np.zeros((3, 3))}, {"normals": np.zeros((3000, 2))}, {"colors": np.zeros((3000, 2))},
    {"colors": np.zeros((2, 3))}, {"colors": "red"}, {"sensors": np.zeros((1, 3))}, {"frames": np.zeros(2)},
    {"frames": np.full(3000, -1)}, {"frames": np.full(3000, 0.5)}, {"progress": 3}, {"hole": 1}, {"noise_model": (1, 2)},
    {"viewpoint": (0, 0, 1), "sensors": np.zeros((3000, 3))}, {"seed": 1e30}, {"compact": "x"}],
    ids=lambda keywords: "-".join(keywords))
def test_bad_options(keywords):
    with pytest.raises(ValueError) as error:
        pcl_slim.fit(POINTS, **keywords)
    assert "\n" not in str(error.value) and len(str(error.value)) > 20


def test_unknown_options_are_named():
    with pytest.raises(TypeError, match="has no option 'degre': it takes compact, correlation, degree"):
        pcl_slim.fit(POINTS, degre=3)
    with pytest.raises(TypeError):
        pcl_slim.smooth(POINTS, trim=False)
    with pytest.raises(ValueError, match="penalty is of a fit"):
        pcl_slim.smooth(POINTS, surface=pcl_slim.fit(POINTS), penalty=4)


def test_other_errors(tmp_path):
    surface = pcl_slim.fit(POINTS)
    with pytest.raises(OSError, match="missing.slim"):
        pcl_slim.load(tmp_path / "missing.slim")
    (tmp_path / "text.slim").write_text("no surface")
    with pytest.raises(ValueError):
        pcl_slim.load(tmp_path / "text.slim")
    with pytest.raises(OSError):
        surface.save(tmp_path / "no folder" / "a.slim")
    with pytest.raises(ValueError, match="another cloud"):
        surface.smooth(POINTS + 100)
    with pytest.raises(pcl_slim.NoSurfaceError):
        pcl_slim.fit(np.linspace([0, 0, 0], [1, 1, 1], 1000))
    with pytest.warns(RuntimeWarning, match="nowhere a surface"):
        line = np.linspace([0, 0, 0], [1, 1, 1], 1000)
        np.testing.assert_array_equal(pcl_slim.smooth(line), line)
    for bad in ({"mode": "wood"}, {"size": (0, 10)}, {"size": (10, 99999)}, {"camera": "under"}, {"camera": (1, 2, 3)},
                {"range": (2, 1)}, {"up": "w"}, {"lines": 3}, {"mode": "color"}, {"aa": 100}, {"fov": 0}):
        with pytest.raises(ValueError):
            surface.render(**bad)
    for bad in ({}, {"spacing": 1, "number": 3}, {"spacing": -1}, {"number": 1e30}):
        with pytest.raises(ValueError):
            surface.sample(**bad)
    for bad in ({"sharp": 3}, {"tolerance": -1}, {"relax": 1000}):
        with pytest.raises(ValueError):
            surface.mesh(**bad)
    red = np.full((len(POINTS), 3), [255, 0, 0], np.uint8)
    for bad in ((POINTS, None), (POINTS, red[:5]), (POINTS, red, DIRECTIONS[:5]), (POINTS + 100, red), (POINTS[:0], red[:0])):
        with pytest.raises(ValueError, match=r"^[^\n]{10,}:[^\n]+$"):
            surface.paint(*bad)
    with pytest.raises(TypeError, match="takes threads"):
        surface.paint(POINTS, red, progress=print)
    with pytest.raises(ValueError):
        pcl_slim.Camera((0, 0, 0), (0, 0, 0))
    with pytest.raises(ValueError):
        pcl_slim.save_picture(tmp_path / "a.png", np.zeros((3, 3)))


def test_hostile_arrays():
    random = np.random.default_rng(7)
    types = ["f4", "f8", "f2", "i4", "u1", "c16", "O", "?", ">f4", "U2", "M8[D]"]
    for _ in range(300):
        shape = tuple(random.integers(0, 5, random.integers(0, 4)))
        array = np.zeros(shape, dtype=types[random.integers(len(types))])
        if array.size and array.dtype.kind == "f":
            array[...] = random.choice([0, 1, np.nan, np.inf, 1e4, 1e-7], shape)
        for arguments in ((array,), (POINTS[:50], array), (POINTS[:50], None, array)):
            try:
                pcl_slim.fit(*arguments, max_surfels=5)
            except (ValueError, RuntimeError) as error:
                assert "\n" not in str(error)


def test_arrays_are_not_copied():
    wide = np.zeros((200000, 4))
    wide[:, :3] = sphere(200000)[0]
    tracemalloc.start()
    pcl_slim.fit(wide[:, :3])
    fit = tracemalloc.get_traced_memory()[1]
    tracemalloc.reset_peak()
    smoothed = pcl_slim.smooth(wide[:, :3])
    smooth = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert fit < 100000 and smooth < smoothed.nbytes + 100000


MEMORY = """
import numpy as np, re, sys
import pcl_slim
points = np.full((2000000, 4), np.nan)[:, :3] if sys.argv[1] == "rows" else np.full((3, 2000000), np.nan).T
def status(name):
    with open("/proc/self/status") as file:
        return int(re.search(name + r":\\s*(\\d+)", file.read())[1]) / 1024
with open("/proc/self/clear_refs", "w") as file:
    file.write("5")  # the peak is that from here on
before = status("VmRSS")
try:
    pcl_slim.fit(points)
except ValueError:
    print(status("VmHWM") - before)
"""


@pytest.mark.skipif(not os.path.exists("/proc/self/clear_refs"), reason="peaks of memory are Linux's")
def test_memory_of_the_process():
    """Points that all are NaN are read, and nothing is stored of them: what is taken is a copy of the input."""
    taken = {}
    for layout in ("rows", "columns"):
        done = subprocess.run([sys.executable, "-c", MEMORY, layout], stdout=subprocess.PIPE, check=True)
        taken[layout] = float(done.stdout)
    size = 2000000 * 24 / 2**20
    assert taken["columns"] > 0.8 * size  # this layout is copied
    assert taken["rows"] < taken["columns"] - 0.8 * size
