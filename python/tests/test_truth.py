# SPDX-License-Identifier: BSD-3-Clause
"""Results beside the exact surface of the points."""
import numpy as np
import pytest
from conftest import sphere, torus

import pcl_slim

NOISE = 0.002


@pytest.fixture(scope="module")
def ball():
    points, directions = sphere(20000, NOISE)
    return points, directions, pcl_slim.fit(points)


def test_fit_reports_the_noise(ball):
    points, _, surface = ball
    assert surface.noise == pytest.approx(NOISE, rel=0.1)
    assert surface.num_points == len(points)
    assert surface.statistics["leaves"] == len(surface) == len(surface.leaves)
    assert surface.diagonal == pytest.approx(np.linalg.norm(np.ptp(points, axis=0)))


def test_projection_is_on_the_sphere(ball):
    points, directions, surface = ball
    got = surface.project(points)
    # A leaf averages hundreds of points: its surface is nearer than a fifth of the noise.
    assert np.abs(np.linalg.norm(got.positions, axis=1) - 1).max() < NOISE / 2
    assert np.sqrt(np.mean((np.linalg.norm(got.positions, axis=1) - 1) ** 2)) < NOISE / 5
    assert np.sum(got.normals * directions, axis=1).min() > 0.999
    assert np.abs(got.k1 - 1).mean() < 0.05 and np.abs(got.k2 - 1).mean() < 0.05
    assert np.all(got.k1 >= got.k2)
    moved = np.linalg.norm(points - got.positions, axis=1)
    np.testing.assert_allclose(got.distance, moved, rtol=0, atol=1e-12)
    outside = np.einsum("ij,ij->i", points - got.positions, got.normals.astype(float)) > 0
    np.testing.assert_array_equal(got.side, np.where(outside, 1, -1))
    off = np.abs(np.linalg.norm(got.positions, axis=1) - 1)
    assert 0.9 < np.mean(off <= 1.96 * got.sigma) < 0.995
    turned = np.arccos(np.clip(np.sum(got.normals * directions, axis=1), -1, 1))
    assert 0.9 < np.mean(turned <= 1.731 * got.sigma_normal)
    assert 0.85 < np.mean(np.abs((got.k1 + got.k2) / 2 - 1) <= 1.96 * got.sigma_curvature)


def test_places_away_from_the_surface(ball):
    _, directions, surface = ball
    far = surface.project(directions[:100] * 3)
    assert np.all(far.side == 0) and np.all(np.isnan(far.distance)) and np.all(np.isnan(far.normals))
    np.testing.assert_array_equal(far.positions, directions[:100] * 3)
    for height, side in ((0.05, 1), (-0.05, -1)):
        near = surface.project(directions[:100] * (1 + height), reach=0.5)
        assert np.all(near.side == side)
        np.testing.assert_allclose(near.distance, 0.05, atol=NOISE)


def test_curvature_of_a_torus():
    points, normals = torus()
    got = pcl_slim.curvature(points, directions=True)
    ring = np.hypot(points[:, 0], points[:, 1])
    expected = (1 - 1 / ring) / 0.4  # cos v / (R + r cos v), with r cos v = ring - R
    assert np.abs(got.k1 - 2.5).mean() < 0.1
    assert np.abs(got.k2 - expected).mean() < 0.1
    np.testing.assert_allclose(got.mean, (got.k1 + got.k2) / 2, rtol=1e-3, atol=1e-3)
    assert np.sum(got.normals * normals, axis=1).min() > 0.99
    assert np.abs(np.sum(got.direction1 * got.normals, axis=1)).max() < 1e-5
    assert np.abs(got.direction1[:, 2]).max() > 0.9  # round the tube
    assert pcl_slim.curvature(points[:1000]).direction1 is None


def test_normals_have_confidence(ball):
    points, directions, surface = ball
    got = pcl_slim.normals(points)
    assert np.sum(got.normals * directions, axis=1).min() > 0.999
    assert got.confidence.min() > 50
    leaves = surface.leaves
    assert got.confidence.max() <= leaves["confidence"].max() * 1.01
    stray = np.vstack([points, [[5.0, 5, 5]]])
    assert pcl_slim.normals(stray).confidence[-1] == 0


def test_covariances_are_flat(ball):
    points, directions, surface = ball
    got = pcl_slim.covariances(points, surface=surface, epsilon=0.01)
    assert got.shape == (len(points), 3, 3) and got.dtype == np.float64
    values, vectors = np.linalg.eigh(got[:500])
    np.testing.assert_allclose(values, [[0.01, 1, 1]] * 500, atol=1e-5)
    assert np.abs(np.sum(vectors[:, :, 0] * directions[:500], axis=1)).min() > 0.999


def test_leaves_describe_the_sphere(ball):
    leaves = ball[2].leaves
    assert leaves["normal"].shape == (len(leaves), 3) and leaves["coefficients"].shape == (len(leaves), 15)
    assert np.abs(np.linalg.norm(leaves["center"], axis=1) - 1).max() < 0.2
    np.testing.assert_allclose(np.linalg.norm(leaves["normal"], axis=1), 1, atol=1e-5)


def test_mesh_is_closed_and_round(ball):
    mesh = ball[2].mesh(tolerance=0.002)
    assert mesh.statistics["euler"] == 2 and mesh.statistics["nonmanifold"] == 0
    assert np.abs(np.linalg.norm(mesh.vertices, axis=1) - 1).max() < NOISE
    a, b, c = (mesh.vertices[mesh.triangles[:, k]] for k in range(3))
    volume = np.einsum("ij,ij->", a, np.cross(b, c)) / 6
    assert volume == pytest.approx(4 * np.pi / 3, rel=0.005)
    assert mesh.k1.mean() == pytest.approx(1, abs=0.05)
    assert len(ball[2].mesh(max_triangles=500)) <= 500


def test_samples_keep_their_distance(ball):
    got = ball[2].sample(spacing=0.1)
    gaps = np.linalg.norm(got.positions[:, None] - got.positions[None], axis=2) + 9 * np.eye(len(got.positions))
    assert gaps.min() >= 0.1 * (1 - 1e-9) and gaps.min(axis=1).max() < 0.2
    assert got.spacing == 0.1 and got.colors is None
    assert len(ball[2].sample(number=300).positions) == 300


def test_survey_coordinates_keep_their_digits(ball):
    points, directions, _ = ball
    offset = np.array([431250.0, 5411800.0, 250.0])
    smoothed = pcl_slim.smooth(points + offset)
    assert smoothed.dtype == np.float64
    assert np.abs(np.linalg.norm(smoothed - offset, axis=1) - 1).max() < NOISE / 2
    # The sums above round to 1e-9; the fits differ by what that does.
    assert np.abs(smoothed - offset - pcl_slim.smooth(points)).max() < NOISE / 20
    mesh = pcl_slim.fit(points + offset).mesh()
    assert np.abs(np.linalg.norm(mesh.vertices - offset, axis=1) - 1).max() < NOISE


def test_normals_and_viewpoint_decide_the_side(ball):
    points, directions, _ = ball
    inward = pcl_slim.normals(points, normals=-directions)
    assert np.sum(inward.normals * directions, axis=1).max() < -0.999
    inside = pcl_slim.curvature(points, viewpoint=(0, 0, 0))
    assert np.sum(inside.normals * directions, axis=1).max() < -0.999 and inside.mean.mean() < -0.9
    sensors = np.zeros((len(points), 3), np.float32)
    leaves = pcl_slim.fit(points, sensors=sensors).leaves
    assert np.sum(leaves["normal"] * leaves["center"], axis=1).max() < 0
    seen = pcl_slim.normals(points, sensors=sensors)
    assert np.sum(seen.normals * directions, axis=1).max() < -0.999


def test_splats_cover_the_colours():
    points, directions = sphere(20000, 0.001)
    colors = np.where(directions[:, 2:] > 0, [255, 0, 0], [0, 0, 255]).astype(np.uint8)
    splats = pcl_slim.splats(points, colors, max_splats=2000)
    assert 1000 < len(splats) <= 2000
    up = splats.positions[:, 2] > 0.1
    assert np.all(splats.colors[up, 0] > 200) and np.all(splats.colors[up, 2] < 60)
    assert np.abs(np.linalg.norm(splats.positions, axis=1) - 1).max() < 0.05
    assert splats.kept.max() < len(points) and splats.radius.min() > 0


def test_paint_takes_the_colours_of_another_cloud(ball):
    """A cloud of z > .5 paints the leaves that it reaches, which are up to .6 wide, and none at the other end."""
    surface = ball[2]
    photo, directions = sphere(30000, 0.001, seed=7)
    up = directions[:, 2] > 0.5
    photo, directions = photo[up], directions[up]
    colors = np.where(directions[:, :1] > 0, [250, 20, 20], [20, 20, 250]).astype(np.uint8)
    painted = surface.paint(photo, colors)
    assert painted.has_colors and not surface.has_colors  # a copy
    mesh = painted.mesh(tolerance=0.002)
    x, _, z = mesh.vertices.T
    for side, expected in ((x > 0.2, [250, 20, 20]), (x < -0.2, [20, 20, 250])):
        assert np.abs(mesh.colors[side & (z > 0.5)].astype(int) - expected).max() < 30
    assert np.abs(mesh.colors[z < -0.8].astype(int) - 128).max() == 0  # grey where no point is
    statistics = painted.statistics
    assert statistics["colors_near"] == len(photo)
    assert len(surface) / 4 < statistics["painted_leaves"] < len(surface)
    assert painted.notes[:-1] == surface.notes and painted.notes[-1].endswith("they are grey")
    assert "painted_leaves" not in surface.statistics


def test_paint_uses_normals_that_face_as_the_surface_does(ball):
    points, directions, _ = ball
    surface = pcl_slim.fit(points, normals=directions)
    colors = np.full((len(points), 3), [10, 200, 30], np.uint8)
    assert not surface.paint(points, colors, directions).statistics["colors_normals_opposed"]
    opposed = surface.paint(points, colors, -directions)
    assert opposed.statistics["colors_normals_opposed"] and "oppose" in opposed.notes[-1]
    same = {surface.paint(points, colors, directions, threads=n).render(size=(80, 60)).tobytes() for n in (1, 3)}
    assert len(same) == 1


def test_colours_of_every_kind_are_the_same():
    points, directions = sphere(5000)
    bytes_ = ((directions + 1) * 127).astype(np.uint8)
    bytes_[0] = 255
    same = [pcl_slim.fit(points, colors=c) for c in (bytes_, bytes_.astype(float) / 255, bytes_.astype(np.uint16) * 257,
                                                     bytes_[:, [0, 1, 2, 0]], bytes_.astype(np.float32))]
    pictures = [s.render(size=(80, 60)).tobytes() for s in same]
    assert len(set(pictures)) == 1 and same[0].has_colors
