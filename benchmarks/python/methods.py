# SPDX-License-Identifier: BSD-3-Clause
"""What beside.py compares, each in the lines that its users write.

    python3 methods.py NAME SCAN OUT [NUMBER]

NAME: one of the functions below; NUMBER: its neighbours, radius, depth or iterations. SCAN.npy has the points, SCAN.pcd the
same for PCL's programs, SCAN.triangles.npy those of a mesh. Writes OUT.npy, normals, moved points (and normals) or mean
curvatures, and OUT.json: seconds of CPU and of wall time, with files read and written for the programs, and the lines of the function.
"""
import inspect
import json
import resource
import subprocess
import sys
import time

import numpy as np
import open3d as o3d
import pcl_slim


def pcl_slim_normals(points):
    return pcl_slim.normals(points).normals


def pcl_slim_smooth(points):
    return pcl_slim.smooth(points)


def pcl_slim_curvature(points):
    return pcl_slim.curvature(points).mean


def open3d_normals(points, neighbours):
    cloud = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(points))
    cloud.estimate_normals(o3d.geometry.KDTreeSearchParamKNN(neighbours))
    cloud.orient_normals_consistent_tangent_plane(30)
    return np.asarray(cloud.normals)


def open3d_poisson(points, depth):
    cloud = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(points))
    cloud.estimate_normals(o3d.geometry.KDTreeSearchParamKNN(30))
    cloud.orient_normals_consistent_tangent_plane(30)
    mesh, _ = o3d.geometry.TriangleMesh.create_from_point_cloud_poisson(cloud, depth=depth)
    # The search ends in an assertion at triangles without area.
    spacing = np.mean(cloud.compute_nearest_neighbor_distance())
    mesh = mesh.merge_close_vertices(1e-3 * spacing).remove_degenerate_triangles()
    scene = o3d.t.geometry.RaycastingScene()
    scene.add_triangles(o3d.t.geometry.TriangleMesh.from_legacy(mesh))
    return scene.compute_closest_points(o3d.core.Tensor(points, o3d.core.float32))["points"].numpy()


def open3d_taubin(points, triangles, iterations):
    mesh = o3d.geometry.TriangleMesh(o3d.utility.Vector3dVector(points), triangles)
    mesh = mesh.filter_smooth_taubin(number_of_iterations=iterations)
    return np.asarray(mesh.vertices)


def pcl_normals(scan, neighbours):
    subprocess.run(["pcl_normal_estimation", scan, "out.pcd", "-k", str(neighbours)], check=True)


def pcl_smooth(scan, radius):
    subprocess.run(["pcl_mls_smoothing", scan, "out.pcd", "-radius", str(radius), "-sqr_gauss_param", str(radius ** 2)], check=True)


def cpu_seconds():
    children = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.process_time() + children.ru_utime + children.ru_stime


def main():
    name, scan, out = sys.argv[1:4]
    function = globals()[name]
    given = [float(text) if "." in text else int(text) for text in sys.argv[4:]]
    program = name in ("pcl_normals", "pcl_smooth")
    if name == "open3d_taubin":
        given.insert(0, o3d.utility.Vector3iVector(np.load(scan + ".triangles.npy")))
    subject = scan + ".pcd" if program else np.load(scan + ".npy")
    cpu, wall = cpu_seconds(), time.perf_counter()
    result = function(subject, *given)
    cpu, wall = cpu_seconds() - cpu, time.perf_counter() - wall
    if program:
        cloud = o3d.io.read_point_cloud("out.pcd")
        result = cloud.normals if name == "pcl_normals" else np.hstack([cloud.points, cloud.normals])
    np.save(out + ".npy", np.asarray(result, float))
    lines = sum(not line.strip().startswith("#") for line in inspect.getsource(function).strip().splitlines()[1:])
    with open(out + ".json", "w", encoding="utf-8") as file:
        json.dump({"cpu": cpu, "wall": wall, "lines": lines}, file)


if __name__ == "__main__":
    main()
