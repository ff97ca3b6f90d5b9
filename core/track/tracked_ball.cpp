#include "core/track/tracked_ball.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace touchline {
namespace {

// Longest time without a sighting after which a bounce is considered. After a longer time the ball may be anywhere, so
// its next sightings must agree with each other.
constexpr double kLongestBounce_s = 0.05;

// Longest useful prediction of the ball's position in the next frame.
constexpr double kMaxExpectation_s = 0.25;

// A rolling ball needs little more process noise than a resting one.
constexpr double kMinBallActivity = 1e-3;

// Lasting errors count as independent below this correlation, or if their stated size changes by more than this factor,
// because the sighting then shows other parts of the ball.
constexpr double kMinBallErrorCorrelation = 0.1, kOtherBallSize = 2.0;

PointFilter::Noise ball_motion(const BallFilterParameters& p, double activity) {
  return {0.0, std::sqrt(activity) * p.noise_mps_rts, p.damping_per_s};
}

LifeCycle::Limits ball_limits(const TrackParameters& p) {
  return {p.ball.confirm_sightings, p.forget_new_after_s, p.ball.lost_after_s};
}

bool credible(const BallSighting& sighting) {
  constexpr float kMaxCoordinate = 100.0f;  // no field of any league is larger
  return sighting.seen && std::abs(sighting.position.x_m) < kMaxCoordinate &&
         std::abs(sighting.position.y_m) < kMaxCoordinate && sighting.sigma_m >= 0.0f &&
         sighting.sigma_m < kMaxCoordinate && sighting.lasting_share >= 0.0f && sighting.lasting_share <= 1.0f;
}

double distance(FieldPoint a, FieldPoint b) {
  return std::hypot(static_cast<double>(a.x_m - b.x_m), static_cast<double>(a.y_m - b.y_m));
}

}  // namespace

TrackedBall::Errors TrackedBall::errors_of(const BallSighting& sighting, const BallFilterParameters& p) {
  const double variance = static_cast<double>(sighting.sigma_m) * static_cast<double>(sighting.sigma_m);
  const double lasting = static_cast<double>(sighting.lasting_share) * variance;
  return {std::hypot(p.position_jitter_m, std::sqrt(variance - lasting)),
          std::hypot(p.position_sigma_m, std::sqrt(lasting))};
}

void TrackedBall::lose() {
  life_.lose();
  outliers_.clear();
}

void TrackedBall::start(const BallSighting& sighting, const PointFilter::Velocity& velocity, const Errors& errors) {
  filter_.start(sighting.position, velocity, errors.white_m, errors.lasting_m);
  activity_.restore();
  lasting_m_ = errors.lasting_m;
  lasting_since_ = sighting.position;
  same_ = 1.0;
}

// As for robots (robot_motion.cpp), the correlation of the errors at two positions depends only on these positions, not
// on the path.
double TrackedBall::renew_lasting_error(const BallSighting& sighting, const Errors& errors) {
  const bool is_other = !(sighting.lasts_m > 0.0f) || errors.lasting_m > kOtherBallSize * lasting_m_ ||
                        lasting_m_ > kOtherBallSize * errors.lasting_m;
  const double moved = distance(sighting.position, lasting_since_);
  const double same = is_other ? 0.0 : std::min(same_, std::exp(-moved / static_cast<double>(sighting.lasts_m)));
  const double part = same / same_;
  same_ = same;
  if (same < kMinBallErrorCorrelation) {
    lasting_since_ = sighting.position;
    same_ = 1.0;
  }
  lasting_m_ = std::hypot(part * lasting_m_, std::sqrt(1.0 - part * part) * errors.lasting_m);
  return part;
}

void TrackedBall::update(const BallSighting& sighting, Instant from, Instant now, const TrackParameters& parameters) {
  innovation2_ = -1.0f;
  if (!life_.lost() && seconds(now - life_.last_seen()) > parameters.ball.lost_after_s) life_.lose();
  if (!life_.lost()) filter_.predict(seconds(now - from), ball_motion(parameters.ball, activity_.value()));
  const bool fused = credible(sighting) && fuse(sighting, now, parameters);
  // Only the state of a damaged recording breaks the filter (visit_state()).
  const FieldPoint at = filter_.position(), moves = filter_.velocity();
  if (!std::isfinite(at.x_m + at.y_m + moves.x_m + moves.y_m)) life_.lose();
  if (fused || life_.lost()) return;
  activity_.restore();
  life_.missed(now, ball_limits(parameters));
}

ExpectedBall TrackedBall::expected(Instant from, Instant now, const TrackParameters& parameters) const {
  if (life_.lost() || seconds(now - life_.last_seen()) > kMaxExpectation_s) return {};
  PointFilter next = filter_;
  next.predict(seconds(now - from), ball_motion(parameters.ball, activity_.value()));
  return {true, next.position(), static_cast<float>(std::sqrt(next.position_variance()))};
}

bool TrackedBall::fuse(const BallSighting& sighting, Instant now, const TrackParameters& parameters) {
  const BallFilterParameters& p = parameters.ball;
  const Errors errors = errors_of(sighting, p);
  if (life_.lost()) {
    start(sighting, {0.0, 0.0, p.start_speed_sigma_mps}, errors);
    outliers_.clear();
    last_position_ = sighting.position;
    confidence_ = sighting.confidence;
    life_.start(now, ball_limits(parameters));
    return true;
  }
  const PointFilter::Noise noise{errors.white_m, 0.0, 0.0};
  TrackedBall next = *this;
  next.filter_.renew_lasting_error(next.renew_lasting_error(sighting, errors), errors.lasting_m);
  double distance2 = next.filter_.distance2(sighting.position, noise);
  const double predicted_share = 1.0 - errors.white_m * errors.white_m / next.filter_.innovation_variance(noise);
  next.activity_.follow(distance2 / 2.0, distance2 > p.gate_position, predicted_share, kMinBallActivity);
  if (distance2 > p.gate_position) {
    // The ball may have bounced, or a robot hit it, since the last sighting.
    next.filter_.disturb(std::min(seconds(now - life_.last_seen()), kLongestBounce_s), p.impact_mps);
    distance2 = next.filter_.distance2(sighting.position, noise);
  }
  if (distance2 <= p.gate_position) {
    next.innovation2_ = static_cast<float>(distance2);
    next.filter_.update(sighting.position, noise);
    *this = next;
  } else {
    const ConsecutiveOutliers::Outlier outlier{{sighting.position, 0.0f}, false, now};
    outliers_.add(outlier, parameters.consistent_m, p.max_speed_mps);
    const bool reachable = ConsecutiveOutliers::within_reach(last_position_, life_.last_seen(), outlier,
                                                             parameters.consistent_m, p.max_speed_mps);
    if (outliers_.count() < p.restart_after || !reachable) return false;
    // After a bounce, the new velocity follows from the outliers.
    const ConsecutiveOutliers::Outlier& first = outliers_.first();
    const double dt = seconds(now - first.when);
    PointFilter::Velocity velocity{0.0, 0.0, p.start_speed_sigma_mps};
    if (outliers_.count() >= 2 && dt > 0.0) {
      velocity.x_mps = static_cast<double>(sighting.position.x_m - first.pose.position.x_m) / dt;
      velocity.y_mps = static_cast<double>(sighting.position.y_m - first.pose.position.y_m) / dt;
      velocity.sigma_mps =
          std::min(p.start_speed_sigma_mps, std::numbers::sqrt2 * std::hypot(errors.white_m, errors.lasting_m) / dt +
                                                p.noise_mps_rts * std::sqrt(dt));
    }
    start(sighting, velocity, errors);
  }
  outliers_.clear();
  last_position_ = sighting.position;
  confidence_ = sighting.confidence;
  life_.seen(now, ball_limits(parameters));
  return true;
}

void TrackedBall::report(Instant now, Instant action, const TrackParameters& parameters, BallTrack& out) const {
  out = BallTrack();
  out.state = life_.state();
  if (life_.lost()) return;
  out.position = filter_.position();
  out.velocity = filter_.velocity();
  out.sigma_m = static_cast<float>(std::sqrt(filter_.position_variance()));
  out.innovation2 = innovation2_;
  out.last_seen = life_.last_seen();
  out.confidence = confidence_;
  PointFilter later = filter_;
  later.predict(seconds(action - now), ball_motion(parameters.ball, activity_.value()));
  out.position_at_action = later.position();
  out.velocity_at_action = later.velocity();
}

}  // namespace touchline
