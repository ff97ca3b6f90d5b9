#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "tools/programs/command_line/command_line.h"
#include "tools/programs/latency/measure_command.h"

int main(int argc, char** argv) {
  using namespace touchline;
  latency::MeasureOptions options;
  latency::Outputs& outputs = options.outputs;
  std::vector<std::string> compared;
  config::FilePaths& files = options.session.files;
  CLI::App app{
      "Measures what frames cost from capture to packet, stage by stage, and says what the worst one was.\n"
      "With a board whose radio is real, robots are driven while it measures.",
      "touchline-latency"};
  app.footer(
      "Ctrl-C ends it with the report so far. Exit codes: 0 all went well, 1 a file is wrong or cannot be written,\n"
      "2 a device failed, 64 the command line is wrong. docs/latency.md explains the report.");
  app.add_option("--board", files.board, "Board file");
  app.add_option("--venue", files.venue, "Venue file instead of the board's");
  app.add_option("--team", files.team, "Team file instead of the board's");
  app.add_option("--set", files.overrides, "key=value: overrides a key of the three files")->allow_extra_args(false);
  app.add_option("--seed", options.session.seed, "Of a simulation (1)");
  CLI::Option* frames =
      app.add_option("--frames", options.frames, "Frames to measure (10000)")->check(CLI::Range(1, 10000000));
  app.add_option("--duration", options.duration_s, "Seconds to measure instead (simulated ones in the arena)")
      ->check(number_range(0.1, 1e6))
      ->excludes(frames);
  app.add_option("--warm-up", options.warm_up, "Frames before them that do not count (200)")
      ->check(CLI::Range(0, 1000000));
  app.add_option("--deadline-ms", options.deadline_ms, "From capture to packet (a frame's period)")
      ->check(number_range(0.001, 1e6));
  app.add_option("--list", options.listed, "Worst frames to list (5)")->check(CLI::Range(1, 20));
  app.add_flag("--worst-frames", options.worst_frames,
               "Pictures that cost the most work instead of the board's camera, and no radio");
  app.add_flag("--load", options.load, "With stress-ng beside it: arithmetic on all processors, caches, memory, files");
  app.add_option("--out", outputs.json, "Write the numbers as JSON into this file");
  app.add_option("--histogram", outputs.histogram, "Draw the histogram into this file, .svg or .png")
      ->check([](const std::string& path) {
        return path.ends_with(".svg") || path.ends_with(".png") ? "" : path + " ends neither in .svg nor in .png";
      });
  app.add_option("--html", outputs.html, "Write the whole report as a page into this file");
  app.add_option("--compare", compared, "Measure nothing: hold the second JSON file against the first")
      ->expected(2)
      ->type_name("A.json B.json");
  app.final_callback([&] {
    if (compared.empty() && files.board.empty()) throw CLI::RequiredError("--board or --compare");
  });
  if (const auto exit_code = parse_arguments(app, argc, argv)) return *exit_code;
  return compared.empty() ? latency::measure(options) : latency::compare(compared[0], compared[1], outputs.html);
}
