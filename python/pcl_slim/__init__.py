# SPDX-License-Identifier: BSD-3-Clause
"""SLIM surfaces of point clouds: sparse sets of local polynomials, fitted without parameters.

    import pcl_slim
    surface = pcl_slim.fit(points)          # (n, 3) float32 or float64
    where = surface.project(points)         # positions, normals, k1, k2, distance, side
    mesh = surface.mesh()                   # vertices, triangles

Functions that take a scan fit a surface first; smooth, curvature, normals, covariances and lines use one that is given
as surface=. Options are keyword arguments with the names and the meaning of the programs' options. Arrays are read in
place where rows are three consecutive float32 or float64. Work runs without the interpreter's lock and ends at Ctrl-C.
"""
from ._pcl_slim import (Camera, Curvature, Lines, Mesh, Normals, NoSurfaceError, Projection, Samples, SensorNoise, Splats,
                        Surface, __version__, covariances, curvature, fit, lines, load, normals, save_picture, smooth,
                        splats)

__all__ = ["Camera", "Curvature", "Lines", "Mesh", "NoSurfaceError", "Normals", "Projection", "Samples", "SensorNoise",
           "Splats", "Surface", "covariances", "curvature", "fit", "lines", "load", "normals", "save_picture", "smooth",
           "splats", "__version__"]
