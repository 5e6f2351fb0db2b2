# SPDX-License-Identifier: BSD-3-Clause
"""Makes a table of what borders_bench printed about scans: borders_scans.py FILE"""
import re
import sys

HEAD = ["scan", "overshoot %", "loss %", "leaves open", "maps, µs/pt", "fit, µs/pt", "floating pieces", "mesh: triangles",
        "components", "border edges", "loops", "zero area", "overshoot %", "floating %"]

with open(sys.argv[1], encoding="utf-8") as file:
    text = file.read()

print("| " + " | ".join(HEAD) + " |")
print("|" + "---|" * len(HEAD))
for part in re.split(r"\n(?! )", text.strip()):
    def find(pattern):
        found = re.search(pattern, part)
        return found.groups() if found else ("",) * re.compile(pattern).groups

    name, opened = find(r"([^/:]+): .*leaves, ([\d.]+) open")
    maps, fit = find(r"maps ([\d.-]+) us/pt CPU \(fit ([\d.]+)\)")
    over, loss = find(r"overshoot ([\d.]+ -> [\d.]+) %, loss ([\d.]+ -> [\d.]+) %")
    pieces, = find(r"floating: (\d+ -> \d+) pieces")
    mesh = find(r"mesh: (\d+) triangles.* (\d+) components, (\d+) border edges, (\d+) loops.*closed, (\d+) of zero area, "
                r"overshoot ([\d.]+) %, floating ([\d.]+) %")
    row = [name, over, loss, opened, maps, fit, pieces, *mesh]
    print("| " + " | ".join(row).replace("->", "→") + " |")
