// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>

#include "common/options.h"
#include "pcl_slim/core/error.h"

namespace pcl_slim {

/** \brief Prints "program: message" on stderr. \return the status, to exit with. */
int
fail(const std::string& program, int status, const std::string& message);

/** \brief The same for work that failed: kExitInterrupted if it was cancelled, else kExitFailed. */
int
failWork(const std::string& program, const Error& error);

/** \brief Does a program's work; what it throws becomes one line and kExitFailed.
 * \param[in] relief what helps when memory runs out: "use a smaller scan". */
int
guarded(const std::string& program, const std::string& relief, const std::function<int()>& work);

/** \brief A whole program: reads the arguments, then checks them (an error there exits
 * with kExitUsage), then works. Errors are printed. \return the status to exit with. */
int
runProgram(OptionTable& options, int argc, const char* const* argv, const std::string& relief,
           const std::function<Error()>& check, const std::function<Error()>& work);

/** \brief The same for a program whose arguments fill one struct: declare(settings) makes the
 * table, check(table, settings) checks, work(settings) works. */
template <typename Settings, typename Declare, typename Check, typename Work>
int
runProgram(int argc, const char* const* argv, const std::string& relief, const Declare& declare,
           const Check& check, const Work& work)
{
  Settings settings;
  OptionTable options = declare(settings);
  return runProgram(
      options, argc, argv, relief, [&] { return check(options, settings); },
      [&] { return work(settings); });
}

/** \brief The command as it was given, without the program's folder. */
std::string
commandLine(int argc, const char* const* argv);

}  // namespace pcl_slim
