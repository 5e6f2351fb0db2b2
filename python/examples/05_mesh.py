# SPDX-License-Identifier: BSD-3-Clause
"""Makes a triangle mesh and even samples of a surface, and writes the mesh as OBJ."""
import sys

import numpy as np
import pcl_slim
from vase import vase

points, colors = vase()
surface = pcl_slim.fit(points, colors=colors)
mesh = surface.mesh(tolerance=0.0005)
print(mesh)
print("area %.4f m2; %d border loop" % (mesh.statistics["area"], mesh.statistics["border_loops"]))
even = surface.sample(spacing=0.004)
print("%d even samples" % len(even.positions))

picture, file = sys.argv[1:] + ["mesh.png", "vase.obj"][len(sys.argv) - 1:]
pcl_slim.save_picture(picture, mesh.render((30, 15), size=(300, 400), white=True))
with open(file, "w") as obj:
    np.savetxt(obj, mesh.vertices, "v %.6f %.6f %.6f")
    np.savetxt(obj, mesh.triangles + 1, "f %d %d %d")
