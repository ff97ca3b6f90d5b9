#pragma once

#include "core/fixed_vector.h"
#include "core/types.h"

namespace touchline {

/// Command of another program to one of our robots. The limits of the drive apply to it.
struct ExternalCommand {
  enum class Kind : std::uint8_t {
    kRelease,  // the built-in play drives the robot again
    kTwist,
    kWheels,
    kPose  // our own control law drives to a pose
  };
  RobotId id = kUnknownId;
  Kind kind = Kind::kTwist;
  Twist twist;               // for kTwist
  WheelSpeeds wheels;        // for kWheels
  Pose target;               // for kPose, in the venue's coordinates
  bool has_heading = false;  // for kPose: the robot turns to the target's heading
  Instant received{};        // the command is ignored when it becomes too old
};

/// The last command of each robot that another program drives or has driven; at most one per robot.
using ExternalCommands = FixedVector<ExternalCommand, kMaxRobotsPerTeam>;

}  // namespace touchline
