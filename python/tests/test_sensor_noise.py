# SPDX-License-Identifier: BSD-3-Clause
"""The noise of a sensor, measured on one frame and used for the next ones."""
import json

import numpy as np
import pytest

import pcl_slim

NOISE = 0.004


def frame(seed, noise=NOISE, count=130):
    """A camera's frame of a wave, errors shared by 3 x 3 points, and the heights of its surface."""
    random = np.random.default_rng(seed)
    white = random.normal(size=(count + 2, count + 2))
    shared = sum(white[i:i + count, j:j + count] for i in range(3) for j in range(3)) / 3
    x, y = np.meshgrid(0.01 * np.arange(count), 0.01 * np.arange(count))
    truth = 0.05 * np.sin(6 * x + 0.3 * seed) * np.cos(5 * y)
    return np.stack([x, y, truth + noise * shared], axis=2).reshape(-1, 3), truth.ravel()


def off(points, truth):
    return np.sqrt(np.mean((points[:, 2] - truth) ** 2))


def test_is_measured_once_and_checked():
    noise = pcl_slim.SensorNoise()
    assert noise.json is None and noise.check is None and noise.ratio is None
    camera = dict(viewpoint=(0.6, 0.5, 2), sensor_noise=noise)
    points, _ = frame(1)
    first = pcl_slim.smooth(points, **camera)
    assert noise.check == "measured"
    np.testing.assert_array_equal(first, pcl_slim.smooth(points, viewpoint=(0.6, 0.5, 2)))
    known = json.loads(noise.json)
    at = known["error"][0] + 1.9 * known["error"][1] + 1.9 ** 2 * known["error"][2]
    assert at == pytest.approx(NOISE, rel=0.2)  # along the ray, which is a fifth longer than deep
    points, truth = frame(2)
    second = pcl_slim.smooth(points, **camera)
    assert noise.check == "agrees" and 0.85 < noise.ratio < 1.1
    assert json.loads(noise.json) == known
    alone = pcl_slim.smooth(points, viewpoint=(0.6, 0.5, 2))
    assert off(second, truth) < 1.1 * off(alone, truth) < 0.5 * off(points, truth)
    pcl_slim.fit(frame(3, 1.5 * NOISE)[0], **camera)
    assert noise.check == "differs" and json.loads(noise.json) != known


def test_goes_through_json():
    noise = pcl_slim.SensorNoise()
    points, _ = frame(1)
    pcl_slim.fit(points, viewpoint=(0.6, 0.5, 2), sensor_noise=noise)
    read = pcl_slim.SensorNoise.from_json(noise.json)
    assert read.json == noise.json and read.check is None
    points, _ = frame(2)
    np.testing.assert_array_equal(pcl_slim.smooth(points, viewpoint=(0.6, 0.5, 2), sensor_noise=read),
                                  pcl_slim.smooth(points, viewpoint=(0.6, 0.5, 2), sensor_noise=noise))


def test_refuses_others():
    points, _ = frame(1)
    with pytest.raises(ValueError, match="is no file of a sensor's noise"):
        pcl_slim.SensorNoise.from_json("{}")
    with pytest.raises(ValueError, match="pass a pcl_slim.SensorNoise"):
        pcl_slim.smooth(points, sensor_noise={"error": [1, 0, 0]})
    noise = pcl_slim.SensorNoise()
    surface = pcl_slim.fit(points, viewpoint=(0.6, 0.5, 2), sensor_noise=noise)
    with pytest.raises(ValueError, match="stands in place of"):
        pcl_slim.smooth(points, sensor_noise=noise, noise=NOISE)
    with pytest.raises(ValueError, match="leave one of them out"):
        pcl_slim.smooth(points, surface=surface, sensor_noise=noise)
