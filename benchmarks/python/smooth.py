# SPDX-License-Identifier: BSD-3-Clause
"""Smoothing from Python beside pcl_slim_smooth: time, memory, and whether the results are the same.

    python3 benchmarks/python/smooth.py BIN_DIR PACKAGE_DIR [POINTS [RUNS]]

Runs alternate; the table has the medians. A run of the program reads and writes a file, one of Python makes its points
in memory, before the clock, from the same numbers. The times of the work alone are those of the program's report and of
the call. Memory is the peak of a call above what the process had before it, in bytes a point.
"""
import json
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time

CALL = r"""
import json, re, resource, sys, time
import numpy as np
import pcl_slim

def status(name):
    with open("/proc/self/status") as file:
        return 1024 * int(re.search(name + r":\s*(\d+)", file.read())[1])

points = np.load(sys.argv[1])
with open("/proc/self/clear_refs", "w") as file:
    file.write("5")
before, cpu, wall = status("VmRSS"), time.process_time(), time.perf_counter()
smoothed = pcl_slim.smooth(points)
wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
print(json.dumps({"wall": wall, "cpu": cpu, "bytes": (status("VmHWM") - before) / len(points)}))
np.save(sys.argv[2], smoothed)
"""


def bumps(count):
    import numpy as np
    random = np.random.default_rng(1)
    directions = random.normal(size=(count, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    x, y, z = directions.T
    radius = 1 + 0.1 * np.sin(5 * x) * np.sin(5 * y) * np.cos(5 * z) + 0.003 * random.normal(size=count)
    return (directions * radius[:, None]).astype(np.float32)


def run_program(bin_dir, folder):
    before, wall = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    subprocess.run([os.path.join(bin_dir, "pcl_slim_smooth"), "scan.pcd", "smooth.pcd", "-quiet", "1", "-json", "smooth.json"],
                   cwd=folder, check=True)
    wall, after = time.perf_counter() - wall, resource.getrusage(resource.RUSAGE_CHILDREN)
    with open(os.path.join(folder, "smooth.json"), encoding="utf-8") as file:
        report = json.load(file)
    seconds = report["seconds"]
    return {"wall": wall, "cpu": after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime,
            "work": seconds["prepare"] + seconds["fit"] + seconds["project"], "rss": report["peak_rss_mb"]}


def main():
    import numpy as np
    bin_dir, package = (os.path.abspath(folder) for folder in sys.argv[1:3])
    count, runs = (int(float(number)) for number in sys.argv[3:] + ["1e6", "5"][len(sys.argv) - 3:])
    points = bumps(count)
    with tempfile.TemporaryDirectory() as folder:
        with open(os.path.join(folder, "scan.pcd"), "wb") as file:
            file.write(("VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH %d\nHEIGHT 1\n"
                        "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS %d\nDATA binary\n" % (count, count)).encode() + points.tobytes())
        np.save(os.path.join(folder, "scan.npy"), points)
        environment = dict(os.environ, PYTHONPATH=package)
        programs, calls = [], []
        for _ in range(runs):
            programs.append(run_program(bin_dir, folder))
            done = subprocess.run([sys.executable, "-c", CALL, "scan.npy", "smooth.npy"], cwd=folder, env=environment,
                                  stdout=subprocess.PIPE, check=True)
            calls.append(json.loads(done.stdout))
        with open(os.path.join(folder, "smooth.pcd"), "rb") as file:
            same = file.read().partition(b"DATA binary\n")[2] == np.load(os.path.join(folder, "smooth.npy")).tobytes()
    median = lambda rows, key: statistics.median(row[key] for row in rows)
    print("| %d points | wall [s] | work alone [s] | CPU [s] | memory |" % count)
    print("|---|---|---|---|---|")
    print("| `pcl_slim_smooth` | %.2f | %.2f | %.2f | %.0f MB in all |" % (
        median(programs, "wall"), median(programs, "work"), median(programs, "cpu"), median(programs, "rss")))
    print("| `pcl_slim.smooth` | %.2f | %.2f | %.2f | %.0f bytes a point above the input |" % (
        median(calls, "wall"), median(calls, "wall"), median(calls, "cpu"), median(calls, "bytes")))
    print("| ratio | %.2f | %.2f | %.2f | results %s |" % (
        median(calls, "wall") / median(programs, "wall"), median(calls, "wall") / median(programs, "work"),
        median(calls, "cpu") / median(programs, "cpu"), "equal to the last bit" if same else "DIFFER"))


if __name__ == "__main__":
    main()
