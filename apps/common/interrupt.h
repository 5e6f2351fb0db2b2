// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pcl_slim/core/progress.h"

namespace pcl_slim {

/** \brief From here on Ctrl-C (SIGINT), SIGTERM and SIGHUP end the program within a second.
 *
 * The first signal cancels the work whose progress was named, which then ends by itself and says so.
 * Work that has not ended half a second later, or that named no progress, is ended as it stands: an
 * unfinished file is removed, an output that existed before stays as it was, and the program returns
 * 128 + the signal's number (130 for Ctrl-C), as a shell expects. So does a second signal, at once. */
void
endOnSignals();

/** \brief The work that the first signal cancels; null: none. */
void
cancelOnSignals(Progress* progress);

/** \brief The signal that came, or 0. */
int
receivedSignal();

}  // namespace pcl_slim
