#include <CLI/CLI.hpp>
#include <fstream>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "firmware/absent_devices.h"
#include "firmware/realtime.h"
#include "firmware/session.h"
#include "firmware/stop_signal.h"
#include "hal/linux/monotonic_clock.h"
#include "tools/latency/latency_output.h"
#include "tools/latency/progress.h"
#include "tools/latency/worst_frames.h"

namespace {

using namespace touchline;

struct Options {
  SessionOptions session;
  std::size_t frames = 10000, warm_up = 200;
  bool worst_frames = false;
  std::string out, histogram;
};

int fail(const std::string& message) {
  std::cerr << "touchline-latency: " << message << '\n';
  return 1;
}

int refuse(const config::Problems& problems) {
  std::cerr << problems.text();
  return 1;
}

void tell(const std::vector<std::string>& refusals) {
  for (const std::string& refusal : refusals) std::cerr << "real time: " << refusal << '\n';
}

// From an open loop to its end. Nobody prints its reports: what does not fit into their ring is left out.
bool run(Loop& loop, const config::BoardFile& board, const latency::Measurement& measurement, std::size_t steps) {
  // Begins before this thread becomes privileged, and inherits nothing of it.
  const latency::Progress progress(measurement, steps);
  tell(become_realtime(board.realtime));
  const LoopEnd end = loop.run(stop_on_signals());
  if (end != LoopEnd::kFault && end != LoopEnd::kDeviceLost) return true;
  fail(std::string("the loop ended by a fault: ") + loop.last_fault().reason.data());
  return false;
}

int report(const Options& options, const latency::Measurement& measurement, const std::string& source, double rate_hz) {
  const latency::LatencyReport result = measurement.report(source, rate_hz);
  if (result.frames == 0) return fail("ended before the warm-up was over");
  latency::print(result, std::cout);
  if (!options.out.empty()) {
    std::ofstream file(options.out);
    file << latency::to_json(result);
    file.close();
    if (!file) return fail(options.out + ": cannot be written");
  }
  std::string error;
  const bool drawn =
      options.histogram.empty() || latency::draw_histogram(measurement, result, options.histogram, error);
  return drawn ? 0 : fail(error);
}

int measure_board(const Options& options) {
  Session session;
  config::Problems problems;
  if (!session.load(options.session, problems).ok()) return refuse(problems);
  latency::Measurement measurement(options.frames, options.warm_up);
  const config::BoardFile& board = session.configuration().board;
  // Before the camera fills its first buffers, which would be old by then.
  tell(lock_memory(board.realtime));
  std::string reason;
  if (!session.open(measurement.observer(), reason).ok()) return fail(reason);
  if (!run(session.loop(), board, measurement, options.session.frames)) return 1;
  const double granted_hz = session.devices().loop_devices().camera.info().rate_hz;
  return report(options, measurement, "board " + board.name, granted_hz > 0.0 ? granted_hz : board.camera.rate_hz);
}

// Without the board's radio: nonsense in the picture must not drive anybody's robots.
int measure_worst_frames(const Options& options) {
  const auto configuration = std::make_unique<config::Configuration>();
  config::Problems problems;
  if (!config::load(options.session.files, *configuration, problems).ok()) return refuse(problems);
  const auto pipeline = std::make_unique<Pipeline>();
  const Status status = pipeline->configure(configuration->pipeline, hal::MonotonicClock::read);
  if (!status.ok()) return fail(std::string("the pipeline refuses these files: ") + describe(status.code()));
  hal::MonotonicClock clock;
  AbsentRadio radio;
  AbsentGpio gpio;
  latency::WorstFrames camera(configuration->pipeline, clock);
  latency::Measurement measurement(options.frames, options.warm_up);
  LoopSettings settings;
  settings.faults = configuration->board.faults;
  settings.frames = options.session.frames;
  const auto reports = std::make_unique<ReportRing>();
  const auto loop = std::make_unique<Loop>(LoopDevices{camera, radio, gpio, clock}, *pipeline, settings, *reports,
                                           measurement.observer());
  tell(lock_memory(configuration->board.realtime));
  std::string reason;
  if (!loop->open(reason).ok()) return fail(reason);
  if (!run(*loop, configuration->board, measurement, settings.frames)) return 1;
  return report(options, measurement, "worst frames", configuration->board.camera.rate_hz);
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  config::FilePaths& files = options.session.files;
  CLI::App app{
      "Runs frames through the loop and tells how long each stage took: percentiles, deadlines, page faults.\n"
      "With a board whose radio is real, robots are driven while it measures."};
  app.add_option("--board", files.board, "Board file")->required();
  app.add_option("--venue", files.venue, "Venue file instead of the board's");
  app.add_option("--team", files.team, "Team file instead of the board's");
  app.add_option("--set", files.overrides, "key=value: overrides a key of the three files")->allow_extra_args(false);
  app.add_option("--seed", options.session.seed, "Of a simulation (1)");
  app.add_option("--frames", options.frames, "Frames to measure (10000)")->check(CLI::Range(1, 10000000));
  app.add_option("--warm-up", options.warm_up, "Frames before them that do not count (200)")
      ->check(CLI::Range(0, 1000000));
  app.add_flag("--worst-frames", options.worst_frames,
               "Pictures that cost the most work instead of the board's camera, and no radio");
  app.add_option("--out", options.out, "Write the numbers as JSON into this file");
  app.add_option("--histogram", options.histogram, "Draw a histogram into this file (PNG)");
  CLI11_PARSE(app, argc, argv);
  options.session.frames = options.frames + options.warm_up;
  return options.worst_frames ? measure_worst_frames(options) : measure_board(options);
}
