#include "tools/programs/replay/recording_replay.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string_view>

#include "tools/programs/replay/recording_source.h"
#include "tools/programs/replay/replay_outputs.h"

namespace touchline::replay {
namespace {

// Enough to see where differences begin; --out has the rest.
constexpr std::size_t kMaxListed = 10;

std::string parts_text(const std::array<bool, recording::kResultParts>& differs) {
  std::string text;
  for (std::size_t i = 0; i < differs.size(); ++i) {
    if (!differs[i]) continue;
    text += (text.empty() ? "" : ", ") + std::string(word_of(static_cast<recording::ResultPart>(i)));
  }
  return text;
}

void count(const RecordingSource::Step& step, RecordingSummary& summary) {
  const bool is_frame = step.trace != nullptr;
  summary.frames += is_frame ? 1U : 0U;
  summary.stops += is_frame ? 0U : 1U;
  summary.with_pictures += is_frame && step.trace->frame.sightings == nullptr ? 1U : 0U;
  const bool is_different = std::find(step.differs.begin(), step.differs.end(), true) != step.differs.end();
  summary.not_compared += step.is_compared ? 0U : 1U;
  if (!step.is_compared || !is_different) return;
  ++summary.different;
  for (std::size_t i = 0; i < step.differs.size(); ++i) summary.different_parts[i] += step.differs[i] ? 1U : 0U;
  if (summary.first_differences.size() >= kMaxListed) return;
  const std::string name = is_frame ? "frame " + std::to_string(step.header.frame_number)
                                    : "stop (step " + std::to_string(step.header.number) + ")";
  summary.first_differences.push_back(name + ": " + parts_text(step.differs));
}

}  // namespace

bool is_recording(const std::string& input) { return std::string_view(input).ends_with(".mcap"); }

Result<RecordingSummary> replay_recording(const ReplayOptions& options, const Progress& progress,
                                          const std::function<void(const std::string&)>& note,
                                          const std::atomic<bool>& stop) {
  TOUCHLINE_TRY(check_outputs(options));
  RecordingSource source(options.overrides);
  TOUCHLINE_TRY(source.open(options.input));
  ReplayOutputs outputs(options);
  std::uint32_t session = 0;
  RecordingSummary summary;
  const std::string name = std::filesystem::path(options.input).filename().string();
  for (;;) {
    const Result<std::optional<RecordingSource::Step>> step = source.next();
    for (const std::string& line : source.take_notes()) note(line);
    if (!step.ok()) return step.error();
    if (!step.value()) break;
    if (stop) return failure(ErrorCode::kStopped, "stopped; no output was written");
    count(*step.value(), summary);
    if (session == 0) TOUCHLINE_TRY(outputs.open(source.configuration(), source.configuration().board.camera.rate_hz));
    if (session != 0 && session != source.session()) outputs.use(source.configuration());
    session = source.session();
    if (step.value()->trace == nullptr) continue;
    const recording::StepHeader& header = step.value()->header;
    TOUCHLINE_TRY(outputs.add(*step.value()->trace, header.frame_number, name, step.value()->has_picture));
    progress(summary.frames, 0);
  }
  if (session == 0) return failure(ErrorCode::kNotFound, "%s: there are no steps in it", options.input.c_str());
  TOUCHLINE_TRY(outputs.finish());
  summary.hash_line = source.hash().line();
  return summary;
}

std::string text_of(const RecordingSummary& summary, bool has_overrides) {
  const auto number = [](std::uint64_t value) { return std::to_string(value); };
  std::string text = number(summary.frames) + " frames, " + number(summary.with_pictures) + " of them from pictures, " +
                     number(summary.frames - summary.with_pictures) + " from recorded sightings; " +
                     number(summary.stops) + " stops\n";
  const std::uint64_t steps = summary.frames + summary.stops;
  const std::string compared = number(steps - summary.not_compared) + " of " + number(steps) + " steps were compared";
  if (summary.not_compared == steps) {
    text += "no step was compared with the recording\n";
  } else if (summary.different == 0 && summary.not_compared > 0) {
    text += compared + "; all equal\n";
  } else if (summary.different == 0) {
    text += "all results are those of the recording, bit for bit\n";
  } else {
    if (summary.not_compared > 0) text += compared + "\n";
    text += number(summary.different) + " steps differ from the recording (";
    for (std::size_t i = 0; i < recording::kResultParts; ++i) {
      text += (i > 0 ? ", " : "") + std::string(word_of(static_cast<recording::ResultPart>(i))) + " " +
              number(summary.different_parts[i]);
    }
    text += "), the first of them:\n";
    for (const std::string& line : summary.first_differences) text += "  " + line + "\n";
    if (has_overrides) {
      text +=
          "The recorded robots did not follow the other commands: what comes later in the game would differ, too.\n";
    }
  }
  return text + summary.hash_line;
}

}  // namespace touchline::replay
