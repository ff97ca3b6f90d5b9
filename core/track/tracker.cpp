#include "core/track/tracker.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/parameter.h"

namespace touchline {
namespace {

// A ball that was not seen for longer may be anywhere. Its next sightings must agree with each other.
constexpr double kLongestBounce_s = 0.05;

bool not_negative(double value) { return std::isfinite(value) && value >= 0.0; }

bool usable(const RobotFilterParameters& p) {
  return is_positive(p.position_sigma_m) && is_positive(p.heading_sigma_rad) && is_positive(p.position_jitter_m) &&
         is_positive(p.heading_jitter_rad) && is_positive(p.patch_sigma_m) && not_negative(p.wheel_lag_s) &&
         not_negative(p.tire_grip_mps2) && not_negative(p.slide_noise_mps_rts) &&
         not_negative(p.contact_noise_mps_rts) && is_positive(p.contacts_per_s) && is_positive(p.contact_lasts_s) &&
         not_negative(p.drive_noise_m_rts) && not_negative(p.turn_noise_rad_rts) && not_negative(p.drive_error_rts) &&
         not_negative(p.turn_error_rts) && not_negative(p.veer_error_rts_per_m) && not_negative(p.slip_m_rts) &&
         not_negative(p.spin_rad_rts) && is_positive(p.free_noise_mps_rts) && is_positive(p.free_noise_radps_rts) &&
         is_positive(p.start_speed_sigma_mps) && is_positive(p.start_turn_sigma_radps) && is_positive(p.impact_mps) &&
         is_positive(p.impact_radps) && is_positive(p.max_speed_mps) && is_positive(p.gate_pose) &&
         is_positive(p.gate_position) && p.restart_after >= 1;
}

bool usable(const BallFilterParameters& p) {
  return is_positive(p.position_sigma_m) && not_negative(p.damping_per_s) && is_positive(p.noise_mps_rts) &&
         is_positive(p.start_speed_sigma_mps) && is_positive(p.impact_mps) && is_positive(p.max_speed_mps) &&
         is_positive(p.gate_position) && p.restart_after >= 1 && p.confirm_sightings >= 1 &&
         is_positive(p.lost_after_s);
}

PointFilter::Noise motion_of(const BallFilterParameters& p) { return {0.0, p.noise_mps_rts, p.damping_per_s}; }

LifeCycle::Limits ball_limits(const TrackParameters& p) {
  return {p.ball.confirm_sightings, p.forget_new_after_s, p.ball.lost_after_s};
}

bool credible(const BallSighting& sighting) {
  constexpr float kMaxCoordinate = 100.0f;  // no field of any league is larger
  return sighting.seen && std::abs(sighting.position.x_m) < kMaxCoordinate &&
         std::abs(sighting.position.y_m) < kMaxCoordinate && sighting.sigma_m >= 0.0f &&
         sighting.sigma_m < kMaxCoordinate;
}

}  // namespace

Status Tracker::configure(const TrackParameters& parameters) {
  const TrackParameters& p = parameters;
  if (!usable(p.robot) || !usable(p.ball) || p.confirm_sightings < 1 || !not_negative(p.forget_new_after_s) ||
      !is_positive(p.lost_after_s) || !not_negative(p.association_m) || !not_negative(p.separation_m) ||
      !not_negative(p.consistent_m)) {
    return ErrorCode::kOutOfRange;
  }
  parameters_ = parameters;
  reset();
  return {};
}

void Tracker::reset() {
  commands_.clear();
  robots_.clear();
  ball_life_.lose();
  ball_outliers_.clear();
  started_ = false;
}

void Tracker::add_commands(const Commands& commands, Instant acts_at) { commands_.add(commands, acts_at); }

void Tracker::update(const Sightings& sightings, Instant capture_time, Instant action_time, Tracks& out) {
  const double forgotten_s = std::max(parameters_.lost_after_s, parameters_.ball.lost_after_s);
  if (started_ && seconds(last_time_ - capture_time) > forgotten_s) reset();
  if (!started_ || capture_time > last_time_) {
    commands_.forget_before(started_ ? last_time_ : capture_time);
    robots_.update(sightings.robots, started_ ? last_time_ : capture_time, capture_time, commands_, parameters_);
    update_ball(sightings.ball, capture_time);
    last_time_ = capture_time;
    started_ = true;
  }
  const Instant action = std::clamp(action_time, last_time_, last_time_ + kMaxPrediction);
  out.capture_time = last_time_;
  out.action_time = action;
  robots_.report(last_time_, action, commands_, parameters_, out.robots);
  report_ball(last_time_, action, out.ball);
}

void Tracker::update_ball(const BallSighting& sighting, Instant now) {
  ball_innovation2_ = -1.0f;
  if (!ball_life_.lost() && seconds(now - ball_life_.last_seen()) > parameters_.ball.lost_after_s) ball_life_.lose();
  if (!ball_life_.lost()) ball_.predict(seconds(now - last_time_), motion_of(parameters_.ball));
  const bool fused = credible(sighting) && fuse_ball(sighting, now);
  if (!fused && !ball_life_.lost()) ball_life_.missed(now, ball_limits(parameters_));
}

bool Tracker::fuse_ball(const BallSighting& sighting, Instant now) {
  const BallFilterParameters& p = parameters_.ball;
  PointFilter::Noise noise = motion_of(p);
  noise.position_sigma_m = std::hypot(p.position_sigma_m, static_cast<double>(sighting.sigma_m));
  if (ball_life_.lost()) {
    ball_.start(sighting.position, {0.0, 0.0, p.start_speed_sigma_mps}, noise.position_sigma_m);
    ball_outliers_.clear();
    ball_last_position_ = sighting.position;
    ball_confidence_ = sighting.confidence;
    ball_life_.start(now, ball_limits(parameters_));
    return true;
  }
  double distance2 = ball_.distance2(sighting.position, noise);
  if (distance2 > p.gate_position) {
    // The ball may have bounced, or a robot hit it, since the last sighting.
    PointFilter hit = ball_;
    hit.disturb(std::min(seconds(now - ball_life_.last_seen()), kLongestBounce_s), p.impact_mps);
    distance2 = hit.distance2(sighting.position, noise);
    if (distance2 <= p.gate_position) ball_ = hit;
  }
  if (distance2 <= p.gate_position) {
    ball_innovation2_ = static_cast<float>(distance2);
    ball_.update(sighting.position, noise);
  } else {
    const ConsecutiveOutliers::Outlier outlier{{sighting.position, 0.0f}, false, now};
    ball_outliers_.add(outlier, parameters_.consistent_m, p.max_speed_mps);
    const bool reachable = ConsecutiveOutliers::within_reach(ball_last_position_, ball_life_.last_seen(), outlier,
                                                             parameters_.consistent_m, p.max_speed_mps);
    if (ball_outliers_.count() < p.restart_after || !reachable) return false;
    // After a bounce, the outliers give the new velocity.
    const ConsecutiveOutliers::Outlier& first = ball_outliers_.first();
    const double dt = seconds(now - first.when);
    PointFilter::Velocity velocity{0.0, 0.0, p.start_speed_sigma_mps};
    if (ball_outliers_.count() >= 2 && dt > 0.0) {
      velocity.x_mps = static_cast<double>(sighting.position.x_m - first.pose.position.x_m) / dt;
      velocity.y_mps = static_cast<double>(sighting.position.y_m - first.pose.position.y_m) / dt;
      velocity.sigma_mps = std::min(
          p.start_speed_sigma_mps, std::numbers::sqrt2 * noise.position_sigma_m / dt + p.noise_mps_rts * std::sqrt(dt));
    }
    ball_.start(sighting.position, velocity, noise.position_sigma_m);
  }
  ball_outliers_.clear();
  ball_last_position_ = sighting.position;
  ball_confidence_ = sighting.confidence;
  ball_life_.seen(now, ball_limits(parameters_));
  return true;
}

void Tracker::report_ball(Instant now, Instant action, BallTrack& out) const {
  out = BallTrack();
  out.state = ball_life_.state();
  if (ball_life_.lost()) return;
  out.position = ball_.position();
  out.velocity = ball_.velocity();
  out.sigma_m = static_cast<float>(std::sqrt(ball_.position_variance()));
  out.innovation2 = ball_innovation2_;
  out.last_seen = ball_life_.last_seen();
  out.confidence = ball_confidence_;
  PointFilter later = ball_;
  later.predict(seconds(action - now), motion_of(parameters_.ball));
  out.position_at_action = later.position();
  out.velocity_at_action = later.velocity();
}

}  // namespace touchline
