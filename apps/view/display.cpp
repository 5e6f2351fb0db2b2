// SPDX-License-Identifier: BSD-3-Clause
#include "view/display.h"

#ifdef PCL_SLIM_HAS_X11
#include <X11/Xlib.h>
#endif

namespace pcl_slim {

Error
checkDisplay()
{
#ifdef PCL_SLIM_HAS_X11
  Display* display = XOpenDisplay(nullptr);
  if (!display) {
    return {ErrorCode::kIo,
            "there is no X server to open a window on; set DISPLAY, run it under xvfb-run, or make "
            "a picture with pcl_slim_render"};
  }
  XCloseDisplay(display);
#endif
  return {};
}

}  // namespace pcl_slim
