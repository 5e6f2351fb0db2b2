// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <utility>

#include "pcl_slim/cloud/side_evidence.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/core/progress.h"

namespace pcl_slim {

/** \brief A progress callback and a cancel flag; a copy takes the callback and has its own flag. */
class RunControl {
 public:
  RunControl() = default;
  RunControl(const RunControl& other) : callback(other.callback) {}
  RunControl& operator=(const RunControl& other) {
    callback = other.callback;
    return *this;
  }

  Progress::Callback callback;
  Progress progress{[this](float fraction, const char* stage) {
    const Progress::Callback now = callback;  // which may replace the callback
    if (now) now(fraction, stage);
  }};
};

/** \brief What every class that works on PCL clouds has in common: progress, a way to stop it, and
 * the reason why it failed. */
class PCL_SLIM_EXPORT ControlledRun {
 public:
  /** \brief Called from the thread that runs with the share done and the stage's name. It may call
   * setters: the run continues with the inputs and parameters of its begin. An exception of the
   * callback stops the run. */
  void setProgressCallback(Progress::Callback callback) { control_.callback = std::move(callback); }

  /** \brief Stops the run in progress, from any thread or a signal handler. Before an object's
   * first run it stops that one. After a run has ended it does nothing, so that one that comes a
   * moment too late does not stop the next run; see expectRun(). */
  void cancel() { control_.progress.cancel(); }

  /** \brief From now on cancel() is meant for the next run, whether or not it has begun: to be
   * called before a second or later run is started in another thread. */
  void expectRun() { control_.progress.expectRun(); }

  /** \brief Why the last run failed, in one sentence; no error after a success. */
  const Error& getError() const { return error_; }
  /** \brief What the last run decided that a user may want otherwise, as the sides of a scan whose
   * sensor is not known, and settings that had no effect; in sentences without a full stop,
   * separated by "; ", empty where there is nothing. Results are complete all the same. Whatever a
   * run prints as a warning is part of it. */
  const std::string& getWarning() const { return warning_; }

 protected:
  ControlledRun() = default;
  ~ControlledRun() = default;

  /** \brief Forgets the last run. */
  void clearResults();
  /** \brief Records an error. \return false, as the run itself does. */
  bool fail(ErrorCode code, const std::string& message);
  /** \brief Adds what sideNotes() says to the warning. */
  void warnOfSides(SideSource source, const NormalAgreement& normals);
  /** \brief Adds a sentence to the warning, which printWarning() prints, too. */
  void warn(const std::string& sentence);
  /** \brief Prints the sentences of warn(), as PCL prints warnings: for verbs that PCL's base
   * classes have. \param[in] verb "Class::verb" */
  void printWarning(const char* verb) const;
  /** \brief Forgets the warning. */
  void clearWarning();
  /** \brief Records the Error that body() returns, that it was cancelled meanwhile, or what it
   * threw. Takes no memory before body() runs. \param[in] work what body does, as in "the fit";
   * \param[in] remedy where memory does not suffice. \return whether all went well. */
  template <typename Body>
  bool guarded(const char* work, const char* remedy, const Body& body) {
    const auto call = [](const void* that) -> Error { return (*static_cast<const Body*>(that))(); };
    return guardedCall(work, remedy, call, &body);
  }

  RunControl control_;
  Error error_;

 private:
  void addWarning(const std::string& sentence);

  std::string warning_, printed_;
  bool guardedCall(const char* work, const char* remedy, Error (*call)(const void*),
                   const void* body);
};

}  // namespace pcl_slim
