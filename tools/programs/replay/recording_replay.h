#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "firmware/recording/step_message.h"
#include "hal/result.h"
#include "tools/programs/replay/replay.h"

namespace touchline::replay {

/// How a replay of a recording compares with it.
struct RecordingSummary {
  std::uint64_t frames = 0, stops = 0;
  std::uint64_t with_pictures = 0;                                       // frames whose recognition was repeated
  std::uint64_t not_compared = 0;                                        // steps after one that was lost
  std::uint64_t different = 0;                                           // steps with at least one difference
  std::array<std::uint64_t, recording::kResultParts> different_parts{};  // steps, by ResultPart
  std::vector<std::string> first_differences;  // one line each: "frame 12: tracks, commands, packets"
  std::string hash_line;                       // RecordingHash::line()
};

/// Returns whether the input is a recording (NAME.mcap), which has its own configuration.
bool is_recording(const std::string& input);

/// Feeds the pipeline with the recording `options.input`, compares its results with the recorded ones, and writes the
/// outputs that the options name. `options.overrides` replace recorded keys: then the results differ, while the robots
/// still move as they did. `note` gets lines for a person. Errors as for replay().
Result<RecordingSummary> replay_recording(const ReplayOptions& options, const Progress& progress,
                                          const std::function<void(const std::string&)>& note,
                                          const std::atomic<bool>& stop);

/// Returns the summary for a person; its last line is the hash.
std::string text_of(const RecordingSummary& summary, bool has_overrides);

}  // namespace touchline::replay
