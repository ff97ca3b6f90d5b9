#pragma once

#include <string>
#include <vector>

#include "tools/programs/devices/judge/judge.h"

namespace touchline::devices {

enum class Grade : std::uint8_t { kGood, kUsable, kUnusable };

/// One reason for a verdict.
struct Finding {
  Grade grade = Grade::kGood;
  std::string reason;  // "it delivers 12.5 frames a second"
};

/// What is not good about the camera, worst first. Empty: all that was measured is good.
std::vector<Finding> judge_findings(const JudgeReport& report);

/// One sentence: good; usable, because ...; or not usable, because ....
std::string verdict(const JudgeReport& report);

/// The figures, a line each, for a person.
std::string figures(const JudgeReport& report);

/// The form of docs/hardware.md with these figures; the rest is left for the user. `system`: board and operating
/// system; `version`: of Touchline.
std::string hardware_report(const JudgeReport& report, const std::string& system, const std::string& version);

}  // namespace touchline::devices
