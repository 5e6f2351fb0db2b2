// SPDX-License-Identifier: BSD-3-Clause
// Pictures and pages of surfaces, meshes and splats.
#include "pictures.h"

#include <pybind11/stl.h>

#include <memory>
#include <string>
#include <utility>

#include "arrays.h"
#include "mesh.h"
#include "options.h"
#include "pcl_slim/core/file_access.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/features/crest_lines.h"
#include "pcl_slim/render/color_map.h"
#include "pcl_slim/render/mesh_renderer.h"
#include "pcl_slim/render/picture_lines.h"
#include "pcl_slim/render/ray_tracer.h"
#include "pcl_slim/render/surface_renderer.h"
#include "pcl_slim/render/traced_picture.h"
#include "pcl_slim/scan/uncertainty.h"
#include "pcl_slim/surface/surface_components.h"
#include "pcl_slim/web/page.h"
#include "view.h"
#include "work.h"

namespace pcl_slim::python {

namespace {

constexpr int kOcclusionRays = 4;  ///< of a traced picture, in each of the frames of aa

constexpr const char* kRenderDoc =
    R"doc(render(camera=None, mode='auto', size=(800, 600), *, up='auto', fov=None, ortho=False, range=None,
       map='auto', bar=False, unit=None, lighting=True, ao=.6, white=False, aa=2, sides='auto', near=0,
       lines=None, min_component=50, threads=0) -> ndarray

A picture, (height, width, 4) uint8: red, green, blue and 255, the pixels of pcl_slim_render.
camera: None chooses a view; 'front', 'back', 'left', 'right', 'top', 'bottom', 'iso', azimuth and
elevation in degrees, or a Camera. mode: auto, shaded, normal, mean, gauss, kmax, kmin, level, size,
error, reflection, color, uncertainty (the standard error of the position), raytraced. size: width and height in pixels. lines: Lines to draw where they
are seen. The others are the program's options.)doc";

constexpr const char* kPageDoc =
    R"doc(to_html(path=None, *, camera=None, mode='auto', up='auto', range=None, map='auto', unit=None, title=None,
        lines=None, precision=896, color_error=2, min_component=50, threads=0) -> str or None

A page with the whole object in it, which any browser opens and turns. Written to path, or returned.
The options are those of render and of pcl_slim_render.)doc";

/** A request of a picture or a page, read. */
struct Request {
  ViewRequest view;
  PictureRequest picture;
  std::shared_ptr<CrestLines> lines;
  double min_component = kLeastComponentPoints;
  PageParams page;
  std::string path;

  std::vector<SpaceLine> spaceLines() const {
    std::vector<SpaceLine> made;
    if (!lines) return made;
    for (std::size_t i = 0; i < lines->numLines(); ++i) {
      SpaceLine& line = made.emplace_back();
      line.kind =
          lines->type[i] == CrestType::kRidge ? PictureLineKind::kRidge : PictureLineKind::kRavine;
      line.points.assign(lines->position.begin() + lines->line_begin[i],
                         lines->position.begin() + lines->line_begin[i + 1]);
      if (lines->closed[i] != 0) line.points.push_back(line.points.front());
    }
    return made;
  }
};

void takeLines(Keywords& keywords, Request& request) {
  const py::object lines = keywords.take("lines");
  if (lines.is_none()) return;
  if (!py::isinstance<CrestLines>(lines))
    raiseValue("lines is no Lines: pass what pcl_slim.lines returned");
  request.lines = lines.cast<std::shared_ptr<CrestLines>>();
}

Request readPicture(Keywords& keywords, bool of_surface) {
  Request request;
  request.view.take(keywords);
  request.picture.take(keywords);
  if (of_surface) {
    takeLines(keywords, request);
    request.min_component = keywords.takeNumber("min_component", 0, 1e12, request.min_component);
  }
  keywords.finish();
  return request;
}

Request readPage(Keywords& keywords, const py::object& path, bool of_surface) {
  Request request;
  if (!path.is_none()) request.path = readPath(path);
  const py::object title = keywords.take("title");
  request.page.title = title.is_none() ? "surface" : py::str(title).cast<std::string>();
  request.page.precision = keywords.takeNumber("precision", 0, 65536, request.page.precision);
  request.page.color_error =
      static_cast<int>(keywords.takeInteger("color_error", 0, 32, request.page.color_error));
  request.view.take(keywords);
  request.picture.take(keywords);
  if (request.picture.isTraced())
    raiseValue("mode raytraced cannot be shown in a page: name another mode");
  if (of_surface) {
    takeLines(keywords, request);
    request.min_component = keywords.takeNumber("min_component", 0, 1e12, request.min_component);
  }
  keywords.finish();
  request.page.lines = request.spaceLines();
  return request;
}

/** A view that opens a room looks through its near walls. */
VisibleSides sidesOf(const PictureRequest& picture, bool opens) {
  return picture.sides == VisibleSides::kAuto && opens ? VisibleSides::kFront : picture.sides;
}

RenderParams renderingOf(const PictureRequest& picture, bool opens) {
  RenderParams params;
  params.sides = sidesOf(picture, opens);
  params.near_plane = picture.near_plane;
  params.close_gaps = true;
  params.threads = picture.shading.threads;
  return params;
}

DiscRenderParams discsOf(const PictureRequest& picture, bool opens) {
  DiscRenderParams params;
  params.sides = sidesOf(picture, opens);
  params.near_plane = picture.near_plane;
  params.threads = picture.shading.threads;
  return params;
}

template <typename Model>
Result<Image> tracePicture(const Model& model, const PictureRequest& picture,
                           const ShadingParams& shading, const ChosenView& view, Work& work) {
  RayTracer tracer(model, shading.threads);
  TraceParams params;
  params.sides = sidesOf(picture, view.opens);
  params.near_plane = picture.near_plane;
  params.occlusion_rays = shading.ambient_occlusion > 0 ? kOcclusionRays : 0;
  params.threads = shading.threads;
  return renderTracedPicture(tracer, view.camera, params, shading, nullptr, work.progress());
}

Error drawSpaceLines(SurfaceRenderer& renderer, const Request& request, const ChosenView& view,
                     Image& image) {
  if (!request.lines) return {};
  RenderParams rendering = renderingOf(request.picture, view.opens);
  rendering.columns = pictureLineColumns({});
  GBuffer buffer;
  if (Error error = renderer.render(view.camera, rendering, buffer)) return error;
  auto seen = projectLines(request.spaceLines(), buffer, view.camera, renderer.surface());
  if (!seen) return seen.error();
  return drawLines(*seen, {}, image);
}

/** What cameras look at must be finite; Python may have written into the columns. */
Error checkTriangles(const TriangleMesh& mesh) {
  if (Error error = mesh.validate()) return error;
  for (const Vector3& vertex : mesh.vertices) {
    if (!isFinite(vertex)) return badInput("a vertex of the mesh is not finite: leave it out");
  }
  return {};
}

/** \brief Draws on the work's thread. \param[in] draw Result<Image>(Work&) */
template <typename Draw>
py::array drawn(std::shared_ptr<void> state, const Draw& draw) {
  auto image = std::make_shared<Image>();
  run(py::none(), std::move(state), [image, draw](Work& work) {
    Result<Image> made = draw(work);
    if (!made) return made.error();
    *image = std::move(*made);
    return Error();
  });
  return toArray(*image);
}

/** The page, written or returned. \param[in] encode Result<std::string>() */
template <typename Encode>
py::object written(std::shared_ptr<void> state, const std::string& path, const Encode& encode) {
  auto text = std::make_shared<std::string>();
  run(py::none(), std::move(state), [text, path, encode](Work&) {
    Result<std::string> made = encode();
    if (!made) return made.error();
    *text = std::move(*made);
    return path.empty() ? Error() : writeFile(path, text->data(), text->size());
  });
  if (!path.empty()) return py::none();
  return py::str(*text);
}

py::kwargs withCamera(const py::kwargs& given, const py::object& camera, const py::object& mode,
                      const py::object& size) {
  py::kwargs all = given.attr("copy")();
  all["camera"] = camera;
  all["mode"] = mode;
  all["size"] = size;
  return all;
}

/** What is drawn of a surface, and how: painted with its standard error for the mode that shows it. */
struct DrawnSurface {
  std::shared_ptr<const SLIMSurface> model;
  ShadingParams shading;
};

Result<DrawnSurface> drawnSurface(const Surface& surface, const Request& request,
                                  const ShadingParams& shading) {
  DrawnSurface drawn{surface.drawn(request.min_component, shading.threads), shading};
  if (shading.mode != ShadingMode::kUncertainty) return drawn;
  auto painted = std::make_shared<SLIMSurface>(*drawn.model);
  const bool diverging = shading.map == ColorMap::kDiverging;
  const auto range = paintUncertainty(
      *painted, shading.range,
      [diverging](double x) { return diverging ? divergingColor(2 * x - 1) : perceptualColor(x); },
      shading.threads);
  if (!range) return range.error();
  drawn.shading.range = *range;
  drawn.model = std::move(painted);
  return drawn;
}

py::array renderSurface(const SurfacePointer& surface, const py::object& camera,
                        const py::object& mode, const py::object& size, const py::kwargs& given) {
  Keywords keywords("render", withCamera(given, camera, mode, size));
  const auto request = std::make_shared<const Request>(readPicture(keywords, true));
  const ShadingParams shading = request->picture.shadingFor(surface->get().hasColors());
  return drawn(surface, [surface = surface.get(), request, shading](Work& work) -> Result<Image> {
    const Result<DrawnSurface> shown = drawnSurface(*surface, *request, shading);
    if (!shown) return shown.error();
    const ChosenView view = request->view.viewOf(
        spheresOf(*shown->model), request->picture.barShare(shading, request->view.size));
    SurfaceRenderer renderer(*shown->model, shading.threads);
    Result<Image> image =
        request->picture.isTraced()
            ? tracePicture(*shown->model, request->picture, shading, view, work)
            : renderPicture(renderer, view.camera, renderingOf(request->picture, view.opens),
                            shown->shading);
    if (!image) return image;
    if (Error error = drawSpaceLines(renderer, *request, view, *image)) return error;
    return image;
  });
}

py::array renderTriangles(const MeshPointer& mesh, const py::object& camera, const py::object& mode,
                          const py::object& size, const py::kwargs& given) {
  Keywords keywords("render", withCamera(given, camera, mode, size));
  const auto request = std::make_shared<const Request>(readPicture(keywords, false));
  if (request->picture.isTraced())
    raiseValue("a mesh has no mode raytraced: render its surface, or name another mode");
  const ShadingParams shading = request->picture.shadingFor(!mesh->triangles.colors.empty());
  return drawn(mesh, [mesh = mesh.get(), request, shading](Work&) -> Result<Image> {
    if (Error error = checkTriangles(mesh->triangles)) return error;
    const ChosenView view =
        request->view.viewOf(spheresOf(mesh->triangles.vertices, mesh->triangles.triangles),
                             request->picture.barShare(shading, request->view.size));
    const RenderParams rendering = renderingOf(request->picture, view.opens);
    MeshRenderParams params;
    params.sides = rendering.sides;
    params.near_plane = rendering.near_plane;
    params.threads = shading.threads;
    return renderPicture(mesh->triangles, view.camera, params, shading);
  });
}

py::array renderSplats(const SplatsPointer& splats, const py::object& camera,
                       const py::object& mode, const py::object& size, const py::kwargs& given) {
  Keywords keywords("render", withCamera(given, camera, mode, size));
  const auto request = std::make_shared<const Request>(readPicture(keywords, false));
  const ShadingParams shading = request->picture.shadingFor(splats->set.hasColors());
  return drawn(splats, [splats = splats.get(), request, shading](Work& work) -> Result<Image> {
    if (Error error = validateDiscs(splats->set)) return error;
    const ChosenView view = request->view.viewOf(
        spheresOf(splats->set), request->picture.barShare(shading, request->view.size));
    return request->picture.isTraced()
               ? tracePicture(splats->set, request->picture, shading, view, work)
               : renderPicture(splats->set, view.camera, discsOf(request->picture, view.opens),
                               shading);
  });
}

py::object surfacePage(const SurfacePointer& surface, const py::object& path,
                       const py::kwargs& given) {
  Keywords keywords("to_html", given);
  const auto request = std::make_shared<Request>(readPage(keywords, path, true));
  const ShadingParams shading = request->picture.shadingFor(surface->get().hasColors());
  return written(
      surface, request->path, [surface = surface.get(), request, shading]() -> Result<std::string> {
        Result<DrawnSurface> shown = drawnSurface(*surface, *request, shading);
        if (!shown) return shown.error();
        // A page has no bar of standard errors: it shows them as colours.
        if (shading.mode == ShadingMode::kUncertainty) {
          shown->shading.mode = ShadingMode::kColor;
          shown->shading.range = {};
        }
        const ChosenView view = request->view.viewOf(spheresOf(*shown->model), 0);
        request->page.up = view.up;
        return encodePage(*shown->model, view.camera, renderingOf(request->picture, view.opens),
                          shown->shading, request->page);
      });
}

py::object splatsPage(const SplatsPointer& splats, const py::object& path,
                      const py::kwargs& given) {
  Keywords keywords("to_html", given);
  const auto request = std::make_shared<Request>(readPage(keywords, path, false));
  const ShadingParams shading = request->picture.shadingFor(splats->set.hasColors());
  return written(splats, request->path,
                 [splats = splats.get(), request, shading]() -> Result<std::string> {
                   if (Error error = validateDiscs(splats->set)) return error;
                   const ChosenView view = request->view.viewOf(spheresOf(splats->set), 0);
                   request->page.up = view.up;
                   return encodePage(splats->set, view.camera,
                                     discsOf(request->picture, view.opens), shading, request->page);
                 });
}

constexpr const char* kSavePictureDoc = R"doc(save_picture(path, picture)

Writes a picture of render(), (height, width, 3 or 4) uint8, as .png or .ppm. A fourth channel is left
out.)doc";

void savePicture(const py::object& path, const py::array& picture) {
  const std::string file = readPath(path);
  if (Error error = checkImageExtension(file)) raise(error);
  const bool bytes = picture.dtype().kind() == 'u' && picture.itemsize() == 1;
  const bool rows = picture.ndim() == 3 && (picture.shape(2) == 3 || picture.shape(2) == 4);
  if (!bytes || !rows || picture.size() == 0)
    raiseValue(
        "a picture is an array (height, width, 3 or 4) of uint8: pass what render() returned");
  const py::array_t<std::uint8_t> array(picture);
  const auto at = array.unchecked<3>();
  auto image = std::make_shared<Image>();
  image->height = static_cast<int>(at.shape(0));
  image->width = static_cast<int>(at.shape(1));
  for (py::ssize_t y = 0; y < at.shape(0); ++y) {
    for (py::ssize_t x = 0; x < at.shape(1); ++x) {
      for (py::ssize_t c = 0; c < 3; ++c) image->rgb.push_back(at(y, x, c));
    }
  }
  run(py::none(), nullptr, [image, file](Work&) { return saveImage(file, *image); });
}

/** The page in a frame of a notebook. */
py::object framed(const py::object& page) {
  const py::object escaped = py::module_::import("html").attr("escape")(page);
  return py::str(
             "<iframe srcdoc=\"{}\" width=\"100%\" height=\"480\" "
             "style=\"border:0\"></iframe>")
      .format(escaped);
}

/** The methods that all three have. */
template <typename Pointer, typename Type, typename Render>
void defineRender(Type& type, const Render& render) {
  type.def("render", render, py::arg("camera") = py::none(), py::arg("mode") = "auto",
           py::arg("size") = py::make_tuple(800, 600), kRenderDoc);
}
template <typename Pointer, typename Type, typename Page>
void definePage(Type& type, const Page& page) {
  type.def("to_html", page, py::arg("path") = py::none(), kPageDoc)
      .def(
          "_repr_html_",
          [page](const Pointer& self) { return framed(page(self, py::none(), py::kwargs())); },
          "The page in a frame, for notebooks.");
}

}  // namespace

void bindPictures(py::module_& m, py::class_<Surface, SurfacePointer>& surface,
                  py::class_<Mesh, MeshPointer>& mesh, py::class_<Splats, SplatsPointer>& splats) {
  defineRender<SurfacePointer>(surface, &renderSurface);
  defineRender<MeshPointer>(mesh, &renderTriangles);
  defineRender<SplatsPointer>(splats, &renderSplats);
  definePage<SurfacePointer>(surface, &surfacePage);
  definePage<SplatsPointer>(splats, &splatsPage);
  m.def("save_picture", &savePicture, py::arg("path"), py::arg("picture"), kSavePictureDoc);
}

}  // namespace pcl_slim::python
