#include "tools/programs/replay/replay_outputs.h"

#include <limits>
#include <utility>

#include "firmware/report/trace_json.h"
#include "tools/programs/command_line/would_overwrite.h"

namespace touchline::replay {
namespace {

// A video goes on this long after the last frame of a session; its clock may begin anew.
constexpr Duration kSessionPause = std::chrono::milliseconds(20);

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

}  // namespace

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

Result<void> ReplayOutputs::open(const config::Configuration& configuration, double rate_hz) {
  if (!options_.out.empty()) TOUCHLINE_TRY(lines_.open(options_.out));
  if (!options_.plot.empty()) TOUCHLINE_TRY(plot_file_.open(options_.plot));
  if (!options_.annotate.empty()) TOUCHLINE_TRY(pictures_.open(options_.annotate, rate_hz));
  use(configuration);
  return {};
}

void ReplayOutputs::use(const config::Configuration& configuration) {
  style_ = annotation_style(configuration);
  begin_.reset();
  if (!options_.annotate.empty()) annotator_ = std::make_unique<Annotator>(configuration.pipeline, style_);
}

Result<void> ReplayOutputs::add(const StepTrace& trace, std::uint64_t frame, const std::string& file,
                                bool has_picture) {
  if (!options_.out.empty()) TOUCHLINE_TRY(lines_.write(report::trace_line(trace, style_.names, frame, file) + "\n"));
  if (annotator_ != nullptr && has_picture) {
    const SurfacePtr surface = annotator_->draw(trace, frame, file);
    if (!begin_) begin_ = trace.frame.capture_time - next_stamp_;
    const Duration stamp = trace.frame.capture_time - *begin_;
    next_stamp_ = stamp + kSessionPause;
    TOUCHLINE_TRY(pictures_.write(*surface, frame, file, stamp));
  }
  if (!options_.plot.empty()) plot_.add(trace);
  return {};
}

Result<void> ReplayOutputs::finish() {
  if (!options_.plot.empty()) TOUCHLINE_TRY(write_plot());
  TOUCHLINE_TRY(pictures_.finish());
  return options_.out.empty() ? Result<void>() : lines_.commit();
}

Result<void> ReplayOutputs::write_plot() {
  const std::array<std::string, 2>& names = style_.names.teams;
  TOUCHLINE_TRY_ASSIGN(const auto robot, robot_to_plot(options_.plot_robot, names, plot_));
  const auto& [team, id] = robot;
  TOUCHLINE_TRY(
      plot_file_.write(plot_.svg(team, id, names[static_cast<std::size_t>(team)] + " " + std::to_string(int{id}))));
  return plot_file_.commit();
}

}  // namespace touchline::replay
