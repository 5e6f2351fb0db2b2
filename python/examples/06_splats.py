# SPDX-License-Identifier: BSD-3-Clause
"""Thins a coloured scan to discs: of its points, and of even samples of its surface, which have no noise."""
import sys

import pcl_slim
from vase import vase

points, colors = vase()
of_points = pcl_slim.splats(points, colors, max_splats=6000)
even = pcl_slim.fit(points, colors=colors).sample(spacing=0.002)
splats = pcl_slim.splats(even.positions, even.colors, even.normals, max_splats=6000)
print(of_points)
print(splats)
print("the largest is %.4f m" % splats.radius.max())
pcl_slim.save_picture((sys.argv + ["splats.png"])[1], splats.render((30, 15), size=(300, 400), white=True))
