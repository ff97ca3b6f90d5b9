#include "firmware/console/driving.h"

#include <algorithm>

namespace touchline::console {

Result<void> Driving::require_driver(ClientNumber client) const {
  if (driver_ == client) return {};
  return failure(ErrorCode::kPermission, "this client does not have control: take over first");
}

// Replaces the commands by zero, because a command given before a stop must not move a robot after it.
void Driving::let_robots_stand() {
  changed_ = true;
  for (ExternalCommand& command : input_.commands) {
    command.twist = {};
    command.wheels = {};
  }
}

void Driving::stop() {
  input_.stop = true;
  input_.setup_ended = false;
  ++input_.stops;
  let_robots_stand();
}

void Driving::stop_after_setup() {
  const bool was_stopped = input_.stop && !input_.setup_ended;
  stop();
  input_.setup_ended = !was_stopped;
}

bool Driving::set_held(std::uint32_t number, bool is_held) {
  is_held_ = is_held;
  if (std::exchange(held_number_, number) == number) return false;
  let_robots_stand();
  return true;
}

void Driving::clear_commands() {
  changed_ = changed_ || !input_.commands.empty();
  input_.commands.clear();
}

Result<void> Driving::start(ClientNumber client, std::uint32_t number) {
  TOUCHLINE_TRY(require_driver(client));
  if (number != stop_number()) {
    return failure(ErrorCode::kInconsistent,
                   "it answers stop %u, but stop %u has come since: see why the robots are stopped, then start again",
                   number, stop_number());
  }
  input_.stop = false;
  ++input_.starts;
  input_.start_number = held_number_;
  let_robots_stand();
  return {};
}

void Driving::take(ClientNumber client, Instant now) {
  driver_ = client;
  input_.driver_heard = now;
  changed_ = true;
}

Result<void> Driving::release(ClientNumber client) {
  TOUCHLINE_TRY(require_driver(client));
  driver_.reset();
  input_.driver_heard.reset();
  changed_ = true;
  clear_commands();
  return {};
}

Result<void> Driving::drive(ClientNumber client, RobotId id, Twist twist, Instant now) {
  TOUCHLINE_TRY(require_driver(client));
  ExternalCommand command;
  command.id = id;
  command.twist = twist;
  command.received = now;
  return put(command);
}

Result<void> Driving::drive_wheels(RobotId id, const WheelSpeeds& wheels, Instant now) {
  if (!driver_) return failure(ErrorCode::kPermission, "nobody has control");
  ExternalCommand command;
  command.id = id;
  command.kind = ExternalCommand::Kind::kWheels;
  command.wheels = wheels;
  command.received = now;
  return put(command);
}

void Driving::end_wheels(RobotId id) {
  ExternalCommands kept;
  for (const ExternalCommand& command : input_.commands) {
    if (command.id != id || command.kind != ExternalCommand::Kind::kWheels) kept.push_back(command);
  }
  changed_ = changed_ || kept.size() != input_.commands.size();
  input_.commands = kept;
}

Result<void> Driving::put(const ExternalCommand& command) {
  const RobotId id = command.id;
  if (std::find(robots_.begin(), robots_.end(), id) == robots_.end()) {
    return failure(ErrorCode::kNotFound, "there is no robot %d in the team file", int{id});
  }
  auto* const known = std::find_if(input_.commands.begin(), input_.commands.end(),
                                   [id](const ExternalCommand& other) { return other.id == id; });
  if (known != input_.commands.end()) {
    *known = command;
  } else if (!input_.commands.push_back(command)) {
    return failure(ErrorCode::kFull, "more than %zu robots are driven", kMaxRobotsPerTeam);
  }
  changed_ = true;
  return {};
}

Result<void> Driving::give_back(ClientNumber client, RobotId id) {
  TOUCHLINE_TRY(require_driver(client));
  ExternalCommands kept;
  for (const ExternalCommand& command : input_.commands) {
    if (command.id != id) kept.push_back(command);
  }
  if (kept.size() == input_.commands.size())
    return failure(ErrorCode::kNotFound, "robot %d is not driven from the console", int{id});
  input_.commands = kept;
  changed_ = true;
  return {};
}

void Driving::hear(ClientNumber client, Instant arrived) {
  if (driver_ != client) return;
  input_.driver_heard = arrived;
  changed_ = true;
}

bool Driving::leave(ClientNumber client) {
  if (driver_ != client) return false;
  driver_.reset();
  input_.driver_heard.reset();
  stop();
  clear_commands();
  return true;
}

}  // namespace touchline::console
