#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "firmware/config/configuration.h"
#include "firmware/loop.h"
#include "hal/camera.h"
#include "hal/clock.h"
#include "hal/gpio.h"
#include "hal/radio.h"

namespace touchline {

namespace hal::mock {
class Arena;
}

/// The devices of one board, each of the backend that the board file names; none is open yet.
class Devices {
 public:
  Devices();
  ~Devices();
  Devices(const Devices&) = delete;
  Devices& operator=(const Devices&) = delete;

  /// `seed`: of everything that is random in a simulation. Any mix of backends will do: an arena with something real
  /// beside it lives in real time.
  void make(const config::Configuration& configuration, std::uint64_t seed);

  /// After make().
  [[nodiscard]] LoopDevices loop_devices();
  /// In simulated time the clock stands still while the processor works.
  [[nodiscard]] bool simulated_time() const { return simulated_time_; }
  /// What a simulation has to tell at the end, in lines; empty for real devices.
  [[nodiscard]] std::string summary() const;

 private:
  std::unique_ptr<hal::mock::Arena> arena_;  // first: the devices refer to it
  std::unique_ptr<hal::Clock> clock_;
  std::unique_ptr<hal::Camera> camera_;
  std::unique_ptr<hal::Radio> radio_;
  std::unique_ptr<hal::Gpio> gpio_;
  bool simulated_time_ = false;
};

}  // namespace touchline
