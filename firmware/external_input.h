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
  kCalibrated,    // the saved ones
  kDraft,         // those of a guided setup: robots stand unless the console permits
  kUncalibrated,  // saved ones or a draft that lack the calibration: robots stand
};

struct ExternalInputSettings {
  Mailbox<ExternalCommands>* commands = nullptr;  // null: no other program may drive robots
  Mailbox<RefereeState>* referee = nullptr;       // null: there is no referee
  // Color of the own team in the team file; nullopt: the referee's team colors are ignored.
  std::optional<bool> own_is_yellow;
  // Counts the acts of persons that let another referee be followed (network::RefereeFollower); null: there is none.
  std::atomic<std::uint32_t>* referee_releases = nullptr;
  // Robots stand until the first message of the referee.
  bool awaits_referee = false;
  ConsoleLink* console = nullptr;  // null: there is no console
  SetupMode setup = SetupMode::kCalibrated;
};

/// Takes the commands of other programs, the messages of a referee and the console's input from their mailboxes. They
/// are stamped with CLOCK_MONOTONIC. The loop's clock differs from it in a simulation; on both clocks a value has the
/// same age when it is taken.
class ExternalInput {
 public:
  explicit ExternalInput(const ExternalInputSettings& settings) : settings_(settings) {}

  /// `now`: of the loop's clock; `machine_now`: CLOCK_MONOTONIC.
  void take(Instant now, Instant machine_now);
  /// Applies what was taken: reasons to halt, the driver's silence, and a start. Tells the console what holds.
  /// `timeout`: for a referee that repeats its messages.
  void apply_to(StopRules& rules, Instant now, Duration timeout);
  /// Passes team colors, sides and heights of the referee on.
  void assign_teams(Pipeline& pipeline);
  /// A person has pressed the start button, or Start in the console.
  void on_start();
  /// Counts the robots whose command has become too old since the last frame.
  void count_expired(const Commands& commands);

  /// Of other programs and of the console, whose commands have precedence. `received` is of the loop's clock, here and
  /// in referee().
  [[nodiscard]] const ExternalCommands& commands() const { return settings_.console != nullptr ? merged_ : commands_; }
  [[nodiscard]] const RefereeState& referee() const { return referee_; }
  [[nodiscard]] const ConsoleInput& console() const { return console_; }
  /// The bits of kExternalHalts that hold. `timeout`: for a referee that repeats its messages.
  [[nodiscard]] std::uint32_t halt(Instant now, Duration timeout) const;
  [[nodiscard]] const ExternalCounts& counts() const { return counts_; }
  /// The number of the stop in force, which a start of the console's driver has to name. Every stop of a client and
  /// everything else that ends with a start changes it.
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
  ExternalCommands merged_;  // those of the console, and commands_ of the other robots
  std::array<Instant, kMaxRobotsPerTeam> machine_received_{};  // of commands_, in their order
  FixedVector<RobotId, kMaxRobotsPerTeam> expired_;
  RefereeState referee_;
  TeamAssignment assignment_;  // the last wanted one
  bool is_assigned_ = true;    // false: the pipeline refused it
  ExternalCounts counts_;
};

}  // namespace touchline
