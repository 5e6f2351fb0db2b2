# SPDX-License-Identifier: BSD-3-Clause
"""Finds what changed between two scans: signed distances of the second one, smoothed, from the surface of the first."""
import sys

import numpy as np
import pcl_slim
from vase import vase

before, _ = vase(seed=1)
after, _ = vase(seed=2, dent=0.006)
surface = pcl_slim.fit(before)
found = surface.project(pcl_slim.smooth(after), reach=0.5)  # places that may be off the surface
change = found.side * found.distance  # + outside, - inside
print("%d of %d points are more than 3 mm inside" % (np.sum(change < -0.003), len(after)))

share = np.clip(np.nan_to_num(change) / 0.006, -1, 1)
colors = np.stack([1 + np.minimum(share, 0), 1 - np.abs(share), 1 - np.maximum(share, 0)], axis=1)
picture = pcl_slim.fit(after, colors=colors).render((20, 10), size=(300, 400), white=True)
pcl_slim.save_picture((sys.argv + ["compare.png"])[1], picture)
