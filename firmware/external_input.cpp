#include "firmware/external_input.h"

#include <algorithm>

namespace touchline {
namespace {

// Converts a time of reception to the loop's clock. A time in the future counts as now.
Instant on_loop_clock(Instant received, Instant now, Instant machine_now) {
  return now - std::max(machine_now - received, Duration::zero());
}

}  // namespace

void ExternalInput::take(Instant now, Instant machine_now) {
  take_commands(now, machine_now);
  take_referee(now, machine_now);
  if (settings_.console != nullptr) take_console(now, machine_now);
}

void ExternalInput::take_commands(Instant now, Instant machine_now) {
  if (settings_.commands == nullptr || !settings_.commands->take(arrived_)) return;
  const ExternalCommands former = commands_;
  const auto former_received = machine_received_;
  commands_ = arrived_;
  for (std::size_t i = 0; i < commands_.size(); ++i) {
    ExternalCommand& command = commands_[i];
    machine_received_[i] = command.received;
    const auto* const same = std::find_if(former.begin(), former.end(),
                                          [&](const ExternalCommand& other) { return other.id == command.id; });
    // A command that was taken before keeps its time on the loop's clock, because the simulated clock may have run
    // faster than the machine's since then.
    if (same != former.end() && former_received[static_cast<std::size_t>(same - former.begin())] == command.received) {
      command.received = same->received;
    } else {
      command.received = on_loop_clock(command.received, now, machine_now);
      ++counts_.commands;
    }
  }
}

void ExternalInput::take_referee(Instant now, Instant machine_now) {
  RefereeState state;
  if (settings_.referee == nullptr) {
    const RefereeSource& simulated = settings_.simulated_referee;
    if (simulated.read == nullptr) return;
    referee_ = simulated.read(simulated.context).value_or(RefereeState{});
    referee_.received = now;
    return;
  }
  if (!settings_.referee->take(state)) return;
  state.received = on_loop_clock(state.received, now, machine_now);
  if (!state.own_is_yellow) state.own_is_yellow = referee_.own_is_yellow;
  if (!state.own_on_positive_half) state.own_on_positive_half = referee_.own_on_positive_half;
  referee_ = state;
  ++counts_.referee_messages;
}

void ExternalInput::take_console(Instant now, Instant machine_now) {
  static_cast<void>(settings_.console->input.take(console_));
  is_driver_silent_ = console_.driver_heard && machine_now - *console_.driver_heard > kDriverSilence;
  merged_.clear();
  for (ExternalCommand command : console_.commands) {
    // The age limit of the console's commands differs from that of other programs' commands.
    const bool is_recent = machine_now - command.received <= kConsoleCommandAge;
    command.received = is_recent ? now : Instant{};
    merged_.push_back(command);
  }
  for (const ExternalCommand& command : commands_) {
    const bool is_replaced = std::any_of(merged_.begin(), merged_.end(),
                                         [&](const ExternalCommand& other) { return other.id == command.id; });
    if (!is_replaced) merged_.push_back(command);
  }
}

void ExternalInput::on_start() {
  if (settings_.referee_releases != nullptr) settings_.referee_releases->fetch_add(1, std::memory_order_relaxed);
}

void ExternalInput::apply_to(StopRules& rules, Instant now, Duration timeout) {
  rules.apply_external(halt(now, timeout));
  if (settings_.console == nullptr) return;
  ConsoleLink& console = *settings_.console;
  rules.hold(kHaltDriver, is_driver_silent_);
  // The count of starts is in the link, because the loop of the next session must know it as well.
  const bool is_new_start = console.starts_taken.load(std::memory_order_relaxed) != console_.starts;
  console.starts_taken.store(console_.starts, std::memory_order_relaxed);
  if (is_new_start && console_.start_number == rules.held_number()) {
    rules.start();
    on_start();
  }
  console.held_number.store(rules.held_number(), std::memory_order_release);
  console.is_held.store(rules.is_held(), std::memory_order_release);
}

void ExternalInput::count_expired(const Commands& commands) {
  FixedVector<RobotId, kMaxRobotsPerTeam> expired;
  for (const RobotCommand& robot : commands.robots) {
    if (robot.source != CommandSource::kExpired) continue;
    expired.push_back(robot.id);
    if (std::find(expired_.begin(), expired_.end(), robot.id) == expired_.end()) ++counts_.commands_expired;
  }
  expired_ = expired;
}

std::uint32_t ExternalInput::halt(Instant now, Duration timeout) const {
  std::uint32_t reasons = kHaltNone;
  if (permission_in(referee_) == Permission::kStand) reasons |= kHaltReferee;
  const bool is_silent = referee_.repeats && now - referee_.received > timeout;
  const bool is_awaited = settings_.awaits_referee && counts_.referee_messages == 0;
  if (is_silent || is_awaited) reasons |= kHaltSilence;
  if (!is_assigned_) reasons |= kHaltTeams;
  if (console_.stop) reasons |= console_.setup_ended ? kHaltConsole | kHaltSetupEnded : kHaltConsole;
  if (is_held_by_setup()) reasons |= kHaltSetup;
  return reasons;
}

bool ExternalInput::is_held_by_setup() const {
  switch (settings_.setup) {
    case SetupMode::kCalibrated:
      return console_.setup == SetupWish::kStand;
    case SetupMode::kDraft:
      return console_.setup != SetupWish::kPermit;
    case SetupMode::kUncalibrated:
      break;
  }
  return true;
}

TeamAssignment ExternalInput::wanted_assignment() const {
  const std::optional<bool> configured = settings_.own_is_yellow, demanded = referee_.own_is_yellow;
  TeamAssignment assignment;
  assignment.colors_exchanged = configured && demanded && *configured != *demanded;
  assignment.sides_exchanged = is_on_positive_half();
  assignment.height_m = {referee_.own_height_m, referee_.opponent_height_m};
  return assignment;
}

void ExternalInput::assign_teams(const Pipeline& pipeline) {
  const TeamAssignment wanted = wanted_assignment();
  if (wanted == assignment_) return;
  assignment_ = wanted;
  is_assigned_ = pipeline.check_teams(wanted).ok();
  if (is_assigned_) teams_ = wanted;
}

}  // namespace touchline
