#include <CLI/CLI.hpp>
#include <fstream>
#include <iostream>
#include <memory>

#include "core/pipeline.h"
#include "firmware/absent_devices.h"
#include "firmware/config/configuration.h"
#include "firmware/loop.h"
#include "firmware/realtime.h"
#include "firmware/stop_signal.h"
#include "hal/linux/monotonic_clock.h"
#include "tools/latency/latency_output.h"
#include "tools/latency/worst_frames.h"

namespace {

using namespace touchline;

struct Options {
  config::FilePaths files;
  std::size_t frames = 10000, warm_up = 200;
  bool worst_frames = false;
  std::string out, histogram;
};

int fail(const std::string& message) {
  std::cerr << "touchline-latency: " << message << '\n';
  return 1;
}

int measure(const Options& options, const config::Configuration& configuration) {
  const auto pipeline = std::make_unique<Pipeline>();
  const Status status = pipeline->configure(configuration.pipeline, hal::MonotonicClock::read);
  if (!status.ok()) return fail(std::string("the pipeline refuses these files: ") + describe(status.code()));
  hal::MonotonicClock clock;
  AbsentRadio radio;
  AbsentGpio gpio;
  latency::WorstFrames camera(configuration.pipeline, clock);
  latency::Measurement measurement(options.frames, options.warm_up);
  LoopSettings settings;
  settings.faults = configuration.board.faults;
  settings.radio_delay = from_seconds(configuration.board.radio.delay_s);
  settings.frames = options.frames + options.warm_up;
  const auto reports = std::make_unique<ReportRing>();  // nobody prints: what does not fit is left out
  const auto loop = std::make_unique<Loop>(LoopDevices{camera, radio, gpio, clock}, *pipeline, settings, *reports,
                                           measurement.observer());
  std::string reason;
  if (!loop->open(reason).ok()) return fail(reason);
  for (const std::string& refusal : become_realtime(configuration.board.realtime)) std::cerr << refusal << '\n';
  const LoopEnd end = loop->run(stop_on_signals());
  if (end == LoopEnd::kFault || end == LoopEnd::kDeviceLost) {
    return fail(std::string("the loop ended by a fault: ") + loop->last_fault().reason.data());
  }

  const latency::LatencyReport report = measurement.report("worst frames", configuration.board.camera.rate_hz);
  if (report.frames == 0) return fail("stopped before the warm-up was over");
  latency::print(report, std::cout);
  if (!options.out.empty()) {
    std::ofstream file(options.out);
    file << latency::to_json(report);
    file.close();
    if (!file) return fail(options.out + ": cannot be written");
  }
  std::string error;
  if (!options.histogram.empty() && !latency::draw_histogram(measurement, report, options.histogram, error))
    return fail(error);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app{"Runs frames through the loop and tells how long each stage took: percentiles, deadlines, page faults."};
  app.add_option("--board", options.files.board, "Board file")->required();
  app.add_option("--venue", options.files.venue, "Venue file instead of the board's");
  app.add_option("--team", options.files.team, "Team file instead of the board's");
  app.add_option("--set", options.files.overrides, "key=value: overrides a key of the three files")
      ->allow_extra_args(false);
  app.add_option("--frames", options.frames, "Frames to measure (10000)")->check(CLI::Range(1, 10000000));
  app.add_option("--warm-up", options.warm_up, "Frames before them that do not count (200)")
      ->check(CLI::Range(0, 1000000));
  app.add_flag("--worst-frames", options.worst_frames, "Pictures that cost the most work instead of the board's camera")
      ->required();
  app.add_option("--out", options.out, "Write the numbers as JSON into this file");
  app.add_option("--histogram", options.histogram, "Draw a histogram into this file (PNG)");
  CLI11_PARSE(app, argc, argv);

  const auto configuration = std::make_unique<config::Configuration>();
  config::Problems problems;
  if (!config::load(options.files, *configuration, problems).ok()) {
    std::cerr << problems.text();
    return 1;
  }
  return measure(options, *configuration);
}
