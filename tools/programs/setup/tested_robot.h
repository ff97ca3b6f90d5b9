#pragma once

#include <cstddef>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "hal/result.h"
#include "tools/programs/radio/drive_measurement.h"

namespace touchline::setup {

/// What the firmware's message `step` tells of a frame and of the robot that a job drives.
struct TestedFrame {
  radio::DriveStep step;
  std::vector<std::string> halt;          // why robots stand
  std::vector<std::byte> sent, received;  // the robot's packet, and all telemetry
};

/// kInconsistent: a member is missing or wrong.
Result<TestedFrame> tested_frame_of(const nlohmann::json& message);

/// What a job answers to a frame.
struct TestOrder {
  WheelSpeeds wheels;  // for the next frame
  bool is_done = false;
  std::string text;         // for the page; "": as before
  double progress = -1;     // 0 to 1; less than 0: unknown
  nlohmann::json exchange;  // bytes for the page; null: as before
};

/// Drives a robot while a job runs: called with every frame. An error ends the job; the robot stands then.
using DriveRobot = std::function<Result<TestOrder>(const TestedFrame&)>;

}  // namespace touchline::setup
