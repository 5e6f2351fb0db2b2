// SPDX-License-Identifier: BSD-3-Clause
#include "lines/crest_root.h"

#include <algorithm>
#include <cmath>

namespace pcl_slim::detail {

double
Parabola::rootBetween(double low, double high) const
{
  // Of the two quotients that solve it, the one without cancellation and its partner.
  const double rest = std::sqrt(std::max(0.0, slope * slope - 4 * bend * at0));
  const double sum = -0.5 * (slope + std::copysign(rest, slope));
  const double first = sum != 0 ? at0 / sum : 0, second = bend != 0 ? sum / bend : first;
  const double middle = 0.5 * (low + high);
  const double root = std::abs(first - middle) <= std::abs(second - middle) ? first : second;
  return std::clamp(root, low, high);
}

CrossSection::CrossSection(const CrestSample* samples, const Vector3& across) : samples_(samples)
{
  const CrestSample& middle = samples[1];
  complete_ = samples[0].known && middle.known && samples[2].known;
  if (!middle.known) return;
  sense_ = dot(middle.t, across) < 0 ? -1.0 : 1.0;
  if (complete_) e_ = Parabola(samples[0].e, middle.e, samples[2].e);
  // A maximum: dk/dt falls along t.
  if (samples[0].known) search(0);
  if (!has_root_ && samples[2].known) search(1);
}

void
CrossSection::search(int from)
{
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

bool
CrossSection::newton(double& step) const
{
  if (!complete_ || !(sense_ * e_.slope < 0)) return false;
  step = -e_.at0 / e_.slope;
  return true;
}

double
CrossSection::between(double before, double middle, double after) const
{
  if (complete_) return Parabola(before, middle, after)(root_);
  return root_ < 0 ? middle - root_ * (before - middle) : middle + root_ * (after - middle);
}

Vector3
CrossSection::between(Vector3 CrestSample::*what) const
{
  Vector3 made;
  for (std::size_t a = 0; a < 3; ++a) {
    made[a] = between((samples_[0].*what)[a], (samples_[1].*what)[a], (samples_[2].*what)[a]);
  }
  return made;
}

CrestVertex
CrossSection::vertex() const
{
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

}  // namespace pcl_slim::detail
