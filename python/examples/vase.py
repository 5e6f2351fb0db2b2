# SPDX-License-Identifier: BSD-3-Clause
"""The scan that the examples use: a fluted, glazed vase with noise, open at its top."""
import numpy as np


def vase(count=80000, noise=0.001, seed=1, dent=0.0):
    """Points (count, 3) [m], colours (count, 3) uint8. dent: depth of a dent in its side."""
    random = np.random.default_rng(seed)
    around = random.uniform(0, 2 * np.pi, count)
    height = random.uniform(0, 0.3, count)
    bottom = random.uniform(0, 1, count) < 0.06

    belly = 0.055 + 0.035 * np.sin(np.pi * (height / 0.3) ** 0.8 * 1.55)
    flutes = 0.0025 * np.cos(16 * around) * np.exp(-((height - 0.09) / 0.055) ** 4)
    pressed = dent * np.exp(-((np.angle(np.exp(1j * (around + 1.2))) * belly / 0.015) ** 2 + ((height - 0.19) / 0.015) ** 2))
    radius = belly + flutes - pressed
    disc = 0.055 * np.sqrt(random.uniform(0, 1, count))
    radius = np.where(bottom, disc, radius)
    points = np.stack([radius * np.cos(around), radius * np.sin(around), np.where(bottom, 0, height)], axis=1)
    points += noise * random.normal(size=points.shape)

    glaze = height + 0.012 * np.sin(5 * around) > 0.16
    band = np.abs(height - 0.25) < 0.008
    colors = np.where(glaze[:, None], [60, 110, 150], [190, 140, 100])
    colors = np.where(band[:, None], [235, 225, 200], colors)
    colors[bottom] = [150, 110, 80]
    return points, np.clip(colors + random.normal(0, 6, colors.shape), 0, 255).astype(np.uint8)


def picture_of_points(points, size=(400, 400)):
    """The points as the scanner gave them, from the side of the other pictures: (h, w, 4) uint8."""
    width, height = size
    picture = np.full((height, width, 4), 255, np.uint8)
    middle, extent = points.mean(axis=0), np.ptp(points[:, 2]) * 1.15
    turn = np.radians(30)
    right = points[:, :2] @ [np.cos(turn), np.sin(turn)]
    depth = points[:, :2] @ [-np.sin(turn), np.cos(turn)]
    column = (width / 2 + right / extent * height).astype(int)
    row = (height / 2 - (points[:, 2] - middle[2]) / extent * height).astype(int)
    seen = (column >= 0) & (column < width) & (row >= 0) & (row < height)
    order = np.argsort(-depth[seen])
    grey = (40 + 150 * (depth[seen] - depth.min()) / np.ptp(depth)).astype(np.uint8)[order]
    picture[row[seen][order], column[seen][order], :3] = grey[:, None]
    return picture
