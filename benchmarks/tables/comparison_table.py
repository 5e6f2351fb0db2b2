#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Prints the tables of benchmarks/README.md from the .csv files comparison.sh leaves in a folder."""
import csv
import math
import os
import sys


def load(folder, stage):
    path = os.path.join(folder, stage + ".csv")
    if not os.path.exists(path):
        return []
    with open(path, encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def number(row, key):
    return float(row[key]) if row[key] else math.nan


def short(value):
    return "" if math.isnan(value) else f"{value:.2g}"


def print_table(title, header, rows):
    if not rows:
        return
    print(f"\n{title}\n")
    for cells in [header, ["---"] * len(header)] + rows:
        print("| " + " | ".join(str(cell) for cell in cells) + " |")


def scenes(rows):
    """Rows by scene, noise and number of points, in the order met."""
    found = {}
    for row in rows:
        found.setdefault((row["scene"], row["noise"], row["points"]), []).append(row)
    return found


def noise_text(noise):
    return "none" if float(noise) == 0 else f"{100 * float(noise):g} %"


def best(rows, key):
    known = [row for row in rows if not math.isnan(number(row, key))]
    return min(known, key=lambda row: number(row, key), default=None)


def of(rows, method, setting=None, normals=None):
    return [row for row in rows if row["method"] == method
            and (setting is None or row["setting"] == setting)
            and (normals is None or row["normals"] == normals)]


def ratio_table(rows, title):
    """CPU of MLS order 2 at its best radius over that of SLIM where it is no less accurate."""
    table = []
    for (scene, noise, points), runs in scenes(rows).items():
        rival = best([row for row in of(runs, "mls") if row["setting"].startswith("order 2")],
                     "rms_position")
        for normals in ("0", "1"):
            ours = of(runs, "slim", normals=normals)
            if not rival or not ours:
                continue
            bound = number(rival, "rms_position")
            cheapest = best([row for row in ours if number(row, "rms_position") <= bound],
                            "cpu_us_per_point")
            cells = [scene, f"{int(points):,}", noise_text(noise),
                     f"{rival['setting'][10:]}, {short(bound)}, {rival['cpu_us_per_point']}",
                     "given" if normals == "1" else "none"]
            for run in (cheapest, of(ours, "slim", "default")[0]):
                if run is None:
                    cells += ["none", ""]
                    continue
                ratio = number(rival, "cpu_us_per_point") / number(run, "cpu_us_per_point")
                name = run["setting"] + ": " if run is cheapest else ""
                cells += [f"{name}{short(number(run, 'rms_position'))}, {run['cpu_us_per_point']}",
                          f"{ratio:.3g}" if number(run, "rms_position") <= bound else "above"]
            table.append(cells)
    print_table(title, ["scene", "points", "noise", "MLS order 2: k, RMS, µs/pt", "normals",
                        "cheapest SLIM no worse: RMS, µs/pt", "ratio", "default: RMS, µs/pt",
                        "ratio"], table)


ERRORS = ("rms_position", "rms_normal_deg", "mean_curvature_error")


def errors_of(row):
    return " ".join(short(number(row, key)) for key in ERRORS)


def error_table(rows):
    """Position, normal and curvature errors, each at its own best setting."""
    table = []
    for (scene, noise, points), runs in scenes(rows).items():
        def least(method):
            return " ".join(short(min((number(row, key) for row in of(runs, method)
                                       if not math.isnan(number(row, key))), default=math.nan))
                            for key in ERRORS)
        table.append([scene, noise_text(noise),
                      errors_of(of(runs, "slim", "default", "0")[0]),
                      errors_of(of(runs, "slim", "default", "1")[0]), least("slim"), least("mls")])
    print_table("Errors: position, normal in degrees, mean curvature",
                ["scene", "noise", "default, no normals", "default, normals",
                 "best of sweep, either", "best of MLS"], table)


def scan_table(rows, title):
    table = []
    for (scene, _, _), runs in scenes(rows).items():
        def add(name, row):
            if row is not None:
                table.append([scene, name] + [f"{number(row, key):.3g}" if row[key] else ""
                                              for key in ("rms_position", "rms_normal_deg",
                                                          "cpu_us_per_point")])
        for normals, words in (("0", "no normals"), ("1", "normals")):
            for setting in ("default", "robust", "robust compact", "sharp"):
                for row in of(runs, "slim", setting, normals)[:1]:
                    add(f"{setting}, {words}", row)
        for normals, words in (("0", "without"), ("1", "with")):
            row = best(of(runs, "slim", normals=normals), "rms_position")
            add(f"best SLIM {words} normals: {row['setting']}" if row else "", row)
        for key, words in (("rms_position", "position"), ("rms_normal_deg", "normals")):
            row = best(of(runs, "mls"), key)
            add(f"best MLS by {words}: {row['setting']}" if row else "", row)
    print_table(title, ["scan", "run", "RMS", "normal °", "CPU µs/pt"], table)


def main():
    if len(sys.argv) != 2 or not os.path.isdir(sys.argv[1]):
        sys.exit("comparison_table.py wants the folder that comparison.sh filled")
    folder = sys.argv[1]
    ratio_table(load(folder, "timed"),
                "CPU time at equal or lower RMS position error, 100,000 points")
    ratio_table(load(folder, "timed438"), "The same, 438,000 points")
    ratio_table(load(folder, "noisy"), "The same under noise, without normals, fewer settings")
    ratio_table(load(folder, "sizes"), "By number of points")
    error_table(load(folder, "exact"))
    scan_table(load(folder, "pairs"), "Scans with a clean original, lengths in mean edges")
    scan_table(load(folder, "bunny"), "Raw scans against a mesh, lengths in metres")


if __name__ == "__main__":
    main()
