// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "common/options.h"
#include "pcl_slim/render/bounding_spheres.h"
#include "pcl_slim/render/camera.h"
#include "pcl_slim/render/render_params.h"
#include "pcl_slim/surface/slim_blocks.h"

namespace pcl_slim {

/** \brief The view that a request gives of an object. */
struct ChosenView {
  Camera camera;
  std::array<double, 3> up{};  ///< of the object, whichever way the camera looks
  bool opens = false;  ///< drawn without its near side, which hides the inside that was scanned
  std::string words;   ///< what was chosen, for the console; nothing of a camera given
};

/** \brief A camera as given on the command line. */
struct ViewRequest {
  std::string camera = "auto", view = "auto", up = "auto", size_text = "800x600";
  double fov = 0.0;           ///< 0: by the object
  double right_margin = 0.0;  ///< share of the width that the object is to leave free there
  bool orthographic = false;
  ImageSize size;               ///< of size_text
  std::vector<double> angles;   ///< of view; empty: chosen by the object
  std::optional<Camera> given;  ///< of camera, but for its size

  /** \brief Adds -size. */
  void declareSize(OptionTable& table);
  /** \brief Adds the options of the camera. The request must outlive the table's parse(). */
  void declareCamera(OptionTable& table);

  /** \brief Reads size_text, view and camera; checks what needs no object. */
  Error parse();

  /** \brief The view of an object, once parse() has gone well. */
  ChosenView viewOf(const BoundingSpheres& object) const;
  /** \brief The same of the whole object, with a camera from which framed fits into the picture. */
  ChosenView viewOf(const BoundingSpheres& object, const BoundingSpheres& framed) const;

 private:
  Camera framing(const BoundingSpheres& framed, const ViewDirection& direction) const;
};

/** \brief The cameras of pictures all the way round an upright object, to the right. One that the
 * request does not give is so far away that every picture shows the whole object. */
class Turntable {
 public:
  Turntable(const ViewRequest& request, const BoundingSpheres& object, int count);

  int count() const { return count_; }
  Camera camera(int turn) const;
  /** \brief The first view. */
  const ChosenView& first() const { return first_; }

  /** \brief OUT_000.png, OUT_001.png ... for OUT.png; OUT.png itself if there is but one. */
  static std::string path(const std::string& path, int turn, int count);

 private:
  ChosenView first_;
  std::array<double, 3> pivot_{};
  int count_;
};

/** \brief A box of interest: everything outside is neither drawn nor looked at by the camera. */
struct RegionRequest {
  std::string text = "all";
  std::vector<HalfSpace> sides;  ///< of text, world coordinates; empty: no box

  /** \brief x0, x1, y0, y1, z0, z1 of the box, once parse() has gone well; an object's own without
   * one. */
  std::array<double, 6> bounds(const BoundingSpheres& object) const;

  /** \brief Its corners, once parse() has gone well; only where there is a box. */
  WorldBox box() const;

  /** \brief Adds -region. The request must outlive the table's parse(). */
  void declare(OptionTable& table);

  /** \brief Reads text. */
  Error parse();

  /** \brief What a camera has to look at. \param[in] whole where the object is, if only a part of
   * it is given
   * \return an error that gives the object's position when the box contains nothing of it */
  Result<BoundingSpheres> within(const BoundingSpheres& object,
                                 const WorldBox* whole = nullptr) const;
};

}  // namespace pcl_slim
