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

// The page sends a ping every 0.3 s: three may be late.
inline constexpr Duration kDriverSilence = std::chrono::seconds(1);

/// Who may drive, whether everything is stopped, and the commands of the driven robots. Every client may stop; one at a
/// time, the driver, may start and drive. Robots stop, until somebody starts them, if the driver's connection ends or
/// it is silent for kDriverSilence. No I/O and no clock.
class Driving {
 public:
  /// `robots`: ids of our robots.
  explicit Driving(std::vector<RobotId> robots) : robots_(std::move(robots)) {}

  void stop() { set_stopped(true); }
  /// After a setup, robots stand until a person says so.
  void stop_after_setup();
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
  /// kPermission: the client is not the driver. Robots that were driven stay with the console.
  Result<void> start(ClientNumber client);
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
  /// A message of the client arrived, whatever it says.
  void hear(ClientNumber client, Instant now);
  /// The client's connection has ended. Returns whether that stopped the robots.
  bool leave(ClientNumber client);
  /// Returns whether the driver's silence has stopped the robots just now.
  bool check_silence(Instant now);

  [[nodiscard]] std::optional<ClientNumber> driver() const { return driver_; }
  [[nodiscard]] bool is_stopped() const { return input_.stop; }
  /// Whether the input has changed since the last call, and has to be passed to the loop.
  [[nodiscard]] bool take_change() { return std::exchange(changed_, false); }
  [[nodiscard]] const ConsoleInput& input() const { return input_; }

 private:
  void set_stopped(bool stopped);
  void clear_commands();

  std::vector<RobotId> robots_;
  ConsoleInput input_;
  bool changed_ = false;
  std::optional<ClientNumber> driver_;
  Instant heard_{};         // the driver's last message
  bool is_silent_ = false;  // for too long; reported once
};

}  // namespace touchline::console
