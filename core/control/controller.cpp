#include "core/control/controller.h"

#include <algorithm>
#include <cmath>

#include "core/control/motion/drive_limits.h"
#include "core/control/turned_field.h"
#include "core/parameter.h"

namespace touchline {
namespace {

// After a longer pause the robots have stopped by themselves (docs/radio.md) and must accelerate from rest again.
constexpr double kMaxStep = 0.1;

}  // namespace

Status Controller::configure(const ControlParameters& parameters, const FieldParameters& field) {
  if (Status s = apply(parameters, field); !s.ok()) return s;
  reset();
  return {};
}

Status Controller::apply(const ControlParameters& parameters, const FieldParameters& field) {
  const DriveParameters& drive = parameters.drive;
  if (!is_positive(drive.wheel_base_m) || !is_positive(drive.max_speed_mps) || !is_positive(drive.max_turn_radps) ||
      !is_positive(drive.max_wheel_speed_mps) || !is_positive(drive.max_wheel_acceleration_mps2)) {
    return ErrorCode::kOutOfRange;
  }
  const PlayParameters& play = parameters.play;
  if (!is_positive(play.robot_radius_m) || !is_positive(play.clearance_m) || !is_positive(play.ball_radius_m) ||
      !is_positive(parameters.line_up.max_speed_mps) || !is_positive(parameters.line_up.ball_distance_m) ||
      !is_positive(parameters.external.max_age_s) || !is_positive(static_cast<double>(field.length_m)) ||
      !is_positive(static_cast<double>(field.width_m))) {
    return ErrorCode::kOutOfRange;
  }
  parameters_ = parameters;
  play_.configure(parameters, field);
  motion_.configure(parameters, field);
  if (other_ != nullptr) other_->configure(parameters, field);
  line_up_.configure(parameters, field);
  return {};
}

void Controller::reset() {
  strategy().reset();
  states_.clear();
  motion_.reset();
  started_ = false;
}

bool Controller::is_usable(const RobotTrack& robot, Instant now) const {
  if (robot.state == TrackState::kSeen) return true;
  return robot.state == TrackState::kCoasting && seconds(now - robot.last_seen) <= parameters_.play.max_coast_s;
}

Controller::RobotState* Controller::state_of(RobotId id) {
  for (RobotState& state : states_) {
    if (state.id == id) return &state;
  }
  if (states_.full()) return nullptr;
  states_.push_back({});
  states_.back().id = id;
  return &states_.back();
}

void Controller::remove_absent() {
  std::size_t kept = 0;
  for (const RobotState& state : states_) {
    if (state.listed) states_[kept++] = state;
  }
  states_.resize(kept);
}

void Controller::set_turned(bool turned) {
  if (turned == turned_) return;
  turned_ = turned;
  strategy().reset();
  motion_.reset();
}

void Controller::set_situation(const GameSituation& situation) {
  if (situation == situation_) return;
  situation_ = situation;
  strategy().set_situation(situation);
}

Players Controller::players_of(const Tracks& tracks) {
  Players players;
  for (const RobotTrack& robot : tracks.robots) {
    if (robot.team != Team::kOwn || robot.id < 0 || !is_usable(robot, tracks.capture_time)) continue;
    if (external_.command_of(robot.id) != nullptr || players.full()) continue;
    const RobotState* state = state_of(robot.id);
    players.push_back(
        {robot.id, robot.pose_at_action, robot.twist_at_action, state != nullptr ? state->wheels : Twist{}});
  }
  return players;
}

void Controller::predict_wheels(const Tracks& tracks, double since_last_s) {
  for (RobotState& state : states_) {
    state.listed = std::any_of(tracks.robots.begin(), tracks.robots.end(), [&](const RobotTrack& robot) {
      return robot.team == Team::kOwn && robot.id == state.id;
    });
    state.wheels = wheels_after(state.wheels, state.command, since_last_s, parameters_.drive);
  }
  remove_absent();
}

Twist Controller::external_twist(const ExternalCommand& command, const Player& robot) {
  ExternalCommand seen = command;
  if (turned_) seen.target = turned(command.target);
  return twist_of(seen, robot, motion_, parameters_.drive);
}

Twist Controller::within_limits(const Twist& wanted, const Twist& wheels, double period_s) const {
  DriveParameters drive = parameters_.drive;
  if (permission_in(situation_) != Permission::kPlay) {
    drive.max_speed_mps = std::min(drive.max_speed_mps, parameters_.line_up.max_speed_mps);
  }
  return within_acceleration_limit(within_speed_limits(wanted, drive), wheels, period_s, parameters_.drive);
}

Twist Controller::permitted(const Twist& wanted, const Player& robot, double period_s) {
  const MotionState moves = motion_state(robot.pose, robot.twist, robot.wheels);
  const Twist limited = within_limits(wanted, robot.wheels, period_s);
  if (motion_.permits(robot.id, moves, limited)) return limited;
  return within_limits(brake(moves, period_s, parameters_.drive), robot.wheels, period_s);
}

void Controller::decide(const Tracks& measured, bool is_halted, Commands& out) {
  const Permission permission = permission_in(situation_);
  const bool halted = is_halted || permission == Permission::kStand;
  out.stop = halted;
  out.robots.clear();
  if (turned_) turn(measured, turned_tracks_);
  const Tracks& tracks = turned_ ? turned_tracks_ : measured;
  const Instant now = tracks.capture_time;
  const double since_last = started_ ? std::max(0.0, seconds(now - last_time_)) : 0.0;
  // The next command acts as long as the last one did.
  const double period = std::min(since_last, kMaxStep);
  last_time_ = now;
  started_ = true;
  predict_wheels(tracks, since_last);
  motion_.begin(tracks);

  const Players players = players_of(tracks);
  Strategy::Twists wanted{};
  if (halted || !parameters_.play.enabled) {
    strategy().reset();
  } else if (permission == Permission::kLineUp) {
    strategy().reset();  // the game begins anew
    line_up_.decide(tracks, players, situation_, period, wanted);
  } else {
    strategy().decide(tracks, players, wanted);
  }

  std::size_t player = 0;
  for (const RobotTrack& robot : tracks.robots) {
    if (robot.team != Team::kOwn || robot.id < 0 || out.robots.full()) continue;
    RobotState* state = state_of(robot.id);
    if (state == nullptr) continue;
    const Player here{robot.id, robot.pose_at_action, robot.twist_at_action, state->wheels};
    RobotCommand command;
    command.id = robot.id;
    const ExternalCommand* external = external_.command_of(robot.id);
    const bool plays = player < players.size() && players[player].id == robot.id;
    if (external != nullptr) {
      const bool expired = external_.is_expired(*external, parameters_.external);
      command.source = expired ? CommandSource::kExpired : CommandSource::kExternal;
      if (!halted && !expired && is_usable(robot, now)) {
        command.twist = permitted(external_twist(*external, here), here, period);
      }
    }
    if (plays && !halted && parameters_.play.enabled) {
      command.twist = permitted(wanted[player], here, period);
      command.role = strategy().role_of(robot.id);
    }
    if (plays) ++player;
    state->command = command.twist;
    command.wheels = wheels_of(command.twist, parameters_.drive.wheel_base_m);
    out.robots.push_back(command);
  }
}

void Controller::explain(PlayDecisions& out) const {
  out.clear();
  const PlayDecisions* const decided = strategy().decisions();
  if (decided == nullptr) return;
  for (PlayDecision decision : *decided) {
    const Pose at = turned({decision.target.value_or(FieldPoint{}), decision.direction_rad.value_or(0.0f)});
    if (turned_ && decision.target) decision.target = at.position;
    if (turned_ && decision.direction_rad) decision.direction_rad = at.theta_rad;
    out.push_back(decision);
  }
}

}  // namespace touchline
