// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>

#include "common/options.h"
#include "common/run_program.h"
#include "pcl_slim/core/error.h"

namespace pcl_slim {

/** \brief What a program does with its files. */
struct FileProgram {
  std::string relief;  ///< what helps when memory runs out: "use a smaller scan"
  /** \brief Completes the settings and checks what can be checked before a file is read. */
  std::function<Error()> finish;
  std::function<Exit()> run;
};

/** \brief A whole program that reads files and writes others; see runProgram().
 *
 * Before the work all places that are written are checked: a folder that does not exist ends the
 * program with status 2. A file named "-" is standard input or output. With -out DIR each input is
 * worked on by a process of its own, one after the other: one that fails does not stop the others.
 */
int runFileProgram(OptionTable& options, int argc, const char* const* argv,
                   const FileProgram& program);

}  // namespace pcl_slim
