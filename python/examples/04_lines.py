# SPDX-License-Identifier: BSD-3-Clause
"""Traces ridges (blue) and ravines (red) and draws them over the surface."""
import sys

import pcl_slim
from vase import vase

points, _ = vase()
surface = pcl_slim.fit(points)
lines = surface.lines(points, significance=4)
print(lines)
print("the longest is %.2f m" % lines.length.max(), "and has", len(lines[int(lines.length.argmax())]), "vertices")
pcl_slim.save_picture((sys.argv + ["lines.png"])[1], surface.render((30, 15), size=(300, 400), white=True, lines=lines))
