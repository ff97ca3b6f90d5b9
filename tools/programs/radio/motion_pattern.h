#pragma once

#include <array>
#include <cstdint>

#include "core/parameter.h"
#include "core/types.h"

namespace touchline::radio {

/// What the wheels of a robot shall do.
enum class Pattern : std::uint8_t { kForward, kBackward, kTurn, kLeftWheel, kRightWheel, kToAndFro };
inline constexpr std::array<Choice<Pattern>, 6> kPatterns{{{"forward", Pattern::kForward},
                                                           {"backward", Pattern::kBackward},
                                                           {"turn", Pattern::kTurn},
                                                           {"left-wheel", Pattern::kLeftWheel},
                                                           {"right-wheel", Pattern::kRightWheel},
                                                           {"to-and-fro", Pattern::kToAndFro}}};

inline constexpr double kPatternDuration_s = 3.0, kPatternSpeed_mps = 0.2;

/// What a person should see, "both wheels roll forward".
const char* expectation_of(Pattern pattern);

/// Wheel speeds of the pattern `time_s` after its start. `speed_mps` > 0.
WheelSpeeds speeds_of(Pattern pattern, double time_s, double speed_mps);

}  // namespace touchline::radio
