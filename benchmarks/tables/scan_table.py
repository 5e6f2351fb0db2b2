#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Prints the tables of benchmarks/README.md from the reports that scan_table.sh leaves in a folder."""
import glob
import json
import math
import os
import sys

# Leaves per point of quadratic fits by an earlier prototype: what the project must not exceed by
# more than 10 %.
REFERENCE = {
    "stanford_bunny_raw_scans": .064, "lion_takanawa": .143, "lone_star_geyser_tls": .164,
    "autzen_stadium": .067, "terrain_isprs_csite1_utm": .191, "kinect_mosd_learn13": .113,
    "stanford_dragon_res2": .226, "armadillo_50k": .251, "angel_real_scan": .178,
}


def load(folder, kind):
    """Reports of a kind by scan; of several repeats the one with the fastest fit."""
    reports = {}
    for path in sorted(glob.glob(os.path.join(glob.escape(folder), f"*.{kind}.*.json"))):
        name = os.path.basename(path).split(f".{kind}.")[0]
        with open(path, encoding="utf-8") as file:
            report = json.load(file)
        if name not in reports or fit_seconds(report) < fit_seconds(reports[name]):
            reports[name] = report
    return reports


def fit_seconds(report):
    return report["seconds"]["prepare"] + report["seconds"]["fit"]


def leaves_per_point(report):
    """Of the points kept: finite, distinct, with a normal where others have one."""
    return report["leaves"] / report["stored_points"]


def print_row(cells):
    print("| " + " | ".join(str(cell) for cell in cells) + " |")


def print_header(cells):
    print_row(cells)
    print("|---" * len(cells) + "|")


def with_reference(stem, report):
    reference = REFERENCE.get(stem)
    if report is None:
        return "–"
    if reference is None:
        return f"{leaves_per_point(report):.3f}"
    change = leaves_per_point(report) / reference - 1
    return f"{leaves_per_point(report):.3f} ({change:+.0%} of {reference})"


def default_table(reports, quadratic):
    print_header(["scan", "points", "normals", "leaves", "leaves/pt", "degree 2: leaves/pt",
                  "levels", "√λ / L", "RMS / L", "uncovered", "unsupported", "µs/pt", "peak MB"])
    for name, r in sorted(reports.items(), key=lambda item: -item[1]["stored_points"]):
        stem = os.path.splitext(name)[0]
        print_row([stem, f"{r['stored_points']:,}", r["normals"], f"{r['leaves']:,}",
                   with_reference(stem, r), with_reference(stem, quadratic.get(name)),
                   f"{r['first_level']}–{r['last_level']}",
                   f"{math.sqrt(r['lambda']):.1e}", f"{r['rms_error_over_diagonal']:.1e}",
                   r["uncovered"], r["unsupported"],
                   f"{1e6 * fit_seconds(r) / r['stored_points']:.2f}", f"{r['peak_rss_mb']:.0f}"])


def paper_table(folder):
    degrees = [load(folder, f"paper{degree}") for degree in (1, 2, 3)]
    print_header(["scan", "points", "degree 1", "degree 2", "degree 3", "uncovered",
                  "RMS / L, degree 2"])
    for name in sorted(degrees[1], key=lambda key: -degrees[1][key]["stored_points"]):
        rows = [reports[name] for reports in degrees if name in reports]
        if len(rows) < 3:
            continue
        print_row([os.path.splitext(name)[0], f"{rows[0]['stored_points']:,}"]
                  + [f"{leaves_per_point(r):.3f}" for r in rows]
                  + [", ".join(str(r["uncovered"]) for r in rows),
                     f"{rows[1]['rms_error_over_diagonal']:.1e}"])


def main():
    if len(sys.argv) != 2 or not os.path.isdir(sys.argv[1]):
        sys.exit("scan_table.py wants the folder that scan_table.sh filled")
    reports = load(sys.argv[1], "default")
    if not reports:
        sys.exit(f"no reports in {sys.argv[1]}: run scan_table.sh first")
    print("Defaults:\n")
    default_table(reports, load(sys.argv[1], "degree2"))
    print("\nPaper mode, T .02, leaves per point:\n")
    paper_table(sys.argv[1])


if __name__ == "__main__":
    main()
