// SPDX-License-Identifier: BSD-3-Clause
// Claims that want a sweep: least errors beside other libraries', and how near the default comes.
#include <algorithm>
#include <cmath>

#include "claims/claim_runner.h"
#include "fit/accuracy.h"

namespace pcl_slim::comparison {

namespace {

constexpr double kDefaultGoal = 1.15;
constexpr std::size_t kPeerPoints = 100000;

/** An error that another library reached on a scene of 100,000 points, each at its best setting,
 * chosen with the truth in hand. Position in scene units, normals in degrees. */
struct PeerError {
  const char* shape;
  double noise;
  double Errors::*error;
  double value;
  const char* peer;
  bool normals_as_data = false;  ///< it fits exact normals as data, and so may SLIM
};

constexpr double Errors::*kPosition = &Errors::position;
constexpr double Errors::*kNormal = &Errors::normal;
constexpr double Errors::*kCurvature = &Errors::curvature;

constexpr PeerError kPeers[] = {
    {"sphere", 0.001, kPosition, 1.4e-4, "APSS, exact normals (Ponca)", true},
    {"torus", 0.001, kPosition, 1.8e-4, "APSS, exact normals (Ponca)", true},
    {"bumpy", 0.001, kPosition, 2.8e-4, "APSS, exact normals (Ponca)", true},
    {"relief", 0.001, kPosition, 3.4e-4, "APSS, exact normals (Ponca)", true},
    {"sphere", 0.001, kNormal, 0.090, "MLS order 2 (PCL)"},
    {"bumpy", 0.001, kNormal, 0.32, "MLS (PCL)"},
    {"relief", 0.001, kNormal, 1.4, "shape operator of APSS (Ponca)"},
    {"sphere", 0.001, kCurvature, 0.021, "MLS order 2 (PCL)"},
    {"torus", 0.001, kCurvature, 0.054, "MLS order 2 (PCL)"},
    {"bumpy", 0.001, kCurvature, 0.068, "MLS (PCL)"},
    {"relief", 0.001, kCurvature, 0.25, "shape operator of APSS (Ponca)"},
    {"torus", 0, kNormal, 1.25e-5, "quartic jets (CGAL)"},
    {"bumpy", 0, kNormal, 8.4e-5, "quartic jets (CGAL)"},
    {"relief", 0, kNormal, 0.0032, "quartic jets (CGAL)"},
    {"torus", 0, kCurvature, 1.08e-5, "quartic jets (CGAL)"},
    {"bumpy", 0, kCurvature, 7.0e-5, "quartic jets (CGAL)"},
    {"relief", 0, kCurvature, 0.0024, "quartic jets (CGAL)"}};

bool
isAbout(const PeerError& peer, const std::string& shape, double noise)
{
  return peer.shape == shape && std::abs(peer.noise - noise) < 1e-9;
}

std::string
nameOf(double Errors::*error)
{
  return error == kPosition ? "RMS position" : error == kNormal ? "RMS normal, °" : "curvature";
}

/** A sweep's least errors, and the settings that gave them. */
struct Best {
  Errors errors;
  std::string position, normal, curvature;

  void take(const Errors& e, const std::string& run)
  {
    const auto keep = [&](double Errors::*error, std::string& name) {
      if (!(errors.*error <= e.*error)) errors.*error = e.*error, name = run;
    };
    keep(kPosition, position);
    keep(kNormal, normal);
    keep(kCurvature, curvature);
  }
  const std::string& runOf(double Errors::*error) const
  {
    return error == kPosition ? position : error == kNormal ? normal : curvature;
  }
};

/** Penalties of the plan, and T where it names any, for one degree (0: the default). */
std::vector<Setting>
penaltySweep(const ClaimRunner& runner, bool normals, int degree)
{
  Setting setting = runner.slim(normals);
  setting.degree = degree;
  return runner.lists().penaltySweep(setting);
}

/** The same, and under noise each penalty with normals as data too. */
std::vector<Setting>
peerSweep(const ClaimRunner& runner, bool normals, int degree, double noise)
{
  std::vector<Setting> settings = penaltySweep(runner, normals, degree);
  for (std::size_t i = settings.size(); normals && noise > 0 && i-- > 0;) {
    if (settings[i].t_mdl > 0) continue;
    settings.push_back(settings[i]);
    settings.back().data = true;
  }
  return settings;
}

Error
addDefault(ClaimRunner& runner, const Scene& scene, bool normals)
{
  Best best;
  const Setting automatic = runner.slim(normals);
  const Result<Errors> own = runner.errors(scene, automatic);
  if (!own) return own.error();
  best.take(*own, automatic.text());
  for (const Setting& setting : penaltySweep(runner, normals, 0)) {
    const Result<Errors> errors = runner.errors(scene, setting);
    if (!errors) return errors.error();
    best.take(*errors, setting.text());
  }
  runner.add(scene, automatic.fullText(), "RMS position over the best",
             own->position / best.errors.position, kDefaultGoal,
             "best: " + best.position + ", " + shortNumber(best.errors.position));
  return {};
}

/** Errors of SLIM on an exact surface whose points are given in double: in floats the rounding of
 * the input is all that is left of the error without noise. */
Result<Errors>
errorsInDouble(ClaimRunner& runner, const std::string& shape, const measure::Scene& scene,
               double noise, const Setting& setting)
{
  measure::Shape kind = measure::Shape::kSphere;
  measure::parseShape(shape, kind);
  Errors errors;
  const Error error = runner.step(sceneTitle(shape, noise) + ", in double: " + setting.fullText(),
                                  [&](std::string& detail) -> Error {
                                    const Result<measure::Outcome> outcome =
                                        measure::measureAccuracy(kind, scene, fitParams(setting),
                                                                 setting.normals, false);
                                    if (!outcome) return outcome.error();
                                    const measure::Accuracy& a = outcome->accuracy;
                                    errors = {a.position, a.worst, a.normal, a.curvature};
                                    detail = "RMS " + shortNumber(a.position);
                                    return {};
                                  });
  if (error) return error;
  return errors;
}

Error
addPeers(ClaimRunner& runner, const std::string& shape, double noise)
{
  measure::Shape kind = measure::Shape::kSphere;
  measure::parseShape(shape, kind);
  const measure::Scene scene = measure::makeScene(kind, kPeerPoints, noise, 0.0, 7);
  Best of_points, of_both;
  for (const bool normals : {false, true}) {
    for (const double degree : runner.lists().degrees()) {
      for (const Setting& setting : peerSweep(runner, normals, static_cast<int>(degree), noise)) {
        const Result<Errors> errors = errorsInDouble(runner, shape, scene, noise, setting);
        if (!errors) return errors.error();
        if (!setting.data) of_points.take(*errors, setting.fullText());
        of_both.take(*errors, setting.fullText());
      }
    }
  }
  for (const PeerError& peer : kPeers) {
    if (!isAbout(peer, shape, noise)) continue;
    const Best& best = peer.normals_as_data ? of_both : of_points;
    runner.add({sceneTitle(shape, noise), kPeerPoints, best.runOf(peer.error), nameOf(peer.error),
                best.errors.*peer.error, peer.value, peer.peer});
  }
  return {};
}

}  // namespace

Error
measureDefault(ClaimRunner& runner)
{
  return runner.lists().forEachScene([&](const Scene& scene) -> Error {
    for (const bool normals : {false, true}) {
      if (Error error = addDefault(runner, scene, normals)) return error;
    }
    return {};
  });
}

Error
measurePeers(ClaimRunner& runner)
{
  for (const std::string& shape : runner.lists().shapes()) {
    for (const double noise : {0.0, 0.001}) {
      const bool known = std::any_of(std::begin(kPeers), std::end(kPeers),
                                     [&](const PeerError& p) { return isAbout(p, shape, noise); });
      if (!known) continue;
      if (Error error = addPeers(runner, shape, noise)) return error;
    }
  }
  return {};
}

}  // namespace pcl_slim::comparison
