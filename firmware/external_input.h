#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>
#include <utility>

#include "core/control/external_command.h"
#include "core/control/referee_state.h"
#include "core/pipeline.h"
#include "firmware/console_input.h"
#include "firmware/loop_statistics.h"
#include "firmware/stop_rules.h"
#include "hal/mailbox.h"

namespace touchline {

/// Which files are in use.
enum class SetupMode : std::uint8_t {
  kCalibrated,    // the saved files
  kDraft,         // the draft of a guided setup: robots stand unless the console permits motion
  kUncalibrated,  // saved files or a draft without calibration: robots stand
};

/// Reads the state of a simulated referee, without its time of reception. nullopt: there is no referee.
struct RefereeSource {
  std::optional<RefereeState> (*read)(void* context) = nullptr;  // null: there is none
  void* context = nullptr;
};

struct ExternalInputSettings {
  Mailbox<ExternalCommands>* commands = nullptr;  // null: no other program may drive robots
  Mailbox<RefereeState>* referee = nullptr;       // null: there is no referee
  // Color of the own team in the team file; nullopt: the referee's team colors are ignored.
  std::optional<bool> own_is_yellow;
  bool own_on_positive_half = false;  // until a referee says otherwise
  // Counts how often a person did something after which another referee may be followed (network::RefereeFollower);
  // null: no referee is followed.
  std::atomic<std::uint32_t>* referee_releases = nullptr;
  // Robots stand until the first message of the referee.
  bool awaits_referee = false;
  ConsoleLink* console = nullptr;  // null: there is no console
  SetupMode setup = SetupMode::kCalibrated;
  RefereeSource simulated_referee{};  // used if there is no other referee
};

/// Takes the commands of other programs, the messages of a referee and the console's input from their mailboxes. Values
/// arrive with stamps of CLOCK_MONOTONIC. In a simulation the loop's clock differs from CLOCK_MONOTONIC, so stamps are
/// converted: when a value is taken, its age is the same on both clocks.
class ExternalInput {
 public:
  explicit ExternalInput(const ExternalInputSettings& settings) : settings_(settings) {}

  /// `now` is the time on the loop's clock, `machine_now` that of CLOCK_MONOTONIC.
  void take(Instant now, Instant machine_now);
  /// Applies the values that were taken to the rules: reasons to halt, the driver's silence, and a start. Tells the
  /// console which stop holds the robots. `timeout` applies to a referee that repeats its messages.
  void apply_to(StopRules& rules, Instant now, Duration timeout);
  /// Takes the referee's team colors, sides and heights for teams(), unless the pipeline cannot use them.
  void assign_teams(const Pipeline& pipeline);
  /// Call it when a person has pressed the start button, or Start in the console.
  void on_start();
  /// Counts the robots whose command has become too old since the last frame.
  void count_expired(const Commands& commands);

  /// Returns the commands of other programs and of the console; those of the console have precedence. `received` is a
  /// time on the loop's clock, here and in referee().
  [[nodiscard]] const ExternalCommands& commands() const { return settings_.console != nullptr ? merged_ : commands_; }
  [[nodiscard]] const RefereeState& referee() const { return referee_; }
  /// Returns whether the own team defends the half with positive x.
  [[nodiscard]] bool is_on_positive_half() const {
    return referee_.own_on_positive_half.value_or(settings_.own_on_positive_half);
  }
  /// Returns the last assignment of the referee that the pipeline can use.
  [[nodiscard]] const TeamAssignment& teams() const { return teams_; }
  [[nodiscard]] const ConsoleInput& console() const { return console_; }
  /// Returns the bits of kExternalHalts that hold. `timeout` applies to a referee that repeats its messages.
  [[nodiscard]] std::uint32_t halt(Instant now, Duration timeout) const;
  [[nodiscard]] const ExternalCounts& counts() const { return counts_; }
  /// Returns the number of the stop in force. A start of the console's driver has to name this number. It changes with
  /// every stop of a client and with everything else that lasts until a start.
  [[nodiscard]] std::uint32_t stop_number(const StopRules& rules) const { return console_.stops + rules.held_number(); }

 private:
  void take_commands(Instant now, Instant machine_now);
  void take_referee(Instant now, Instant machine_now);
  void take_console(Instant now, Instant machine_now);
  [[nodiscard]] bool is_held_by_setup() const;
  [[nodiscard]] TeamAssignment wanted_assignment() const;

  const ExternalInputSettings settings_;
  ExternalCommands arrived_, commands_;
  ConsoleInput console_;
  bool is_driver_silent_ = false;
  ExternalCommands merged_;  // the console's commands, and commands_ for the other robots
  std::array<Instant, kMaxRobotsPerTeam> machine_received_{};  // times of reception of commands_, in the same order
  FixedVector<RobotId, kMaxRobotsPerTeam> expired_;
  RefereeState referee_;
  TeamAssignment assignment_;  // assignment that was requested last
  bool is_assigned_ = true;    // false: the pipeline cannot use it
  TeamAssignment teams_;
  ExternalCounts counts_;
};

}  // namespace touchline
