# SPDX-License-Identifier: BSD-3-Clause
"""Moves points onto their surface: how far they moved, and normals with their confidence."""
import numpy as np
import pcl_slim
from vase import vase

points, _ = vase()
surface = pcl_slim.fit(points)
smoothed = pcl_slim.smooth(points)             # fits by itself
again = surface.smooth(points)                 # with a surface that is there
moved = np.linalg.norm(smoothed - points, axis=1)
print("moved %.4f RMS, as the noise of %.4f; %.4f at most" % (np.sqrt(np.mean(moved**2)), surface.noise, moved.max()))
print("with the surface that is there: %.1g m apart" % np.abs(smoothed - again).max())

normals, confidence = pcl_slim.normals(points)
print("normals are means of %.0f points and more" % np.percentile(confidence, 5))
