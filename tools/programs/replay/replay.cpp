#include "tools/programs/replay/replay.h"

#include <memory>

#include "core/pipeline.h"
#include "firmware/config/configuration.h"
#include "firmware/report/trace_json.h"
#include "hal/linux/files/output_file.h"
#include "hal/replay/replay_camera.h"
#include "tools/programs/replay/annotation.h"
#include "tools/programs/replay/annotation_output.h"

namespace touchline::replay {
namespace {

AnnotationStyle annotation_style(const config::Configuration& configuration) {
  AnnotationStyle style;
  style.names.colors = {"background"};
  style.colors = {Rgb{0.0, 0.0, 0.0}};
  for (const config::ColorEntry& color : configuration.venue.color) {
    style.names.colors.push_back(color.name);
    style.colors.push_back({color.shown_rgb[0] / 255.0, color.shown_rgb[1] / 255.0, color.shown_rgb[2] / 255.0});
  }
  style.names.teams = {configuration.team.own.color, configuration.team.opponent.color};
  return style;
}

bool outputs_are_safe(const ReplayOptions& options, std::string& error) {
  for (const std::string& output : {options.out, options.annotate}) {
    if (output.empty()) continue;
    for (const std::string& input : {options.input, options.venue, options.team}) {
      if (!would_overwrite(input, output)) continue;
      error = output;
      error.append(": would overwrite, or be added to, the input ").append(input);
      return false;
    }
  }
  if (would_overwrite(options.out, options.annotate)) error = options.annotate + ": is also the result file";
  return error.empty();
}

void count(const StepTrace& trace, ReplaySummary& summary) {
  ++summary.frames;
  summary.robots += trace.sightings.robots.size();
  for (const RobotSighting& robot : trace.sightings.robots) summary.robots_with_id += robot.id != kUnknownId ? 1u : 0u;
  summary.frames_with_ball += trace.sightings.ball.seen ? 1u : 0u;
  summary.frames_overloaded += trace.overload ? 1u : 0u;
}

}  // namespace

bool replay(const ReplayOptions& options, const Progress& progress, const std::atomic<bool>& stop,
            ReplaySummary& summary, std::string& error) {
  summary = {};
  error.clear();
  if (!outputs_are_safe(options, error)) return false;
  const auto configuration = std::make_unique<config::Configuration>();
  config::Problems problems;
  const auto refuse = [&problems, &error] {
    error = problems.text();
    while (!error.empty() && error.back() == '\n') error.pop_back();
    return false;
  };
  const config::FilePaths paths{{}, options.venue, options.team, options.overrides};
  if (!config::load_venue_and_team(paths, *configuration, problems).ok()) return refuse();

  // YUYV keeps the values of 4:2:0 and 4:2:2 files exactly.
  const PixelFormat format =
      configuration->venue.colors.space == ColorSpace::kRgb ? PixelFormat::kRgb24 : PixelFormat::kYuyv;
  hal::ReplayCamera camera({options.input, format, options.rate_hz});
  if (!camera.open().ok() || !camera.start().ok()) {
    error = camera.reason();
    return false;
  }
  const hal::CameraInfo& info = camera.info();
  if (!config::resolve({format, info.width_px, info.height_px, options.input}, *configuration, problems).ok()) {
    return refuse();
  }
  const auto pipeline = std::make_unique<Pipeline>();
  if (const Status status = pipeline->configure(configuration->pipeline); !status.ok()) {
    error =
        options.venue + ", " + options.team + ": the pipeline refuses these values (" + describe(status.code()) + ")";
    return false;
  }
  pipeline->set_observing(true);

  const AnnotationStyle style = annotation_style(*configuration);
  hal::OutputFile lines;
  AnnotationOutput pictures;
  std::unique_ptr<Annotator> annotator;
  const auto fail_lines = [&lines, &error] {
    error = lines.reason();
    return false;
  };
  if (!lines.open(options.out).ok()) return fail_lines();
  if (!options.annotate.empty()) {
    if (!pictures.open(options.annotate, info.rate_hz, error)) return false;
    annotator = std::make_unique<Annotator>(configuration->pipeline, style);
  }
  for (;;) {
    const Result<hal::FrameLease> lease = camera.wait(Instant::max());
    if (lease.code() == ErrorCode::kEndOfStream) break;
    if (lease.code() == ErrorCode::kCorruptFrame && options.skip_damaged) {
      ++summary.damaged;
      continue;
    }
    if (!lease.ok() || stop) {
      error = stop ? "stopped; no output was written" : camera.reason();
      return false;
    }
    const Frame& frame = lease.value().frame();
    const StepTrace& trace = pipeline->step(frame);
    pipeline->adapt();
    const std::string line = report::trace_line(trace, style.names, frame.sequence, camera.file()) + "\n";
    if (!lines.write(line).ok()) return fail_lines();
    if (annotator != nullptr) {
      const SurfacePtr surface = annotator->draw(trace, frame.sequence, camera.file());
      const Duration stamp = frame.capture_time.time_since_epoch();
      if (!pictures.write(*surface, frame.sequence, camera.file(), stamp, error)) return false;
    }
    count(trace, summary);
    progress(summary.frames, camera.frame_count());
  }
  if (!pictures.finish(error)) return false;
  return lines.commit().ok() || fail_lines();
}

}  // namespace touchline::replay
