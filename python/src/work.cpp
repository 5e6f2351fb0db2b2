// SPDX-License-Identifier: BSD-3-Clause
#include "work.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "pcl_slim/core/parallel.h"

namespace pcl_slim::python {

namespace {

using namespace std::chrono_literals;

constexpr auto kLook = 50ms;       ///< between two looks for signals
constexpr auto kPatience = 500ms;  ///< how long a caller waits for cancelled work to end
constexpr int kInterrupted = 130;  ///< exit status of a process that Ctrl-C ended
std::atomic<bool> forked{false};   ///< this process is a child of one that may have used threads
PyObject* no_surface_error = nullptr;

/** One piece of work on its thread. */
class Job : public Work {
 public:
  Job(std::shared_ptr<void> state, std::function<Error(Work&)> body)
      : state_(std::move(state)), body_(std::move(body)) {
    thread_ = std::thread([this] { perform(); });
  }
  ~Job() override { thread_.join(); }

  Progress* progress() override { return &progress_; }
  void part(double begin, double end) override {
    const std::lock_guard<std::mutex> lock(mutex_);
    begin_ = begin;
    end_ = end;
  }

  /** Whether the body ended within a time. */
  bool waitFor(std::chrono::milliseconds time) {
    std::unique_lock<std::mutex> lock(mutex_);
    return ended_signal_.wait_for(lock, time, [this] { return ended_; });
  }
  bool hasEnded() { return waitFor(0ms); }

  struct Report {
    double share = 0;
    std::string stage;
  };
  /** The latest report, if it is a new one. */
  std::optional<Report> takeReport() {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!reported_) return std::nullopt;
    reported_ = false;
    return report_;
  }

  /** Of a body that has ended. */
  Error result() {
    if (thrown_) std::rethrow_exception(thrown_);
    return error_;
  }

 private:
  void perform() {
    Error error;
    std::exception_ptr thrown;
    try {
      error = body_(*this);
    } catch (...) {
      thrown = std::current_exception();
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    error_ = std::move(error);
    thrown_ = thrown;
    ended_ = true;
    ended_signal_.notify_all();
  }

  void take(float share, const char* stage) {
    const std::lock_guard<std::mutex> lock(mutex_);
    report_.share = begin_ + (end_ - begin_) * std::clamp(static_cast<double>(share), 0.0, 1.0);
    report_.stage = stage != nullptr ? stage : "";
    reported_ = true;
  }

  std::shared_ptr<void> state_;  ///< outlives the body, which uses it
  std::function<Error(Work&)> body_;
  Progress progress_{[this](float share, const char* stage) { take(share, stage); }};
  std::mutex mutex_;
  std::condition_variable ended_signal_;
  bool ended_ = false, reported_ = false;
  double begin_ = 0, end_ = 1;
  Report report_;
  Error error_;
  std::exception_ptr thrown_;
  std::thread thread_;
};

/** Cancelled work that did not end in time. Python's lock guards it. */
std::vector<std::unique_ptr<Job>>& leftBehind() {
  static auto* jobs = new std::vector<std::unique_ptr<Job>>;  // never destroyed: threads may run
  return *jobs;
}

void dropEnded() {
  auto& jobs = leftBehind();
  jobs.erase(std::remove_if(jobs.begin(), jobs.end(),
                            [](const std::unique_ptr<Job>& job) { return job->hasEnded(); }),
             jobs.end());
}

/** At the end of the interpreter, which would pull the memory away under running work. Ctrl-C ends
 * the process immediately. */
void awaitAll() {
  for (const auto& job : leftBehind()) {
    for (bool ended = false; !ended;) {
      {
        const py::gil_scoped_release release;
        ended = job->waitFor(kLook);
      }
      if (PyErr_CheckSignals() != 0) std::_Exit(kInterrupted);
    }
  }
  leftBehind().clear();
}

/** Waits for a job; calls progress and looks for signals. Throws what these raise. */
void await(Job& job, const py::object& progress) {
  for (;;) {
    bool ended = false;
    {
      const py::gil_scoped_release release;
      ended = job.waitFor(kLook);
    }
    if (ended) return;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    if (progress.is_none()) continue;
    if (const auto report = job.takeReport()) progress(report->share, report->stage);
  }
}

}  // namespace

void raise(const Error& error) {
  switch (error.code) {
    case ErrorCode::kIo: PyErr_SetString(PyExc_OSError, error.message.c_str()); break;
    case ErrorCode::kNoSurface: PyErr_SetString(no_surface_error, error.message.c_str()); break;
    case ErrorCode::kCancelled:
      PyErr_SetString(PyExc_KeyboardInterrupt, error.message.c_str());
      break;
    default: PyErr_SetString(PyExc_ValueError, error.message.c_str());
  }
  throw py::error_already_set();
}

void raiseValue(const std::string& sentence) {
  raise({ErrorCode::kBadArgument, sentence});
}

void run(const py::object& progress, std::shared_ptr<void> state,
         std::function<Error(Work&)> body) {
  if (!progress.is_none() && PyCallable_Check(progress.ptr()) == 0)
    raiseValue("progress is no callable: pass a function of a share and a stage, or None");
  dropEnded();
  auto job = std::make_unique<Job>(std::move(state), std::move(body));
  try {
    await(*job, progress);
  } catch (...) {
    job->progress()->cancel();
    bool ended = false;
    {
      const py::gil_scoped_release release;
      ended = job->waitFor(kPatience);
    }
    if (!ended) leftBehind().push_back(std::move(job));
    throw;
  }
  if (Error error = job->result()) raise(error);
  if (progress.is_none()) return;
  const auto last = job->takeReport();
  progress(1.0, last ? last->stage : std::string("done"));
}

int threadsFor(int requested) {
  if (Error error = checkThreads(requested)) raise(error);
  return forked ? 1 : requested;
}

void bindWork(py::module_& m) {
  const auto builtin = py::reinterpret_borrow<py::object>(PyExc_RuntimeError);
  no_surface_error =
      PyErr_NewExceptionWithDoc("pcl_slim.NoSurfaceError",
                                "The points are fine, but nowhere a surface: too few, along lines, "
                                "or scattered in space.",
                                builtin.ptr(), nullptr);
  m.attr("NoSurfaceError") = py::reinterpret_borrow<py::object>(no_surface_error);
  py::module_::import("atexit").attr("register")(py::cpp_function(&awaitAll));
  const auto after_fork = py::cpp_function([] { forked = true; });
  py::module_::import("os").attr("register_at_fork")(py::arg("after_in_child") = after_fork);
}

}  // namespace pcl_slim::python
