# SPDX-License-Identifier: BSD-3-Clause
"""Fits a surface to a scan and draws it: points, surface, mean curvature."""
import sys

import numpy as np
import pcl_slim
from vase import picture_of_points, vase

points, _ = vase()
surface = pcl_slim.fit(points)
print(surface)

size = (300, 400)
pictures = [picture_of_points(points, size), surface.render((30, 15), size=size, white=True),
            surface.render((30, 15), mode="mean", range=40, size=size, white=True)]
pcl_slim.save_picture((sys.argv + ["fit.png"])[1], np.hstack(pictures))
