// SPDX-License-Identifier: BSD-3-Clause
// Frames of one surface in a VTK window: the graphics card's beside the CPU's, how long they take,
// which of the two kAuto chooses and how their pictures differ. Needs an X server.
#include <vtkActor.h>
#include <vtkCamera.h>
#include <vtkNew.h>
#include <vtkProperty.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkUnsignedCharArray.h>
#include <vtk_glew.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "common/options.h"
#include "pcl_slim/render/auto_view.h"
#include "pcl_slim/render/image.h"
#include "pcl_slim/surface/surface_io.h"
#include "pcl_slim/visualization/slim_mapper.h"
#include "render/made_sphere.h"
#include "support/lab/bench.h"

using namespace pcl_slim;
using measure::median;
using measure::wallSeconds;

namespace {

struct Settings {
  std::string surface, pictures, only = "all";
  int width = 1280, height = 720, frames = 24, threads = 0, leaves = 48000, degree = 4;
  double first_zoom = 1.0;
};

/** \brief What is drawn, and how. */
struct Scene {
  const char* name;
  DisplayMode mode = DisplayMode::kShaded;
  double lod = 0.0, zoom = 1.0, opacity = 1.0;
  bool parallel = false;
};

const Scene kScenes[] = {
    {"shaded"},
    {"normals", DisplayMode::kNormal},
    {"mean curvature", DisplayMode::kMean},
    {"largest curvature", DisplayMode::kMax},
    {"levels", DisplayMode::kLevel},
    {"radii", DisplayMode::kSize},
    {"residuals", DisplayMode::kError},
    {"reflection lines", DisplayMode::kReflection},
    {"colours", DisplayMode::kColor},
    {"level of detail 4", DisplayMode::kShaded, 4.0},
    {"6 times nearer", DisplayMode::kShaded, 0.0, 6.0},
    {"translucent", DisplayMode::kShaded, 0.0, 1.0, 0.5},
    {"parallel", DisplayMode::kNormal, 0.0, 1.0, 1.0, true},
    {"sketch", DisplayMode::kSketch},
};

/** \brief Frames of kAuto over a turn. */
struct AutoTurn {
  double milliseconds = 0.0;  ///< a frame, median of the turn
  int by_card = 0;            ///< frames of the turn that the card drew
  int changes = 0;            ///< frames of it drawn by another back end than the frame before
};

/** \brief A window on one surface, and the camera that frames it. */
class Window {
 public:
  Window(const Settings& s, std::shared_ptr<const SLIMSurface> surface) : settings_(s) {
    window_->SetOffScreenRendering(1);
    window_->SetMultiSamples(0);
    window_->SetSize(s.width, s.height);
    window_->AddRenderer(renderer_);
    renderer_->SetBackground(1.0, 1.0, 1.0);
    mapper_->setNumberOfThreads(s.threads);
    mapper_->setFrameBudget(0.0);
    home_ = homeOf(*surface);
    mapper_->setSurface(std::move(surface));
    actor_->SetMapper(mapper_);
    actor_->GetProperty()->SetColor(0.6, 0.6, 0.6);
    renderer_->AddActor(actor_);
  }

  /** \brief Sets a scene and its camera. \return false for what the surface has not. */
  bool show(const Scene& scene) {
    if (!mapper_->setMode(scene.mode)) return false;
    mapper_->setLevelOfDetail(scene.lod);
    actor_->GetProperty()->SetOpacity(scene.opacity);
    vtkCamera* camera = renderer_->GetActiveCamera();
    camera->SetPosition(home_.position.data());
    camera->SetFocalPoint(home_.look_at.data());
    camera->SetViewUp(home_.up.data());
    camera->SetViewAngle(home_.fov / scene.zoom);
    camera->SetParallelProjection(scene.parallel);
    camera->SetParallelScale(camera->GetDistance() * std::tan(home_.fov * M_PI / 360.0));
    renderer_->ResetCameraClippingRange();
    return true;
  }

  Image picture(RayBackend backend) {
    mapper_->setBackend(backend);
    window_->Render();
    Image image;
    image.width = settings_.width;
    image.height = settings_.height;
    vtkNew<vtkUnsignedCharArray> pixels;
    window_->GetPixelData(0, 0, image.width - 1, image.height - 1, 1, pixels);
    for (int y = image.height - 1; y >= 0; --y) {
      const unsigned char* row = pixels->GetPointer(3 * static_cast<vtkIdType>(y) * image.width);
      image.rgb.insert(image.rgb.end(), row, row + 3 * image.width);
    }
    return image;
  }

  /** \brief Milliseconds a frame, the camera turning about the object: the median of a turn. */
  double milliseconds(RayBackend backend, int frames) {
    mapper_->setBackend(backend);
    std::vector<double> times;
    for (int i = -2; i < frames; ++i) {
      const double time = turn(360.0 / frames);
      if (i >= 0) times.push_back(time);
    }
    return median(times);
  }

  /** \brief A turn by kAuto, after the six frames that it measures; those are seen first_zoom times
   * nearer. */
  AutoTurn turnByAuto(int frames) {
    mapper_->setSurface(mapper_->getSurface());
    mapper_->setBackend(RayBackend::kAuto);
    vtkCamera* camera = renderer_->GetActiveCamera();
    camera->Dolly(settings_.first_zoom);
    constexpr int kMeasured = 6;
    for (int i = 0; i < kMeasured; ++i) turn(360.0 / frames);
    camera->Dolly(1.0 / settings_.first_zoom);
    AutoTurn result;
    std::vector<double> times;
    for (int i = 0; i < frames; ++i) {
      const bool before = onCard();
      times.push_back(turn(360.0 / frames));
      result.by_card += onCard();
      result.changes += onCard() != before;
    }
    result.milliseconds = median(times);
    return result;
  }

  bool onCard() const { return mapper_->getStatistics().on_card; }
  std::uint64_t coveredPixels() const { return mapper_->getStatistics().covered_pixels; }

  /** \brief "RENDERER, OpenGL VERSION". */
  std::string cardName() {
    window_->Render();
    window_->MakeCurrent();
    const auto text = [](GLenum what) {
      const auto* value = reinterpret_cast<const char*>(glGetString(what));
      return std::string(value ? value : "unknown");
    };
    return text(GL_RENDERER) + ", OpenGL " + text(GL_VERSION);
  }

 private:
  /** \brief Turns the camera. \return milliseconds of the frame */
  double turn(double degrees) {
    renderer_->GetActiveCamera()->Azimuth(degrees);
    renderer_->ResetCameraClippingRange();
    const double start = wallSeconds();
    window_->Render();
    window_->WaitForCompletion();
    return 1e3 * (wallSeconds() - start);
  }

  Camera homeOf(const SLIMSurface& surface) const {
    const BoundingSpheres object = spheresOf(surface);
    return cameraFor(chooseView(object), object, {settings_.width, settings_.height});
  }

  const Settings& settings_;
  Camera home_;
  vtkNew<vtkRenderWindow> window_;
  vtkNew<vtkRenderer> renderer_;
  vtkNew<SLIMMapper> mapper_;
  vtkNew<vtkActor> actor_;
};

/** \brief How two pictures of white background differ. */
struct Difference {
  std::size_t over_2 = 0, over_16 = 0;  ///< pixels with a channel that differs by more
  std::size_t drawn_once = 0;           ///< pixels that only one of them draws
  int largest = 0;                      ///< of 255
};

Difference differenceOf(const Image& a, const Image& b) {
  Difference d;
  for (std::size_t i = 0; i + 2 < a.rgb.size(); i += 3) {
    int largest = 0, paper_a = 255, paper_b = 255;
    for (std::size_t k = i; k < i + 3; ++k) {
      largest = std::max(largest, std::abs(int{a.rgb[k]} - int{b.rgb[k]}));
      paper_a = std::min(paper_a, int{a.rgb[k]});
      paper_b = std::min(paper_b, int{b.rgb[k]});
    }
    d.over_2 += largest > 2;
    d.over_16 += largest > 16;
    d.drawn_once += (paper_a == 255) != (paper_b == 255);
    d.largest = std::max(d.largest, largest);
  }
  return d;
}

Error savePictures(const std::string& folder, std::string name, const Image& cpu,
                   const Image& card) {
  if (folder.empty()) return {};
  std::replace(name.begin(), name.end(), ' ', '_');
  if (Error error = savePng(folder + "/" + name + "_cpu.png", cpu)) return error;
  return savePng(folder + "/" + name + "_card.png", card);
}

Result<std::shared_ptr<const SLIMSurface>> surfaceOf(const Settings& s) {
  if (s.surface == "sphere") {
    const MadeSphere sphere{static_cast<std::size_t>(s.leaves), s.degree, false, true};
    return std::make_shared<const SLIMSurface>(makeSphere(sphere));
  }
  Result<SLIMSurface> surface = loadSlim(s.surface);
  if (!surface) return surface.error();
  return std::make_shared<const SLIMSurface>(std::move(*surface));
}

/** \brief One row: a scene by both, times and differences. */
Error compare(const Settings& s, const Scene& scene, Window& window) {
  if (!window.show(scene)) return {};
  const Image cpu = window.picture(RayBackend::kCPU);
  const Image card = window.picture(RayBackend::kOpenGL);
  if (!window.onCard()) return {ErrorCode::kBadArgument, "the graphics card did not draw"};
  const Difference d = differenceOf(cpu, card);
  const double card_time = window.milliseconds(RayBackend::kOpenGL, s.frames);
  const double cpu_time = window.milliseconds(RayBackend::kCPU, s.frames);
  const AutoTurn automatic = window.turnByAuto(s.frames);
  std::printf("| %s | %.1f | %.1f | %.1f | %d of %d | %d | %zu | %zu | %zu | %d |\n", scene.name,
              cpu_time, card_time, automatic.milliseconds, automatic.by_card, s.frames,
              automatic.changes, d.over_2, d.over_16, d.drawn_once, d.largest);
  std::fflush(stdout);
  return savePictures(s.pictures, scene.name, cpu, card);
}

Error run(const Settings& s) {
  const auto surface = surfaceOf(s);
  if (!surface) return surface.error();
  Window window(s, *surface);
  std::printf("%s: %zu leaves of degree %d, %d x %d pixels\n%s\n\n", s.surface.c_str(),
              (*surface)->numLeaves(), (*surface)->info.degree, s.width, s.height,
              window.cardName().c_str());
  std::printf(
      "| scene | CPU, ms | card, ms | kAuto, ms | by the card | changes | pixels over 2 of 255 | "
      "over 16 | drawn by one alone | largest |\n|---|---|---|---|---|---|---|---|---|---|\n");
  for (const Scene& scene : kScenes) {
    if (s.only != "all" && s.only != scene.name) continue;
    if (Error error = compare(s, scene, window)) return error;
  }
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  Settings s;
  OptionTable table("card_bench", "", "Frames by the graphics card beside those by the CPU.");
  table.positional("SURFACE.slim|sphere", &s.surface,
                   "surface of pcl_slim_fit, or a sphere made here");
  table.integer("leaves", &s.leaves, 100, 10000000, "of the sphere");
  table.integer("degree", &s.degree, 2, 4, "of the sphere's leaves");
  table.integer("width", &s.width, 16, 8192, "pixels");
  table.integer("height", &s.height, 16, 8192, "pixels");
  table.integer("frames", &s.frames, 1, 1000, "frames of a turn, of which the median is taken");
  table.number("first_zoom", &s.first_zoom, 0.01, 100.0,
               "how many times nearer the six frames are seen that kAuto measures first");
  table.text("only", &s.only, "SCENE", "one scene, by its name in the table");
  table.integer("threads", &s.threads, 0, 256, "of the CPU's frames", "all cores");
  table.text("pictures", &s.pictures, "FOLDER", "pictures of both, as .png");
  if (const auto status = table.parse(argc, argv)) return *status;
  if (const Error error = run(s)) {
    std::fprintf(stderr, "card_bench: %s\n", error.message.c_str());
    return kExitFailed;
  }
  return kExitDone;
}
