#include "tools/programs/replay/game_log_replay.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string_view>

#include "firmware/config/poses.h"
#include "firmware/pose_plan.h"
#include "hal/poses/pose_source.h"
#include "hal/recording/ssl_log.h"
#include "tools/programs/replay/replay_outputs.h"

namespace touchline::replay {
namespace {

// No tournament takes longer: another time is damage.
constexpr std::int64_t kLongest_ns = std::int64_t{1'000'000'000} * 3600 * 24 * 30;

bool has_type(const hal::SslLogMessage& message, hal::PoseProtocol protocol) {
  if (protocol == hal::PoseProtocol::kSslTracked) return message.type == hal::kSslTracker;
  return message.type == hal::kSslVision || message.type == hal::kSslVision2010;
}

Result<hal::PoseProtocol> protocol_of(hal::SslLogReader& reader, const std::string& path) {
  bool has_tracker = false;
  for (;;) {
    TOUCHLINE_TRY_ASSIGN(const std::optional<hal::SslLogMessage> message, reader.next());
    if (!message) break;
    if (has_type(*message, hal::PoseProtocol::kSslVision)) return hal::PoseProtocol::kSslVision;
    has_tracker = has_tracker || has_type(*message, hal::PoseProtocol::kSslTracked);
  }
  if (has_tracker) return hal::PoseProtocol::kSslTracked;
  return failure(ErrorCode::kNotFound, "%s: there are no packets of SSL-Vision or of a tracker in it", path.c_str());
}

/// Times of arrival, which do not go back.
class ArrivalTimes {
 public:
  Result<Instant> of(std::int64_t time_ns) {
    if (!begin_ns_) begin_ns_ = time_ns;
    std::int64_t since_ns = 0;
    if (__builtin_sub_overflow(time_ns, *begin_ns_, &since_ns) || since_ns > kLongest_ns) {
      return failure(ErrorCode::kOutOfRange, "the time of a message is more than 30 days after the first one");
    }
    last_ = std::max(last_, Instant(Duration(since_ns)));
    return last_;
  }

 private:
  std::optional<std::int64_t> begin_ns_;
  Instant last_{};
};

}  // namespace

bool is_game_log(const std::string& input) {
  const std::string_view name = input;
  return name.ends_with(".log") || name.ends_with(".log.gz");
}

Result<ReplaySummary> replay_game_log(const ReplayOptions& options, const Progress& progress,
                                      const std::atomic<bool>& stop) {
  TOUCHLINE_TRY(check_outputs(options));
  const auto configuration = std::make_unique<config::Configuration>();
  TOUCHLINE_TRY(config::load_venue_and_team({{}, options.venue, options.team, options.overrides}, *configuration));
  TOUCHLINE_TRY(config::resolve_for_poses(*configuration));
  TOUCHLINE_TRY_ASSIGN(const auto pipeline, make_pipeline(options, *configuration));
  const StepInputs inputs = observing_inputs();

  hal::SslLogReader reader;
  TOUCHLINE_TRY(reader.open(options.input));
  hal::PoseSourceSettings settings;
  TOUCHLINE_TRY_ASSIGN(settings.protocol, protocol_of(reader, options.input));
  settings.teams = pose_teams(configuration->team);
  const auto source = std::make_unique<hal::PoseSource>(settings);
  const auto poses = std::make_unique<hal::MergedPoses>();
  TOUCHLINE_TRY(reader.rewind());

  ReplayOutputs outputs(options);
  TOUCHLINE_TRY(outputs.open(*configuration, 0.0));
  const std::string name = std::filesystem::path(options.input).filename().string();
  ReplaySummary summary;
  ArrivalTimes arrivals;
  for (;;) {
    const std::uint64_t position = reader.position();
    const auto error_of = [&](const Error& error) {
      return prefixed(options.input + ": byte " + std::to_string(position), error);
    };
    TOUCHLINE_TRY_ASSIGN(const std::optional<hal::SslLogMessage> message, reader.next());
    if (!message) break;
    if (stop) return stopped_replay();
    if (!has_type(*message, settings.protocol)) continue;
    const Result<Instant> arrival = arrivals.of(message->time_ns);
    if (!arrival.ok()) return error_of(arrival.error());
    // The log does not tell the senders.
    const Result<bool> is_complete = source->take(message->data, 0, arrival.value(), *poses);
    if (!is_complete.ok() && !options.skip_damaged) return error_of(is_complete.error());
    if (!is_complete.ok() || !is_complete.value()) continue;
    Frame frame;
    frame.capture_time = poses->capture_time;
    frame.sequence = source->sequence();
    frame.sightings = &poses->sightings;
    const StepTrace& trace = pipeline->step(frame, inputs);
    TOUCHLINE_TRY(outputs.add(trace, summary.frames, name, false));
    summary.add(trace);
    progress(summary.frames, 0);
  }
  TOUCHLINE_TRY(outputs.finish());
  summary.damaged = source->counters().malformed;
  if (!reader.is_complete()) {
    summary.notes.push_back(options.input + ": the game log was cut off in the message at byte " +
                            std::to_string(reader.position()) + ", which is left out");
  }
  return summary;
}

}  // namespace touchline::replay
