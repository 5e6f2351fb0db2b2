// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <functional>
#include <string>
#include <utility>

#include "common/options.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/core/progress.h"

namespace pcl_slim {

/** \brief From here on signals are ignored: the output is about to be renamed to its final name,
 * which takes no time and must not end half way. \return false if a signal has come already: then
 * nothing is to be renamed. */
bool outlastSignals();

/** \brief From here on signals end the program again, as runProgram() says. */
void endOnSignals();

/** \brief The work that the first signal cancels; null: none. */
void cancelOnSignals(Progress* progress);

/** \brief A process that signals are passed to, in place of what they would end here; 0: none. */
void passSignalsTo(pid_t process);

/** \brief The signal that has come, or 0. */
int signalReceived();

/** \brief Adds -max_memory, in 2^20 bytes; 0, the default, is no limit. From the end of parsing on an
 * allocation beyond the limit fails (Linux; elsewhere only checkMemory() enforces it), and
 * runProgram() reports it. */
void declareMemoryLimit(OptionTable& options);

/** \brief Whether the limit allows this number of bytes, whatever is in use already. */
bool isWithinMemoryLimit(double bytes);

/** \brief Refuses work that would take it beyond the limit set. \param[in] bytes a lower bound of
 * what the work will take on top; \param[in] what needs it, as in "fitting 5000000 points";
 * \param[in] relief what else helps than a higher limit. */
Error checkMemory(double bytes, const std::string& what,
                  const std::string& relief = "use fewer points");

/** \brief Bytes that the limit leaves; without one, most of what the machine has free. */
double memoryLeft();

/** \brief The error of work that a signal stopped. */
Error stopped();

/** \brief How a program ends: its status and, unless it has done its work, the one line that says why.
 */
struct Exit {
  int status = kExitDone;
  std::string message;

  Exit() = default;
  Exit(int exit_status, std::string why) : status(exit_status), message(std::move(why)) {}

  /** \brief The end of work that is done, failed or, where it was cancelled, was interrupted. */
  Exit(const Error& work);

  /** \brief The end of a program whose options or input cannot be used. */
  static Exit usage(const Error& error) { return {kExitUsage, error.message}; }
};

/** \brief A whole program: reads the arguments, runs the body and prints the line that says why it
 * failed. What the body throws fails, too. \return the status to exit with
 * \param[in] relief what helps when memory runs out: "use a smaller scan"
 *
 * From here on Ctrl-C (SIGINT), SIGTERM and SIGHUP end the program within a second. The first signal
 * cancels the work whose progress was named; the work then ends and reports it. Work that has not
 * ended half a second later, or that named no progress, is ended by force: an unfinished file is
 * removed, an output that existed before stays as it was, and the program returns 128 + the signal's
 * number (130 for Ctrl-C), as a shell expects. A second signal does so immediately. The end of the
 * time that ulimit -t grants (SIGXCPU) is such a signal, too. What a pipe without a reader or a file
 * beyond ulimit -f refuses is reported by the write itself: SIGPIPE and SIGXFSZ end nothing. */
int runProgram(OptionTable& options, int argc, const char* const* argv, const std::string& relief,
               const std::function<Exit()>& body);

/** \brief The command as it was given, without the program's folder. */
std::string commandLine(int argc, const char* const* argv);

}  // namespace pcl_slim
