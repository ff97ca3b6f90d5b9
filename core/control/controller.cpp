#include "core/control/controller.h"

#include <algorithm>
#include <cmath>

#include "core/control/drive_limits.h"
#include "core/parameter.h"

namespace touchline {
namespace {

// After a longer pause the robots have stopped by themselves (docs/radio.md): a jump to full speed would be wrong.
constexpr double kMaxStep = 0.1;

}  // namespace

Status Controller::configure(const ControlParameters& parameters, const FieldParameters& field) {
  if (Status s = take(parameters, field); !s.ok()) return s;
  reset();
  return {};
}

Status Controller::take(const ControlParameters& parameters, const FieldParameters& field) {
  const DriveParameters& drive = parameters.drive;
  if (!is_positive(drive.wheel_base_m) || !is_positive(drive.max_speed_mps) || !is_positive(drive.max_turn_radps) ||
      !is_positive(drive.max_wheel_speed_mps) || !is_positive(drive.max_wheel_acceleration_mps2)) {
    return ErrorCode::kOutOfRange;
  }
  const PlayParameters& play = parameters.play;
  if (!is_positive(play.robot_radius_m) || !is_positive(play.clearance_m) || !is_positive(play.behind_ball_m) ||
      !is_positive(parameters.motion.distance_per_s) || !is_positive(static_cast<double>(field.length_m)) ||
      !is_positive(static_cast<double>(field.width_m))) {
    return ErrorCode::kOutOfRange;
  }
  parameters_ = parameters;
  play_.configure(parameters, field);
  return {};
}

void Controller::reset() {
  play_.reset();
  memories_.clear();
  started_ = false;
}

bool Controller::fit_to_play(const RobotTrack& robot, Instant now) const {
  if (robot.state == TrackState::kSeen) return true;
  return robot.state == TrackState::kCoasting && seconds(now - robot.last_seen) <= parameters_.play.max_coast_s;
}

Controller::Memory* Controller::memory_of(RobotId id) {
  for (Memory& memory : memories_) {
    if (memory.id == id) return &memory;
  }
  if (memories_.full()) return nullptr;
  memories_.push_back({});
  memories_.back().id = id;
  return &memories_.back();
}

void Controller::forget_absent() {
  std::size_t kept = 0;
  for (const Memory& memory : memories_) {
    if (memory.listed) memories_[kept++] = memory;
  }
  memories_.resize(kept);
}

void Controller::decide(const Tracks& tracks, bool halted, Commands& out) {
  out.stop = halted;
  out.robots.clear();
  const Instant now = tracks.capture_time;
  const double dt = started_ ? std::clamp(seconds(now - last_time_), 0.0, kMaxStep) : 0.0;
  last_time_ = now;
  started_ = true;

  Players players;
  for (const RobotTrack& robot : tracks.robots) {
    if (robot.team != Team::kOwn || robot.id < 0 || !fit_to_play(robot, now)) continue;
    if (!players.full()) players.push_back({robot.id, robot.pose_at_action, robot.twist_at_action});
  }
  Play::Twists wanted{};
  if (halted || !parameters_.play.enabled) {
    play_.reset();
  } else {
    play_.decide(tracks, players, wanted);
  }

  for (Memory& memory : memories_) memory.listed = false;
  std::size_t player = 0;
  for (const RobotTrack& robot : tracks.robots) {
    if (robot.team != Team::kOwn || robot.id < 0 || out.robots.full()) continue;
    Memory* memory = memory_of(robot.id);
    if (memory == nullptr) {
      // Eleven others are remembered, of whom some are gone.
      forget_absent();
      memory = memory_of(robot.id);
      if (memory == nullptr) continue;
    }
    memory->listed = true;
    const bool plays = player < players.size() && players[player].id == robot.id;
    Twist twist;
    if (plays && !halted && parameters_.play.enabled) {
      twist = memory->stuck.watch(robot.pose_at_action, wanted[player], now, parameters_.play);
      twist = within_speed_limits(twist, parameters_.drive);
      twist = within_acceleration_limit(twist, memory->last, dt, parameters_.drive);
    } else {
      memory->stuck = StuckMonitor();
    }
    if (plays) ++player;
    memory->last = twist;
    out.robots.push_back({robot.id, twist, wheels_of(twist, parameters_.drive.wheel_base_m)});
  }
  forget_absent();
}

}  // namespace touchline
