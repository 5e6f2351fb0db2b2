// SPDX-License-Identifier: BSD-3-Clause
#include "benchmark/sweep_lists.h"

#include <algorithm>
#include <sstream>

#include "measure/lists.h"

namespace pcl_slim::comparison {

void
SweepLists::declareScenes(OptionTable& options)
{
  options.text("shapes", &shapes_, "NAME,...",
               "exact surfaces: sphere, torus, bumpy, relief, cube");
  options.text("noises", &noises_, "S,...", "noise, as a share of the box diagonal");
  options.text("points", &points_, "N,...", "sizes of the clouds");
}

void
SweepLists::declareSlim(OptionTable& options)
{
  options.text("degrees", &degrees_, "D,...", "SLIM: degrees of the polynomials");
  options.text("kappas", &kappas_, "K,...", "SLIM: penalties; 0: the default one");
  options.text("t_mdls", &t_mdls_, "T,...",
               "SLIM: the paper's T_MDL in place of a penalty; 0: none");
}

void
SweepLists::declareMls(OptionTable& options)
{
  options.text("mls_orders", &orders_, "D,...", "MLS: orders of the polynomial");
  options.text("mls_neighbours", &neighbours_, "K,...",
               "MLS: mean numbers of points in the search radius");
}

void
SweepLists::declareThreads(OptionTable& options)
{
  options.integer("threads", &threads_, 1, 4096, "threads, of each method");
}

Error
SweepLists::finish()
{
  if (Error error = parseWords("shapes", shapes_, shapeNames(), shape_list_)) return error;
  return measure::parseLists({{"noises", &noises_, 0, 1, false, &noise_list_},
                              {"points", &points_, 100, 4e9, true, &point_list_},
                              {"degrees", &degrees_, 1, 4, true, &degree_list_},
                              {"kappas", &kappas_, 0, 1e6, false, &kappa_list_},
                              {"t_mdls", &t_mdls_, 0, 1e3, false, &t_mdl_list_},
                              {"mls_orders", &orders_, 1, 6, true, &order_list_},
                              {"mls_neighbours", &neighbours_, 3, 1e6, true, &neighbour_list_}});
}

Error
SweepLists::forEachScene(const std::function<Error(const Scene&)>& treat) const
{
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

std::vector<Setting>
SweepLists::penaltySweep(Setting setting) const
{
  std::vector<Setting> settings;
  for (const double kappa : kappa_list_) {
    setting.penalty = kappa;
    settings.push_back(setting);
  }
  setting.penalty = 0;
  for (const double t : t_mdl_list_) {
    setting.t_mdl = t;
    if (t > 0) settings.push_back(setting);
  }
  return settings;
}

std::vector<Setting>
SweepLists::mlsSettings() const
{
  std::vector<Setting> settings;
  Setting s;
  s.threads = threads_;
  s.method = Method::kMls;
  for (const double order : order_list_) {
    for (const double neighbours : neighbour_list_) {
      s.degree = static_cast<int>(order);
      s.neighbours = static_cast<int>(neighbours);
      settings.push_back(s);
    }
  }
  return settings;
}

Error
parseWords(const std::string& option, const std::string& text,
           const std::vector<std::string>& known, std::vector<std::string>& words)
{
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

}  // namespace pcl_slim::comparison
