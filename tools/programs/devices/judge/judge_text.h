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

/// Returns the camera's weaknesses, worst first. Empty if everything that was measured is good.
std::vector<Finding> judge_findings(const JudgeReport& report);

/// Returns one sentence: good; usable, because ...; or not usable, because ....
std::string verdict(const JudgeReport& report);

/// Returns the figures for a person, one per line.
std::string figures(const JudgeReport& report);

/// Returns the form of docs/hardware.md, filled with these figures; the user completes the rest. `system`: board and
/// operating system; `version`: version of Touchline.
std::string hardware_report(const JudgeReport& report, const std::string& system, const std::string& version);

}  // namespace touchline::devices
