#include "core/track/tracked_robot.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/geometry/angle.h"

namespace touchline {
namespace {

// Standard deviation of an unknown angle (uniform distribution over the circle).
constexpr double kUnknownHeadingSigma = std::numbers::pi / std::numbers::sqrt3;

// Largest error of a position that counts as right: with an id as that of a sighting; without one, as far as the team
// patch is from the center.
constexpr double kSamePlace_m = 0.02, kSameRobot_m = 0.05;

// The filters have to cover the worst robots. In rendered games in bad light, the error of robots that are hidden, or
// of which only the team patch is seen, is this part of the filter's standard deviation.
constexpr double kTypicalError = 0.6;

// Probability that the error in two dimensions is below `reach_m` (Rayleigh distribution).
float probability_within(double reach_m, double sigma_m) {
  const double ratio = reach_m / (kTypicalError * sigma_m);
  return static_cast<float>(-std::expm1(-0.5 * ratio * ratio));
}

// Probability of the id from which on the commands to this id are used in the prediction.
constexpr float kSureOfCommands = 0.9f;

LifeCycle::Limits limits_of(const TrackParameters& p) {
  return {p.confirm_sightings, p.forget_new_after_s, p.lost_after_s};
}

PointFilter::Noise point_noise(const RobotFilterParameters& p) {
  return {p.position_sigma_m, p.free_noise_mps_rts, 0.0};
}

}  // namespace

void TrackedRobot::start(const RobotSighting& sighting, Instant now, std::uint32_t birth,
                         const TrackParameters& parameters) {
  team_ = sighting.team;
  id_ = kUnknownId;
  identity_.clear();
  birth_ = birth;
  outliers_.clear();
  heading_known_ = sighting.has_heading;
  const RobotFilterParameters& p = parameters.robot;
  if (heading_known_) {
    drive_.start(sighting.pose, {0.0, 0.0, p.start_speed_sigma_mps, p.start_turn_sigma_radps}, p.position_sigma_m,
                 p.heading_sigma_rad);
  } else {
    point_.start(sighting.pose.position, {0.0, 0.0, p.start_speed_sigma_mps}, p.position_sigma_m);
  }
  last_position_ = sighting.pose.position;
  confidence_ = sighting.confidence;
  life_.start(now, limits_of(parameters));
}

const CommandHistory* TrackedRobot::own_commands(const CommandHistory* commands) const {
  return id_ != kUnknownId && identity_.confidence() >= kSureOfCommands ? commands : nullptr;
}

// Calls predict(time, input) for every interval with a constant command.
template <class Predict>
void TrackedRobot::follow_commands(Instant from, Instant to, const CommandHistory* commands, Predict predict) {
  while (from < to) {
    const Instant until = commands == nullptr ? to : commands->next_change(from, to);
    predict(seconds(until - from), commands == nullptr ? DriveInput{} : commands->at(from, id_));
    from = until;
  }
}

void TrackedRobot::predict(Instant from, Instant to, const CommandHistory* commands,
                           const TrackParameters& parameters) {
  if (!heading_known_) {
    point_.predict(seconds(to - from), point_noise(parameters.robot));
    return;
  }
  follow_commands(from, to, own_commands(commands),
                  [&](double dt_s, const DriveInput& input) { drive_.predict(dt_s, input, parameters.robot); });
}

void TrackedRobot::look_ahead(Instant from, Instant to, const CommandHistory* commands,
                              const TrackParameters& parameters) {
  if (!heading_known_) {
    point_.predict(seconds(to - from), point_noise(parameters.robot));
    return;
  }
  follow_commands(from, to, own_commands(commands),
                  [&](double dt_s, const DriveInput& input) { drive_.predict_state(dt_s, input, parameters.robot); });
}

bool TrackedRobot::fuse(const RobotSighting& sighting, Instant now, const TrackParameters& parameters) {
  const RobotFilterParameters& p = parameters.robot;
  bool accepted = false;
  if (heading_known_ && sighting.has_heading) {
    accepted = drive_.distance2(sighting.pose, p) <= p.gate_pose;
    if (accepted) drive_.update(sighting.pose, p);
  } else if (heading_known_) {
    accepted = drive_.distance2(sighting.pose.position, p) <= p.gate_position;
    if (accepted) drive_.update(sighting.pose.position, p);
  } else {
    // With the first heading, the position moves from the team patch to the robot's center.
    PointFilter::Noise noise = point_noise(p);
    if (sighting.has_heading) noise.position_sigma_m += p.patch_sigma_m;
    accepted = point_.distance2(sighting.pose.position, noise) <= p.gate_position;
    if (accepted && sighting.has_heading) {
      const double c = std::cos(static_cast<double>(sighting.pose.theta_rad));
      const double s = std::sin(static_cast<double>(sighting.pose.theta_rad));
      drive_.start(sighting.pose,
                   {c * point_.vx_mps() + s * point_.vy_mps(), 0.0, std::sqrt(point_.velocity_variance()),
                    p.start_turn_sigma_radps},
                   p.position_sigma_m, p.heading_sigma_rad);
      heading_known_ = true;
    } else if (accepted) {
      point_.update(sighting.pose.position, noise);
    }
  }

  if (!accepted) {
    const ConsecutiveOutliers::Outlier outlier{sighting.pose, sighting.has_heading, now};
    outliers_.add(outlier, parameters.consistent_m, p.max_speed_mps);
    const bool reachable = ConsecutiveOutliers::within_reach(last_position_, life_.last_seen(), outlier,
                                                             parameters.consistent_m, p.max_speed_mps);
    if (outliers_.count() < p.restart_after || !reachable) return false;
    restart(sighting, now, parameters);
  }
  outliers_.clear();
  last_position_ = sighting.pose.position;
  confidence_ = sighting.confidence;
  life_.seen(now, limits_of(parameters));
  return true;
}

// The consistent outliers also give a first velocity: the difference of two positions.
void TrackedRobot::restart(const RobotSighting& sighting, Instant now, const TrackParameters& parameters) {
  const RobotFilterParameters& p = parameters.robot;
  const ConsecutiveOutliers::Outlier& first = outliers_.first();
  const double dt = seconds(now - first.when);
  double vx = 0.0, vy = 0.0, v_sigma = p.start_speed_sigma_mps;
  if (outliers_.count() >= 2 && dt > 0.0) {
    vx = static_cast<double>(sighting.pose.position.x_m - first.pose.position.x_m) / dt;
    vy = static_cast<double>(sighting.pose.position.y_m - first.pose.position.y_m) / dt;
    v_sigma = std::min(v_sigma, std::numbers::sqrt2 * p.position_sigma_m / dt + p.free_noise_mps_rts * std::sqrt(dt));
  }
  if (!sighting.has_heading) {
    heading_known_ = false;
    point_.start(sighting.pose.position, {vx, vy, v_sigma}, p.position_sigma_m);
    return;
  }
  const double theta = static_cast<double>(sighting.pose.theta_rad);
  double w = 0.0, w_sigma = p.start_turn_sigma_radps;
  double v = vx * std::cos(theta) + vy * std::sin(theta);
  if (outliers_.count() >= 2 && dt > 0.0 && first.has_heading) {
    const double turned = wrap_angle(theta - static_cast<double>(first.pose.theta_rad));
    w = turned / dt;
    v = vx * std::cos(theta - 0.5 * turned) + vy * std::sin(theta - 0.5 * turned);
    w_sigma =
        std::min(w_sigma, std::numbers::sqrt2 * p.heading_sigma_rad / dt + p.free_noise_radps_rts * std::sqrt(dt));
  }
  drive_.start(sighting.pose, {v, w, v_sigma, w_sigma}, p.position_sigma_m, p.heading_sigma_rad);
  heading_known_ = true;
}

void TrackedRobot::shift_to(FieldPoint position) {
  drive_.shift_to(position);
  point_.shift_to(position);
}

void TrackedRobot::missed(Instant now, const TrackParameters& parameters) { life_.missed(now, limits_of(parameters)); }

FieldPoint TrackedRobot::position() const { return heading_known_ ? drive_.pose().position : point_.position(); }

double TrackedRobot::position_sigma_m() const {
  return heading_known_ ? std::max(drive_.sigma(0), drive_.sigma(1)) : std::sqrt(point_.position_variance());
}

Pose TrackedRobot::pose() const {
  if (heading_known_) return drive_.pose();
  return {point_.position(), wrap_to_float(std::atan2(point_.vy_mps(), point_.vx_mps()))};
}

Twist TrackedRobot::twist() const {
  if (heading_known_) return drive_.twist();
  return {static_cast<float>(std::hypot(point_.vx_mps(), point_.vy_mps())), 0.0f};
}

RobotTrack TrackedRobot::report(const TrackParameters& parameters) const {
  RobotTrack track;
  track.team = team_;
  track.id = id_;
  track.state = life_.state();
  track.pose = pose();
  track.twist = twist();
  track.last_seen = life_.last_seen();
  track.confidence = id_ == kUnknownId ? confidence_ * probability_within(kSameRobot_m, position_sigma_m())
                                       : identity_.confidence() * probability_within(kSamePlace_m, position_sigma_m());
  if (heading_known_) {
    for (std::size_t i = 0; i < track.sigma.size(); ++i) track.sigma[i] = static_cast<float>(drive_.sigma(i));
  } else {
    const auto sigma = static_cast<float>(std::hypot(position_sigma_m(), parameters.robot.patch_sigma_m));
    track.sigma = {sigma, sigma, static_cast<float>(kUnknownHeadingSigma)};
  }
  return track;
}

}  // namespace touchline
