#pragma once

#include <array>
#include <cstddef>

#include "core/types.h"

namespace touchline {

/// Which wheel a command drives, and in which direction.
struct WheelWiring {
  bool is_swapped = false;            // the command for the left wheel drives the right one, and vice versa
  std::array<bool, 2> is_reversed{};  // of the commands for left and right: a positive one drives backward
  friend bool operator==(const WheelWiring&, const WheelWiring&) = default;

  /// The speeds with which commands move the wheels on the robot's left and right.
  [[nodiscard]] WheelSpeeds wheels_of(const WheelSpeeds& command) const {
    const WheelSpeeds signed_speed{is_reversed[0] ? -command.left_mps : command.left_mps,
                                   is_reversed[1] ? -command.right_mps : command.right_mps};
    return is_swapped ? WheelSpeeds{signed_speed.right_mps, signed_speed.left_mps} : signed_speed;
  }
  /// The commands that move the wheels on the robot's left and right with these speeds.
  [[nodiscard]] WheelSpeeds command_of(const WheelSpeeds& wheels) const {
    const WheelSpeeds command = is_swapped ? WheelSpeeds{wheels.right_mps, wheels.left_mps} : wheels;
    return {is_reversed[0] ? -command.left_mps : command.left_mps,
            is_reversed[1] ? -command.right_mps : command.right_mps};
  }
};

}  // namespace touchline
