// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/core/deprecated.h"

#include <gtest/gtest.h>

namespace {

PCL_SLIM_DEPRECATED(1, 0, "use newName()") int oldName() {
  return 1;
}

struct Settings {
  PCL_SLIM_DEPRECATED(1, 0, "use size") int length = 2;
};

// Marked names stay usable; their warnings are errors in continuous integration, here they are meant.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wdeprecated-declarations"
TEST(Deprecated, NamesStayUsable) {
  EXPECT_EQ(oldName(), 1);
  EXPECT_EQ(Settings{}.length, 2);
}
#pragma GCC diagnostic pop

}  // namespace
