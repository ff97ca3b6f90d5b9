#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "firmware/arena_objects.h"
#include "firmware/arena_sides.h"
#include "firmware/config/configuration.h"
#include "firmware/loop.h"
#include "firmware/radio_plan.h"
#include "hal/camera.h"
#include "hal/clock.h"
#include "hal/gpio.h"
#include "hal/radio.h"

namespace touchline {

namespace hal::mock {
class Arena;
}  // namespace hal::mock

/// How the time of a simulated arena passes.
enum class ArenaTime : std::uint8_t {
  kFast,     // as fast as possible; time stands still while the processor works
  kPaced,    // as kFast, but as slow as real time: the results are the same
  kMachine,  // the machine's time, except while a picture is rendered: a late loop gets late frames and loses some
};

/// The devices of one board, with the backends that the board file names. make() creates them without opening them.
class Devices {
 public:
  Devices();
  ~Devices();
  Devices(const Devices&) = delete;
  Devices& operator=(const Devices&) = delete;

  /// `seed`: seed of all random numbers of a simulation. Backends can be combined freely: a simulated arena with a real
  /// device beside it runs in real time.
  /// kInconsistent: errors in the radios of board and team file.
  Result<void> make(const config::Configuration& configuration, std::uint64_t seed, ArenaTime time = ArenaTime::kFast);

  /// Lets `objects` move the robots and the ball of the arena, if there is one. Call it after make(). null: nobody
  /// moves them.
  void attach(std::shared_ptr<ArenaObjects> objects);
  [[nodiscard]] HalDevices hal_devices();
  /// Returns whether time is simulated: the clock then stands still while the processor works.
  [[nodiscard]] bool simulated_time() const { return simulated_time_; }
  /// Returns the source of the goals of a simulation; an empty one for real devices.
  [[nodiscard]] ScoreSource score() const;
  /// Returns when robots of a simulation were put elsewhere; an empty one for real devices.
  [[nodiscard]] JumpSource jumps() const;
  /// Returns the simulation's referee; an empty source for real devices.
  [[nodiscard]] RefereeSource referee() const;
  /// Returns the result of a simulation, several lines; empty for real devices.
  [[nodiscard]] std::string summary() const;

 private:
  [[nodiscard]] std::unique_ptr<hal::Radio> make_radio(const PlannedRadio& radio);

  ArenaOpponents opponents_;                  // before the arena, which refers to them
  std::unique_ptr<hal::mock::Arena> arena_;   // before the devices, which refer to it
  std::unique_ptr<hal::Clock> slowed_clock_;  // the clock that `clock_` slows or pauses
  std::unique_ptr<hal::Clock> clock_;
  std::unique_ptr<hal::Camera> camera_;
  std::unique_ptr<hal::Radio> radio_;
  std::unique_ptr<hal::Gpio> gpio_;
  std::shared_ptr<ArenaObjects> objects_;
  std::optional<hal::NetworkAddress> remote_arena_;  // where the arena that sends the pictures takes requests
  std::array<std::string, 2> colors_;                // names of the teams, by Side
  ArenaTimeControl time_control_ = ArenaTimeControl::kNone;
  bool simulated_time_ = false;
};

}  // namespace touchline
