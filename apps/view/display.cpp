// SPDX-License-Identifier: BSD-3-Clause
#include "view/controls.h"

#ifdef PCL_SLIM_HAS_X11
#include <X11/Xlib.h>
#endif

namespace pcl_slim {

Error checkDisplay() {
#ifdef PCL_SLIM_HAS_X11
  // The connection stays open as long as the program runs: Xvfb restarts when its last client
  // disconnects, and refuses connections meanwhile.
  static Display* const display = XOpenDisplay(nullptr);
  if (!display) {
    return {ErrorCode::kIo,
            "there is no X server to open a window on; set DISPLAY, run it under xvfb-run, or make "
            "a picture with pcl_slim_render"};
  }
#endif
  return {};
}

}  // namespace pcl_slim
