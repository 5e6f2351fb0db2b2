// SPDX-License-Identifier: BSD-3-Clause
#include "ball/ball_fitter.h"

#include "ball/recentring.h"

namespace pcl_slim::detail {

BallOutcome
BallFitter::fit(std::size_t i, int level, SurfelRecord& surfel)
{
  ++tried_;
  const BallSite site = siteOf(store_, settings_, i, settings_.levelRadius(level));
  search_.setNoise(site.lambda);
  if (tooWideAtAGlance(site, level, surfel)) return BallOutcome::kInternal;
  FramedBall ball;
  const BallOutcome outcome = prepare(site, 1, ball);
  if (outcome != BallOutcome::kLeaf) return outcome;
  if (settings_.internal_only) return widest(ball, level, surfel);
  const RadiusChoice choice = chooseRadius(ball);
  if (choice.kind == RadiusChoice::Kind::kSparse) {
    return withoutFit(ball, site, choice.trial, surfel);
  }
  surfel = recordOf(ball, choice, level, settings_.constants.ball.bias);
  return choice.kind == RadiusChoice::Kind::kLeaf ? BallOutcome::kLeaf : BallOutcome::kInternal;
}

/** The surfel at r_r, for finer ones to stand below. */
BallOutcome
BallFitter::widest(const FramedBall& ball, int level, SurfelRecord& surfel)
{
  if (!search_.right().supported) return BallOutcome::kUnsupported;
  RadiusChoice choice;
  choice.kind = RadiusChoice::Kind::kInternal;
  choice.trial = search_.right();
  surfel = recordOf(ball, choice, level, settings_.constants.ball.bias);
  return BallOutcome::kInternal;
}

/** Gathers and frames the points of every so many blocks. \return kLeaf where a radius can be
 * sought. */
BallOutcome
BallFitter::prepare(const BallSite& site, std::size_t stride, FramedBall& ball)
{
  const GatheredBall gathered = gatherer_.gather(site, stride);
  if (gathered.empty()) return BallOutcome::kUnsupported;
  if (normalIsAlone(gathered, settings_)) return BallOutcome::kLoneNormal;
  ball = onItsFit(ownSheet(searchable(framed(gathered, settings_), 1.0)), stride);
  return BallOutcome::kLeaf;
}

/** Lets the radius search begin on a ball. \param[in] rho_right r_r in units of its radius */
FramedBall
BallFitter::searchable(const FramedBall& ball, double rho_right)
{
  search_.begin(*ball.points, ball.site.radius, rho_right);
  return ball;
}

FramedBall
BallFitter::ownSheet(const FramedBall& ball)
{
  if (!settings_.split_sheets) return ball;
  return splitter_.ownSheet(ball, settings_.constants.ball.sheets, search_);
}

FramedBall
BallFitter::onItsFit(const FramedBall& ball, std::size_t stride)
{
  return settings_.paper ? ball : recentred(ball, settings_, stride, gatherer_, search_);
}

/** Seeks the radius of a ball; one with too few points is gathered again one radius wider. */
RadiusChoice
BallFitter::chooseRadius(FramedBall& ball)
{
  RadiusChoice choice = search_.search();
  if (choice.kind == RadiusChoice::Kind::kSparse) {
    BallSite wider = ball.site;
    wider.radius /= kGolden;
    ball = searchable(framed(gatherer_.gather(wider), settings_), kGolden);
    choice = search_.fallBack();
  }
  if (choice.kind == RadiusChoice::Kind::kLeaf) choice.trial = search_.refine(choice);
  return choice;
}

/** Many points without even a plane lie along a line: a finer level may find the band they are. The
 * ball looked at is one radius wider than the site's, so those of the points marked lie in it. */
BallOutcome
BallFitter::withoutFit(const FramedBall& ball, const BallSite& site, const Trial& trial,
                       SurfelRecord& surfel)
{
  const bool many = ball.points->count >= settings_.constants.ball.line_points;
  if (!many || trial.fit.degree > 0) return BallOutcome::kUnsupported;
  ++lines_;
  surfel.center = site.center;
  surfel.normal = site.normal;
  surfel.radius = static_cast<float>(kGolden * site.radius);
  return BallOutcome::kLine;
}

/** Some thousand points tell that a wide ball must be divided: the rest need not be read. */
bool
BallFitter::tooWideAtAGlance(const BallSite& site, int level, SurfelRecord& surfel)
{
  if (settings_.paper) return false;
  const BallConstants& constants = settings_.constants.ball;
  const std::size_t stride = gatherer_.countBlocks(site) / constants.glance_blocks;
  if (stride < constants.glance_stride) return false;
  FramedBall ball;
  if (prepare(site, stride, ball) != BallOutcome::kLeaf || !search_.surelyInternal()) return false;
  return widest(ball, level, surfel) == BallOutcome::kInternal;
}

}  // namespace pcl_slim::detail
