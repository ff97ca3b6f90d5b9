#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "firmware/console_input.h"
#include "hal/result.h"

namespace touchline::console {

/// Number of a client, counted from 1 since the start of the server.
using ClientNumber = std::uint32_t;

/// Decides who may drive, whether all robots are stopped, and which commands the driven robots get. Every client may
/// stop; only one client at a time, the driver, may start and drive. If the driver's connection ends, robots stop until
/// somebody starts them. The loop notices a silent driver, because the input contains the time of the driver's last
/// message. The class uses no I/O and no clock.
///
/// Every stop has a number, and a start names the stop that it ends. A start that was sent before another stop arrived
/// therefore ends nothing.
class Driving {
 public:
  /// `robots`: ids of the own robots.
  explicit Driving(std::vector<RobotId> robots) : robots_(std::move(robots)) {}

  void stop();
  /// Stops the robots after a setup, until a person starts them.
  void stop_after_setup();
  /// Takes the loop's values of ConsoleLink. Returns whether robots have begun or ceased to wait for a start.
  bool set_held(std::uint32_t number, bool is_held);
  /// Sets the robots of other files; nobody drives a robot any more.
  void set_robots(std::vector<RobotId> robots) {
    robots_ = std::move(robots);
    clear_commands();
  }
  [[nodiscard]] const std::vector<RobotId>& robots() const { return robots_; }
  /// Returns whether the driver drives a robot at the moment.
  [[nodiscard]] bool is_driving(Instant now) const {
    return std::any_of(input_.commands.begin(), input_.commands.end(),
                       [now](const ExternalCommand& command) { return now - command.received <= kConsoleCommandAge; });
  }
  /// Ends a stop. `number`: number of the stop that the client knows. kPermission: the client is not the driver;
  /// kInconsistent: the present stop is another one. Robots that were driven stay with the console.
  Result<void> start(ClientNumber client, std::uint32_t number);
  /// Makes the client the driver, even if there is one.
  void take(ClientNumber client, Instant now);
  /// Ends the client's role as driver; its robots play by themselves again. kPermission: the client is not the driver.
  Result<void> release(ClientNumber client);
  /// kPermission: the client is not the driver; kNotFound: there is no such robot.
  Result<void> drive(ClientNumber client, RobotId id, Twist twist, Instant now);
  /// As drive(), for the setup program, which sets the wheels. kPermission: nobody drives.
  Result<void> drive_wheels(RobotId id, const WheelSpeeds& wheels, Instant now);
  /// Forgets the command of drive_wheels().
  void end_wheels(RobotId id);
  /// Lets the robot play by itself again. Errors as drive().
  Result<void> give_back(ClientNumber client, RobotId id);

  /// kPermission: the client is not the driver.
  [[nodiscard]] Result<void> require_driver(ClientNumber client) const;
  /// Records that a message of the client arrived at `arrived`, whatever its content.
  void hear(ClientNumber client, Instant arrived);
  /// Records that the client's connection has ended. Returns whether this has stopped the robots.
  bool leave(ClientNumber client);

  [[nodiscard]] std::optional<ClientNumber> driver() const { return driver_; }
  /// Returns whether robots wait for a start.
  [[nodiscard]] bool is_stopped() const { return input_.stop || is_held_; }
  /// Returns the number of the stop in force, or of the last stop.
  [[nodiscard]] std::uint32_t stop_number() const { return input_.stops + held_number_; }
  [[nodiscard]] bool is_silent(Instant now) const {
    return input_.driver_heard && now - *input_.driver_heard > kDriverSilence;
  }
  /// Returns whether the input has changed since the last call and must be passed to the loop.
  [[nodiscard]] bool take_change() { return std::exchange(changed_, false); }
  [[nodiscard]] const ConsoleInput& input() const { return input_; }

 private:
  Result<void> put(const ExternalCommand& command);
  void let_robots_stand();
  void clear_commands();

  std::vector<RobotId> robots_;
  ConsoleInput input_;
  bool changed_ = false;
  std::optional<ClientNumber> driver_;
  std::uint32_t held_number_ = 0;  // as in ConsoleLink
  bool is_held_ = false;
};

}  // namespace touchline::console
