// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pcl_slim/core/progress.h"

namespace pcl_slim {

/** \brief From here on Ctrl-C (SIGINT), SIGTERM and SIGHUP end the program within a second.
 *
 * The first signal cancels the work whose progress was named, which then ends by itself and says so.
 * Work that has not ended half a second later, or that named no progress, is ended as it stands: an
 * unfinished file is removed, an output that existed before stays as it was, and the program returns
 * 128 + the signal's number (130 for Ctrl-C), as a shell expects. So does a second signal, at once.
 * The end of the time that ulimit -t grants (SIGXCPU) is such a signal, too. What a pipe without a
 * reader or a file beyond ulimit -f refuses is told by the write itself: SIGPIPE and SIGXFSZ end
 * nothing. */
void
endOnSignals();

/** \brief From here on signals are passed over: what was made is about to be put in its place, which
 * takes no time and must not end half way. \return false if a signal has come already, which asks to
 * put nothing there. */
bool
outlastSignals();

/** \brief The work that the first signal cancels; null: none. */
void
cancelOnSignals(Progress* progress);

/** \brief The signal that came, or 0. */
int
receivedSignal();

}  // namespace pcl_slim
