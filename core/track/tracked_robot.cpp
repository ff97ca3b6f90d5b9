#include "core/track/tracked_robot.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/geometry/angle.h"

namespace touchline {
namespace {

// Standard deviation of an unknown angle (uniform distribution over the circle).
constexpr double kUnknownHeadingSigma = std::numbers::pi / std::numbers::sqrt3;

// Largest position error of a track that counts as right. With an id, it is the same as for a sighting; without an id,
// it is the distance of the team patch from the center.
constexpr double kSamePlace_m = 0.02, kSameRobot_m = 0.05;

// Typical position error relative to the filter's standard deviation, which is chosen for the worst robots. It was
// measured in rendered games in bad light, for robots that are hidden or show only their team patch.
constexpr double kTypicalError = 0.6;

// Returns the probability that the error in two dimensions is below `reach_m` (Rayleigh distribution).
float probability_within(double reach_m, double sigma_m) {
  const double ratio = reach_m / (kTypicalError * sigma_m);
  return static_cast<float>(-std::expm1(-0.5 * ratio * ratio));
}

// If the id has at least this probability, the prediction uses the commands to this id.
constexpr float kSureOfCommands = 0.9f;

// A sighting with a certain id is rejected only once: if two agree, they are no errors of the vision.
constexpr float kCertainId = 0.9f;
constexpr int kCertainOutliers = 2;

LifeCycle::Limits limits_of(const TrackParameters& p) {
  return {p.confirm_sightings, p.forget_new_after_s, p.lost_after_s};
}

// Weight of the newest squared innovation (per degree of freedom) in a running mean. If this mean exceeds kSurprise,
// the prediction gets less weight; with correct predictions, 1 in 1000 means is larger.
constexpr double kNewestSurprise = 0.4, kSurprise = 3.0;

// Lower limits of the process noise's factor (activity.h), for a standing robot and for one that drives at 1 m/s. With
// known commands, errors of the wheels grow with the speed. A smaller limit would make headings of tracks worse than
// those of sightings. Without known commands, the noise stands for the acceleration by the commands, which hardly
// depends on the speed.
constexpr double kMinActivity = 1e-3, kMinActivityAtSpeed = 0.3, kMinFreeActivityAtSpeed = 0.015;

// Longest time without a sighting after which a collision is considered. After a longer time the robot may be anywhere,
// so its next sightings must agree with each other.
constexpr double kLongestImpact_s = 0.05;

PointFilter::Noise point_motion(const RobotFilterParameters& p) { return {0.0, p.free_noise_mps_rts, 0.0}; }

PoseCovariance scaled(const PoseCovariance& c, float by) {
  return {by * c.xx, by * c.yy, by * c.tt, by * c.xy, by * c.xt, by * c.yt};
}

// Scales the standard deviations of position and heading by these factors.
PoseCovariance scaled(const PoseCovariance& c, double position, double heading) {
  const auto xx = static_cast<float>(position * position), tt = static_cast<float>(heading * heading);
  const auto xt = static_cast<float>(position * heading);
  return {xx * c.xx, xx * c.yy, tt * c.tt, xx * c.xy, xt * c.xt, xt * c.yt};
}

// Returns the errors that the sighting states, plus those of the parameters.
SightingNoise noise_of(const RobotSighting& sighting, const RobotFilterParameters& p) {
  SightingNoise noise{scaled(sighting.noise, 1.0f - sighting.lasting_share),
                      scaled(sighting.noise, sighting.lasting_share), static_cast<double>(sighting.lasts_m)};
  const auto add = [](PoseCovariance& to, double position_m, double heading_rad) {
    const auto position = static_cast<float>(position_m * position_m);
    to.xx += position;
    to.yy += position;
    to.tt += static_cast<float>(heading_rad * heading_rad);
  };
  add(noise.white, p.position_jitter_m, p.heading_jitter_rad);
  add(noise.lasting, p.position_sigma_m, p.heading_sigma_rad);
  return noise;
}

// Adds the errors caused by motion. Motion blur displaces each patch center independently, so the heading's variance
// grows with the position's in the ratio of the picture's noise. An error of the time stamp displaces the position
// along the path, and the heading by the rotation.
void add_motion(const RobotSighting& sighting, const Twist& twist, double sigma_s, PoseCovariance& lasting) {
  const auto by_speed = static_cast<float>(sigma_s) * twist.v_mps,
             by_turn = static_cast<float>(sigma_s) * twist.w_radps;
  const float position = by_speed * by_speed, of_picture = sighting.noise.xx + sighting.noise.yy;
  lasting.xx += position;
  lasting.yy += position;
  lasting.tt += by_turn * by_turn;
  if (of_picture > 0.0f) lasting.tt += 2.0f * position * sighting.noise.tt / of_picture;
}

PoseCovariance sum_of(const SightingNoise& noise) {
  const PoseCovariance &a = noise.white, &b = noise.lasting;
  return {a.xx + b.xx, a.yy + b.yy, a.tt + b.tt, a.xy + b.xy, a.xt + b.xt, a.yt + b.yt};
}

// Multiplies the variances of the process noise by these factors.
RobotFilterParameters with_activity(const RobotFilterParameters& parameters, double drive, double turn) {
  RobotFilterParameters p = parameters;
  const double drive_factor = std::sqrt(drive), turn_factor = std::sqrt(turn);
  for (double* density : {&p.slide_noise_mps_rts, &p.contact_noise_mps_rts, &p.drive_noise_m_rts, &p.drive_error_rts,
                          &p.slip_m_rts, &p.free_noise_mps_rts}) {
    *density *= drive_factor;
  }
  for (double* density :
       {&p.turn_noise_rad_rts, &p.turn_error_rts, &p.veer_error_rts_per_m, &p.spin_rad_rts, &p.free_noise_radps_rts}) {
    *density *= turn_factor;
  }
  return p;
}

double position_sigma(const PoseCovariance& noise) {
  return static_cast<double>(std::sqrt(std::max(noise.xx, noise.yy)));
}
double heading_sigma(const PoseCovariance& noise) { return static_cast<double>(std::sqrt(noise.tt)); }

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
    start_drive(sighting, {0.0, 0.0, p.start_speed_sigma_mps, p.start_turn_sigma_radps}, p);
  } else {
    point_.start(sighting.pose.position, {0.0, 0.0, p.start_speed_sigma_mps},
                 position_sigma(sum_of(noise_of(sighting, p))));
  }
  last_position_ = sighting.pose.position;
  confidence_ = sighting.confidence;
  life_.start(now, limits_of(parameters));
}

void TrackedRobot::start_drive(const RobotSighting& sighting, const DriveFilter::Velocity& velocity,
                               const RobotFilterParameters& parameters) {
  drive_.start(sighting.pose, velocity, noise_of(sighting, parameters));
  heading_known_ = true;
  surprise_ = 0.0;
  drive_activity_.restore();
  turn_activity_.restore();
}

bool TrackedRobot::is_finite() const {
  const Pose at = pose();
  const Twist moves = twist();
  return std::isfinite(at.position.x_m) && std::isfinite(at.position.y_m) && std::isfinite(at.theta_rad) &&
         std::isfinite(moves.v_mps) && std::isfinite(moves.w_radps) && std::isfinite(position_sigma_m());
}

const CommandHistory* TrackedRobot::own_commands(const CommandHistory* commands) const {
  return id_ != kUnknownId && identity_.confidence() >= kSureOfCommands ? commands : nullptr;
}

// Calls predict(time, input) for every interval with a constant command.
template <class Predict>
void TrackedRobot::follow_commands(Instant from, Instant to, const CommandHistory* commands, Predict predict) {
  while (from < to) {
    const Instant until = commands == nullptr ? to : commands->next_change(from, to, id_);
    predict(seconds(until - from), commands == nullptr ? DriveInput{} : commands->at(from, id_));
    from = until;
  }
}

void TrackedRobot::predict(Instant from, Instant to, const CommandHistory* commands,
                           const TrackParameters& parameters) {
  innovation2_ = -1.0f;
  if (!heading_known_) {
    point_.predict(seconds(to - from), point_motion(parameters.robot));
    return;
  }
  const RobotFilterParameters p = with_activity(parameters.robot, drive_activity_.value(), turn_activity_.value());
  follow_commands(from, to, own_commands(commands), [&](double dt_s, const DriveInput& input) {
    drive_.predict(dt_s, input, p);
    commands_known_ = input.known;
  });
}

void TrackedRobot::look_ahead(Instant from, Instant to, const CommandHistory* commands,
                              const TrackParameters& parameters) {
  if (!heading_known_) {
    point_.predict(seconds(to - from), point_motion(parameters.robot));
    return;
  }
  follow_commands(from, to, own_commands(commands),
                  [&](double dt_s, const DriveInput& input) { drive_.predict_state(dt_s, input, parameters.robot); });
}

// A sighting that free motion cannot explain may show a collision since the last sighting. A robot that is pushed moves
// sideways, which the model excludes. If several innovations in a row are large, the prediction therefore counts less
// (fading memory).
bool TrackedRobot::fuse_pose(const RobotSighting& sighting, Instant now, const RobotFilterParameters& parameters) {
  SightingNoise errors = noise_of(sighting, parameters);
  add_motion(sighting, drive_.twist(), parameters.motion_sigma_s, errors.lasting);
  if (!commands_known_) {
    errors.white = scaled(errors.white, std::sqrt(drive_activity_.noise()), std::sqrt(turn_activity_.noise()));
  }
  const PoseCovariance& noise = errors.white;
  RobotMotion drive = drive_;
  drive.renew_lasting_error(sighting.pose, errors);
  const DriveFilter::Innovation innovation = drive.innovation(sighting.pose, noise);
  double distance2 = innovation.distance2;
  const double speed = static_cast<double>(drive.twist().v_mps);
  const bool is_beyond_gate = distance2 > parameters.gate_pose;
  if (commands_known_) {
    // Errors of the wheels affect both velocities.
    const double lower_limit = std::min(1.0, kMinActivity + kMinActivityAtSpeed * speed * speed);
    for (FreeActivity* activity : {&drive_activity_, &turn_activity_}) {
      activity->follow(distance2 / 3.0, is_beyond_gate, innovation.predicted_share, lower_limit);
    }
  } else {
    // The speed of a robot may change while its rotation does not, and the other way round.
    const double lower_limit = std::min(1.0, kMinActivity + kMinFreeActivityAtSpeed * speed * speed);
    drive_activity_.follow_direction(innovation.along, is_beyond_gate, lower_limit);
    turn_activity_.follow_direction(innovation.heading, is_beyond_gate, lower_limit);
  }
  const double newest = std::min(distance2, parameters.gate_pose) / 3.0;
  const double surprise = surprise_ + kNewestSurprise * (newest - surprise_);
  if (surprise > kSurprise) {
    drive.scale_covariance(surprise);
    distance2 = drive.innovation(sighting.pose, noise).distance2;
  }
  if (distance2 > parameters.gate_pose) {
    drive.disturb(std::min(seconds(now - life_.last_seen()), kLongestImpact_s), parameters);
    distance2 = drive.innovation(sighting.pose, noise).distance2;
    if (distance2 > parameters.gate_pose) return false;
  }
  drive.update(sighting.pose, noise, parameters);
  drive_ = drive;
  surprise_ = surprise;
  innovation2_ = static_cast<float>(distance2);
  return true;
}

bool TrackedRobot::fuse_without_heading(const RobotSighting& sighting, const RobotFilterParameters& p) {
  if (heading_known_) {
    if (drive_.distance2(sighting.pose.position, p) > p.gate_position) return false;
    drive_.update(sighting.pose.position, p);
    return true;
  }
  // With the first heading, the position moves from the team patch to the robot's center.
  PointFilter::Noise noise = point_motion(p);
  noise.position_sigma_m =
      position_sigma(sum_of(noise_of(sighting, p))) + (sighting.has_heading ? p.patch_sigma_m : 0.0);
  if (point_.distance2(sighting.pose.position, noise) > p.gate_position) return false;
  if (sighting.has_heading) {
    const double c = std::cos(static_cast<double>(sighting.pose.theta_rad));
    const double s = std::sin(static_cast<double>(sighting.pose.theta_rad));
    start_drive(sighting,
                {c * point_.vx_mps() + s * point_.vy_mps(), 0.0, std::sqrt(point_.velocity_variance()),
                 p.start_turn_sigma_radps},
                p);
  } else {
    point_.update(sighting.pose.position, noise);
  }
  return true;
}

bool TrackedRobot::fuse(const RobotSighting& sighting, Instant now, const TrackParameters& parameters) {
  const RobotFilterParameters& p = parameters.robot;
  const bool both_have_heading = heading_known_ && sighting.has_heading;
  if (!(both_have_heading ? fuse_pose(sighting, now, p) : fuse_without_heading(sighting, p))) {
    const ConsecutiveOutliers::Outlier outlier{sighting.pose, sighting.has_heading, now};
    outliers_.add(outlier, parameters.consistent_m, p.max_speed_mps);
    const bool reachable = ConsecutiveOutliers::within_reach(last_position_, life_.last_seen(), outlier,
                                                             parameters.consistent_m, p.max_speed_mps);
    const bool certain = sighting.id != kUnknownId && sighting.id == id_ && sighting.confidence >= kCertainId;
    const int needed = certain ? std::min(p.restart_after, kCertainOutliers) : p.restart_after;
    if (outliers_.count() < needed || !reachable) return false;
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
  const PoseCovariance noise = sum_of(noise_of(sighting, p));
  double vx = 0.0, vy = 0.0, v_sigma = p.start_speed_sigma_mps;
  if (outliers_.count() >= 2 && dt > 0.0) {
    vx = static_cast<double>(sighting.pose.position.x_m - first.pose.position.x_m) / dt;
    vy = static_cast<double>(sighting.pose.position.y_m - first.pose.position.y_m) / dt;
    v_sigma =
        std::min(v_sigma, std::numbers::sqrt2 * position_sigma(noise) / dt + p.free_noise_mps_rts * std::sqrt(dt));
  }
  if (!sighting.has_heading) {
    heading_known_ = false;
    point_.start(sighting.pose.position, {vx, vy, v_sigma}, position_sigma(noise));
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
        std::min(w_sigma, std::numbers::sqrt2 * heading_sigma(noise) / dt + p.free_noise_radps_rts * std::sqrt(dt));
  }
  start_drive(sighting, {v, w, v_sigma, w_sigma}, p);
}

void TrackedRobot::shift_to(FieldPoint position) {
  drive_.shift_to(position);
  point_.shift_to(position);
}

void TrackedRobot::missed(Instant now, const TrackParameters& parameters) {
  drive_activity_.restore();
  turn_activity_.restore();
  life_.missed(now, limits_of(parameters));
}

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
    track.xy_covariance_m2 = static_cast<float>(drive_.xy_covariance());
    track.innovation2 = innovation2_;
  } else {
    const auto sigma = static_cast<float>(std::hypot(position_sigma_m(), parameters.robot.patch_sigma_m));
    track.sigma = {sigma, sigma, static_cast<float>(kUnknownHeadingSigma)};
  }
  return track;
}

}  // namespace touchline
