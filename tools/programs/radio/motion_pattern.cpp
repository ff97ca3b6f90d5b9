#include "tools/programs/radio/motion_pattern.h"

#include <cmath>

namespace touchline::radio {

const char* expectation_of(Pattern pattern) {
  switch (pattern) {
    case Pattern::kForward:
      return "both wheels roll forward";
    case Pattern::kBackward:
      return "both wheels roll backward";
    case Pattern::kTurn:
      return "the right wheel rolls forward, the left one backward: the robot would turn to the left";
    case Pattern::kLeftWheel:
      return "the left wheel rolls forward, the right one stands";
    case Pattern::kRightWheel:
      return "the right wheel rolls forward, the left one stands";
    case Pattern::kToAndFro:
      return "both wheels roll forward and backward, half a second each";
  }
  return "";
}

WheelSpeeds speeds_of(Pattern pattern, double time_s, double speed_mps) {
  const auto speed = static_cast<float>(speed_mps);
  switch (pattern) {
    case Pattern::kForward:
      return {speed, speed};
    case Pattern::kBackward:
      return {-speed, -speed};
    case Pattern::kTurn:
      return {-speed, speed};
    case Pattern::kLeftWheel:
      return {speed, 0.0f};
    case Pattern::kRightWheel:
      return {0.0f, speed};
    case Pattern::kToAndFro: {
      const float now = std::fmod(time_s, 1.0) < 0.5 ? speed : -speed;
      return {now, now};
    }
  }
  return {};
}

}  // namespace touchline::radio
