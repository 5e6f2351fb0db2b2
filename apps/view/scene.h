// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vtkNew.h>
#include <vtkSmartPointer.h>

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "pcl_slim/cloud/cloud_view.h"
#include "pcl_slim/render/bounding_spheres.h"
#include "pcl_slim/render/render_params.h"
#include "pcl_slim/splat/splat_set.h"
#include "pcl_slim/surface/surface.h"
#include "pcl_slim/visualization/display_mode.h"

class vtkActor;
class vtkBoxRepresentation;
class vtkBoxWidget2;
class vtkPlaneCollection;
class vtkRenderWindowInteractor;
class vtkRenderer;
class vtkScalarBarActor;

namespace pcl_slim {

class GBufferMapper;
class SLIMMapper;
class SplatMapper;

/** \brief What a window shows of a model: the model itself, and, where requested, the points it was
 * made of, the balls of its leaves coloured by size, and the normals. */
class Scene {
 public:
  explicit Scene(vtkRenderer* renderer);
  ~Scene();

  /** \brief Another surface in place of one keeps its colours, lines and detail. */
  void setSurface(std::shared_ptr<const SLIMSurface> surface);
  void setSplats(std::shared_ptr<const SplatSet> splats);
  /** \brief Shows a scan's finite points, in their colours if they have any, else grey. O(points).
   */
  void setPoints(const CloudView& points, const ColorView& colors);

  /** \brief The mapper of the surface or the splats; null before there is either. */
  GBufferMapper* mapper() const;
  SLIMMapper* surfaceMapper() const;
  /** \brief Whether what is shown has colours of its own. */
  bool hasColors() const {
    return (splats_ && splats_->hasColors()) || (surface_ && surface_->hasColors());
  }
  vtkActor* model() const;
  /** \brief The name of the unit of length, such as mm, for text and scale; empty: none. */
  void setUnit(const std::string& unit) { unit_ = unit; }
  const std::string& unit() const { return unit_; }
  /** \brief The diagonal of the model's bounding box, world units. */
  double diagonal() const { return diagonal_; }
  /** \brief Whether the model is lit, now and later, or shown in bare colours. */
  void setLighting(bool lit);

  /** \brief What cameras look at: the model, else the points. */
  BoundingSpheres spheres() const;

  /** \brief \return false for what the model does not have. */
  bool setMode(DisplayMode mode, double range);
  /** \brief The next mode the model has, forwards or backwards. */
  void stepMode(int step);
  /** \brief Widens or narrows the range of a curvature map; 0: back to the automatic one. */
  void scaleRange(double factor);

  /** \brief Cuts all that is shown, now and later, to the intersection of some half spaces. */
  void cut(const std::vector<HalfSpace>& sides);

  void showModel(bool shown);
  void showPoints(bool shown);
  void showBalls(bool shown);
  void showNormals(bool shown);
  bool modelShown() const;
  bool pointsShown() const;
  bool ballsShown() const;
  bool normalsShown() const;
  bool barShown() const { return bar_ != nullptr; }
  /** \brief Size of the scalar bar's letters, that shown and those to come. */
  void setBarLetters(int pixels);

 private:
  void setMapper(GBufferMapper* mapper);
  void add(vtkActor* actor);
  void remove(vtkSmartPointer<vtkActor>& actor);
  void updateBar();

  vtkRenderer* renderer_;
  std::shared_ptr<const SLIMSurface> surface_;
  std::shared_ptr<const SplatSet> splats_;
  BoundingSpheres point_spheres_;
  vtkNew<vtkPlaneCollection> cuts_;
  vtkSmartPointer<GBufferMapper> mapper_;
  vtkSmartPointer<vtkActor> model_, points_, balls_, normals_;
  vtkSmartPointer<vtkScalarBarActor> bar_;
  int letters_ = 13;  ///< pixels
  std::string unit_;
  double diagonal_ = 1.0;
  bool lit_ = true;
};

/** \brief A box in a window whose sides and place the mouse drags by their handles: everything
 * outside is to be cut away. */
class CutBox {
 public:
  /** \param[in] dragged called whenever the mouse has moved the box */
  explicit CutBox(const std::function<void()>& dragged);
  ~CutBox();

  /** \brief Shows it in an interactor's window. \param[in] bounds x0, x1, y0, y1, z0, z1 that it
   * starts from, and which size its handles */
  void show(vtkRenderWindowInteractor* interactor, const std::array<double, 6>& bounds);
  void hide();
  bool shown() const;

  /** \brief The half spaces that its sides bound, world coordinates. */
  std::vector<HalfSpace> sides() const;

 private:
  std::function<void()> dragged_;
  vtkNew<vtkBoxWidget2> widget_;
  vtkNew<vtkBoxRepresentation> box_;
};

/** \brief A sample of a scan's points, with their normals where it has any, for the first camera:
 * it then is placed as for the fitted surface, or nearly so. Finite points only. O(sample). */
BoundingSpheres spheresOfPoints(const CloudView& points);

}  // namespace pcl_slim
