// SPDX-License-Identifier: BSD-3-Clause
#include "lines/crest_tracer.h"

#include <algorithm>
#include <cmath>

namespace pcl_slim::detail {

namespace {

/** A parabola through the values at -1, 0 and 1; a straight line where an outer one is not known.
 */
struct Parabola {
  double at0 = 0, slope = 0, bend = 0;

  Parabola() = default;
  Parabola(double before, double middle, double after)
      : at0(middle), slope(0.5 * (after - before)), bend(0.5 * (after + before) - middle) {}
  double operator()(double x) const { return at0 + x * (slope + x * bend); }
  double slopeAt(double x) const { return slope + 2 * bend * x; }
  /** The root between two places of different sign. */
  double rootBetween(double low, double high) const;
};

/** Three samples side by side across a line, and where between them k is largest along t. */
class CrossSection {
 public:
  CrossSection(const CrestSample* samples, const Vector3& across);

  /** Whether dk/dt passes zero, falling along t, between two samples. */
  bool hasRoot() const { return has_root_; }
  /** In units of the samples' distance, within [-1, 1]. */
  double root() const { return root_; }
  /** A Newton step from the middle; false where it goes nowhere. */
  bool newton(double& step) const;
  /** Position, frame and curvatures at the root; its fall per sample. */
  CrestVertex vertex() const;

 private:
  void search(int from);
  double between(double before, double middle, double after) const;
  Vector3 between(Vector3 CrestSample::*what) const;

  const CrestSample* samples_;
  double sense_ = 1;  ///< +1 where t points along across, else -1
  bool complete_ = false, has_root_ = false;
  double root_ = 0;
  Parabola e_;
};

double Parabola::rootBetween(double low, double high) const {
  // Of the two quotients that solve it, the one without cancellation and its partner.
  const double rest = std::sqrt(std::max(0.0, slope * slope - 4 * bend * at0));
  const double sum = -0.5 * (slope + std::copysign(rest, slope));
  const double first = sum != 0 ? at0 / sum : 0, second = bend != 0 ? sum / bend : first;
  const double middle = 0.5 * (low + high);
  const double root = std::abs(first - middle) <= std::abs(second - middle) ? first : second;
  return std::clamp(root, low, high);
}

CrossSection::CrossSection(const CrestSample* samples, const Vector3& across) : samples_(samples) {
  const CrestSample& middle = samples[1];
  complete_ = samples[0].known && middle.known && samples[2].known;
  if (!middle.known) return;
  sense_ = dot(middle.t, across) < 0 ? -1.0 : 1.0;
  if (complete_) e_ = Parabola(samples[0].e, middle.e, samples[2].e);
  // A maximum: dk/dt falls along t.
  if (samples[0].known) search(0);
  if (!has_root_ && samples[2].known) search(1);
}

void CrossSection::search(int from) {
  const double before = sense_ * samples_[from].e, after = sense_ * samples_[from + 1].e;
  if (!(before > 0 && after <= 0)) return;
  has_root_ = true;
  const double low = from - 1.0, high = from;
  if (!complete_) {
    root_ = low + before / (before - after);
    return;
  }
  root_ = e_.rootBetween(low, high);
}

bool CrossSection::newton(double& step) const {
  if (!complete_ || !(sense_ * e_.slope < 0)) return false;
  step = -e_.at0 / e_.slope;
  return true;
}

double CrossSection::between(double before, double middle, double after) const {
  if (complete_) return Parabola(before, middle, after)(root_);
  return root_ < 0 ? middle - root_ * (before - middle) : middle + root_ * (after - middle);
}

Vector3 CrossSection::between(Vector3 CrestSample::*what) const {
  Vector3 made;
  for (std::size_t a = 0; a < 3; ++a) {
    made[a] = between((samples_[0].*what)[a], (samples_[1].*what)[a], (samples_[2].*what)[a]);
  }
  return made;
}

CrestVertex CrossSection::vertex() const {
  CrestVertex v;
  v.position = between(&CrestSample::position);
  v.normal = normalized(between(&CrestSample::normal));
  const Vector3 t = between(&CrestSample::t);
  v.t = normalized(along(t, -dot(t, v.normal), v.normal));
  v.k = between(samples_[0].k, samples_[1].k, samples_[2].k);
  if (complete_) v.fall = -sense_ * e_.slopeAt(root_);
  v.other = between(samples_[0].other, samples_[1].other, samples_[2].other);
  return v;
}

constexpr double kAside = 0.8;        ///< roots are searched this many steps to both sides
constexpr double kShorter = 0.4;      ///< a step that fails is tried again, shortened to this
constexpr double kLeastCosine = 0.5;  ///< a line turns by less than 60 degrees a step
constexpr double kTurnAgain = 0.5;   ///< share of the last turn that the next one is expected to be
constexpr double kFine = 0.02;       ///< distance of the last samples across, in radii
constexpr double kNearMiddle = 0.4;  ///< of a section's half width
constexpr int kRefinements = 3;
constexpr double kPastReach = 1.2;  ///< roots count up to this multiple of the searched reach

Vector3 acrossOf(const Vector3& normal, const Vector3& ahead) {
  return normalized(cross(normal, ahead));
}

}  // namespace

/** To the root of dk/dt along its gradient. */
bool CrestStepper::start(const CrestVertex& seed, const CrestSample (&samples)[3],
                         CrestVertex& vertex) {
  forget();
  if (!samples[0].known || !samples[1].known || !samples[2].known) return false;
  const CrestAxes axes = seed.axes();
  const Vector3 gradient = along(scaled(axes.t, samples[1].e - samples[0].e),
                                 samples[2].e - samples[0].e, cross(axes.normal, axes.t));
  if (!(length(gradient) > 0)) return false;
  const double size = kAside * step_ * axes.radius;
  Search search;
  search.row = {samples[0].position, normalized(gradient), std::max(size, field_.leastSpan(axes))};
  search.reach = size;
  search.stride_across = search.row.across;
  search.stride = scaled(cross(axes.normal, search.row.across), step_ * axes.radius);
  if (!correct(search, axes, vertex)) return false;
  vertex.ahead = normalized(cross(vertex.normal, search.row.across));
  return complete(vertex);
}

/** Finds the line's vertex on a segment across it. */
bool CrestStepper::correct(const Search& search, const CrestAxes& axes, CrestVertex& vertex) {
  const Vector3& across = search.row.across;
  const double reach = search.reach;
  double at = search.at, span = search.row.span;
  CrestSample s[6];
  for (int round = 0; round <= kRefinements; ++round) {
    CrestRow rows[2];
    rows[0] = {along(search.row.place, at, across), across, span};
    rows[1] = {along(rows[0].place, 1.0, search.stride), search.stride_across, search.row.span};
    const bool strides = dot(search.stride, search.stride) > 0;
    field_.sampleAcross(rows, strides ? 2 : 1, axes, s);
    const CrossSection section(s, across);
    double move = 0;
    if (section.hasRoot()) {
      move = section.root();
      // Differences reach as far as the section: one whose middle is near the root is as good as
      // any.
      const bool centered = !field_.isAnalytic() && std::abs(move) < kNearMiddle;
      if (round > 0 || centered) {
        vertex = section.vertex();
        vertex.fall /= span;
        ahead_.known = strides && s[3].known;
        ahead_.row = rows[1];
        std::copy(s + 3, s + 6, ahead_.samples);
        return std::abs(at + move * span) <= kPastReach * reach &&
               vertex.k > std::abs(vertex.other);
      }
    } else if (round == 0 || !section.newton(move)) {
      return false;
    }
    at += std::clamp(move * span, -reach, reach);
    if (std::abs(at) > kPastReach * reach) return false;
    span = std::max(std::min(reach, kFine * axes.radius), field_.leastSpan(axes));
  }
  return false;
}

/** Fills in what depends on the leaves around a vertex; false outside their support. */
bool CrestStepper::complete(CrestVertex& vertex) {
  const ProbeScale scale = field_.scaleAt(vertex.position, vertex.normal);
  vertex.radius = scale.radius;
  vertex.equivalent_count = scale.equivalent_count;
  vertex.reach = CrestField::reachAt(vertex);
  return scale.radius > 0;
}

bool CrestStepper::finish(const CrestVertex& from, CrestVertex& next) {
  const Vector3 chord = normalized(subtract(next.position, from.position));
  if (dot(chord, from.ahead) < kLeastCosine) return false;
  next.ahead = normalized(along(chord, -dot(chord, next.normal), next.normal));
  return complete(next);
}

bool CrestStepper::step(const std::vector<CrestVertex>& line, double size, CrestVertex& next) {
  const CrestVertex& from = line.back();
  Vector3 turn{};
  if (line.size() > 2) turn = scaled(subtract(from.ahead, line[line.size() - 2].ahead), kTurnAgain);
  const CrestAxes axes = from.axes();
  Search search;
  const Vector3 ahead = normalized(along(from.ahead, 1.0, turn));
  search.reach = kAside * size;
  search.row = {along(from.position, size, ahead), acrossOf(from.normal, ahead),
                std::max(search.reach, field_.leastSpan(axes))};
  const Vector3 beyond = normalized(along(ahead, 1.0, turn));
  search.stride = scaled(beyond, size);
  search.stride_across = acrossOf(from.normal, beyond);
  return correct(search, axes, next) && finish(from, next);
}

/** The vertex on the row that was sampled with the last one's. */
bool CrestStepper::useAhead(const CrestVertex& from, CrestVertex& next) {
  if (!ahead_.known) return false;
  ahead_.known = false;
  const CrossSection section(ahead_.samples, ahead_.row.across);
  if (!section.hasRoot() || std::abs(section.root()) >= kNearMiddle) return false;
  next = section.vertex();
  next.fall /= ahead_.row.span;
  return next.k > std::abs(next.other) && finish(from, next);
}

bool CrestStepper::advance(const std::vector<CrestVertex>& line, CrestVertex& next) {
  const double size = step_ * line.back().radius;
  return useAhead(line.back(), next) || step(line, size, next) || step(line, kShorter * size, next);
}

}  // namespace pcl_slim::detail
