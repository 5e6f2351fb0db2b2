# SPDX-License-Identifier: BSD-3-Clause
"""Saves a surface, loads it again and writes it as a page for browsers."""
import os
import sys

import pcl_slim
from vase import vase

folder = (sys.argv + ["."])[1]
points, colors = vase()
surface = pcl_slim.fit(points, colors=colors, progress=lambda share, stage: print("%3.0f %%  %s" % (100 * share, stage)))
surface.save(os.path.join(folder, "vase.slim"), quantize=0.1)
surface = pcl_slim.load(os.path.join(folder, "vase.slim"))
surface.to_html(os.path.join(folder, "vase.html"), title="vase", unit="m")
for name in ("vase.slim", "vase.html"):
    print(name, os.path.getsize(os.path.join(folder, name)), "bytes")
