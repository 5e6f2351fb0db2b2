# SPDX-License-Identifier: BSD-3-Clause
"""Open3D's part of the gallery (scripts/gallery.sh).

    python3 open3d_peer.py prepare SCAN OUT.ply             finite points and their normals, relative to their middle
                                                            where they are in map coordinates
    python3 open3d_peer.py METHOD SCAN.ply OUT.ply SIDES    a mesh; SIDES: "none", "camera" (at the origin) or "up"
    python3 open3d_peer.py discs CLOUD.ply SCAN.ply OUT.ply discs of a cloud with normals, for pcl_slim_render
    python3 open3d_peer.py measure SCAN.ply MESH.ply OUT.json [TRUTH.ply]    distances, pieces and borders

METHOD, of the steps that Open3D's tutorials show:
  tutorial   normals of 30 neighbours, oriented by tangent planes (100), Poisson of depth 9, without the hundredth of the
             vertices of the lowest density
  tuned      depth 10, sides by what is known (SIDES, else tangent planes of 30), without vertices that are farther than
             three spacings from all points
  pivoting   without statistical outliers (20 neighbours, 2 deviations), balls of 1, 2 and 4 mean spacings, sides by SIDES
"""
import json
import sys

import numpy as np
import open3d as o3d

FAR = 3  # spacings: a point this far from the mesh is lost, and area this far from the points is invented


def decompressed(data, size):
    """LZF, as PCD files have it."""
    out, at = bytearray(), 0
    while at < len(data):
        control = data[at]
        at += 1
        if control < 32:
            out += data[at:at + control + 1]
            at += control + 1
            continue
        length = control >> 5
        if length == 7:
            length += data[at]
            at += 1
        begin = len(out) - ((control & 31) << 8 | data[at]) - 1
        at += 1
        for _ in range(length + 2):
            out.append(out[begin])
            begin += 1
    assert len(out) == size
    return bytes(out)


def columns_of(path):
    """The fields of a binary_compressed PCD file; Open3D 0.19 reads float coordinates alone."""
    with open(path, "rb") as file:
        head = {}
        while "DATA" not in head:
            key, *values = file.readline().decode().split()
            head[key] = values
        compressed, size = np.frombuffer(file.read(8), "<u4")
        data = decompressed(file.read(int(compressed)), size)
    columns, at, count = {}, 0, int(head["POINTS"][0])
    for name, width, kind in zip(head["FIELDS"], head["SIZE"], head["TYPE"]):
        columns[name] = np.frombuffer(data, f"<{kind.lower()}{width}", count, at)
        at += count * int(width)
    return columns


def prepare(scan, out):
    columns = columns_of(scan)
    points = np.stack([columns[name].astype(float) for name in "xyz"], 1)
    kept = np.isfinite(points).all(1)
    points = points[kept]
    if np.abs(points).max() > 1e4:
        points -= np.round(points.mean(0))
    cloud = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(points))
    if "normal_x" in columns:
        normals = np.stack([columns["normal_" + name].astype(float) for name in "xyz"], 1)[kept]
        cloud.normals = o3d.utility.Vector3dVector(normals)
    o3d.io.write_point_cloud(out, cloud)


def orient(cloud, sides, neighbours):
    if sides == "camera":
        cloud.orient_normals_towards_camera_location(np.zeros(3))
    elif sides == "up":
        cloud.orient_normals_to_align_with_direction(np.array([0.0, 0.0, 1.0]))
    else:
        cloud.orient_normals_consistent_tangent_plane(neighbours)


def poisson(cloud, depth):
    """Mesh and the density of points at its vertices."""
    mesh, densities = o3d.geometry.TriangleMesh.create_from_point_cloud_poisson(cloud, depth=depth)
    return mesh, np.asarray(densities)


def reconstruct(method, scan, out, sides):
    cloud = o3d.io.read_point_cloud(scan)
    given = cloud.has_normals()
    if method == "pivoting":
        cloud, _ = cloud.remove_statistical_outlier(nb_neighbors=20, std_ratio=2.0)
    if not given:
        cloud.estimate_normals(o3d.geometry.KDTreeSearchParamKNN(30))
        if method == "tutorial":
            cloud.orient_normals_consistent_tangent_plane(100)
        else:
            orient(cloud, sides, 30)
    if method == "tutorial":
        mesh, densities = poisson(cloud, 9)
        mesh.remove_vertices_by_mask(densities < np.quantile(densities, 0.01))
    elif method == "tuned":
        mesh, _ = poisson(cloud, 10)
        vertices = o3d.geometry.PointCloud(mesh.vertices)
        away = np.asarray(vertices.compute_point_cloud_distance(cloud))
        mesh.remove_vertices_by_mask(away > FAR * spacing_of(np.asarray(cloud.points)))
    else:
        spacing = np.mean(cloud.compute_nearest_neighbor_distance())
        radii = o3d.utility.DoubleVector([spacing, 2 * spacing, 4 * spacing])
        mesh = o3d.geometry.TriangleMesh.create_from_point_cloud_ball_pivoting(cloud, radii)
    o3d.io.write_triangle_mesh(out, mesh)


def spacing_of(points):
    """Median over the points of the mean distance to six neighbours."""
    tensor = o3d.core.Tensor(points, dtype=o3d.core.float64)
    search = o3d.core.nns.NearestNeighborSearch(tensor)
    search.knn_index()
    some = tensor[:: max(1, len(points) // 50000)]
    _, squares = search.knn_search(some, 7)
    return float(np.median(np.sqrt(squares.numpy()[:, 1:]).mean(1)))


def discs(path, scan, out):
    cloud = o3d.io.read_point_cloud(path)
    points, normals = np.asarray(cloud.points), np.asarray(cloud.normals)
    radius = spacing_of(np.asarray(o3d.io.read_point_cloud(scan).points))
    rows = np.hstack([points, normals, np.full((len(points), 1), radius)]).astype("<f4")
    names = ("x", "y", "z", "normal_x", "normal_y", "normal_z", "radius")
    with open(out, "wb") as file:
        file.write(f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\n".encode())
        file.write("".join(f"property float {name}\n" for name in names).encode() + b"end_header\n")
        file.write(rows.tobytes())


def scene_of(mesh, spacing):
    """For distances. Slivers, at which Open3D's search ends in an assertion, are left out: their neighbours cover them."""
    vertices, triangles = np.asarray(mesh.vertices), np.asarray(mesh.triangles)
    first, second, third = (vertices[triangles[:, i]].astype(np.float32) for i in range(3))
    area = np.linalg.norm(np.cross(second - first, third - first), axis=1) / 2
    scene = o3d.t.geometry.RaycastingScene()
    scene.add_triangles(o3d.core.Tensor(vertices, dtype=o3d.core.float32),
                        o3d.core.Tensor(triangles[area > 1e-5 * spacing ** 2], dtype=o3d.core.uint32))
    return scene


def distances(scene, points):
    return scene.compute_distance(o3d.core.Tensor(points, dtype=o3d.core.float32)).numpy()


def angle_between_neighbours(mesh, inverse, counts):
    """Mean angle [degrees] between the triangles at an edge that has two, whatever their sides."""
    mesh.compute_triangle_normals()
    normals = np.asarray(mesh.triangle_normals)
    triangles = np.argsort(inverse, kind="stable") % len(normals)
    begins = np.concatenate([[0], np.cumsum(counts)[:-1]])[counts == 2]
    cosines = np.abs((normals[triangles[begins]] * normals[triangles[begins + 1]]).sum(1))
    return float(np.degrees(np.arccos(np.clip(cosines, 0, 1))).mean())


def measure(scan, path, out, truth=None):
    points = np.asarray(o3d.io.read_point_cloud(scan).points)
    mesh = o3d.io.read_triangle_mesh(path)
    mesh.remove_degenerate_triangles()
    triangles = np.asarray(mesh.triangles)
    spacing = spacing_of(points)
    away = distances(scene_of(mesh, spacing), points) / spacing
    near = away[away <= FAR]
    samples = np.asarray(mesh.sample_points_uniformly(300000).points)
    cloud = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(samples))
    beyond = np.asarray(cloud.compute_point_cloud_distance(o3d.geometry.PointCloud(o3d.utility.Vector3dVector(points))))
    edges = np.sort(np.vstack([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    _, inverse, counts = np.unique(edges, axis=0, return_inverse=True, return_counts=True)
    result = {
        "triangles": len(triangles),
        "spacing": spacing,
        "median": float(np.median(away)),
        "rms": float(np.sqrt(np.mean(near ** 2))),
        "lost": float(100 * np.mean(away > FAR)),
        "invented": float(100 * np.mean(beyond > FAR * spacing)),
        "angle": angle_between_neighbours(mesh, inverse.ravel(), counts),
        "pieces": len(mesh.cluster_connected_triangles()[1]),
        "border": int((counts == 1).sum()),
        "nonmanifold": int((counts > 2).sum()),
    }
    if truth:
        away = distances(scene_of(o3d.io.read_triangle_mesh(truth), spacing), samples) / spacing
        result["truth"] = float(np.sqrt(np.mean(away[away <= FAR] ** 2)))
    with open(out, "w", encoding="utf-8") as file:
        json.dump(result, file)


def main():
    o3d.utility.random.seed(1)
    task, arguments = sys.argv[1], sys.argv[2:]
    if task in ("prepare", "discs", "measure"):
        globals()[task](*arguments)
    else:
        reconstruct(task, *arguments)


main()
