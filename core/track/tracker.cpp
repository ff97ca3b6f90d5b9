#include "core/track/tracker.h"

#include <algorithm>
#include <cmath>

#include "core/parameter.h"

namespace touchline {
namespace {

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
  return is_positive(p.position_sigma_m) && is_positive(p.position_jitter_m) && not_negative(p.damping_per_s) &&
         is_positive(p.noise_mps_rts) && is_positive(p.start_speed_sigma_mps) && is_positive(p.impact_mps) &&
         is_positive(p.max_speed_mps) && is_positive(p.gate_position) && p.restart_after >= 1 &&
         p.confirm_sightings >= 1 && is_positive(p.lost_after_s);
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
  ball_.lose();
  started_ = false;
}

void Tracker::add_commands(const Commands& commands, Instant acts_at) { commands_.add(commands, acts_at); }

ExpectedBall Tracker::expected_ball(Instant capture_time) const {
  if (!started_ || capture_time <= last_time_) return {};
  return ball_.expected(last_time_, capture_time, parameters_);
}

void Tracker::expected_robots(Instant capture_time, ExpectedRobots& out) const {
  out.clear();
  if (started_ && capture_time > last_time_) robots_.expect(last_time_, capture_time, commands_, parameters_, out);
}

void Tracker::update(const Sightings& sightings, Instant capture_time, Instant action_time, Tracks& out) {
  const double forgotten_s = std::max(parameters_.lost_after_s, parameters_.ball.lost_after_s);
  if (started_ && seconds(last_time_ - capture_time) > forgotten_s) reset();
  if (!started_ || capture_time > last_time_) {
    commands_.forget_before(started_ ? last_time_ : capture_time);
    robots_.update(sightings.robots, started_ ? last_time_ : capture_time, capture_time, commands_, parameters_);
    ball_.update(sightings.ball, started_ ? last_time_ : capture_time, capture_time, parameters_);
    last_time_ = capture_time;
    started_ = true;
  }
  const Instant action = std::clamp(action_time, last_time_, last_time_ + kMaxPrediction);
  out.capture_time = last_time_;
  out.action_time = action;
  robots_.report(last_time_, action, commands_, parameters_, out.robots);
  ball_.report(last_time_, action, parameters_, out.ball);
}

}  // namespace touchline
