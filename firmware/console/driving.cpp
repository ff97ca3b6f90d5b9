#include "firmware/console/driving.h"

#include <algorithm>

namespace touchline::console {

Result<void> Driving::require_driver(ClientNumber client) const {
  if (driver_ == client) return {};
  return failure(ErrorCode::kPermission, "another client drives, or nobody: take over first");
}

void Driving::set_stopped(bool stopped) {
  changed_ = changed_ || input_.stop != stopped;
  input_.stop = stopped;
  // A command from before the stop must not move a robot after it.
  for (ExternalCommand& command : input_.commands) command.twist = {};
}

void Driving::clear_commands() {
  changed_ = changed_ || !input_.commands.empty();
  input_.commands.clear();
}

Result<void> Driving::start(ClientNumber client) {
  TOUCHLINE_TRY(require_driver(client));
  set_stopped(false);
  ++input_.starts;
  changed_ = true;
  return {};
}

void Driving::take(ClientNumber client, Instant now) {
  driver_ = client;
  heard_ = now;
  is_silent_ = false;
}

Result<void> Driving::release(ClientNumber client) {
  TOUCHLINE_TRY(require_driver(client));
  driver_.reset();
  clear_commands();
  return {};
}

Result<void> Driving::drive(ClientNumber client, RobotId id, Twist twist, Instant now) {
  TOUCHLINE_TRY(require_driver(client));
  if (std::find(robots_.begin(), robots_.end(), id) == robots_.end()) {
    return failure(ErrorCode::kNotFound, "there is no robot %d in the team file", int{id});
  }
  ExternalCommand command;
  command.id = id;
  command.twist = twist;
  command.received = now;
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
  if (kept.size() == input_.commands.size()) return failure(ErrorCode::kNotFound, "robot %d is not driven", int{id});
  input_.commands = kept;
  changed_ = true;
  return {};
}

void Driving::hear(ClientNumber client, Instant now) {
  if (driver_ != client) return;
  heard_ = now;
  is_silent_ = false;
}

bool Driving::leave(ClientNumber client) {
  if (driver_ != client) return false;
  driver_.reset();
  set_stopped(true);
  clear_commands();
  return true;
}

bool Driving::check_silence(Instant now) {
  if (!driver_ || is_silent_ || now - heard_ <= kDriverSilence) return false;
  is_silent_ = true;
  set_stopped(true);
  return true;
}

}  // namespace touchline::console
