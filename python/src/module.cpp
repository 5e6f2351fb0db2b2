// SPDX-License-Identifier: BSD-3-Clause
// The extension module behind the Python package pcl_slim.
#include <pybind11/pybind11.h>

#include "mesh.h"
#include "pcl_slim/version.h"
#include "pictures.h"
#include "sensor_noise.h"
#include "splats.h"
#include "surface.h"
#include "view.h"
#include "work.h"

PYBIND11_MODULE(_pcl_slim, m) {
  namespace py = pybind11;
  using namespace pcl_slim::python;
  // Docstrings begin with a signature of their own: options are keyword arguments.
  py::options options;
  options.disable_function_signatures();
  m.doc() = "SLIM surfaces of point clouds; import pcl_slim.";
  m.attr("__version__") = PCL_SLIM_VERSION;
  bindWork(m);
  // Types first, so that functions know all of them.
  py::class_<Surface, SurfacePointer> surface(m, "Surface");
  py::class_<Mesh, MeshPointer> mesh(m, "Mesh");
  py::class_<Splats, SplatsPointer> splats(m, "Splats");
  bindCamera(m);
  bindSensorNoise(m);
  bindSurface(m, surface);
  bindFit(m);
  bindScanFunctions(m, surface);
  bindLines(m, surface);
  bindPaint(surface);
  bindMesh(surface, mesh);
  bindSplats(m, splats);
  bindPictures(m, surface, mesh, splats);
  for (const char* name : {"Surface", "Mesh", "Splats", "Camera", "Lines", "SensorNoise"})
    m.attr(name).attr("__module__") = "pcl_slim";
}
