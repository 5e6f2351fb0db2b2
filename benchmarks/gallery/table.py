# SPDX-License-Identifier: BSD-3-Clause
"""The table of docs/gallery.md from what scripts/gallery.sh left: python3 table.py OUT SCAN..."""
import json
import os
import sys

RUNS = {
    "surface": "pcl_slim, surface",
    "mesh": "pcl_slim, mesh",
    "tutorial": "Open3D, Poisson",
    "tuned": "Open3D, Poisson, tuned",
    "pivoting": "Open3D, ball pivoting",
    "cgal_tutorial": "CGAL, Poisson",
    "cgal_scale_space": "CGAL, scale space",
    "normals": "CloudCompare, normals",
}


def load(path):
    if not os.path.exists(path):
        return None
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def count(number):
    return f"{number / 1000:.0f}K" if number >= 1000 else str(number)


def row(folder, run, name):
    timed = load(os.path.join(folder, run + ".json"))
    if not timed or timed["state"] != "done":
        return f"| {name} | {timed['state'] if timed else '–'} |" + " |" * 8
    cells = [name, f"{timed['cpu']:.0f}" if timed["cpu"] >= 10 else f"{timed['cpu']:.1f}", f"{timed['mb']:,}"]
    m = load(os.path.join(folder, run + ".measures.json"))
    if not m:
        return "| " + " | ".join(cells + ["–"] * 7) + " |"
    cells += [count(m["triangles"]), f"{m['rms']:.2f}", f"{m['lost']:.1f}", f"{m['invented']:.1f}", f"{m['angle']:.1f}",
              f"{m['pieces']:,}", f"{count(m['border'])}, {count(m['nonmanifold'])}"]
    return "| " + " | ".join(cells) + " |"


def main():
    out = sys.argv[1]
    for scan in sys.argv[2:]:
        folder = os.path.join(out, scan)
        if not os.path.isdir(folder):
            continue
        print(f"**{scan}**\n\n| | CPU s | MB | triangles | RMS | lost % | invented % | angle ° | pieces | border, non-manifold |")
        print("|---|---|---|---|---|---|---|---|---|---|")
        for run, name in RUNS.items():
            print(row(folder, run, name))
        truths = {name: load(os.path.join(folder, run + ".measures.json")) for run, name in RUNS.items()}
        truths = [f"{name} {m['truth']:.3f}" for name, m in truths.items() if m and "truth" in m]
        if truths:
            print("\nRMS distance from the reference mesh, spacings: " + ", ".join(truths) + ".")
        print()


main()
