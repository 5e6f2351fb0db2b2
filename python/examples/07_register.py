# SPDX-License-Identifier: BSD-3-Clause
"""Registers a scan to a surface: point to surface, by Gauss-Newton steps of the signed distances."""
import numpy as np
import pcl_slim
from vase import vase


def rotation(vector):
    """Of a rotation vector [rad]."""
    x, y, z = vector
    skew = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    angle = np.linalg.norm(vector) + 1e-300
    return np.eye(3) + np.sin(angle) / angle * skew + (1 - np.cos(angle)) / angle**2 * skew @ skew


surface = pcl_slim.fit(vase(seed=1)[0])
turned = rotation([0.03, -0.04, 0.02])
moving = vase(seed=2)[0] @ turned.T + [0.002, -0.003, 0.001]
for step in range(20):
    found = surface.project(moving, reach=0.5)
    near = found.side != 0
    normals = found.normals[near].astype(float)
    rows = np.hstack([np.cross(moving[near], normals), normals])
    turn = np.linalg.lstsq(rows, -(found.side * found.distance)[near], rcond=None)[0]
    moving = moving @ rotation(turn[:3]).T + turn[3:]
error = np.linalg.norm(moving - vase(seed=2)[0], axis=1).max()
print("every point is within %.5f m of its true place after %d steps" % (error, step + 1))
