#include "tools/programs/replay/replay.h"

#include <array>
#include <limits>
#include <memory>
#include <utility>

#include "core/pipeline.h"
#include "firmware/config/configuration.h"
#include "firmware/report/trace_json.h"
#include "hal/files/output_file.h"
#include "hal/replay/replay_camera.h"
#include "tools/programs/command_line/would_overwrite.h"
#include "tools/programs/replay/annotation.h"
#include "tools/programs/replay/motion_plot.h"
#include "tools/programs/replay/picture_output.h"

namespace touchline::replay {
namespace {

AnnotationStyle annotation_style(const config::Configuration& configuration) {
  AnnotationStyle style;
  style.names.colors = {"background"};
  style.colors = {CanvasColor{0.0, 0.0, 0.0}};
  for (const config::ColorEntry& color : configuration.venue.color) {
    style.names.colors.push_back(color.name);
    style.colors.push_back(canvas_color(color.shown_rgb));
  }
  style.names.teams = {configuration.team.own.color, configuration.team.opponent.color};
  return style;
}

Result<void> check_outputs(const ReplayOptions& options) {
  for (const std::string& output : {options.out, options.annotate, options.plot}) {
    for (const std::string& input : {options.input, options.venue, options.team}) {
      if (!would_overwrite(input, output)) continue;
      return failure(ErrorCode::kInconsistent, "%s: would overwrite, or be added to, the input %s", output.c_str(),
                     input.c_str());
    }
  }
  if (would_overwrite(options.out, options.annotate)) {
    return failure(ErrorCode::kInconsistent, "%s: is also the result file", options.annotate.c_str());
  }
  if (would_overwrite(options.out, options.plot) || would_overwrite(options.annotate, options.plot)) {
    return failure(ErrorCode::kInconsistent, "%s: is also another output", options.plot.c_str());
  }
  return {};
}

// Finds the robot of --plot-robot. `names`: names of the two teams.
Result<std::pair<Team, RobotId>> robot_to_plot(const std::string& wanted, const std::array<std::string, 2>& names,
                                               const MotionPlot& plot) {
  if (wanted.empty()) return plot.farthest();
  for (const Team team : {Team::kOwn, Team::kOpponent}) {
    const std::string prefix = names[static_cast<std::size_t>(team)] + ":";
    for (int id = 0; id <= std::numeric_limits<RobotId>::max(); ++id) {
      if (wanted != prefix + std::to_string(id)) continue;
      if (plot.knows(team, static_cast<RobotId>(id))) return std::pair{team, static_cast<RobotId>(id)};
      return failure(ErrorCode::kNotFound, "--plot-robot %s: it was never seen", wanted.c_str());
    }
  }
  return failure(ErrorCode::kNotFound, "--plot-robot %s: not a robot of this game, such as %s:0", wanted.c_str(),
                 names[0].c_str());
}

Result<void> write_plot(const ReplayOptions& options, const std::array<std::string, 2>& names, const MotionPlot& plot,
                        hal::OutputFile& file) {
  TOUCHLINE_TRY_ASSIGN(const auto robot, robot_to_plot(options.plot_robot, names, plot));
  const auto& [team, id] = robot;
  TOUCHLINE_TRY(file.write(plot.svg(team, id, names[static_cast<std::size_t>(team)] + " " + std::to_string(int{id}))));
  return file.commit();
}

void count(const StepTrace& trace, ReplaySummary& summary) {
  ++summary.frames;
  summary.robots += trace.sightings.robots.size();
  for (const RobotSighting& robot : trace.sightings.robots) summary.robots_with_id += robot.id != kUnknownId ? 1u : 0u;
  summary.frames_with_ball += trace.sightings.ball.seen ? 1u : 0u;
  summary.frames_overloaded += trace.overload ? 1u : 0u;
}

Error stopped() { return failure(ErrorCode::kIo, "stopped; no output was written"); }

Result<ReplaySummary> replay_input(const ReplayOptions& options, const Progress& progress,
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
  const auto pipeline = std::make_unique<Pipeline>();
  if (const Status status = pipeline->configure(configuration->pipeline); !status.ok()) {
    return failure(status.code(), "%s and %s cannot be used together: %s", options.venue.c_str(), options.team.c_str(),
                   describe(status.code()));
  }
  const StepInputs inputs = observing_inputs();

  const AnnotationStyle style = annotation_style(*configuration);
  hal::OutputFile lines;
  PictureOutput pictures;
  std::unique_ptr<Annotator> annotator;
  TOUCHLINE_TRY(lines.open(options.out));
  hal::OutputFile plot_file;
  MotionPlot plot;
  if (!options.plot.empty()) TOUCHLINE_TRY(plot_file.open(options.plot));
  if (!options.annotate.empty()) {
    TOUCHLINE_TRY(pictures.open(options.annotate, info.rate_hz));
    annotator = std::make_unique<Annotator>(configuration->pipeline, style);
  }
  ReplaySummary summary;
  for (;;) {
    const Result<hal::FrameLease> lease = camera.wait(Instant::max());
    if (lease.code() == ErrorCode::kEndOfStream) break;
    if (stop) return stopped();
    if (!lease.ok()) return lease.error();
    const Frame& frame = lease.value().frame();
    const StepTrace& trace = pipeline->step(frame, inputs);
    pipeline->adapt();
    const std::string line = report::trace_line(trace, style.names, frame.sequence, camera.file()) + "\n";
    TOUCHLINE_TRY(lines.write(line));
    if (annotator != nullptr) {
      const SurfacePtr surface = annotator->draw(trace, frame.sequence, camera.file());
      const Duration stamp = frame.capture_time.time_since_epoch();
      TOUCHLINE_TRY(pictures.write(*surface, frame.sequence, camera.file(), stamp));
    }
    if (!options.plot.empty()) plot.add(trace);
    count(trace, summary);
    progress(summary.frames, camera.frame_count());
  }
  if (!options.plot.empty()) TOUCHLINE_TRY(write_plot(options, style.names.teams, plot, plot_file));
  TOUCHLINE_TRY(pictures.finish());
  TOUCHLINE_TRY(lines.commit());
  summary.damaged = camera.damaged();
  return summary;
}

}  // namespace

Result<ReplaySummary> replay(const ReplayOptions& options, const Progress& progress, const std::atomic<bool>& stop) {
  Result<ReplaySummary> summary = replay_input(options, progress, stop);
  // An error that the stop itself has caused is not reported.
  return summary.ok() || !stop ? std::move(summary) : stopped();
}

}  // namespace touchline::replay
