#pragma once

#include <string>

#include "core/marker/matcher.h"
#include "firmware/loop.h"
#include "firmware/loop_report.h"

// Formats reports as text.
namespace touchline {

/// Expected number of robots, and the size of the field.
struct Expectation {
  std::uint32_t own = 0, opponents = 0;
  FieldParameters field;
  std::string source{};  // of the poses; empty: a camera
};

/// Returns a text such as "12 s  60.0 fps  own 5/5  opp 5/5  ball (0.12, -0.30)  score 1:0  playing right  latency p50
/// 1.2 p99 2.3 max 3.1 ms  packets 720". The score (own : opponent's) and the direction in which the own team plays
/// appear if they are known. Counts of problems (lost frames, overloads, faults), the robots' telemetry ("robots 0:
/// 7.92 V 98 %"), and the reasons for which robots are halted follow.
std::string status_line(const StatusReport& status, const Expectation& expected);
/// Returns a text such as "camera: device disconnected (/dev/video0: ...); robots stopped, reopening it".
std::string fault_line(const FaultReport& fault);
/// Returns a text such as "robot 2: battery is low, 6.92 V".
std::string battery_line(const BatteryReport& battery);
/// Names the key, its value in the file and the measured one.
std::string drive_line(const DriveReport& drive);
/// Returns "all robots stand although they are commanded to move: check batteries, radio and picture".
std::string standing_line(const StandingReport& standing);
/// Returns "robots halted: emergency stop" or "robots may move".
std::string halt_line(const HaltReport& halt);
/// Draws the field with `columns` characters per row and the number of rows that its shape needs: own robots as the
/// last digit of their id with their heading, opponents as x, the ball as o, unknown ids as ?. `color`: with ANSI
/// colors.
std::string field_map(const StatusReport& status, const FieldParameters& field, int columns, bool color);
/// Returns the summary of a run in several lines.
std::string summary(const LoopStatistics& statistics, LoopEnd end);

}  // namespace touchline
