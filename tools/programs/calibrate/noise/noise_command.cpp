#include "tools/programs/calibrate/noise/noise_command.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <numbers>

#include "hal/replay/replay_camera.h"
#include "tools/programs/calibrate/noise/noise_recorder.h"
#include "tools/programs/calibrate/venue/confirmation.h"
#include "tools/programs/calibrate/venue/venue_draft.h"
#include "tools/programs/command_line/command_line.h"
#include "tools/programs/command_line/progress.h"

namespace touchline::calibrate {
namespace {

constexpr double kMillimeter = 1e3, kDegree = 180.0 / std::numbers::pi;

// Adds all pictures of the input.
Result<void> record(const std::string& input, NoiseRecorder& recorder) {
  hal::ReplayCamera camera({input, hal::replay_format(recorder.color_space()), 0.0});
  TOUCHLINE_TRY(camera.open());
  TOUCHLINE_TRY(camera.start());
  Progress progress("frames", camera.frame_count());
  for (;;) {
    const Result<hal::FrameLease> lease = camera.wait(Instant::max());
    if (lease.code() == ErrorCode::kEndOfStream) return {};
    if (!lease.ok()) return lease.error();
    TOUCHLINE_TRY(recorder.add(lease.value().frame(), input));
    progress.step();
  }
}

void print(const NoiseReport& report) {
  std::printf("%-16s %9s   standard deviation (that the pictures show)\n", "", "sightings");
  for (const ObjectNoise& one : report.objects) {
    std::printf("%-16s %9zu   %.3f mm (%.3f)", one.name.c_str(), one.sightings, one.position_m * kMillimeter,
                one.shown_position_m * kMillimeter);
    if (one.heading_rad > 0.0) {
      std::printf(", %.3f degrees (%.3f)", one.heading_rad * kDegree, one.shown_heading_rad * kDegree);
    }
    std::printf("\n");
  }
  for (const std::string& line : report.left_out) std::printf("left out: %s\n", line.c_str());
  const config::NoiseEntry& e = report.entry;
  std::printf("in addition to what the pictures show: robots %.3f mm, %.3f degrees; ball %.3f mm%s\n",
              e.robot_position_m * kMillimeter, e.robot_heading_rad * kDegree, e.ball_position_m * kMillimeter,
              report.has_ball ? "" : " (not measured)");
}

}  // namespace

void NoiseCommand::add_options(CLI::App& app) {
  app.add_option("input", input, "Folder of pictures, or video, of standing robots; 100 frames or more")
      ->required()
      ->type_name("PATH");
  app.add_option("--venue", venue, "Venue file; section [noise] is written")->required()->type_name("FILE");
  app.add_option("--team", team, "Team file")->required()->type_name("FILE");
  app.add_flag("--yes", yes, "Write the result without asking");
  add_examples(app, {{"touchline-calibrate noise standing --venue venue.toml --team team.toml",
                      "from the pictures in the folder standing"}});
}

Result<void> NoiseCommand::run() const {
  NoiseRecorder recorder;
  TOUCHLINE_TRY(recorder.load(venue, team));
  TOUCHLINE_TRY(record(input, recorder));
  Result<NoiseReport> measured = recorder.report();
  if (!measured.ok()) return prefixed(input, std::move(measured).error());
  const NoiseReport report = std::move(measured).value();
  print(report);
  if (!yes && !confirmed("write this to " + venue + "?")) {
    return failure(ErrorCode::kInconsistent, "not confirmed, nothing was written; --yes writes without asking");
  }
  TOUCHLINE_TRY(write_sections(venue, {section_of("noise", report.entry, "")}));
  std::printf("%s: [noise] written\n", venue.c_str());
  return {};
}

}  // namespace touchline::calibrate
