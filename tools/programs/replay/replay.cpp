#include "tools/programs/replay/replay.h"

#include <memory>
#include <utility>

#include "core/pipeline.h"
#include "firmware/config/configuration.h"
#include "hal/replay/replay_camera.h"
#include "tools/programs/replay/game_log_replay.h"
#include "tools/programs/replay/replay_outputs.h"

namespace touchline::replay {
namespace {

Result<ReplaySummary> replay_pictures(const ReplayOptions& options, const Progress& progress,
                                      const std::atomic<bool>& stop) {
  TOUCHLINE_TRY(check_outputs(options));
  const auto configuration = std::make_unique<config::Configuration>();
  const config::FilePaths paths{{}, options.venue, options.team, options.overrides};
  TOUCHLINE_TRY(config::load_venue_and_team(paths, *configuration));

  const PixelFormat format = hal::replay_format(configuration->venue.colors.space);
  hal::ReplayCamera camera({options.input, format, options.rate_hz, options.skip_damaged});
  TOUCHLINE_TRY(camera.open());
  TOUCHLINE_TRY(camera.start());
  const hal::CameraInfo& info = camera.info();
  TOUCHLINE_TRY(config::resolve({format, info.width_px, info.height_px, options.input}, *configuration));
  TOUCHLINE_TRY_ASSIGN(const auto pipeline, make_pipeline(options, *configuration));
  const StepInputs inputs = observing_inputs();

  ReplayOutputs outputs(options);
  TOUCHLINE_TRY(outputs.open(*configuration, info.rate_hz));
  ReplaySummary summary;
  for (;;) {
    const Result<hal::FrameLease> lease = camera.wait(Instant::max());
    if (lease.code() == ErrorCode::kEndOfStream) break;
    if (stop) return stopped_replay();
    if (!lease.ok()) return lease.error();
    const Frame& frame = lease.value().frame();
    const StepTrace& trace = pipeline->step(frame, inputs);
    pipeline->adapt();
    TOUCHLINE_TRY(outputs.add(trace, frame.sequence, camera.file(), true));
    summary.add(trace);
    progress(summary.frames, camera.frame_count());
  }
  TOUCHLINE_TRY(outputs.finish());
  summary.damaged = camera.damaged();
  return summary;
}

}  // namespace

void ReplaySummary::add(const StepTrace& trace) {
  ++frames;
  robots += trace.sightings.robots.size();
  for (const RobotSighting& robot : trace.sightings.robots) robots_with_id += robot.id != kUnknownId ? 1u : 0u;
  frames_with_ball += trace.sightings.ball.seen ? 1u : 0u;
  frames_overloaded += trace.overload ? 1u : 0u;
}

Error stopped_replay() { return failure(ErrorCode::kIo, "stopped; no output was written"); }

Result<std::unique_ptr<Pipeline>> make_pipeline(const ReplayOptions& options,
                                                const config::Configuration& configuration) {
  auto pipeline = std::make_unique<Pipeline>();
  if (const Status status = pipeline->configure(configuration.pipeline); !status.ok()) {
    return failure(status.code(), "%s and %s cannot be used together: %s", options.venue.c_str(), options.team.c_str(),
                   describe(status.code()));
  }
  return pipeline;
}

Result<ReplaySummary> replay(const ReplayOptions& options, const Progress& progress, const std::atomic<bool>& stop) {
  Result<ReplaySummary> summary =
      is_game_log(options.input) ? replay_game_log(options, progress, stop) : replay_pictures(options, progress, stop);
  // An error that the stop itself has caused is not reported.
  return summary.ok() || !stop ? std::move(summary) : stopped_replay();
}

}  // namespace touchline::replay
