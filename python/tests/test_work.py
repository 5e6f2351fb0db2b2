# SPDX-License-Identifier: BSD-3-Clause
"""Threads, Ctrl-C, progress, forks and pickles."""
import concurrent.futures
import copy
import multiprocessing
import pickle
import subprocess
import sys
import threading

import numpy as np
import pytest
from conftest import bumps

import pcl_slim

POINTS, COLORS = bumps(20000)


def everything(threads=0):
    """Bytes of all results."""
    surface = pcl_slim.fit(POINTS, colors=COLORS, threads=threads)
    parts = [pickle.dumps(surface.leaves), pcl_slim.smooth(POINTS, threads=threads).tobytes()]
    parts += [column.tobytes() for column in surface.project(POINTS, threads=threads)]
    parts += [column.tobytes() for column in pcl_slim.normals(POINTS, threads=threads)]
    mesh = surface.mesh(tolerance=0.01, threads=threads)
    parts += [mesh.vertices.tobytes(), mesh.triangles.tobytes(), mesh.colors.tobytes()]
    parts += [surface.render(size=(60, 40), threads=threads).tobytes(), surface.to_html(threads=threads).encode()]
    parts += [surface.sample(number=500, threads=threads).positions.tobytes()]
    parts += [pcl_slim.splats(POINTS, COLORS, max_splats=1000, threads=threads).positions.tobytes()]
    parts += [surface.lines(POINTS, threads=threads).positions.tobytes()]
    return parts


@pytest.fixture(scope="module")
def expected():
    return everything()


def test_number_of_threads_changes_nothing(expected):
    assert everything(1) == expected and everything(3) == expected


def test_eight_threads_at_once(expected):
    with concurrent.futures.ThreadPoolExecutor(8) as pool:
        assert all(got == expected for got in pool.map(lambda _: everything(), range(8)))


def test_threads_share_a_surface():
    surface = pcl_slim.fit(POINTS)
    alone = [surface.render(size=(60, 40)).tobytes(), surface.smooth(POINTS).tobytes()]
    with concurrent.futures.ThreadPoolExecutor(8) as pool:
        for got in pool.map(lambda _: [surface.render(size=(60, 40)).tobytes(), surface.smooth(POINTS).tobytes()], range(8)):
            assert got == alone


def test_other_threads_run_meanwhile():
    counts, running = [0], [True]

    def count():
        while running[0]:
            counts[0] += 1
    thread = threading.Thread(target=count)
    thread.start()
    before = counts[0]
    pcl_slim.smooth(bumps(60000)[0])
    during = counts[0] - before
    running[0] = False
    thread.join()
    assert during > 1000


def test_progress():
    calls = []
    pcl_slim.smooth(bumps(100000)[0], threads=1, progress=lambda share, stage: calls.append((share, stage)))
    shares = [share for share, _ in calls]
    assert shares == sorted(shares) and shares[-1] == 1.0 and 0 <= shares[0] <= 1
    assert len(calls) > 1 and all(isinstance(stage, str) and stage for _, stage in calls)


def test_what_progress_raises_ends_the_work():
    class Enough(Exception):
        pass

    def stop(share, stage):
        raise Enough(stage)
    for function in (pcl_slim.fit, pcl_slim.smooth, pcl_slim.splats):
        with pytest.raises(Enough):
            function(POINTS, progress=stop)
    assert len(pcl_slim.fit(POINTS)) > 10


INTERRUPTED = """
import os, signal, threading, time
import numpy as np
import conftest, pcl_slim
points = conftest.bumps(500000)[0]
signal.signal(signal.SIGINT, signal.default_int_handler)  # shells start jobs in the background without it
for share in (.1, .6):
    began = []
    def interrupt():
        time.sleep(share)
        began.append(time.monotonic())
        os.kill(os.getpid(), signal.SIGINT)
    thread = threading.Thread(target=interrupt)
    thread.start()
    try:
        while True:
            pcl_slim.smooth(points, threads=1)
    except KeyboardInterrupt:
        print(time.monotonic() - began[0])
    thread.join()
pcl_slim.smooth(points[:5000])
surface = pcl_slim.fit(points[:20000])
threading.Thread(target=lambda: (time.sleep(.3), began.append(time.monotonic()), os.kill(os.getpid(), signal.SIGINT))).start()
try:
    while True:
        surface.render(size=(1000, 800), aa=4, threads=1)  # nothing in a picture looks for the end
except KeyboardInterrupt:
    print(time.monotonic() - began[-1], flush=True)
pcl_slim.smooth(points[:5000])
"""


def test_ctrl_c_ends_work():
    done = subprocess.run([sys.executable, "-c", INTERRUPTED], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          cwd=__file__.rpartition("/")[0], check=False, timeout=120)
    assert done.returncode == 0, done.stderr.decode()
    waits = [float(line) for line in done.stdout.split()]
    assert len(waits) == 3, "each loop ended by Ctrl-C alone"


def fit_leaves(_):
    return pickle.dumps(pcl_slim.fit(POINTS).leaves)


def test_forked_processes():
    expected = fit_leaves(0)
    with multiprocessing.get_context("fork").Pool(2) as pool:
        assert pool.map_async(fit_leaves, range(2)).get(timeout=60) == [expected, expected]


def test_pickles_and_copies(tmp_path):
    surface = pcl_slim.fit(POINTS, colors=COLORS)
    for other in (pickle.loads(pickle.dumps(surface)), copy.deepcopy(surface), copy.copy(surface)):
        assert repr(other) == repr(surface) and other.statistics == surface.statistics and other.notes == surface.notes
        np.testing.assert_array_equal(other.leaves, surface.leaves)
        assert other.render(size=(60, 40)).tobytes() == surface.render(size=(60, 40)).tobytes()
    surface.save(tmp_path / "a.slim")
    np.testing.assert_array_equal(pcl_slim.load(str(tmp_path / "a.slim")).leaves, surface.leaves)
    surface.save(tmp_path / "b.slim", quantize=0.1)
    assert (tmp_path / "b.slim").stat().st_size < (tmp_path / "a.slim").stat().st_size / 2
    with pytest.raises(ValueError):
        pcl_slim.Surface.__new__(pcl_slim.Surface).__setstate__((b"no surface", [], {}))


def test_arrays_outlive_what_they_are_of():
    def vertices():
        return pcl_slim.fit(POINTS).mesh(tolerance=0.01).vertices
    got = vertices()
    kept = got.copy()
    del got
    again = vertices()
    np.testing.assert_array_equal(again, kept)
    mesh = pcl_slim.fit(POINTS).mesh(tolerance=0.01)
    mesh.vertices[:] = 7  # views, as other packages want them
    mesh.triangles[0] = 1 << 30
    assert np.all(mesh.vertices == 7)
    with pytest.raises(ValueError):
        mesh.render()
    mesh.triangles[0] = 1
    mesh.vertices[0] = np.nan
    with pytest.raises(ValueError):
        mesh.render()
    splats = pcl_slim.splats(POINTS, max_splats=500)
    splats.radius[0] = np.nan
    for draw in (splats.render, splats.to_html):
        with pytest.raises(ValueError):
            draw()
    lines = pcl_slim.lines(POINTS)
    lines.positions[0] = np.nan
    pcl_slim.fit(POINTS).render(size=(60, 40), lines=lines)
    with pytest.raises(ValueError):
        lines.offsets[0] = 7  # which would be used as an index
