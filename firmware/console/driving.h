#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "firmware/console_input.h"
#include "hal/result.h"

namespace touchline::console {

/// Number of a client since the start of the server: 1, 2, ...
using ClientNumber = std::uint32_t;

/// Decides who may drive, whether everything is stopped, and which commands the driven robots get. Every client may
/// stop; one at a time, the driver, may start and drive. Robots stop, until somebody starts them, if the driver's
/// connection ends. The loop notices that a driver is silent, because the input tells when the driver was last heard.
/// No I/O and no clock.
///
/// Every stop has a number, and a start names the number of the stop that it ends: a start that was on its way when
/// another stop came ends nothing.
class Driving {
 public:
  /// `robots`: ids of our robots.
  explicit Driving(std::vector<RobotId> robots) : robots_(std::move(robots)) {}

  void stop();
  /// After a setup, robots stand until a person says so.
  void stop_after_setup();
  /// Takes the loop's values of ConsoleLink. Returns whether robots have begun or ceased to be held.
  bool set_held(std::uint32_t number, bool is_held);
  /// Other files describe other robots: nobody is driven any more.
  void set_robots(std::vector<RobotId> robots) {
    robots_ = std::move(robots);
    clear_commands();
  }
  [[nodiscard]] const std::vector<RobotId>& robots() const { return robots_; }
  /// Whether the driver drives a robot at the moment.
  [[nodiscard]] bool is_driving(Instant now) const {
    return std::any_of(input_.commands.begin(), input_.commands.end(),
                       [now](const ExternalCommand& command) { return now - command.received <= kConsoleCommandAge; });
  }
  /// `number`: of the stop that the client knows. kPermission: the client is not the driver; kInconsistent: it is
  /// another stop. Robots that were driven stay with the console.
  Result<void> start(ClientNumber client, std::uint32_t number);
  /// The client becomes the driver, also if there is one.
  void take(ClientNumber client, Instant now);
  /// The driver gives up; its robots play by themselves again. kPermission: the client is not the driver.
  Result<void> release(ClientNumber client);
  /// kPermission: the client is not the driver; kNotFound: no such robot.
  Result<void> drive(ClientNumber client, RobotId id, Twist twist, Instant now);
  /// The robot plays by itself again. Errors as drive().
  Result<void> give_back(ClientNumber client, RobotId id);

  /// kPermission: the client is not the driver.
  [[nodiscard]] Result<void> require_driver(ClientNumber client) const;
  /// Records that a message of the client arrived at `arrived`, whatever it says.
  void hear(ClientNumber client, Instant arrived);
  /// The client's connection has ended. Returns whether that stopped the robots.
  bool leave(ClientNumber client);

  [[nodiscard]] std::optional<ClientNumber> driver() const { return driver_; }
  /// Whether robots wait for a start.
  [[nodiscard]] bool is_stopped() const { return input_.stop || is_held_; }
  /// Returns the number of the stop in force, or of the last stop.
  [[nodiscard]] std::uint32_t stop_number() const { return input_.stops + held_number_; }
  [[nodiscard]] bool is_silent(Instant now) const {
    return input_.driver_heard && now - *input_.driver_heard > kDriverSilence;
  }
  /// Whether the input has changed since the last call, and has to be passed to the loop.
  [[nodiscard]] bool take_change() { return std::exchange(changed_, false); }
  [[nodiscard]] const ConsoleInput& input() const { return input_; }

 private:
  void let_robots_stand();
  void clear_commands();

  std::vector<RobotId> robots_;
  ConsoleInput input_;
  bool changed_ = false;
  std::optional<ClientNumber> driver_;
  std::uint32_t held_number_ = 0;  // see ConsoleLink
  bool is_held_ = false;
};

}  // namespace touchline::console
