#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/types.h"
#include "firmware/report/json_writer.h"

namespace touchline::report {

/// Names of the colors and teams for people.
struct TraceNames {
  std::vector<std::string> colors;   // by ColorId; 0: background
  std::array<std::string, 2> teams;  // by Team: the color of its team patches
};

/// Results of a frame, from a StepTrace or a Snapshot.
struct FrameResults {
  Instant captured;
  const BallSighting& ball;
  const FixedVector<RobotSighting, kMaxRobots>& robots;
  const Tracks& tracks;
  bool overload;
};

// Steps to which values are rounded: smaller than the noise, but short as text.
constexpr double kMeterStep = 1e-5, kRadianStep = 1e-5, kSpeedStep = 1e-4, kPixelStep = 1e-3, kSecondStep = 1e-6,
                 kConfidenceStep = 1e-4;

/// Writes the members that the replay's lines and the live lines have in common (docs/replay.md): results from the
/// frame alone (`sightings`) and the filtered state at its capture time (`tracks`). Meters, radians, seconds. Unknown
/// ids and headings are null. `frame`: its number from 0; `file`: its file, or the device.
void write_frame(JsonWriter& json, const FrameResults& results, const TraceNames& names, std::uint64_t frame,
                 std::string_view file);

/// Writes the value of the member `tracks`.
void write_tracks(JsonWriter& json, const Tracks& tracks, const TraceNames& names);

/// Writes a pair of key and rounded number.
void write_number(JsonWriter& json, std::string_view key, double value, double step);
void write_number(JsonWriter& json, std::string_view key, float value, double step);
/// Writes the members `team` and `id`; an unknown id is null.
void write_identity(JsonWriter& json, std::string_view team, RobotId id);

/// Returns the replay's line for a frame: an object with the members of write_frame(), without line end.
std::string trace_line(const StepTrace& trace, const TraceNames& names, std::uint64_t frame, std::string_view file);
std::string trace_line(const FrameResults& results, const TraceNames& names, std::uint64_t frame,
                       std::string_view file);

}  // namespace touchline::report
