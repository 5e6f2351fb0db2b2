// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include "common/options.h"
#include "common/program.h"
#include "common/programs.h"
#include "comparison/tables.h"
#include "comparison/treat.h"
#include "support/lab/bench.h"

// pcl_slim_benchmark: time against error, SLIM compared with PCL's own classes.

namespace pcl_slim::comparison {

/** \brief What pcl_slim_benchmark measures: scenes, and the ways each is treated. */
class Plan {
 public:
  /** \brief Adds the options; the plan must outlive the table's parse(). */
  void declareOptions(OptionTable& options);

  /** \brief Reads the lists given. \return the first mistake, with its remedy. */
  Error finishOptions(const OptionTable& options);

  /** \brief Makes or loads one scene after the other and hands it over, until an error. */
  Error forEachScene(const std::function<Error(const Scene&)>& treat) const;

  /** \brief Every way to treat a scene. */
  std::vector<Setting> settingsFor(const Scene& scene) const;

  int repeats() const { return repeats_; }

 private:
  void addSlim(const Scene& scene, std::vector<Setting>& settings) const;
  Error finishFiles();

  std::string shapes_ = "sphere,torus,bumpy,relief,cube", noises_ = "0,0.001,0.005,0.01";
  std::string points_ = "100000", degrees_ = "1,2,3,4", kappas_ = "0,1,8";
  std::string t_mdls_ = "0.003,0.01", orders_ = "1,2,3", neighbours_ = "30,60,100,200,400";
  std::string methods_ = "slim,mls,normals", normals_ = "both", normal_neighbours_ = "20,50,100";
  std::string input_, truth_, pairs_, vectors_ = "best";
  bool sharp_ = true, robust_ = false, compact_ = false, data_ = false;
  int threads_ = 2, repeats_ = 3;

  struct FilePair {
    std::string name, input, truth;
  };
  std::vector<std::string> shape_list_, method_list_;
  std::vector<double> noise_list_, point_list_, degree_list_, kappa_list_, t_mdl_list_;
  std::vector<double> order_list_, neighbour_list_, normal_neighbour_list_;
  std::vector<FilePair> files_;
};

namespace {

/** Repeats the settings from begin on, sharp ones left out, with a switch turned on. */
void repeatWith(bool Setting::*on, std::size_t begin, std::vector<Setting>& settings) {
  const std::size_t end = settings.size();
  for (std::size_t i = begin; i < end; ++i) {
    if (settings[i].sharp) continue;
    // Normals are weighed against the noise, which T leaves open.
    if (on == &Setting::data && (!settings[i].normals || settings[i].t_mdl > 0)) continue;
    settings.push_back(settings[i]);
    settings.back().*on = true;
  }
}

/** Words separated by commas, each one of those known; the error names them. */
Error parseWords(const std::string& option, const std::string& text,
                 const std::vector<std::string>& known, std::vector<std::string>& words) {
  std::string remedy;
  for (const std::string& word : known) remedy += (remedy.empty() ? "" : ", ") + word;
  std::stringstream stream(text);
  for (std::string word; std::getline(stream, word, ',');) {
    if (std::count(known.begin(), known.end(), word) == 0) {
      return {ErrorCode::kBadArgument,
              "option -" + option + " got '" + word + "'; give some of " + remedy};
    }
    words.push_back(word);
  }
  if (!words.empty()) return {};
  return {ErrorCode::kBadArgument, "option -" + option + " is empty; give some of " + remedy};
}

}  // namespace

void Plan::declareOptions(OptionTable& options) {
  options.text("shapes", &shapes_, "NAME,...",
               "exact surfaces: sphere, torus, bumpy, relief, cube");
  options.text("noises", &noises_, "S,...", "noise, as a share of the box diagonal");
  options.text("points", &points_, "N,...", "sizes of the clouds");
  options.text("input", &input_, "FILE", "a noisy scan in place of exact surfaces; needs -truth");
  options.text("truth", &truth_, "FILE",
               "the scan's true points, in the same order, or a mesh of its true surface");
  options.text("pairs", &pairs_, "FOLDER",
               "every NAME_noisy.ply and NAME_original.ply of a folder in place of exact surfaces");
  options.text("methods", &methods_, "NAME,...",
               "slim, mls (pcl::MovingLeastSquares), normals (pcl::NormalEstimationOMP)");
  options.choice("normals", &normals_, {"0", "1", "both"}, "SLIM: normals given");
  options.text("degrees", &degrees_, "D,...", "SLIM: degrees of the polynomials");
  options.text("kappas", &kappas_, "K,...", "SLIM: penalties; 0: the default one");
  options.text("t_mdls", &t_mdls_, "T,...",
               "SLIM: the paper's T_MDL in place of a penalty; 0: none");
  options.toggle("sharp", &sharp_, "SLIM: also keeping sharp edges, where normals are given");
  options.toggle("normals_as_data", &data_,
                 "SLIM: also each without T, given normals fitted as data beside the points");
  options.toggle("robust", &robust_, "SLIM: also each, reweighted against outliers");
  options.toggle("compact", &compact_, "SLIM: also every setting but sharp with -compact 1");
  options.text("mls_orders", &orders_, "D,...", "MLS: orders of the polynomial");
  options.text("mls_neighbours", &neighbours_, "K,...",
               "MLS: mean numbers of points in the search radius");
  options.text("normal_neighbours", &normal_neighbours_, "K,...", "normals: numbers of neighbours");
  options.integer("threads", &threads_, 1, 4096, "threads, of each method");
  options.integer("repeats", &repeats_, 1, 1000,
                  "runs of each setting that takes no more than 2 s; times are medians");
  options.text("vectors", &vectors_, "NAME",
               "instruction set of SLIM's kernels, such as AVX2; best: all there are");
  options.exclusive({"input", "pairs"});
}

Error Plan::finishFiles() {
  if (input_.empty() != truth_.empty()) {
    return {ErrorCode::kBadArgument,
            "a scan and its truth belong together; give -input and -truth"};
  }
  if (!input_.empty()) {
    files_.push_back({std::filesystem::path(input_).stem().string(), input_, truth_});
  }
  if (pairs_.empty()) return {};
  const std::string suffix = "_noisy.ply";
  std::error_code code;
  for (const auto& entry : std::filesystem::directory_iterator(pairs_, code)) {
    const std::string file = entry.path().filename().string();
    if (file.size() <= suffix.size()) continue;
    const std::string name = file.substr(0, file.size() - suffix.size());
    const auto truth = entry.path().parent_path() / (name + "_original.ply");
    if (file != name + suffix || !std::filesystem::exists(truth, code)) continue;
    files_.push_back({name, entry.path().string(), truth.string()});
  }
  std::sort(files_.begin(), files_.end(),
            [](const FilePair& a, const FilePair& b) { return a.name < b.name; });
  if (!files_.empty()) return {};
  return {ErrorCode::kBadInput,
          "'" + pairs_ + "' has no NAME_noisy.ply with its NAME_original.ply; name another folder"};
}

Error Plan::finishOptions(const OptionTable& options) {
  if (Error error = measure::chooseVectors(vectors_)) return error;
  if (Error error = parseWords("shapes", shapes_, shapeNames(), shape_list_)) return error;
  if (Error error = parseWords("methods", methods_, {"slim", "mls", "normals"}, method_list_)) {
    return error;
  }
  if (Error error = measure::parseLists(
          {{"noises", &noises_, 0, 1, false, &noise_list_},
           {"points", &points_, 100, 4e9, true, &point_list_},
           {"degrees", &degrees_, 1, 4, true, &degree_list_},
           {"kappas", &kappas_, 0, 1e6, false, &kappa_list_},
           {"t_mdls", &t_mdls_, 0, 1e3, false, &t_mdl_list_},
           {"mls_orders", &orders_, 1, 6, true, &order_list_},
           {"mls_neighbours", &neighbours_, 3, 1e6, true, &neighbour_list_},
           {"normal_neighbours", &normal_neighbours_, 3, 1e6, true, &normal_neighbour_list_}})) {
    return error;
  }
  const bool files = options.given("input") || options.given("truth") || options.given("pairs");
  for (const char* name : {"shapes", "noises", "points"}) {
    if (!files || !options.given(name)) continue;
    return {ErrorCode::kBadArgument,
            "-" + std::string(name) + " is for exact surfaces; leave it out with files"};
  }
  return finishFiles();
}

Error Plan::forEachScene(const std::function<Error(const Scene&)>& treat) const {
  for (const FilePair& pair : files_) {
    const Result<Scene> scene = loadScene(pair.name, pair.input, pair.truth);
    if (!scene) return scene.error();
    if (Error error = treat(*scene)) return error;
  }
  if (!files_.empty()) return {};
  for (const double count : point_list_) {
    for (const std::string& shape : shape_list_) {
      for (const double noise : noise_list_) {
        const Result<Scene> scene = makeScene(shape, static_cast<std::size_t>(count), noise);
        if (!scene) return scene.error();
        if (Error error = treat(*scene)) return error;
      }
    }
  }
  return {};
}

void Plan::addSlim(const Scene& scene, std::vector<Setting>& settings) const {
  for (const bool normals : {false, true}) {
    if (normals_ == (normals ? "0" : "1") || (normals && scene.normals.empty())) continue;
    Setting s;
    s.threads = threads_;
    s.normals = normals;
    const std::size_t begin = settings.size();
    settings.push_back(s);
    if (sharp_ && normals) {
      s.sharp = true;
      settings.push_back(s);
      s.sharp = false;
    }
    for (const double degree : degree_list_) {
      s.degree = static_cast<int>(degree);
      for (const double kappa : kappa_list_) {
        s.penalty = kappa;
        settings.push_back(s);
      }
      s.penalty = 0;
      for (const double t : t_mdl_list_) {
        s.t_mdl = t;
        if (t > 0) settings.push_back(s);
      }
      s.t_mdl = 0;
    }
    if (data_) repeatWith(&Setting::data, begin, settings);
    if (robust_) repeatWith(&Setting::robust, begin, settings);
    if (compact_) repeatWith(&Setting::compact, begin, settings);
  }
}

std::vector<Setting> Plan::settingsFor(const Scene& scene) const {
  std::vector<Setting> settings;
  const auto asked = [this](const char* method) {
    return std::count(method_list_.begin(), method_list_.end(), method) > 0;
  };
  if (asked("slim")) addSlim(scene, settings);
  Setting s;
  s.threads = threads_;
  s.method = Method::kMls;
  for (const double order : order_list_) {
    for (const double neighbours : neighbour_list_) {
      s.degree = static_cast<int>(order);
      s.neighbours = static_cast<int>(neighbours);
      if (asked("mls")) settings.push_back(s);
    }
  }
  s.degree = 0;
  s.method = Method::kNormals;
  for (const double neighbours : normal_neighbour_list_) {
    s.neighbours = static_cast<int>(neighbours);
    if (asked("normals")) settings.push_back(s);
  }
  return settings;
}

}  // namespace pcl_slim::comparison

namespace {

using namespace pcl_slim;
using comparison::Run;
using comparison::Scene;
using comparison::SceneRuns;

struct Settings {
  std::string prefix;
  comparison::Plan plan;
  bool chart = true, quiet = false;
};

OptionTable declareOptions(Settings& s) {
  OptionTable options = programOptions("pcl_slim_benchmark");
  options.positional("OUT_PREFIX", &s.prefix,
                     "writes OUT_PREFIX.csv, OUT_PREFIX.md, OUT_PREFIX.png");
  s.plan.declareOptions(options);
  options.toggle("chart", &s.chart, "draw OUT_PREFIX.png; needs an X server, as xvfb-run -a gives");
  options.toggle("quiet", &s.quiet, "say nothing but errors");
  return options;
}

std::string outcomeText(const Run& run, std::size_t points) {
  char text[128];
  std::snprintf(text, sizeof(text), "%.3g us/pt CPU", 1e6 * run.cpu / static_cast<double>(points));
  std::string all = text;
  const auto add = [&](const char* form, double value) {
    if (!std::isfinite(value)) return;
    std::snprintf(text, sizeof(text), form, value);
    all += text;
  };
  add(", RMS %.3g", run.errors.position);
  add(", normals %.3g deg", run.errors.normal);
  return all;
}

Error treatScene(const Settings& s, const Scene& scene, Console& console,
                 std::vector<SceneRuns>& all) {
  SceneRuns measured;
  measured.name = scene.name;
  measured.noise = scene.noise;
  measured.points = scene.size();
  measured.mean_edges = scene.unit_is_edge;
  measured.input = inputErrors(scene);
  for (std::size_t i = 0; i < scene.size(); ++i) measured.judged += scene.isJudged(i);
  for (const comparison::Setting& setting : s.plan.settingsFor(scene)) {
    if (console.interrupted()) return stopped();
    console.begin(measured.title() + ": " + methodName(setting.method) + " " + setting.text() +
                  (setting.normals ? ", normals given" : ""));
    const Result<Run> run = runSetting(scene, setting, s.plan.repeats());
    if (!run) return console.failed(run.error());
    console.done(outcomeText(*run, scene.size()));
    measured.runs.push_back(*run);
  }
  all.push_back(std::move(measured));
  return {};
}

Exit run(const OptionTable& options, Settings& s, const std::string& command) {
  if (Error error = s.plan.finishOptions(options)) return Exit::usage(error);
  if (Error error = comparison::checkTables(s.prefix)) return Exit::usage(error);
  Console console(s.quiet);
  std::vector<SceneRuns> scenes;
  bool loaded = false;
  Error error = s.plan.forEachScene([&](const Scene& scene) {
    loaded = true;
    return treatScene(s, scene, console, scenes);
  });
  if (error) return loaded ? Exit(error) : Exit::usage(error);
  error =
      comparison::writeTables(s.prefix, csvText(scenes), markdownText(scenes, command), console);
  if (error || !s.chart) return error;
  error = drawChart(scenes, s.prefix + ".png");
  console.note("> " + (error ? error.message : "Drew " + s.prefix + ".png"));
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  measure::keepFreedMemory();
  Settings s;
  OptionTable options = declareOptions(s);
  return runProgram(options, argc, argv, "give smaller -points",
                    [&] { return run(options, s, commandLine(argc, argv)); });
}
