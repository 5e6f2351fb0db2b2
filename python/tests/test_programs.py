# SPDX-License-Identifier: BSD-3-Clause
"""Results are the programs' to the last bit."""
import json

import numpy as np
import pytest
from conftest import bumps, columns, read_pcd, read_ply, sphere, write_pcd

import pcl_slim

KINDS = ("floats", "survey", "coloured", "normals", "holes")


def scan_of(kind):
    points, colors = bumps(15000)
    if kind == "survey":
        return points + [431250.0, 5411800.0, 250.0], {}
    points = points.astype(np.float32)
    if kind == "coloured":
        return points, {"colors": colors}
    if kind == "normals":
        return points, {"normals": (points / np.linalg.norm(points, axis=1)[:, None]).astype(np.float32)}
    if kind == "holes":
        points[::50] = np.nan
    return points, {}


@pytest.fixture(params=KINDS)
def scan(request, tmp_path):
    points, more = scan_of(request.param)
    write_pcd(tmp_path / "scan.pcd", points, more.get("colors"), more.get("normals"))
    return points, more


@pytest.fixture
def surface(tmp_path, program):
    """A coloured surface, and its file."""
    points, colors = bumps(15000)
    points = points.astype(np.float32)
    write_pcd(tmp_path / "scan.pcd", points, colors)
    program("pcl_slim_fit", "scan.pcd", "surface.slim", "-quiet", 1)
    return points, pcl_slim.load(tmp_path / "surface.slim")


def test_fit(scan, program, tmp_path):
    points, more = scan
    for options, keywords in (((), {}), (("-degree", 2, "-penalty", 8, "-trim", 0), {"degree": 2, "penalty": 8, "trim": False})):
        program("pcl_slim_fit", "scan.pcd", "program.slim", "-quiet", 1, *options)
        pcl_slim.fit(points, **more, **keywords).save(tmp_path / "python.slim")
        assert (tmp_path / "python.slim").read_bytes() == (tmp_path / "program.slim").read_bytes()


def test_smooth_and_curvature(scan, program, tmp_path):
    points, more = scan
    more.pop("colors", None)
    program("pcl_slim_smooth", "scan.pcd", "smooth.pcd", "-quiet", 1)
    expected = columns(read_pcd(tmp_path / "smooth.pcd"), "x y z")
    got = pcl_slim.smooth(points, **more)
    assert got.dtype == points.dtype and got.tobytes() == expected.tobytes()

    program("pcl_slim_curvature", "scan.pcd", "curvature.pcd", "-quiet", 1, "-directions", 1)
    fields = read_pcd(tmp_path / "curvature.pcd")
    got = pcl_slim.curvature(points, directions=True, **more)
    names = {"k1": "k1", "k2": "k2", "mean": "mean_curvature", "gaussian": "gaussian_curvature"}
    for name, field in names.items():
        np.testing.assert_array_equal(getattr(got, name), fields[field])
    np.testing.assert_array_equal(got.normals, columns(fields, "normal_x normal_y normal_z"))
    np.testing.assert_array_equal(got.direction1, columns(fields, "direction1_x direction1_y direction1_z"))
    np.testing.assert_array_equal(pcl_slim.normals(points, **more).normals, got.normals)


def test_smooth_with_a_surface(surface, program, tmp_path):
    points, fitted = surface
    program("pcl_slim_smooth", "scan.pcd", "smooth.pcd", "-surface", "surface.slim", "-quiet", 1)
    expected = columns(read_pcd(tmp_path / "smooth.pcd"), "x y z")
    assert fitted.smooth(points).tobytes() == expected.tobytes()
    assert pcl_slim.smooth(points, surface=fitted).tobytes() == expected.tobytes()


def test_mesh(surface, program, tmp_path):
    program("pcl_slim_mesh", "surface.slim", "mesh.ply", "-tol", 0.002, "-quiet", 1)
    vertices, triangles = read_ply(tmp_path / "mesh.ply")
    mesh = surface[1].mesh(tolerance=0.002)
    np.testing.assert_array_equal(mesh.triangles, triangles)
    expected = columns(vertices, "x y z")
    np.testing.assert_array_equal(mesh.vertices.astype(expected.dtype), expected)
    np.testing.assert_array_equal(mesh.colors, columns(vertices, "red green blue"))


def test_samples(surface, program, tmp_path):
    program("pcl_slim_sample", "surface.slim", "even.pcd", "-spacing", 0.05, "-quiet", 1)
    fields = read_pcd(tmp_path / "even.pcd")
    got = surface[1].sample(spacing=0.05)
    expected = columns(fields, "x y z")
    np.testing.assert_array_equal(got.positions.astype(expected.dtype), expected)
    np.testing.assert_array_equal(got.mean, fields["mean_curvature"])
    np.testing.assert_array_equal(got.normals, columns(fields, "normal_x normal_y normal_z"))


@pytest.mark.parametrize("with_normals", (False, True))
def test_paint(program, tmp_path, with_normals):
    """The colours of another cloud on half of a surface that has its own."""
    points, colors = bumps(15000)
    photo, other = bumps(20000, seed=5)
    photo, other = photo[photo[:, 2] > 0].astype(np.float32), other[photo[:, 2] > 0]
    normals = (photo / np.linalg.norm(photo, axis=1)[:, None]).astype(np.float32) if with_normals else None
    write_pcd(tmp_path / "scan.pcd", points.astype(np.float32), colors)
    write_pcd(tmp_path / "photo.pcd", photo, other, normals)
    program("pcl_slim_fit", "scan.pcd", "program.slim", "-colors", "photo.pcd", "-json", "program.json", "-quiet", 1)
    painted = pcl_slim.fit(points.astype(np.float32), colors=colors).paint(photo, other, normals)
    painted.save(tmp_path / "python.slim")
    assert (tmp_path / "python.slim").read_bytes() == (tmp_path / "program.slim").read_bytes()
    report = json.loads((tmp_path / "program.json").read_text())
    for name in ("colors_near", "painted_leaves", "colors_normals_opposed"):
        assert painted.statistics[name] == report[name], name


def test_lines(surface, program, tmp_path):
    points = surface[0]
    program("pcl_slim_lines", "scan.pcd", "lines.pcd", "-quiet", 1)
    fields = read_pcd(tmp_path / "lines.pcd")
    got = pcl_slim.lines(points)
    assert len(got) > 5 and len(got) == fields["line"].max() + 1
    expected = columns(fields, "x y z")
    np.testing.assert_array_equal(got.positions.astype(expected.dtype), expected)
    assert sum(len(got[i]) for i in range(len(got))) == len(got.positions)
    assert len(pcl_slim.lines(points, type="ridges")) == np.sum(got.ravine == 0)


@pytest.mark.parametrize("options,keywords", [
    ((), {}),
    (("-mode", "mean", "-bar", 1, "-unit", "mm", "-view", "top"), {"mode": "mean", "bar": True, "unit": "mm", "camera": "top"}),
    (("-mode", "raytraced", "-view", "30,20", "-aa", 1), {"mode": "raytraced", "camera": (30, 20), "aa": 1}),
    (("-ortho", 1, "-white", 1, "-up", "y"), {"ortho": True, "white": True, "up": "y"}),
    (("-camera", "3,0,1,0,0,0,0,0,1,25"), {"camera": pcl_slim.Camera((3, 0, 1), (0, 0, 0), (0, 0, 1), fov=25)})])
def test_pictures(surface, program, tmp_path, options, keywords):
    program("pcl_slim_render", "surface.slim", "picture.ppm", "-size", "160x120", "-quiet", 1, *options)
    picture = surface[1].render(size=(160, 120), **keywords)
    assert picture.shape == (120, 160, 4) and np.all(picture[:, :, 3] == 255)
    pcl_slim.save_picture(tmp_path / "python.ppm", picture)
    assert (tmp_path / "python.ppm").read_bytes() == (tmp_path / "picture.ppm").read_bytes()


def test_page(surface, program, tmp_path):
    program("pcl_slim_render", "surface.slim", "surface.html", "-quiet", 1, "-mode", "gauss")
    page = surface[1].to_html(mode="gauss")
    assert page == (tmp_path / "surface.html").read_text(encoding="utf-8")
    assert surface[1].to_html(tmp_path / "python.html", mode="gauss") is None
    assert (tmp_path / "python.html").read_bytes() == (tmp_path / "surface.html").read_bytes()


def test_splats(program, tmp_path):
    points, colors = bumps(15000)
    points = points.astype(np.float32)
    write_pcd(tmp_path / "scan.pcd", points, colors)
    program("pcl_color_splat_sampling", "scan.pcd", "splats.pcd", "-max_splats", 3000, "-rays", 0, "-quiet", 1)
    fields = read_pcd(tmp_path / "splats.pcd")
    got = pcl_slim.splats(points, colors, max_splats=3000)
    expected = columns(fields, "x y z")
    np.testing.assert_array_equal(got.positions.astype(expected.dtype), expected)
    np.testing.assert_array_equal(got.radius, fields["radius"])
    np.testing.assert_array_equal(got.normals, columns(fields, "normal_x normal_y normal_z"))


def test_sphere_of_doubles_is_read_in_place(program, tmp_path):
    points, _ = sphere(5000)
    write_pcd(tmp_path / "scan.pcd", points)
    program("pcl_slim_smooth", "scan.pcd", "smooth.pcd", "-quiet", 1)
    wide = np.zeros((5000, 7))
    wide[:, 2:5] = points
    assert pcl_slim.smooth(wide[:, 2:5]).tobytes() == columns(read_pcd(tmp_path / "smooth.pcd"), "x y z").tobytes()
