// SPDX-License-Identifier: BSD-3-Clause
// Work without Python's lock: on a thread of its own, while the caller's thread looks after Ctrl-C
// and the progress callable.
#pragma once

#include <pybind11/pybind11.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/progress.h"

namespace pcl_slim::python {

namespace py = pybind11;

/** \brief Raises an error: ValueError of arguments and input, OSError of files, NoSurfaceError,
 * KeyboardInterrupt. Needs Python's lock. */
[[noreturn]] void raise(const Error& error);

/** \brief ValueError with a sentence. */
[[noreturn]] void raiseValue(const std::string& sentence);

/** \brief What a piece of work reports to. */
class Work {
 public:
  virtual ~Work() = default;
  virtual Progress* progress() = 0;
  /** \brief From now on the reported share [0, 1] is that of this part of the whole. */
  virtual void part(double begin, double end) = 0;
};

/** \brief Runs a body without Python's lock and raises what it returns.
 *
 * The progress callable is called on this thread, about 20 times a second, with the share done and
 * the name of the stage. What it raises, or Ctrl-C, ends the work: at once where the body stops
 * within kPatience, else the body ends in the background, so it must own what it uses: in `state`,
 * which is released with Python's lock.
 * \param[in] progress a callable or None */
void run(const py::object& progress, std::shared_ptr<void> state, std::function<Error(Work&)> body);

/** \brief The number of threads for work: 1 in a process that was forked, where oneTBB's threads
 * are missing. Results are the same. Raises for a number out of range. */
int threadsFor(int requested);

void bindWork(py::module_& m);

}  // namespace pcl_slim::python
