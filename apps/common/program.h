// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "common/run_program.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/core/file_access.h"
#include "pcl_slim/core/progress.h"
#include "pcl_slim/core/stopwatch.h"

namespace pcl_slim {

/** \brief What a program prints while it works, in the manner of PCL's tools:
 * "> Loading scan.pcd [done, 12 ms : 34817 points]".
 *
 * On a terminal a bar shows how far a stage is. With quiet nothing is written but warnings. While
 * it lives, Ctrl-C cancels the running work through progress() (see runProgram()).
 */
class Console {
 public:
  explicit Console(bool quiet);
  ~Console();
  Console(const Console&) = delete;
  Console& operator=(const Console&) = delete;

  /** \brief Begins a line: "> Loading scan.pcd ". */
  void begin(const std::string& what);
  /** \brief Wall time since begin(). */
  double seconds() const { return stage_.seconds(); }
  /** \brief Ends the line: "[done, 12 ms : detail]". */
  void done(const std::string& detail) { done(seconds(), detail); }
  void done(double seconds, const std::string& detail);
  /** \brief Ends the line without success. \return the error. */
  Error failed(const Error& error);
  /** \brief A line of its own. */
  void note(const std::string& text);
  /** \brief One on stderr, also with quiet: the output is not what was hoped for. */
  void warn(const std::string& text);

  Progress& progress() { return progress_; }
  bool interrupted() const { return progress_.cancelled(); }

 private:
  void showBar(float fraction, const char* stage);
  void clearBar();

  bool quiet_, terminal_;
  int shown_percent_ = -1;
  std::string line_, shown_stage_;
  Stopwatch stage_;
  Progress progress_;
};

struct ReportField;

/** \brief A value of a report: a truth, a number, a text, or a list or an object of values. */
struct ReportValue {
  using List = std::vector<ReportValue>;
  using Object = std::vector<ReportField>;

  ReportValue(bool truth) : data(truth) {}
  template <typename T, std::enable_if_t<std::is_integral_v<T>, int> = 0>
  ReportValue(T number)
      : data(std::conditional_t<std::is_signed_v<T>, std::int64_t, std::uint64_t>(number)) {}
  ReportValue(double number) : data(number) {}
  ReportValue(const char* text) : data(std::string(text)) {}
  ReportValue(const std::string& text) : data(text) {}
  template <typename T>
  ReportValue(const std::vector<T>& list) : data(List(list.begin(), list.end())) {}
  ReportValue(const std::array<double, 3>& list) : data(List(list.begin(), list.end())) {}
  ReportValue(std::initializer_list<ReportField> fields);
  ReportValue(const Object& fields);

  std::variant<bool, std::int64_t, std::uint64_t, double, std::string, List, Object> data;
};

struct ReportField {
  std::string name;
  ReportValue value;
};

/** \brief What a program did, as a JSON object with the keys every program has in common.
 *
 * program, version, input, points, threads, seconds{total, ...}, peak_rss_mb, and what the program
 * sets and adds before write().
 */
class Report {
 public:
  /** \param[in] threads as given; 0: all cores. */
  Report(const OptionTable& options, const std::string& input, int threads);

  /** \brief Appends a key with its value; a key that is there keeps its place and gets the value. */
  void set(const std::string& name, ReportValue value) { add({{name, std::move(value)}}); }
  /** \brief The same of several. */
  void add(std::initializer_list<ReportField> fields);

  /** \brief Sets an object with what another report has of an input of its own: all but what every
   * report has in common, and the times of its stages. */
  void addPart(const std::string& name, const Report& part);

  /** \brief Notes a stage's wall time under seconds{}. */
  void time(const std::string& stage, double seconds) { seconds_.push_back({stage, seconds}); }

  /** \brief Writes the report with the total time and peak memory; nothing for an empty path. */
  Error write(const std::string& path) const;

 private:
  Stopwatch total_;
  ReportValue::Object fields_, seconds_;
};

/** \brief Highest resident memory of this process so far, in 2^20 bytes; 0 where unknown. */
double peakMemoryMb();

/** \brief Whether two names are of one file; an empty name is of none. */
bool samePlace(const std::string& a, const std::string& b);

/** \brief Whether the files written differ from the files read and from each other; empty
 * names are of no file. */
Error checkPlaces(const std::vector<std::string>& read, const std::vector<std::string>& written);

/** \brief The last stage of a program: saves its output and its report and prints it. Both appear,
 * or neither; an older output stays when something fails. Work that was interrupted is not saved;
 * signals end nothing from then on.
 * \param[in] save writes the output; \param[in] detail its contents: "5000 surfels". */
Error saveOutput(const std::string& output, const std::string& report_file,
                 const std::function<Error()>& save, const std::string& detail, Console& console,
                 Report& report);

/** \brief Puts a program's files in their places, unless a signal has come: then none of them. */
Error commitOutputs(FileTransaction& files);

}  // namespace pcl_slim
