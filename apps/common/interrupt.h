// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pcl_slim/core/progress.h"

namespace pcl_slim {

/** \brief From here on Ctrl-C (SIGINT), SIGTERM and SIGHUP end the program within a second.
 *
 * The first signal cancels the work whose progress was named; the work then ends and reports it.
 * Work that has not ended half a second later, or that named no progress, is ended by force: an
 * unfinished file is removed, an output that existed before stays as it was, and the program returns
 * 128 + the signal's number (130 for Ctrl-C), as a shell expects. A second signal does so immediately.
 * The end of the time that ulimit -t grants (SIGXCPU) is such a signal, too. What a pipe without a
 * reader or a file beyond ulimit -f refuses is reported by the write itself: SIGPIPE and SIGXFSZ end
 * nothing. */
void
endOnSignals();

/** \brief From here on signals are ignored: the output is about to be renamed to its final name, which
 * takes no time and must not end half way. \return false if a signal has come already: then nothing
 * is to be renamed. */
bool
outlastSignals();

/** \brief The work that the first signal cancels; null: none. */
void
cancelOnSignals(Progress* progress);

/** \brief The signal that came, or 0. */
int
receivedSignal();

}  // namespace pcl_slim
